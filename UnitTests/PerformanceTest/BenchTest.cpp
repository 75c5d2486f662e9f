// ./fulcrum bench as a whole: its command line, its exit status, a slower run found against its own baseline.
#include <Fulcrum/Math/Wide.h>
#include <Fulcrum/PerformanceTest/Scenes/Bench.h>
#include <Fulcrum/PerformanceTest/Scenes/SavedRuns.h>
#include <Fulcrum/PerformanceTest/Scenes/TimedScene.h>
#include <Fulcrum/Samples/Runner/RunEnvironment.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <unistd.h>

#include <fstream>

namespace fulcrum {
namespace {

using Words = std::vector<std::string>;

BenchOptions Options(const Words& words) {
    Result<BenchOptions> options = ParseBenchOptions(words);
    if (options) return options.Value();
    ADD_FAILURE() << options.GetError().message;
    return {};
}

std::string ErrorOf(const Words& words) {
    const Result<BenchOptions> options = ParseBenchOptions(words);
    return options ? "" : options.GetError().message;
}

Words NamesOf(const BenchOptions& options) {
    Words names;
    for (const Scene* scene : options.scenes) names.push_back(scene->name);
    return names;
}

// A folder of its own, and runs of the program in it.
class Bench : public ::testing::Test {
protected:
    Bench() : folder_(std::filesystem::temp_directory_path() / ("fulcrum-bench-" + std::to_string(getpid()))) {
        std::filesystem::create_directories(folder_);
    }
    ~Bench() override { std::filesystem::remove_all(folder_); }

    std::string File(const char* name) const { return (folder_ / name).string(); }
    // The exit status; output and errors are kept.
    int Run(Words words) {
        ::testing::internal::CaptureStdout();
        ::testing::internal::CaptureStderr();
        const int status = RunBench(Options(words));
        output_ = ::testing::internal::GetCapturedStdout();
        errors_ = ::testing::internal::GetCapturedStderr();
        return status;
    }
    bool Says(const std::string& part) const { return (output_ + errors_).find(part) != std::string::npos; }

    std::filesystem::path folder_;
    std::string output_, errors_;
};

TEST_F(Bench, TakesScenesByPlaceOrByName) {
    EXPECT_EQ(NamesOf(Options({"drum", "pyramid"})), (Words{"drum", "pyramid"}));
    EXPECT_EQ(NamesOf(Options({"--scene", "drum"})), (Words{"drum"}));
    EXPECT_EQ(NamesOf(Options({"--scene", "drum", "--threads", "1"})), (Words{"drum"}));
    EXPECT_EQ(NamesOf(Options({"drum", "drum"})), (Words{"drum"}));
    EXPECT_GE(Options({"all"}).scenes.size(), 11u);
    EXPECT_EQ(ErrorOf({"pyramids"}).substr(0, 24), "unknown scene 'pyramids'");
    EXPECT_EQ(ErrorOf({"--thraeds", "2"}).substr(0, 26), "unknown option '--thraeds'");
}

TEST_F(Bench, TakesThreadsStepsAndPresets) {
    const BenchOptions options = Options({"--threads", "1,2", "--dt", "0.01", "--preset", "fast", "--quiet"});
    EXPECT_EQ(options.threads, (std::vector<int>{1, 2}));
    EXPECT_DOUBLE_EQ(options.dt, 0.01);
    EXPECT_EQ(options.solver.substeps, SolverSettings::Fast().substeps);
    EXPECT_TRUE(options.quiet);
    EXPECT_NE(ErrorOf({"--threads", "1,65"}), "");
    EXPECT_NE(ErrorOf({"--threads", "1,,2"}), "");
    EXPECT_NE(ErrorOf({"--threads", "two"}), "");
    EXPECT_NE(ErrorOf({"--dt", "0"}), "");
}

TEST_F(Bench, TakesATolerance) {
    EXPECT_DOUBLE_EQ(Options({"--baseline", "a", "--tolerance", "5%"}).tolerance, 0.05);
    EXPECT_DOUBLE_EQ(Options({"--baseline", "a", "--tolerance", "5"}).tolerance, 0.05);
    EXPECT_DOUBLE_EQ(Options({"--baseline", "a"}).tolerance, 0.1);
    EXPECT_NE(ErrorOf({"--baseline", "a", "--tolerance", "-5%"}), "");
    EXPECT_NE(ErrorOf({"--baseline", "a", "--tolerance", "5 apples"}), "");
    EXPECT_NE(ErrorOf({"--tolerance", "5%"}), "") << "there is nothing to compare with";
}

TEST_F(Bench, TakesEnoughRunsToCompare) {
    EXPECT_EQ(Options({}).runs, 1);
    EXPECT_EQ(Options({"--save", "a"}).runs, 7);
    EXPECT_EQ(Options({"--baseline", "a", "--runs", "9"}).runs, 9);
    EXPECT_NE(ErrorOf({"--save", "a", "--runs", "4"}), "");
    EXPECT_EQ(Options({"--history", "a", "b"}).history, (Words{"a", "b"}));
    EXPECT_NE(ErrorOf({"--peer", "bulet"}).find("the nearest is 'bullet'"), std::string::npos);
}

// Twelve times the substeps on the same scene are far beyond any noise of the machine that the kernel does not see.
TEST_F(Bench, FindsASlowerRunAgainstItsOwnBaseline) {
    const Words scene{"pyramid", "--steps", "15", "--runs", "5"};
    const auto with = [&](Words more) {
        more.insert(more.begin(), scene.begin(), scene.end());
        return more;
    };
    ASSERT_EQ(Run(with({"--save", File("base.json")})), 0) << errors_;
    EXPECT_EQ(Run(with({"--baseline", File("base.json"), "--substeps", "48"})), 1) << output_;
    EXPECT_TRUE(Says("slower")) << output_;
    EXPECT_TRUE(Says("substeps 4 -> 48")) << output_;
    EXPECT_TRUE(Says("changed")) << output_;
    // Against itself, with a tolerance that only such a change exceeds.
    EXPECT_EQ(Run(with({"--baseline", File("base.json"), "--tolerance", "200%"})), 0) << output_;
    EXPECT_TRUE(Says("0 slower")) << output_;
    EXPECT_EQ(Run(with({"--baseline", File("base.json"), "--tolerance", "200%", "--quiet"})), 0);
    EXPECT_EQ(output_ + errors_, "");
    EXPECT_EQ(Run({"--history", File("base.json"), File("base.json")}), 0) << errors_;
    EXPECT_TRUE(Says("1.000   1.000")) << output_;
}

TEST_F(Bench, BadInputHasStatus2AndSaysWhat) {
    EXPECT_EQ(Run({"--baseline", File("none.json")}), 2);
    EXPECT_TRUE(Says("there is no such file")) << errors_;
    std::ofstream(File("damaged.json")) << "{\"schema\": 2, \"runs\": [";
    EXPECT_EQ(Run({"--baseline", File("damaged.json")}), 2);
    EXPECT_TRUE(Says("is damaged")) << errors_;
    EXPECT_EQ(Run({"--history", File("damaged.json")}), 2);
    std::ofstream(File("old.json")) << "[{\"scene\": \"pyramid\"}]";
    EXPECT_EQ(Run({"--baseline", File("old.json")}), 2);
    EXPECT_TRUE(Says("older version")) << errors_;
    EXPECT_EQ(Run({"--save", File("no/such/folder.json")}), 2);
    EXPECT_TRUE(Says("there is no folder")) << errors_;

    ASSERT_EQ(Run({"pyramid", "--steps", "1", "--runs", "5", "--save", File("base.json")}), 0) << errors_;
    EXPECT_EQ(Run({"drum", "--baseline", File("base.json")}), 2);
    EXPECT_TRUE(Says("has no run of drum with 1 thread; it has pyramid (1)")) << errors_;
    EXPECT_EQ(Run({"pyramid", "--threads", "2", "--baseline", File("base.json")}), 2);
    EXPECT_TRUE(Says("has no run of pyramid with 2 threads")) << errors_;
}

TEST_F(Bench, WritesWhatItTimed) {
    ASSERT_EQ(Run({"pyramid", "--threads", "1,2", "--steps", "2", "--json", File("runs.json")}), 0) << errors_;
    std::ifstream stream(File("runs.json"));
    const nlohmann::json document = nlohmann::json::parse(stream);
    EXPECT_EQ(document["schema"], kFileSchema);
    EXPECT_EQ(document["lanes"], kLanes);
    EXPECT_TRUE(document["machine"]["cpu"].is_string());
    EXPECT_TRUE(document["units"].is_object());
    ASSERT_EQ(document["runs"].size(), 2u);
    EXPECT_EQ(document["runs"][1]["threads"], 2);
    EXPECT_EQ(document["runs"][0]["hash"], document["runs"][1]["hash"]);
    EXPECT_EQ(document["runs"][0]["relative_times"].size(), 1u);
}

// So that a regression of its accuracy is found.
TEST_F(Bench, EveryPerformanceSceneHasAnAccuracyTolerance) {
    for (const Scene* scene : AllScenes()) {
        const bool isTime = std::string(scene->name) == "mostly_asleep";  // its figure
        EXPECT_TRUE(scene->accuracyTolerance || isTime || scene->kind == SceneKind::Sample) << scene->name;
    }
}

}  // namespace
}  // namespace fulcrum
