// N ball joints side by side, solved in lanes: joints that hold two points together and do nothing else, the most
// frequent kind. What JointBatch.h says of joints holds for them; they have kernels and a batch of their own because a
// large part of their time is the way from memory, and this is a third smaller. No two joints of a batch share a moving
// body. Called by the stages Prepare, Solve and Store; one thread per batch.
#pragma once

#include <Fulcrum/Constraints/Joints/JointBatch.h>

namespace fulcrum {

template <int N>
struct alignas(64) BallBatch {
    using Real = Wide<N>;
    uint32_t bodyA[N], bodyB[N];
    uint32_t joint[N];  // indices of the records; the first `count` lanes are in use
    int32_t count;
    uint32_t fixedA, fixedB;          // bit i: the body of lane i is not dynamic
    uint32_t kinematicA, kinematicB;  // bit i: but it moves
    bool round;                       // no body has an inertia that depends on the direction
    bool turning;                     // inertias of some lane turn from substep to substep: they are read again

    Vec3<Real> impulse;           // on B, of this substep, N s
    Vec3<Real> push;              // m/s
    Vec3<Real> armA, armB;        // from the centers to the point at which impulses act, m
    Sym3<Real> mass;              // K^-1, see PointPart.h
    Vec3<Real> turnedA, turnedB;  // rad/s: what the turning of the arms changed of the impulse
    Vec3<Real> earlier;           // impulses of the substeps before, summed
    Real inverseMassA, inverseMassB;
    Real inverseInertiaA, inverseInertiaB;  // where all are round
    Vec3<Real> startArmA, startArmB, startOffset;
    Sym3<Real> inertiaA, inertiaB;  // inverses; where not all are round

    // Of lanes that are far apart, as in JointBatch.
    bool far;  // some lane is
    Real isFar, isDistant, follows;
    Real secondsOfTeleport;  // as the step ends, see JointRecord
    Vec3<Real> pull;         // m/s
};

// As those of JointBatch.h. Of bodies that are not kinematic they read how far they turned as BodyState::halfTurn says.
template <int N>
void PrepareJoints(BallBatch<N>& batch, const JointRecord* records, const ConstSolverBodies& bodies,
                   const JointSolveSettings& settings, JointFindings& findings);
template <int N>
void WarmStartJoints(const BallBatch<N>& batch, BodyState* states);
template <int N>
void SolveJointVelocities(BallBatch<N>& batch, BodyState* states, const JointSolveSettings& settings);
template <int N>
void RelaxJoints(BallBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings);
template <int N>
void UpdateJoints(BallBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings);
template <int N>
void CorrectJoints(BallBatch<N>& batch, const SolverBodies& bodies, const JointSolveSettings& settings);
// The same with the pseudo-velocities of joints that are far apart.
template <int N>
void PullJoints(BallBatch<N>& batch, BodyState* pseudo, const JointSolveSettings& settings);
template <int N>
void StoreJoints(const BallBatch<N>& batch, JointRecord* records, float dt, float impulseScale);

}  // namespace fulcrum
