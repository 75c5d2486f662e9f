// Recordings of runs: what they show, and where they are.
#include <Fulcrum/PerformanceTest/Accuracy/LabRecorder.h>
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Recordings.h>

namespace fulcrum::accuracy {
namespace {

TEST(LabRecorder, ShowsTheFirstWorldOfARun) {
    LabRecorder recorder;
    const Setting setting{.rate = 240};
    LabRun run(setting, 0, true, 1);
    run.recorder = &recorder;
    {
        LabWorld world(run, kNoGravity);
        const BodyId moving = world.Add({.shape = SphereOf(0.5), .linearVelocity = {1, 0, 0}});
        world.Steps(0.5);
        world.Add({.shape = BoxOf(1, 1, 1), .position = {0, 5, 0}});
        EXPECT_TRUE(world.Ours("").Bodies().Remove(moving));
        world.Steps(0.5);
    }
    LabWorld other(run);
    other.Add({.shape = SphereOf(2)});
    other.Steps(1);
    const Recording& recording = recorder.recording;
    EXPECT_TRUE(CheckRecording(recording));
    ASSERT_EQ(recording.bodies.size(), 2u);
    EXPECT_EQ(recording.shapes[recording.bodies[0].shape].radius, 0.5f);
    EXPECT_EQ(recording.frames.size(), 61u);  // 60 a second, of 240 steps, and the start
    EXPECT_NEAR(recording.frames[30].time, 0.5, 1e-9);
    for (const RecordedPresence& presence : PresencesOf(recording)) {
        EXPECT_EQ(presence.from, presence.body == 0 ? 0u : 30u);
        EXPECT_EQ(presence.until, presence.body == 0 ? 30u : 61u);
    }
    EXPECT_NEAR(recording.latest[0].position.x(), 0.5, 0.02);
}

TEST(Recordings, AreFoundByTheirRuns) {
    const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "recordings_test";
    std::filesystem::remove_all(folder);
    std::vector<RunRecord> runs(2);
    for (RunRecord& run : runs) run.scene = "incline.slide";
    runs[1].setting.rate = 30;
    EXPECT_EQ(RecordingPath(runs[1]), "recordings/incline.slide_soft_1-30_4_1_1.html");
    const Status unknown = WriteRecordings(runs, {.setting = "soft 1/31 4 1 1", .showsProgress = false}, folder);
    ASSERT_FALSE(unknown);
    EXPECT_NE(unknown.GetError().message.find("'soft 1/30 4 1 1'"), std::string::npos) << unknown.GetError().message;
    ASSERT_TRUE(WriteRecordings(runs, {.setting = "soft 1/30 4 1 1", .isQuick = true, .showsProgress = false}, folder));
    FindRecordings(runs, folder);
    EXPECT_EQ(runs[0].recording, "");
    EXPECT_EQ(runs[1].recording, RecordingPath(runs[1]));
    EXPECT_GT(std::filesystem::file_size(folder / runs[1].recording), 100'000u);
}

}  // namespace
}  // namespace fulcrum::accuracy
