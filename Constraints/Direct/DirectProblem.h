// What the direct solver minimizes, and what it answers. Filled from an island's constraints by the Solve stage, solved
// by DirectSolver.h; plain data.
//
// Over the velocities v of all bodies, with v* those without constraints and M the masses, it minimizes
//     (v - v*)^T M (v - v*) / 2 + v^T G v / 2 + sum over rows of s(J v + c),    s'(r) = -clamp(-r / gamma, lo, hi)
// The impulse of a row is -s'(J v + c) along J^T: a damper that takes any velocity it can within its limits. Its matrix
// M + G + J^T J / gamma is positive definite for any rows, redundant ones and those of loops too.
// Source: E. Todorov, "Convex and Analytically-Invertible Dynamics with Contacts and Constraints", ICRA 2014.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

namespace fulcrum {

// Velocities and Jacobians: linear, then angular about the center of mass.
struct DirectBody {
    double velocity[6];        // m/s, rad/s: v*
    double inverseMass;        // 1/kg, also of directions that are locked
    double inverseInertia[6];  // 1/(kg m^2), in the world: xx, yy, zz, xy, xz, yz; singular where rotation is locked
    uint32_t lockedAxes = 0;   // bits 0, 1, 2: x, y, z of translation
};

// J v = ja va + jb vb. Rows of one pair of bodies are best next to each other.
struct DirectRow {
    static constexpr uint32_t kNone = ~0u;
    static constexpr double kUnlimited = std::numeric_limits<double>::infinity();

    uint32_t a = kNone, b = kNone;  // different bodies of the island; kNone: c has its part of the velocity
    double ja[6] = {}, jb[6] = {};
    double c = 0;                              // m/s or rad/s
    double inverseGamma = 0;                   // kg or kg m^2; 0: the row is inactive
    double lo = -kUnlimited, hi = kUnlimited;  // N s or N m s, lo <= hi
    double impulse = 0;                        // before: the last one, with which the search begins; after: the result
};

// Friction of a contact. Its rows: `normals` ones (lo 0, hi unlimited), then two tangents with the same inverseGamma,
// then twist about the normal; all of the same pair of bodies. With N the sum of the normal impulses, the tangents'
// impulse is in the disc of radius friction * N, that of the twist row at most twistRadius times as large. Limits of
// the three rows are not read. With l its last impulse c of each of them is less by gamma l, so that what holds with l
// does not creep. N begins with the sum of the last impulses; where that is 0, friction is unlimited until N is known.
struct DirectPatch {
    static constexpr double kHolding = 0.999;  // friction within this part of its limit holds

    uint32_t firstNormal, normals;
    double friction;     // > 0
    double twistRadius;  // m
};

// Part of G: of the rotation of a body, positive semidefinite; kg m^2, that is, a stiffness times the time squared.
struct DirectStiffness {
    uint32_t body;
    double k[6];  // xx, yy, zz, xy, xz, yz
};

struct DirectProblem {
    std::span<const DirectBody> bodies;
    std::span<DirectRow> rows;
    std::span<const DirectPatch> patches;
    std::span<const DirectStiffness> stiffness;
    bool isAtRest = false;  // then normals of patches do not give way to their last impulses, either
};

struct DirectSettings {
    double tolerance = 0;  // m/s, of a body's unbalanced impulse over its mass; of torques over sqrt(mass inertia)
    // The same with limits of friction by the normal impulses found. If less is left than that, the solution has those
    // of the pass before: where bodies wedge each other, further passes would part from the solution.
    double limitTolerance = 0;
    double speed = 0.1;  // m/s: what bodies gain by gravity; only the way of the search depends on it
    uint32_t mostFactorizations = 60;
    uint32_t mostPasses = 6;  // solutions with limits of friction from the one before
};

struct DirectResult {
    enum class Outcome : uint8_t {
        Solved,
        Capped,          // more factorizations are needed than allowed
        Failed,          // not finite
        OutsidePattern,  // a row is of a pair of bodies that the pattern does not have
    };
    Outcome outcome = Outcome::Failed;
    // Limits of friction agree with the normal impulses, up to the tolerances; else with those of the pass before.
    bool limitsAgree = false;
    uint32_t factorizations = 0, chordSteps = 0, passes = 0;
    double residual = 0;  // m/s, as the tolerance
};

}  // namespace fulcrum
