// The recent calls of a long game are kept, in bounded memory, and play again with the same bits.
#include <Fulcrum/Samples/Embedding/RecentCalls.h>
#include <Fulcrum/UnitTests/Physics/Recording/RecordedProgram.h>

namespace fulcrum::testing {
namespace {

TEST(RecentCalls, PlayAgainFromTheMiddleOfAGame) {
    constexpr uint64_t kSteps = 50;
    TestWorld world;
    samples::RecentCalls recent(world.System(), kSteps);
    world.AddFloor();
    std::vector<BodyId> boxes;
    for (int i = 0; i < 30; ++i)
        boxes.push_back(world.Add({.shape = CubeOf(0.3f), .position = {0.5 * (i % 6), 0.3 + 0.7 * (i / 6), 0}}));
    std::vector<uint64_t> hashes;  // by step
    size_t largest = 0;
    for (int step = 0; step < 620; ++step) {
        const Vector3 push(0, 30 * static_cast<float>(step % 9), 20 * static_cast<float>(step % 5) - 40);
        const size_t which = static_cast<size_t>(step * 7 % 30);
        ASSERT_TRUE(world.Bodies().AddImpulse(boxes[which], push));
        if (step % 100 == 90) {
            ASSERT_TRUE(world.Bodies().Remove(boxes[which]));
            boxes[which] = world.Add({.shape = CubeOf(0.2f), .position = {0, 6, 0}});
        }
        world.Step();
        ASSERT_TRUE(recent.AfterStep());
        hashes.push_back(world.System().HashState());
        size_t size = 0;
        for (const std::span<const std::byte> bytes : recent.Recordings()) size += bytes.size();
        if (step >= 150 && step < 300) largest = std::max(largest, size);
        EXPECT_TRUE(step < 300 || size < 2 * largest) << step;
    }
    // From the last recording backwards.
    uint64_t steps = 0;
    const auto recordings = recent.Recordings();
    for (size_t i = 2; i-- > 0;) {
        const auto recording = CallRecording::Read({recordings[i].begin(), recordings[i].end()});
        ASSERT_TRUE(recording) << recording.GetError().message;
        const Result<ReplayReport> report = Replay(recording.Value());
        ASSERT_TRUE(report) << report.GetError().message;
        EXPECT_FALSE(report.Value().divergence) << report.Value().divergence->what;
        EXPECT_EQ(report.Value().stateHash, hashes[hashes.size() - 1 - steps]) << i;
        steps += report.Value().steps;
    }
    EXPECT_GE(steps, kSteps);
    EXPECT_LE(steps, 2 * kSteps);
}

}  // namespace
}  // namespace fulcrum::testing
