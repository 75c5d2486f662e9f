// The whole state is the same, however many threads and lanes computed it: each number that a snapshot has.
#include <Fulcrum/UnitTests/Physics/Snapshots/SnapshotTesting.h>

namespace fulcrum::testing {
namespace {

// HashState of the scene of joints after 130 steps, in every build. Another number where steps give other results, or
// snapshots have other contents: the failure prints it.
constexpr uint64_t kGoldenHash = 0xfe2846d8e217d17full;

TEST(SnapshotDeterminism, StateAndSnapshotsAreTheSameForAnyNumberOfThreads) {
    TestWorld one(JointScene::Settings(), 1), two(JointScene::Settings(), 2), four(JointScene::Settings(), 4);
    JointScene scenes[] = {JointScene(one), JointScene(two), JointScene(four)};
    for (int step = 0; step < 130; ++step) {
        for (JointScene& scene : scenes) scene.BeforeStep(step);
        for (TestWorld* world : {&one, &two, &four}) world->Step();
        ASSERT_EQ(one.System().HashState(), two.System().HashState()) << "step " << step;
        ASSERT_EQ(one.System().HashState(), four.System().HashState()) << "step " << step;
    }
    EXPECT_TRUE(SnapshotOf(one.System()) == SnapshotOf(two.System()));
    EXPECT_TRUE(SnapshotOf(one.System()) == SnapshotOf(four.System()));
    EXPECT_EQ(one.System().HashState(), kGoldenHash)
        << "This build gives kGoldenHash = 0x" << std::hex << one.System().HashState() << "ull";
}

}  // namespace
}  // namespace fulcrum::testing
