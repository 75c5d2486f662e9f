// Integration of bodies with constraints in a substep. Called by Solve, for disjoint sets of bodies from any number of
// threads at once. In lanes, except for bodies that need special treatment.
#pragma once

#include <Fulcrum/Constraints/WarmStart.h>
#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// How the velocities of a substep begin.
enum class SubstepStart {
    First,    // the first substep of the step
    Carries,  // with the change that constraints made in the last substep, which replaces their warm start
    Anew      // as the last substep left them: the constraints are warm started explicitly
};

// Applies forces, damping, locked axes and speed limits for h seconds.
void IntegrateVelocities(BodyStore& store, const JointStore& joints, std::span<const uint32_t> bodies, float h,
                         SubstepStart start, WorkerFindings& findings);

// The gyroscopic torque of jointed bodies acts for half of a substep before they turn, and for half of it after that.
enum class GyroscopicHalves {
    First,   // of this substep: for the velocities after the warm start, which follows
    Second,  // of the substep that ends
    Both     // the second of the last substep, then the first of this one: at the same poses
};

// Applies these halves for substeps of h seconds. starts: by body. What the warm start changes of an angular velocity
// counts from before the first half, at the principal axes at which it acts: it changes the angular momentum by its
// torque, where after the first half it would change that across by as much as the body turns.
void AddGyroscopicTorque(BodyStore& store, const JointStore& joints, std::span<const uint32_t> bodies, float h,
                         GyroscopicHalves halves, const WarmStart* starts);

// Inputs of IntegratePoses, and the bodies, which it moves. Colliders and pairs are used for the contacts of dispersing
// bodies.
struct MovedBodies {
    const SystemSettings& settings;
    const ColliderStore& colliders;
    const PairStore& pairs;
    const JointStore& joints;
    BodyStore& store;
};

// Integrates displacements for h seconds, within speed limits, and rotates the inertia of jointed bodies. Bodies
// without constraint impulses move by v h - a h^2 / 2, which is exact; the correction is applied by the next substep
// or, if isLast, by this one.
void IntegratePoses(const MovedBodies& moved, std::span<const uint32_t> bodies, float h, bool isLast,
                    WorkerFindings& findings);

enum class GyroscopicRule {
    Midpoint,  // the implicit midpoint rule
    // Products averaged over both ends, x' - x = r (y z' + y' z), r = h (Iy - Iz) / 2 Ix, and so on, which are linear
    // in the new velocity (R. Hirota, K. Kimura, Discretization of the Euler Top, Journal of the Physical Society of
    // Japan 69, 2000). Without iterations, time-reversible, and exact in the spin of a body of revolution at any speed.
    Reversible
};

// The angular velocity after h seconds of gyroscopic torque, at the principal axes then reached: Euler's equations in
// the frame of the body. It conserves energy, and the spin of a body of revolution about its axis; an integrator that
// conserves momentum in world axes lets the spin of a thin rod grow without bound. inverseInertia: principal, 1/(kg
// m2). Real: float, or lanes.
template <class Real, GyroscopicRule kRule = GyroscopicRule::Midpoint>
FULCRUM_FORCE_INLINE Vec3<Real> AddGyroscopicTorque(const Vec3<Real>& inverseInertia, const Mat3<Real>& axes,
                                                    const Vec3<Real>& w, Real h) {
    // Only ratios of the moments matter: (1 / iy - 1 / iz) ix = ix^2 (iz - iy) / (ix iy iz), and so on.
    const Vec3<Real> i =
        inverseInertia * (Real(1.0f) / Max(Max(inverseInertia.x(), inverseInertia.y()), inverseInertia.z()));
    const Real product = i[0] * i[1] * i[2];
    const Real scale = h / product;
    const Vec3<Real> rate(scale * (i[0] * i[0] * (i[2] - i[1])), scale * (i[1] * i[1] * (i[0] - i[2])),
                          scale * (i[2] * i[2] * (i[1] - i[0])));
    const Vec3<Real> inertia(i[1] * i[2], i[2] * i[0], i[0] * i[1]);  // moments times the product
    const Vec3<Real> start(Dot<Real>(axes.x, w), Dot<Real>(axes.y, w), Dot<Real>(axes.z, w));
    const auto energyOf = [&](const Vec3<Real>& u) {
        return inertia.x() * u.x() * u.x() + inertia.y() * u.y() * u.y() + inertia.z() * u.z() * u.z();
    };
    Vec3<Real> end = start;
    if constexpr (kRule == GyroscopicRule::Reversible) {
        // By Cramer's rule.
        const Vec3<Real> r = rate * Real(0.5f);
        const Real &x = start.x(), &y = start.y(), &z = start.z();
        const Vec3<Real> v(x + r.x() * y * z, y + r.y() * z * x, z + r.z() * x * y);
        const Real determinant = Real(1.0f) - (r.y() * r.z() * x * x + r.z() * r.x() * y * y + r.x() * r.y() * z * z) -
                                 Real(2.0f) * (r.x() * r.y() * r.z()) * (x * y * z);
        const Real twice = Real(2.0f) / determinant;
        end += Vec3<Real>(r.x() * v.y() * v.z() * twice, r.y() * v.z() * v.x() * twice, r.z() * v.x() * v.y() * twice);
    } else {
        constexpr int kIterations = 3;
        for (int n = 0; n < kIterations; ++n) {
            const Vec3<Real> middle = (start + end) * Real(0.5f);
            end = start + Vec3<Real>(rate.x() * middle.y() * middle.z(), rate.y() * middle.z() * middle.x(),
                                     rate.z() * middle.x() * middle.y());
        }
    }
    // Gyroscopic torque does no work. Changes within rounding are ignored: their bias would accumulate.
    const Real ratio = energyOf(start) / energyOf(end);
    const Real keeping = Select(Abs(ratio - Real(1.0f)) < Real(1e-6f), Real(1.0f), Sqrt(ratio));
    // Only the change is transformed by the axes: they are not exactly of unit length, and w would grow or shrink with
    // each substep.
    const Vec3<Real> turned = w + axes * Vec3<Real>(end * keeping - start);
    // No torque if a moment is infinite, or if the ratio of moments overflows a float.
    const auto isKnown = (product > Real(0.0f)) & ((turned[0] + turned[1] + turned[2]) * Real(0.0f) == Real(0.0f));
    Vec3<Real> result;
    for (int k = 0; k < 3; ++k) result[k] = Select(isKnown, Real(turned[k]), Real(w[k]));
    return result;
}

}  // namespace fulcrum
