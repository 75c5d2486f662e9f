// Joints of every kind solved one by one and in lanes: the same bits, joint by joint, whatever joints share a batch.
#include <Fulcrum/UnitTests/Constraints/Joints/RandomJoints.h>

#include <gtest/gtest.h>

#include <cstring>

namespace fulcrum::testing {
namespace {

constexpr uint32_t kJoints = 4 * 22 + 1;  // no multiple of any number of lanes

struct Solved {
    std::vector<BodyState> states;
    std::vector<JointRecord> records;
    std::vector<std::array<float, JointRowList::kMaxRows>> impulses;
    JointFindings findings;
};

// The whole life of joints over two substeps of two passes each.
template <int N>
Solved Solve(std::span<const JointCase> cases, uint32_t seed, const RandomJoints::Options& options) {
    RandomJoints joints(cases, kJoints, seed, options);
    for (BodyState& state : joints.states) {
        std::fill(std::begin(state.deltaPosition), std::end(state.deltaPosition), 0.0f);
        std::fill(std::begin(state.deltaRotation), std::end(state.deltaRotation), 0.0f);
    }
    std::vector<JointRows<N>> rows;
    std::vector<JointBatch<N>> batches = joints.Batches<N>(rows);
    BodyState* states = joints.states.data();
    JointSolveSettings settings = DefaultJointSettings();
    Solved solved;
    for (JointBatch<N>& batch : batches)
        PrepareJoints(batch, joints.records.data(), joints.typePointers.data(), joints.Bodies(), settings,
                      solved.findings);
    for (int substep = 0; substep < 2; ++substep) {
        settings.continues = substep > 0;
        settings.elapsed = settings.substepDt * static_cast<float>(substep + 1);
        std::vector<WarmStart> starts(joints.states.size());
        for (JointBatch<N>& batch : batches) AddWarmStart(batch, states, starts.data(), settings);
        joints.ApplyHalf(starts);
        for (JointBatch<N>& batch : batches) ScaleImpulses(batch, starts.data());
        for (int pass = 0; pass < 2; ++pass)
            for (JointBatch<N>& batch : batches) SolveJointVelocities(batch, states, settings);
        joints.Move(settings.substepDt);
        for (int pass = 0; pass < 2; ++pass)
            for (JointBatch<N>& batch : batches) CorrectJoints(batch, joints.Bodies(), nullptr, settings);
    }
    for (JointBatch<N>& batch : batches)
        StoreJoints(batch, joints.records.data(), joints.typePointers.data(), states, settings.dt, 1.0f);
    for (const JointType* type : joints.typePointers) solved.impulses.push_back(type->impulses);
    solved.states = std::move(joints.states);
    solved.records = std::move(joints.records);
    return solved;
}

void ExpectSameBits(std::span<const JointCase> cases, const Solved& a, const Solved& b, const std::string& lanes) {
    const auto same = [](const auto& x, const auto& y) { return std::memcmp(&x, &y, sizeof x) == 0; };
    for (size_t i = 0; i < a.records.size(); ++i) {
        const JointCase& how = cases[i % cases.size()];
        EXPECT_TRUE(same(a.records[i], b.records[i])) << lanes << ", record of " << how.kind << ", " << how.state;
        EXPECT_TRUE(same(a.impulses[i], b.impulses[i])) << lanes << ", rows of " << how.kind << ", " << how.state;
    }
    for (size_t i = 0; i < a.states.size(); ++i) EXPECT_TRUE(same(a.states[i], b.states[i])) << lanes << ", body " << i;
    EXPECT_EQ(a.findings.linearError, b.findings.linearError);
    EXPECT_EQ(a.findings.angularError, b.findings.angularError);
    EXPECT_EQ(a.findings.linearJoint, b.findings.linearJoint);
    EXPECT_EQ(a.findings.angularJoint, b.findings.angularJoint);
}

void ExpectParity(std::span<const JointCase> cases, const RandomJoints::Options& options) {
    for (uint32_t seed = 1; seed <= 5; ++seed) {
        const Solved one = Solve<1>(cases, seed, options);
        ExpectSameBits(cases, one, Solve<kLanes>(cases, seed, options), kSimdName);
    }
}

TEST(JointParity, OfEachKindAlone) {
    for (const JointCase& how : AllJointCases()) ExpectParity(std::span(&how, 1), {});
}

// Joints with and without rows, of different kinds, share the batches of their locks.
TEST(JointParity, OfAllKindsMixed) { ExpectParity(AllJointCases(), {}); }

TEST(JointParity, WithBodiesThatAreFixedOrKinematic) { ExpectParity(AllJointCases(), {.someFixed = true}); }

TEST(JointParity, KeepsTheSignsOfZerosInAPlane) { ExpectParity(AllJointCases(), {.someFixed = true, .inPlane = true}); }

}  // namespace
}  // namespace fulcrum::testing
