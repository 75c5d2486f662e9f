// N contacts side by side: the rows of their manifolds, solved in lanes. No two contacts of a batch share a moving
// body.
//
// A manifold has one axis row per point along the normal n, two axis rows for friction along t1 and t2 at its center c,
// and one angle row about n. All of them look at nothing but the relative twist of the two bodies at c,
//     V = (v2 + w2 x r2) - (v1 + w1 x r1),   W = w2 - w1,
// and with a point at c + a t1 + b t2 its row is J v = V.n + b W.t1 - a W.t2. So a batch reads the twist once, relaxes
// all its rows on six numbers by means of their small response matrices, and applies one wrench (F, T) at the end:
//     v += m^-1 F,  w += I^-1 (r x F + T).
// This is the sequence of the axis and angle parts, row after row (the tests compare), at half the arithmetic. The
// friction rows come first, the normal rows last: non-penetration wins.
//
// A surface that moves on its body, as a belt does, changes what friction aims at: along t1, t2 and about n, B's
// surface has a velocity of its own. Where B is fixed that is part of the motion of its point, and costs nothing; where
// it moves, batches with such a contact have their own instance of the kernel, which looks it up in the records:
// batches grow by nothing.
//
// The same rows read positions: with displacements since the start of the step in place of velocities, the row gives
// the change of the separation.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactRecord.h>
#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Constraints/Parts/BodyState.h>
#include <Fulcrum/Constraints/Parts/RowSoftness.h>

namespace fulcrum {

// Body B of a contact where it is dynamic.
template <int N>
struct MovingSide {
    using Real = Wide<N>;
    uint32_t body[N];
    Vec3<Real> arm;  // m, from its center of mass to c
    InverseMass<Real> inverse;
};
// Body B where it is static or kinematic: only the motion of its point at c is needed.
template <int N>
struct FixedSide {
    using Real = Wide<N>;
    Twist<Real> velocity;  // at the start of the step
    // m/s2, centripetal, w x (w x r): a turntable carries its load along the arc. Of what turns by more than a radian
    // in the step less: no more than its velocity changes by within the step.
    Vec3<Real> acceleration;
};

template <int N, bool kFixedB>
struct ContactBatch {
    using Real = Wide<N>;
    static constexpr int kPoints = ContactRecord::kMaxPoints;

    uint32_t contact[N];  // indices of the records; the first `count` lanes are in use
    uint32_t bodyA[N];
    int32_t count;
    int32_t pointCount;     // largest of the lanes
    bool bounces;           // some lane has restitution
    bool hasNotes = false;  // some lane has contact events: see ContactNote
    const ContactRecord*
        surfaces;  // where the second bodies move and some lane has a surface velocity: the records; else null

    Vec3<Real> normal, tangent1, tangent2;
    Vec3<Real> armA;
    InverseMass<Real> inverseA;
    std::conditional_t<kFixedB, FixedSide<N>, MovingSide<N>> sideB;

    struct Row {
        Real a, b;             // place in the manifold, m
        Real inverseResponse;  // effective mass, kg; 0: no point
        Real startSeparation;  // m, at the start of the step
        Real separation;       // m, now
        Real impulse;          // N s
    };
    Row rows[kPoints];
    Real response[6];          // J_i M^-1 J_j^T for (i, j) = 01 02 03 12 13 23
    Real frictionInverse[3];   // effective masses of t1, t2, twist
    Real slideMass;            // kg, the least effective mass of any direction in the plane
    Real frictionResponse[3];  // between t1 and t2, t1 and twist, t2 and twist
    Real coupling[3][3];       // change of V.n, W.t1, W.t2 by a unit impulse of t1, t2, twist
    Real frictionImpulse[3];
    Real friction, twistRadius;
    Real maxPushSpeed;      // m/s: the fastest that overlaps are pushed apart
    Real inverseSoftDepth;  // 1/m, of the overlap from which on rows give way less, see ContactSolveSettings

    // Only where `bounces`.
    Real restitution;   // 0..1
    Real closing;       // m/s2 that gravity and forces press the bodies together by, along the normal
    Real acceleration;  // m/s2 of gravity and forces, of the body that has the larger one
};

struct ContactNote;

struct ContactPrepareSettings {
    float impulseScale;                           // dt of this substep / dt of the last: scales the warm start
    float restitutionSpeed;                       // m/s, see BounceContacts
    float maxPushSpeed;                           // m/s
    float dt = 0;                                 // s, of the step
    const MassOverride* massOverrides = nullptr;  // by record, of those with kMassOverride; null where none has one
};

struct ContactSolveSettings {
    float inverseDt;  // 1/s, of the substep
    float elapsed;    // s since the start of the step: where fixed sides are
    // Points that overlap are pushed apart by a soft row, see Soften.
    float pushRate;      // 1/s: speed of the push per meter of overlap
    float massScale;     // 0..1: softened effective mass / effective mass
    float impulseScale;  // 0..1: part of the impulse that the row gives way by
    // A soft row gives way in proportion to its load, however deep the overlap: a push that has reached its largest
    // speed would lose against a heavy one, and a light body under a heavy one would be pressed through what it lies
    // on. So rows give way less the deeper the overlap is beyond that, and beyond a quarter of the smaller inner
    // radius: not at all, but for mostStiffer, at twice that depth.
    float stiffening = 0;   // s/m: by so much of the impulse less for each m/s that the push falls short
    float mostStiffer = 0;  // 0..1: but never by more than this
    float slop;             // m: overlap that is left alone
    bool relaxes = true;    // relaxing passes follow, which friction is left to
    // Bounces, see BounceContacts:
    float restitutionSpeed = 0;      // m/s: slower impacts do not bounce
    float* unconstrained = nullptr;  // of all bodies, eight floats each: velocities without what the next substep's
                                     // warm start repeats; null where there is none
    ContactNote* notes = nullptr;    // of all contacts, by record, for batches with notes: what bounces do is added
    // Position passes, see CorrectContacts:
    float baumgarte = 0;       // 0..1: the part of an overlap that a pass corrects
    float mostCorrection = 0;  // m, by a pass

    // Sets pushRate, massScale and impulseScale to those of PushSoftnessOf (RowSoftness.h), for a substep of h seconds,
    // and stiffening by the usual largest speed of pushes, m/s.
    void Soften(float frequency, float dampingRatio, float h, float maxPushSpeed);
};

// Fills the batch of `batch.contact[0 .. count)` from the records, which it may look at until they are stored; bodyB[]
// are the second bodies. Returns the lanes, bit by bit, of which some number came out not finite: these do nothing.
template <int N, bool kFixedB>
uint32_t PrepareContacts(ContactBatch<N, kFixedB>& batch, const ContactRecord* records, const uint32_t (&bodyB)[N],
                         const ConstSolverBodies& bodies, const ContactPrepareSettings& settings);

// Applies the impulses of the last step.
template <int N, bool kFixedB>
void WarmStartContacts(ContactBatch<N, kFixedB>& batch, BodyState* states);

template <int N, bool kFixedB>
void SolveContactVelocities(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings);

// Brings the separations up to date with the displacements, and solves the velocities again without any push: what was
// pushed apart keeps its place but not its speed.
template <int N, bool kFixedB>
void RelaxContacts(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings);

// Brings the separations up to date.
template <int N, bool kFixedB>
void UpdateSeparations(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings);

// A position pass (Baumgarte): moves the bodies out of overlaps, adds no speed.
template <int N, bool kFixedB>
void CorrectContacts(const ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings);

// One pass over the pseudo-velocities, in the velocities' place in `pseudo`, by which joints that are far apart are
// pulled together (PullJoints): points may close their gaps within the substep and approach no further. Sets
// BodyState::nearFixed where the second bodies are fixed.
template <int N, bool kFixedB>
void PullContacts(const ContactBatch<N, kFixedB>& batch, BodyState* pseudo, const ContactSolveSettings& settings);

// Writes the impulses back to the records, divided by `impulseScale`.
template <int N, bool kFixedB>
void StoreContacts(const ContactBatch<N, kFixedB>& batch, ContactRecord* records, float impulseScale = 1.0f);

}  // namespace fulcrum
