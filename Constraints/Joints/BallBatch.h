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
    uint32_t high;                    // bit i: as in JointBatch
    bool round;                       // all bodies have isotropic inertia
    bool turning;  // some lane's inertia rotates with its body: inertias are read anew in every substep

    Vec3<Real> impulse;     // on B, of this substep, N s
    Vec3<Real> aim;         // m/s: the bias, see AimAtEnd in JointKernels.h
    Vec3<Real> armA, armB;  // from the centers of mass to the point at which impulses act, m
    Sym3<Real> mass;        // K^-1, see PointPart.h
    Real turns;             // 1: an inertia of this lane turns
    Vec3<Real> earlier;     // sum of the impulses of earlier substeps
    Real inverseMassA, inverseMassB;
    Real inverseInertiaA, inverseInertiaB;  // if round
    Vec3<Real> startArmA, startArmB, startOffset;
    Sym3<Real> inertiaA, inertiaB;  // inverses; if not round
};

// Like the functions of JointBatch.h. The rotation of non-kinematic bodies is read from BodyState::halfTurn.
template <int N>
void PrepareJoints(BallBatch<N>& batch, const JointRecord* records, const ConstSolverBodies& bodies,
                   const JointSolveSettings& settings, JointFindings& findings);
template <int N>
void AddWarmStart(BallBatch<N>& batch, BodyState* states, WarmStart* starts, const JointSolveSettings& settings);
template <int N>
void ScaleImpulses(BallBatch<N>& batch, const WarmStart* starts);
template <int N>
void SolveJointVelocities(BallBatch<N>& batch, BodyState* states, const JointSolveSettings& settings);
template <int N>
void CorrectJoints(BallBatch<N>& batch, const SolverBodies& bodies, WarmStart* starts,
                   const JointSolveSettings& settings);
template <int N>
void StoreJoints(const BallBatch<N>& batch, JointRecord* records, float dt, float impulseScale);

}  // namespace fulcrum
