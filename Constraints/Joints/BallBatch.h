// N ball joints side by side, solved in lanes: joints with a point lock and nothing else, the most frequent kind.
// JointBatch.h explains the solver; ball joints have a batch and kernels of their own because their cost is mostly
// memory traffic, and this batch is a third smaller. No two joints of a batch share a dynamic body. Called by the
// stages Prepare, Solve and Store; one thread per batch.
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
    uint32_t kinematicA, kinematicB;  // bit i: not dynamic, but kinematic and moving
    uint32_t pushed;                  // bit i: as in JointBatch
    bool round;                       // all bodies have isotropic inertia
    bool turning;  // some lane's inertia rotates with its body: inertias are read anew in every substep

    Vec3<Real> impulse;           // on B, of this substep, N s
    Vec3<Real> push;              // m/s
    Vec3<Real> armA, armB;        // from the centers of mass to the point at which impulses act, m
    Sym3<Real> mass;              // K^-1, see PointPart.h
    Vec3<Real> turnedA, turnedB;  // rad/s: change of velocity due to the rotation of the arms
    Vec3<Real> earlier;           // sum of the impulses of earlier substeps
    Real inverseMassA, inverseMassB;
    Real inverseInertiaA, inverseInertiaB;  // if round
    Vec3<Real> startArmA, startArmB, startOffset;
    Sym3<Real> inertiaA, inertiaB;  // inverses; if not round

    // For lanes that are far apart, as in JointBatch.
    bool far;  // some lane is far apart
    Real isFar, isDistant, follows;
    Real secondsOfTeleport;  // at the end of the step, see JointRecord
    Vec3<Real> pull;         // m/s
};

// Like the functions of JointBatch.h. The rotation of non-kinematic bodies is read from BodyState::halfTurn.
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
