// N contacts in SIMD lanes: the rows of their manifolds. No two contacts of a batch share a dynamic body.
//
// A manifold has one axis row per point along the normal n, two axis rows for friction along t1 and t2 at its center c,
// and one angle row about n. All of them depend only on the relative twist of the two bodies at c,
//     V = (v2 + w2 x r2) - (v1 + w1 x r1),   W = w2 - w1,
// and with a point at c + a t1 + b t2 its row is J v = V.n + b W.t1 - a W.t2. So a batch reads the twist once, iterates
// all its rows on six numbers with their small response matrices, and applies one wrench (F, T) at the end:
//     v += m^-1 F,  w += I^-1 (r x F + T),
// with m^-1 zero along the locked translations of a body.
// The result equals solving the axis and angle parts row after row (tests compare them), at half the arithmetic.
// Friction rows come first, normal rows last, so non-penetration wins.
//
// A surface velocity (conveyor belts) changes the target velocity of the friction rows along t1, t2 and about n. If B
// is static or kinematic it is added to the velocity of its contact point, at no cost. If B is dynamic, batches with
// such a contact use their own instance of the kernel, which reads the surface velocity by contact, so batches do not
// grow. So do batches with restitution.
//
// Applied to displacements since the start of the step instead of velocities, the same rows give the change of the
// separations.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactRecord.h>
#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Constraints/Parts/BodyState.h>
#include <Fulcrum/Constraints/Parts/RowSoftness.h>
#include <Fulcrum/Constraints/WarmStart.h>

namespace fulcrum {

// Body B of a contact if it is dynamic.
template <int N>
struct MovingSide {
    using Real = Wide<N>;
    Vec3<Real> arm;  // m, from its center of mass to c
    UniformInverseMass<Real> inverse;
};
// Body B if it is static or kinematic: only the motion of its point at c is needed.
template <int N>
struct FixedSide {
    using Real = Wide<N>;
    Twist<Real> velocity;  // at the start of the step
    // m/s2, of the velocity where the contact goes (PrepareContacts.cpp): a turntable carries its load along the arc.
    // Limited for bodies that rotate by more than a radian in the step: no more than the velocity changes within it.
    Vec3<Real> acceleration;
};

// A manifold is valid for small rotations only: points at a distance r from the center of a body that rotates by an
// angle t deviate by r t^2 / 2 from the straight line of the rows. And a body that slides over a surface gets to other
// triangles. These are the largest deviation and the largest sliding, as fractions of the smaller inner radius.
inline constexpr float kMostDeviation = 0.07f, kMostSliding = 0.25f;

// In a step overlaps grow up to this depth, and beyond it by this much, as fractions of the smaller inner radius:
// LimitDepth corrects more, with that tolerance. What grows slowly is left to the soft rows: a load sinks in.
inline constexpr float kMostDepth = 0.05f, kMostDeepening = 0.005f, kDepthTolerance = 0.005f;

template <int N, bool kFixedB>
struct ContactBatch {
    using Real = Wide<N>;
    static constexpr int kPoints = ContactRecord::kMaxPoints;

    // Indices of the records and of the bodies. The first `count` lanes are in use, the others repeat the last of them.
    uint32_t contact[N];
    uint32_t bodyA[N], bodyB[N];
    int32_t count;
    int32_t pointCount;     // maximum over the lanes
    bool bounces;           // some lane has restitution
    bool hasNotes = false;  // some lane reports contact events: see ContactNote
    bool hasSurface;        // second bodies are dynamic, and some lane has a surface velocity
    uint16_t gentle = 0;    // lanes whose penetration recovery is limited to RareContactData::gentlePushSpeed
    // Lanes whose bodies moved so far relative to each other that they should collide again.
    uint16_t rotated = 0, slid = 0;
    // Lanes with a velocity error above ContactSolveSettings::mostError before the last velocity iteration, and above
    // hitError, if B is static or kinematic.
    uint16_t unsolved = 0, hits = 0;
    // Lanes with an overlap that has grown by more in this step than LimitDepth allows.
    uint16_t deepened = 0;
    // How often the bodies collided in this step: they collide again after as many times the relative motion for which
    // one manifold is valid (UpdateSeparations).
    uint8_t collisions[N];
    bool hasCollidedAgain;  // some lane
    // Some body has locked translations. They get no velocity from impulses, and the responses are those of the free
    // axes. locks: bits 0..2, x, y and z of A; bits 3..5, those of B.
    bool isGuided = false;
    uint8_t locks[N];
    uint8_t locksOfAll, locksOfSome;  // of all lanes, and of any

    Real inverseSoftDepth;  // 1/m, of the overlap from which rows stiffen, see ContactSolveSettings

    // All that depends on the manifold, see ContactLanes.h.
    Vec3<Real> normal;
    Vec3<Real> armA;
    UniformInverseMass<Real> inverseA;
    std::conditional_t<kFixedB, FixedSide<N>, MovingSide<N>> sideB;

    struct Row {
        Real a, b;             // coordinates in the manifold along t1 and t2, m
        Real inverseResponse;  // effective mass, kg; 0: no point
        Real startSeparation;  // m, at the start of the step
        Real separation;       // m, current
        Real impulse;          // N s
    };
    Row rows[kPoints];
    Real response[6];  // J_i M^-1 J_j^T for (i, j) = 01 02 03 12 13 23

    // Of friction alone. Iterations without friction read nothing from here on.
    Vec3<Real> tangent1, tangent2;
    Real frictionInverse[3];   // effective masses of t1, t2, twist
    Real slideMass;            // kg, the smallest effective mass of any direction in the tangent plane
    Real frictionResponse[3];  // between t1 and t2, t1 and twist, t2 and twist
    Real coupling[3][3];       // change of V.n, W.t1, W.t2 by a unit impulse of t1, t2, twist
    Real frictionImpulse[3];
    Real friction, twistRadius;
};

struct ContactNote;

struct ContactPrepareSettings {
    float impulseScale;                           // dt of this substep / dt of the last: scales the warm start
    float restitutionSpeed;                       // m/s, see BounceContacts
    float dt = 0;                                 // s, of the step
    const MassOverride* massOverrides = nullptr;  // by record, for those with kMassOverride; null if none has one
    const SurfaceVelocity* surfaceVelocities = nullptr;  // by record; null if none has one
};

// What few batches read while they are solved.
struct RareContactData {
    const ContactRecord* records = nullptr;              // restitution
    const BodyPose* poses = nullptr;                     // accelerations, for contacts with restitution
    const SurfaceVelocity* surfaceVelocities = nullptr;  // as above
    float gentlePushSpeed = 0;                           // m/s, <= maxPushSpeed: for lanes that are `gentle`
};

struct ContactSolveSettings {
    float inverseDt;  // 1/s, of the substep
    float elapsed;    // s since the start of the step: gives the motion of static and kinematic sides
    // Penetration is recovered by a soft row, see Soften.
    float pushRate;          // 1/s: recovery speed per meter of overlap
    float maxPushSpeed = 0;  // m/s: limit of the recovery speed
    float massScale;         // 0..1: softened effective mass / effective mass
    float impulseScale;      // 0..1: fraction of the accumulated impulse that the soft row releases per iteration
    // A soft row yields in proportion to its load, however deep the overlap. Where the recovery speed has reached its
    // limit, a heavy load would win, and a light body under a heavy one would be pressed through its support. So rows
    // become stiffer as the overlap grows beyond that depth, and beyond a quarter of the smaller inner radius: at twice
    // that depth the stiffening reaches its limit mostStiffer.
    float stiffening = 0;   // s/m: reduction of impulseScale per m/s by which the limit cuts the recovery speed
    float mostStiffer = 0;  // 0..1: largest reduction
    float slop;             // m: allowed overlap, not corrected
    bool relaxes = true;    // relax iterations follow; friction is then left to those, but see StopRecovery
    // The largest velocity error of a normal row with which a contact counts as solved: 1/s, times inverseSoftDepth,
    // but at least leastError, m/s.
    float mostError = std::numeric_limits<float>::infinity(), leastError = 0;
    float hitError = std::numeric_limits<float>::infinity();  // likewise, above which it counts as a hit
    // Restitution, see BounceContacts:
    float restitutionSpeed = 0;      // m/s: restitution threshold, slower impacts do not bounce
    float* unconstrained = nullptr;  // of all bodies, eight floats each: velocities without the impulses that the next
                                     // substep's warm start applies again; null if there is none
    const RareContactData* rare = nullptr;  // for batches with restitution, surface velocities or gentle lanes
    ContactNote* notes = nullptr;  // of all contacts, by record, for batches with notes: impact impulses are added
    // Position passes, see CorrectContacts:
    float baumgarte = 0;       // 0..1: fraction of an overlap that an iteration corrects
    float mostCorrection = 0;  // m, limit per iteration

    // Sets maxPushSpeed and, from PushSoftnessOf (RowSoftness.h) for a substep of h seconds, pushRate, massScale and
    // impulseScale, and stiffening from both.
    void Soften(float frequency, float dampingRatio, float h, float itsMaxPushSpeed);
    // Hard rows that leave overlaps as they are, with friction: it cannot react to a recovery speed then, and resists
    // what impacts would slide by within the substep if friction were left to the relax iterations.
    void StopRecovery();
};

// Fills the rows of a batch whose contacts and bodies are set from the records. Returns the bit mask of lanes that got
// a number that is not finite: these are inactive.
template <int N, bool kFixedB>
uint32_t PrepareContacts(ContactBatch<N, kFixedB>& batch, const ContactRecord* records, const ConstSolverBodies& bodies,
                         const ContactPrepareSettings& settings);

// After PrepareContacts, for a batch with `isGuided`: scales the depths of the rows by the square of the share of the
// bodies' mobility that the locked translations leave, and limits them where that is small. A row that can move a body
// by its rotation alone would rotate it by the overlap over the lever arm, however short that is, and two such rows
// that contradict each other would spin it up.
template <int N, bool kFixedB>
void LimitGuidedPushes(ContactBatch<N, kFixedB>& batch);

// Applies the impulses of the last step.
template <int N, bool kFixedB>
void WarmStartContacts(ContactBatch<N, kFixedB>& batch, BodyState* states);

// The same where the warm start is scaled by island: see WarmStart.h.
template <int N, bool kFixedB>
void AddWarmStart(const ContactBatch<N, kFixedB>& batch, WarmStart* starts, const ContactSolveSettings& settings);
template <int N, bool kFixedB>
void ScaleImpulses(ContactBatch<N, kFixedB>& batch, const WarmStart* starts);

template <int N, bool kFixedB>
void SolveContactVelocities(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings);

// The same iteration for one lane, with successive over-relaxation of its normal rows; relax: that of RelaxContacts,
// with the separations as they are. Returns whether its velocity error was above ContactSolveSettings::mostError
// before.
template <int N, bool kFixedB>
bool IterateContact(ContactBatch<N, kFixedB>& batch, int lane, float overRelaxation, BodyState* states,
                    const ContactSolveSettings& settings, bool relax);

// Updates the separations from the displacements and solves the velocities again without penetration recovery: bodies
// keep the corrected positions but not the recovery velocity.
template <int N, bool kFixedB>
void RelaxContacts(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings);

// Updates the separations from the displacements, the lanes that should collide again, and those that deepened.
template <int N, bool kFixedB>
void UpdateSeparations(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings);

// A position iteration (Baumgarte): moves the bodies out of overlap, adds no velocity.
template <int N, bool kFixedB>
void CorrectContacts(const ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings);

// The same iteration over one lane, only for overlaps that have grown too much in the step (kMostDeepening), and back
// to what is allowed. Updates the separations. Returns whether it moved the bodies.
template <int N, bool kFixedB>
bool LimitDepth(ContactBatch<N, kFixedB>& batch, int lane, BodyState* states, const ContactSolveSettings& settings);

// Replaces the rows of a lane by those of its record, `elapsed` seconds after the start of the step: with kRecollided
// after the bodies collided again, with kApart by inactive ones. records: impulses are those of the last substep.
// bodies: body A at index 0 and body B at index 1, at their poses at that time, with their displacements since the
// start of the step. freeA, freeB: velocities without the impulses that the next substep's warm start applies again,
// eight floats each; freeB is null if B is static or kinematic. The warm start becomes that of the new rows.
template <int N, bool kFixedB>
void RefillContact(ContactBatch<N, kFixedB>& batch, int lane, const ContactRecord* records,
                   const ConstSolverBodies& bodies, float* freeA, float* freeB, const ContactPrepareSettings& settings,
                   float elapsed);

// Writes the impulses back to the records, divided by `impulseScale`.
template <int N, bool kFixedB>
void StoreContacts(const ContactBatch<N, kFixedB>& batch, ContactRecord* records, float impulseScale = 1.0f);

}  // namespace fulcrum
