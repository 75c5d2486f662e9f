// Whole scenes with NarrowPhaseMethod::Libccd: what stands by the engine's own functions stands by libccd, too, nothing
// falls through, and threads change no bit.
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace fulcrum {
namespace {

struct Outcome {
    double accuracy = 0;
    double largestPenetration = 0;  // m
    uint64_t hash = 0;
    uint32_t failures = 0, contacts = 0;
    int nonFinite = 0;
};

Outcome RunByLibccd(const char* name, int steps, uint32_t threads = 1) {
    const Scene& scene = *FindScene(name);
    SceneInput input;
    input.narrowPhase = NarrowPhaseMethod::Libccd;
    std::optional<ThreadPool> pool;
    if (threads > 1) pool.emplace(threads);
    const auto created = SceneWorld::Create(scene, input, pool ? &*pool : nullptr);
    Outcome run;
    if (!created) {
        ADD_FAILURE() << created.GetError().message;
        return run;
    }
    SceneWorld& world = *created.Value();
    EXPECT_EQ(world.System().Settings().narrowPhase, NarrowPhaseMethod::Libccd);
    for (int step = 0; step < steps; ++step) {
        EXPECT_TRUE(world.Step(1.0 / 60));
        const StepReport& report = world.System().Report();
        run.largestPenetration = std::max(run.largestPenetration, double{report.largestPenetration});
        run.failures += report.libccd.epaFailures;
        run.contacts += report.contacts;
    }
    run.accuracy = scene.accuracy(world);
    run.hash = world.System().HashPoses();
    run.nonFinite = world.NonFiniteBodies();
    return run;
}

int Steps(int normally) { return testing::kIsSanitized ? std::max(normally / 20, 5) : normally; }

TEST(LibccdScenes, ThePyramidStands) {
    const Outcome run = RunByLibccd("pyramid", Steps(200));
    EXPECT_EQ(run.nonFinite, 0);
    EXPECT_LT(run.largestPenetration, 0.025);
    // The top's height against that of a perfect stack; it starts 7 m higher.
    if (!testing::kIsSanitized) {
        EXPECT_NEAR(run.accuracy, 0, 0.02);
    }
}

TEST(LibccdScenes, TheTowerStands) {
    const Outcome run = RunByLibccd("tower", Steps(300));
    EXPECT_EQ(run.nonFinite, 0);
    EXPECT_LT(run.largestPenetration, 0.02);
}

// A box that turns at 165 rad/s in a corner of the room may get into one wall where the end of another pushes it out at
// the back: one body of 5000 in one of six runs.
TEST(LibccdScenes, HighSpeedLosesOneBodyAtMost) {
    const Outcome run = RunByLibccd("high_speed", Steps(200));
    EXPECT_EQ(run.nonFinite, 0);
    EXPECT_LE(run.accuracy, 1);
}

TEST(LibccdScenes, BulletsPassNoWall) {
    const Outcome run = RunByLibccd("bullets", Steps(200));
    EXPECT_EQ(run.accuracy, 0);
}

TEST(LibccdScenes, NothingFallsThroughAMesh) {
    const Outcome run = RunByLibccd("convex_on_mesh", Steps(200));
    EXPECT_EQ(run.nonFinite, 0);
    EXPECT_EQ(run.accuracy, 0);
    EXPECT_LT(run.largestPenetration, 0.25);  // half of the thinnest body's inner radius
    EXPECT_LE(run.failures, run.contacts / 1000);
}

TEST(LibccdScenes, NothingFallsThroughAHeightField) {
    const Outcome run = RunByLibccd("terrain_with_holes", Steps(280));
    EXPECT_EQ(run.nonFinite, 0);
    EXPECT_EQ(run.accuracy, 0);
}

TEST(LibccdScenes, NothingFallsThroughAHalfSpace) {
    const Outcome run = RunByLibccd("endless_slope", Steps(200));
    EXPECT_EQ(run.nonFinite, 0);
    EXPECT_LT(run.largestPenetration, 0.05);
}

TEST(LibccdScenes, HullsAndCurvedShapesStayAboveTheFloor) {
    EXPECT_GT(RunByLibccd("hull_pile", Steps(100)).accuracy, -0.05);
    EXPECT_EQ(RunByLibccd("convex_shapes", Steps(200)).accuracy, 0);
}

TEST(LibccdScenes, QueriesAgreeWithEachOther) {
    EXPECT_EQ(RunByLibccd("query_overlaps", Steps(150)).accuracy, 0);
    EXPECT_LT(RunByLibccd("query_casts", Steps(150)).accuracy, 2e-4);    // m
    EXPECT_LT(RunByLibccd("query_closest", Steps(150)).accuracy, 1e-4);  // m
}

TEST(LibccdScenes, ThreadsChangeNoBit) {
    for (const char* name : {"convex_on_mesh", "convex_shapes", "bullets", "endless_slope"}) {
        const Outcome one = RunByLibccd(name, Steps(100));
        for (const uint32_t threads : {2u, 4u})
            EXPECT_EQ(RunByLibccd(name, Steps(100), threads).hash, one.hash) << name;
    }
}

}  // namespace
}  // namespace fulcrum
