// Ball joints between random bodies, in batches of their own. For the tests and the benchmarks of their kernels, so
// without a test library. One thread.
#pragma once

#include <Fulcrum/Constraints/Joints/BallBatch.h>
#include <Fulcrum/UnitTests/Constraints/Joints/RandomJoints.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace fulcrum::testing {

struct BallOptions {
    bool round;
    RandomJoints::Options joints;
};

inline const JointCase& PointJointCase() {
    for (const JointCase& how : AllJointCases())
        if (std::string_view(how.kind) == "point") return how;
    return AllJointCases().front();
}

inline RandomJoints RandomBalls(uint32_t count, uint32_t seed, const BallOptions& options) {
    RandomJoints joints(std::span(&PointJointCase(), 1), count, seed, options.joints);
    for (size_t i = 0; i < joints.states.size(); ++i) {
        BodyState& state = joints.states[i];
        std::fill(std::begin(state.deltaPosition), std::end(state.deltaPosition), 0.0f);
        std::fill(std::begin(state.deltaRotation), std::end(state.deltaRotation), 0.0f);
        if (!options.round) continue;
        float(&inertia)[6] = joints.masses[i].inverseInertia;
        inertia[1] = inertia[2] = inertia[0];
        inertia[3] = inertia[4] = inertia[5] = 0;
        joints.masses[i].flags = 0;
    }
    return joints;
}

template <int N>
BallBatch<N> BallsOf(const JointBatch<N>& joints, bool round) {
    BallBatch<N> balls{};
    std::copy(joints.joint, joints.joint + N, balls.joint);
    std::copy(joints.bodyA, joints.bodyA + N, balls.bodyA);
    std::copy(joints.bodyB, joints.bodyB + N, balls.bodyB);
    balls.count = joints.count;
    balls.fixedA = joints.fixedA;
    balls.fixedB = joints.fixedB;
    balls.kinematicA = joints.kinematicA;
    balls.high = joints.high;
    balls.kinematicB = joints.kinematicB;
    balls.round = round;
    return balls;
}

}  // namespace fulcrum::testing
