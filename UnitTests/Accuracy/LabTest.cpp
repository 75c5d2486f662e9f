// The lab makes the same runs whatever the number of threads, and whether it was interrupted or not.
#include <Fulcrum/PerformanceTest/Accuracy/Lab.h>
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

namespace fulcrum::accuracy {
namespace {

namespace fs = std::filesystem;

std::string ReadFile(const fs::path& path) {
    std::ostringstream content;
    content << std::ifstream(path, std::ios::binary).rdbuf();
    return content.str();
}

// All of a run but its times.
std::string WithoutTimes(const std::vector<RunRecord>& runs) {
    std::string text;
    for (const RunRecord& run : runs) {
        nlohmann::ordered_json json = ToJson(run);
        json.erase("us_per_second");
        json.erase("timed_runs");
        json.erase("cost_ratio");
        text += json.dump() + "\n";
    }
    return text;
}

class Lab : public ::testing::Test {
protected:
    Lab() : folder_(fs::temp_directory_path() / ("fulcrum-lab-" + std::to_string(getpid()))) {}
    ~Lab() override { fs::remove_all(folder_); }

    LabOptions Options(const char* name,
                       std::initializer_list<const char*> scenes = {"projectile", "motor", "incline.slide"}) {
        LabOptions options;
        for (const char* scene : scenes)
            for (const LabScene* each : FindLabScenes(scene)) options.scenes.push_back(each);
        options.isQuick = true;
        options.folder = folder_ / name;
        options.showsProgress = false;
        return options;
    }
    std::vector<RunRecord> Run(const LabOptions& options) {
        Result<std::vector<RunRecord>> runs = RunLab(options);
        EXPECT_TRUE(runs) << (runs ? "" : runs.GetError().message);
        return runs ? runs.Value() : std::vector<RunRecord>();
    }

    fs::path folder_;
};

TEST_F(Lab, OneAndTwoThreadsMakeTheSameRuns) {
    LabOptions one = Options("one"), two = Options("two");
    two.threads = 2;
    const std::string expected = WithoutTimes(Run(one));
    EXPECT_GT(expected.size(), 1000u);
    EXPECT_EQ(WithoutTimes(Run(two)), expected);
}

TEST_F(Lab, ResumesAfterAnyPlaceAtWhichItWasCut) {
    LabOptions options = Options("cut");
    const std::string expected = WithoutTimes(Run(options)), whole = ReadFile(options.folder / "runs.jsonl");
    options.resumes = true;
    // Within the header, within a line, after a line, and not at all.
    for (const size_t length : {size_t{10}, whole.size() / 3, whole.find('\n', whole.size() / 2) + 1, whole.size()}) {
        std::ofstream(options.folder / "runs.jsonl", std::ios::binary | std::ios::trunc) << whole.substr(0, length);
        EXPECT_EQ(WithoutTimes(Run(options)), expected) << "cut after " << length << " bytes";
        // The file is whole again: as many lines as before, each of them a run.
        std::istringstream lines(ReadFile(options.folder / "runs.jsonl"));
        std::string line;
        std::ptrdiff_t count = 0;
        for (; std::getline(lines, line); ++count) EXPECT_TRUE(nlohmann::json::accept(line)) << line;
        EXPECT_EQ(count, std::count(whole.begin(), whole.end(), '\n'));
    }
}

TEST_F(Lab, KeepsWhatItIsGoingToReplaceAndRefusesAnotherGrid) {
    LabOptions options = Options("again", {"projectile"});
    Run(options);
    const std::string first = ReadFile(options.folder / "runs.jsonl");
    Run(options);
    EXPECT_EQ(ReadFile(options.folder / "runs.jsonl.bak"), first);
    options.isQuick = false;
    options.resumes = true;
    const Result<std::vector<RunRecord>> other = RunLab(options);
    ASSERT_FALSE(other);
    EXPECT_NE(other.GetError().message.find("another grid"), std::string::npos) << other.GetError().message;
}

TEST(Measure, TakesMediansOverTheSeedsAndTheGatesOfAny) {
    static int calls;
    calls = 0;
    LabScene scene{.name = "made_up", .what = "", .error = "", .quickSeeds = 3};
    scene.run = [](LabRun& run) {
        constexpr double kErrors[] = {3, kNaN, 1};
        const int call = calls++;
        run.Error("error", kErrors[call % 3]);
        run.Figure("figure", call % 3);
        run.Observe(10 * (call % 3));
        run.Require(call != 1, "holds");
        run.work.simulatedSeconds = 2;
        run.work.traversals = 100;
        run.work.seconds = 1e-6 * (call + 1);
    };
    const RunRecord record = Measure(scene, {}, true);
    EXPECT_EQ(record.Error(), 3);
    EXPECT_EQ(record.figures[0].value, 1);
    EXPECT_EQ(record.observed, std::vector<double>{10});
    EXPECT_EQ(record.failedConditions, std::vector<std::string>{"holds"});
    EXPECT_FALSE(record.blewUp);
    EXPECT_EQ(record.seeds, 3);
    EXPECT_EQ(record.traversals, 50);
    // Five runs of 1 to 5 us for 2 s each.
    EXPECT_EQ(record.timedRuns, 5);
    EXPECT_DOUBLE_EQ(record.microseconds, 1.5);
    scene.blowUp = 2;
    calls = 0;
    EXPECT_TRUE(Measure(scene, {}, true).blewUp);
    scene.quickSeeds = 2;
    calls = 1;  // NaN and 1: their mean is none
    EXPECT_TRUE(Measure(scene, {}, true).blewUp);
}

TEST(RunRecord, SurvivesItsFile) {
    RunRecord run;
    run.scene = "incline.slide";
    run.setting = {.rate = 240,
                   .solver = {.substeps = 2, .positionCorrection = PositionCorrection::Baumgarte},
                   .family = Family::Baumgarte};
    run.errors = {{"way", kNaN}, {"speed", 0.125}};
    run.observed = {1, kNaN};
    run.failedConditions = {"every pose is finite"};
    run.blewUp = true;
    run.hash = 0xFFFFFFFFFFFFFFFFull;
    const nlohmann::ordered_json json = ToJson(run);
    EXPECT_TRUE(json["errors"]["way"].is_null());
    const Result<RunRecord> read = RecordFromJson(json);
    ASSERT_TRUE(read);
    EXPECT_EQ(ToJson(read.Value()).dump(), json.dump());
    EXPECT_EQ(read.Value().setting, run.setting);
    EXPECT_FALSE(RecordFromJson({{"scene", "incline.slide"}}));
}

}  // namespace
}  // namespace fulcrum::accuracy
