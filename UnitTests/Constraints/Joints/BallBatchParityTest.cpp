// Ball joints solved by kernels of their own: the same bits in lanes and one by one, the physics of any other joint.
#include <Fulcrum/Constraints/Joints/JointKernels.h>
#include <Fulcrum/UnitTests/Constraints/Joints/RandomBalls.h>

#include <gtest/gtest.h>

#include <cstring>

namespace fulcrum::testing {
namespace {

constexpr uint32_t kBalls = 4 * 7 + 1;  // no multiple of any number of lanes

// The whole life of joints over two substeps of two passes each.
template <class Batches, class Verbs>
JointFindings Live(RandomJoints& joints, Batches& batches, const Verbs& verbs) {
    JointSolveSettings settings = DefaultJointSettings();
    JointFindings findings;
    for (auto& batch : batches) verbs.prepare(batch, settings, findings);
    for (int substep = 0; substep < 2; ++substep) {
        settings.continues = substep > 0;
        settings.elapsed = settings.substepDt * static_cast<float>(substep + 1);
        std::vector<WarmStart> starts(joints.states.size());
        for (auto& batch : batches) AddWarmStart(batch, joints.states.data(), starts.data(), settings);
        joints.ApplyHalf(starts);
        for (auto& batch : batches) ScaleImpulses(batch, starts.data());
        for (int pass = 0; pass < 2; ++pass)
            for (auto& batch : batches) SolveJointVelocities(batch, joints.states.data(), settings);
        joints.Move(settings.substepDt);
        for (int pass = 0; pass < 2; ++pass)
            for (auto& batch : batches) CorrectJoints(batch, joints.Bodies(), nullptr, settings);
    }
    for (auto& batch : batches) verbs.store(batch, settings.dt);
    return findings;
}

struct BallVerbs {
    RandomJoints& joints;
    void prepare(auto& batch, const JointSolveSettings& s, JointFindings& findings) const {
        PrepareJoints(batch, joints.records.data(), joints.Bodies(), s, findings);
    }
    void store(auto& batch, float dt) const { StoreJoints(batch, joints.records.data(), dt, 1.0f); }
};

struct JointVerbs {
    RandomJoints& joints;
    void prepare(auto& batch, const JointSolveSettings& s, JointFindings& findings) const {
        PrepareJoints(batch, joints.records.data(), joints.typePointers.data(), joints.Bodies(), s, findings);
    }
    void store(auto& batch, float dt) const {
        StoreJoints(batch, joints.records.data(), joints.typePointers.data(), joints.states.data(), dt, 1.0f);
    }
};

struct LivedBalls {
    std::vector<BodyState> states;
    std::vector<JointRecord> records;
    JointFindings findings;
};

template <int N>
LivedBalls LiveAsBalls(uint32_t seed, const BallOptions& options) {
    RandomJoints joints = RandomBalls(kBalls, seed, options);
    std::vector<JointRows<N>> rows;
    std::vector<BallBatch<N>> batches;
    for (const JointBatch<N>& batch : joints.Batches<N>(rows)) batches.push_back(BallsOf(batch, options.round));
    LivedBalls lived;
    lived.findings = Live(joints, batches, BallVerbs{joints});
    lived.states = std::move(joints.states);
    lived.records = std::move(joints.records);
    return lived;
}

LivedBalls LiveAsJoints(uint32_t seed, const BallOptions& options) {
    RandomJoints joints = RandomBalls(kBalls, seed, options);
    std::vector<JointRows<1>> rows;
    std::vector<JointBatch<1>> batches = joints.Batches<1>(rows);
    LivedBalls lived;
    lived.findings = Live(joints, batches, JointVerbs{joints});
    lived.states = std::move(joints.states);
    lived.records = std::move(joints.records);
    return lived;
}

void ExpectSameBits(const LivedBalls& a, const LivedBalls& b, int lanes) {
    for (size_t i = 0; i < a.records.size(); ++i)
        EXPECT_EQ(std::memcmp(&a.records[i], &b.records[i], sizeof(JointRecord)), 0) << lanes << " lanes, joint " << i;
    for (size_t i = 0; i < a.states.size(); ++i)
        EXPECT_EQ(std::memcmp(&a.states[i], &b.states[i], sizeof(BodyState)), 0) << lanes << " lanes, body " << i;
    EXPECT_EQ(a.findings.linearError, b.findings.linearError);
    EXPECT_EQ(a.findings.linearJoint, b.findings.linearJoint);
}

template <class Test>
void ForAllOptions(Test&& test) {
    for (bool round : {false, true})
        for (bool someFixed : {false, true})
            for (bool inPlane : {false, true})
                for (uint32_t seed = 1; seed <= 3; ++seed)
                    test(seed, BallOptions{round, {.someFixed = someFixed, .inPlane = inPlane}});
}

TEST(BallBatch, GivesTheSameBitsInLanesAndOneByOne) {
    ForAllOptions([](uint32_t seed, const BallOptions& options) {
        const LivedBalls one = LiveAsBalls<1>(seed, options);
        ExpectSameBits(one, LiveAsBalls<kLanes>(seed, options), kLanes);
    });
}

// Both are the same mathematics in another order: some twenty roundings of 6e-8 of speeds up to 1 m/s and 10 rad/s, and
// of forces that are impulses of such speeds and masses of 2 kg, over 1/60 s.
TEST(BallBatch, DoesWhatOtherJointsDo) {
    ForAllOptions([](uint32_t seed, const BallOptions& options) {
        const LivedBalls balls = LiveAsBalls<kLanes>(seed, options), joints = LiveAsJoints(seed, options);
        EXPECT_EQ(balls.findings.linearJoint, joints.findings.linearJoint);
        EXPECT_EQ(balls.findings.linearError, joints.findings.linearError);
        for (size_t i = 0; i < balls.states.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                const BodyState &ball = balls.states[i], &joint = joints.states[i];
                EXPECT_NEAR(ball.linearVelocity[k], joint.linearVelocity[k], 2e-5) << "body " << i;
                EXPECT_NEAR(ball.angularVelocity[k], joint.angularVelocity[k], 1e-4) << "body " << i;
                EXPECT_NEAR(ball.deltaPosition[k], joint.deltaPosition[k], 2e-7) << "body " << i;
                EXPECT_NEAR(ball.deltaRotation[k], joint.deltaRotation[k], 1e-6) << "body " << i;
            }
        for (size_t i = 0; i < balls.records.size(); ++i)
            for (int k = 0; k < 3; ++k) {
                EXPECT_NEAR(balls.records[i].ownImpulse[k], joints.records[i].ownImpulse[k], 2e-5) << "joint " << i;
                EXPECT_NEAR(balls.records[i].totalForce[k], joints.records[i].totalForce[k], 1e-2) << "joint " << i;
                EXPECT_EQ(balls.records[i].totalForce[k], balls.records[i].lockForce[k]) << "joint " << i;
                EXPECT_EQ(balls.records[i].totalTorque[k], 0.0f) << "joint " << i;
            }
    });
}

}  // namespace
}  // namespace fulcrum::testing
