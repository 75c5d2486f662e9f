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
    for (JointBatch<N>& batch : batches) {
        PrepareJoints(batch, joints.records.data(), joints.typePointers.data(), joints.Bodies(), settings,
                      solved.findings);
        WarmStartJoints(batch, states);
    }
    for (int substep = 1; substep <= 2; ++substep) {
        settings.elapsed = settings.substepDt * static_cast<float>(substep);
        for (int pass = 0; pass < 2; ++pass) {
            settings.continues = substep > 1 && pass == 0;
            for (JointBatch<N>& batch : batches) SolveJointVelocities(batch, states, settings);
        }
        for (size_t body = 0; body < joints.states.size(); ++body) {
            if (!joints.Moves(static_cast<uint32_t>(body))) continue;
            for (int k = 0; k < 3; ++k) {
                states[body].deltaPosition[k] += states[body].linearVelocity[k] * settings.substepDt;
                states[body].deltaRotation[k] += states[body].angularVelocity[k] * settings.substepDt;
            }
            // As if it had turned.
            BodyMass& mass = joints.masses[body];
            if (static_cast<int>(mass.flags) & BodyMass::kTurns)
                for (float& x : mass.inverseInertia) x *= 1.1f;
        }
        for (int pass = 0; pass < 2; ++pass) {
            settings.firstPass = pass == 0;
            for (JointBatch<N>& batch : batches) RelaxJoints(batch, joints.Bodies(), settings);
        }
    }
    for (JointBatch<N>& batch : batches) RotateJointImpulses(batch, states);
    settings.firstPass = true;
    for (JointBatch<N>& batch : batches) UpdateJoints(batch, joints.Bodies(), settings);
    for (JointBatch<N>& batch : batches) {
        RotateJointImpulses(batch, states);
        StoreJoints(batch, joints.records.data(), joints.typePointers.data(), states, settings.dt, 1.0f);
    }
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
