// Files of saved runs: what is written is read again, damaged ones are refused, and what two of them differ in is
// found.
#include <Fulcrum/PerformanceTest/Scenes/Comparison.h>
#include <Fulcrum/PerformanceTest/Scenes/History.h>

#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>
#include <limits>

namespace fulcrum {
namespace {

using Json = nlohmann::ordered_json;

Json RunOf(const char* scene, int threads, double time) {
    return {{"scene", scene},
            {"threads", threads},
            {"steps", 300},
            {"accuracy", -0.003},
            {"nonfinite", 0},
            {"hash", "0123456789abcdef"},
            {"settings", {{"substeps", 4}, {"seed", 1}}},
            {"run_ms", {2 * time, 2.02 * time, 1.98 * time, 2.04 * time, 1.96 * time}},
            {"relative_times", {time, 1.01 * time, 0.99 * time, 1.02 * time, 0.98 * time}}};
}

Json DocumentOf(const std::vector<Json>& runs) {
    Json document = NewDocument();
    document["runs"] = runs;
    return document;
}

SavedRuns Parsed(const Json& document, const char* file = "file.json") {
    Result<SavedRuns> runs = ParseSavedRuns(document, file);
    if (runs) return runs.Value();
    ADD_FAILURE() << runs.GetError().message;
    return {};
}

std::string ErrorOf(const Json& document) {
    const Result<SavedRuns> runs = ParseSavedRuns(document, "file.json");
    return runs ? "" : runs.GetError().message;
}

bool Says(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

std::vector<ComparedRun> Compared(const Json& now, const Json& baseline) {
    const Result<std::vector<ComparedRun>> runs =
        CompareRuns(Parsed(DocumentOf({now})), Parsed(DocumentOf({baseline})), 0.1,
                    [](const std::string&) -> std::optional<double> { return 0.001; });
    if (runs) return runs.Value();
    ADD_FAILURE() << runs.GetError().message;
    return {ComparedRun{}};
}

class SavedRunsFile : public ::testing::Test {
protected:
    ~SavedRunsFile() override { std::filesystem::remove(file_); }

    std::filesystem::path file_ =
        std::filesystem::temp_directory_path() / ("fulcrum-saved-" + std::to_string(getpid()) + ".json");
};

TEST_F(SavedRunsFile, IsReadAsItWasWritten) {
    const Json document = DocumentOf({RunOf("pyramid", 1, 3), RunOf("pyramid", 2, 2), RunOf("drum", 1, 30)});
    ASSERT_TRUE(WriteSavedRuns(document, file_));
    const Result<SavedRuns> read = ReadSavedRuns(file_);
    ASSERT_TRUE(read) << read.GetError().message;
    const SavedRuns written = Parsed(document, file_.c_str());
    EXPECT_EQ(read.Value().date, written.date);
    EXPECT_EQ(read.Value().cpu, written.cpu);
    EXPECT_EQ(read.Value().cores, written.cores);
    EXPECT_EQ(read.Value().compiler, written.compiler);
    ASSERT_EQ(read.Value().runs.size(), 3u);
    const SavedRun* run = read.Value().Find("pyramid", 2);
    ASSERT_TRUE(run);
    EXPECT_DOUBLE_EQ(run->medianMs, 4);
    EXPECT_EQ(run->relativeTimes, written.Find("pyramid", 2)->relativeTimes) << "every bit of a double is written";
    EXPECT_EQ(run->hash, "0123456789abcdef");
    EXPECT_EQ(run->accuracy, -0.003);
    EXPECT_EQ(run->settings, written.runs[1].settings);
    EXPECT_FALSE(read.Value().Find("drum", 2));
}

TEST_F(SavedRunsFile, HasNullWhereANumberIsNotFinite) {
    Json run = RunOf("pyramid", 1, 3);
    run["accuracy"] = std::numeric_limits<double>::quiet_NaN();
    run["max_ms"] = std::numeric_limits<double>::infinity();
    ASSERT_TRUE(WriteSavedRuns(DocumentOf({run}), file_));
    std::ifstream stream(file_);
    const Json read = Json::parse(stream);
    EXPECT_TRUE(read["runs"][0]["accuracy"].is_null());
    EXPECT_TRUE(read["runs"][0]["max_ms"].is_null());
    EXPECT_FALSE(Parsed(read).runs[0].accuracy);
}

TEST_F(SavedRunsFile, MissingCutAndForeignOnesAreRefused) {
    EXPECT_TRUE(Says(ReadSavedRuns(file_).GetError().message, "there is no such file"));
    ASSERT_TRUE(WriteSavedRuns(DocumentOf({RunOf("pyramid", 1, 3)}), file_));
    std::filesystem::resize_file(file_, std::filesystem::file_size(file_) / 2);
    const std::string cut = ReadSavedRuns(file_).GetError().message;
    EXPECT_TRUE(Says(cut, "is damaged") && Says(cut, file_.c_str())) << cut;
    std::ofstream(file_) << "not JSON";
    EXPECT_TRUE(Says(ReadSavedRuns(file_).GetError().message, "is damaged"));
    EXPECT_TRUE(Says(ReadSavedRuns(file_.parent_path()).GetError().message, "there is no such file"));
    EXPECT_FALSE(WriteSavedRuns(Json::object(), file_ / "below"));
}

TEST(SavedRuns, OtherSchemasAreNamed) {
    EXPECT_TRUE(Says(ErrorOf(Json::array({RunOf("pyramid", 1, 3)})), "no schema number"));
    Json document = DocumentOf({});
    document["schema"] = 1;
    EXPECT_TRUE(Says(ErrorOf(document), "has schema 1, this version reads 2"));
    document = DocumentOf({});
    document["kernel"] = 77;
    EXPECT_TRUE(Says(ErrorOf(document), "version 77 of the reference kernel"));
}

TEST(SavedRuns, WhatIsMissingOrWrongIsNamed) {
    const Json whole = RunOf("pyramid", 1, 3);
    for (const auto& [name, value] : whole.items()) {
        Json run = whole;
        run.erase(name);
        EXPECT_TRUE(Says(ErrorOf(DocumentOf({RunOf("drum", 1, 3), run})), "is damaged: in run 2")) << name;
    }
    for (const Json& times : {Json::array(), Json{1, -1}, Json{1, 0}, Json{1, "2"}, Json{1, nullptr}, Json("1")}) {
        Json run = RunOf("pyramid", 1, 3);
        run["relative_times"] = times;
        EXPECT_TRUE(Says(ErrorOf(DocumentOf({run})), "is damaged: in run 1")) << times.dump();
    }
    Json document = DocumentOf({});
    document.erase("machine");
    EXPECT_TRUE(Says(ErrorOf(document), "is damaged: in the head"));
}

TEST(Comparison, OfARunWithItself) {
    const ComparedRun run = Compared(RunOf("pyramid", 1, 3), RunOf("pyramid", 1, 3))[0];
    EXPECT_EQ(run.verdict, Verdict::Same);
    EXPECT_DOUBLE_EQ(run.time.ratio, 1);
    EXPECT_FALSE(run.isAccuracyWorse || run.hasHashChanged);
    EXPECT_EQ(run.remark, "");
    EXPECT_EQ(ExitStatusOf({run}), 0);
}

TEST(Comparison, SlowerIsAnErrorFasterIsNone) {
    const auto slower = Compared(RunOf("pyramid", 1, 3.6), RunOf("pyramid", 1, 3)),
               faster = Compared(RunOf("pyramid", 1, 3), RunOf("pyramid", 1, 3.6));
    EXPECT_EQ(slower[0].verdict, Verdict::Slower);
    EXPECT_EQ(ExitStatusOf(slower), 1);
    EXPECT_EQ(faster[0].verdict, Verdict::Faster);
    EXPECT_EQ(ExitStatusOf(faster), 0);
}

// The machine is twice as slow, and so is the kernel.
TEST(Comparison, IsOfTimesRelativeToTheKernel) {
    Json now = RunOf("pyramid", 1, 3);
    for (Json& ms : now["run_ms"]) ms = 2 * ms.get<double>();
    const ComparedRun run = Compared(now, RunOf("pyramid", 1, 3))[0];
    EXPECT_DOUBLE_EQ(run.ms, 2 * run.baselineMs);
    EXPECT_EQ(run.verdict, Verdict::Same);
}

// Relative times say faster by a third, the clock slower by a third: the kernel was disturbed, not the scene.
TEST(Comparison, IsTheSameWhereTheClockSaysTheOpposite) {
    Json now = RunOf("pyramid", 1, 2);
    for (Json& ms : now["run_ms"]) ms = 2 * ms.get<double>();
    const ComparedRun run = Compared(now, RunOf("pyramid", 1, 3))[0];
    EXPECT_EQ(run.verdict, Verdict::Same);
    EXPECT_TRUE(Says(run.remark, "not faster by the clock"));
}

TEST(Comparison, AChangedHashIsReportedButNoError) {
    Json now = RunOf("pyramid", 1, 3);
    now["hash"] = "0123456789abcdee";
    const auto runs = Compared(now, RunOf("pyramid", 1, 3));
    EXPECT_TRUE(runs[0].hasHashChanged);
    EXPECT_EQ(ExitStatusOf(runs), 0);
}

TEST(Comparison, AWorseAccuracyIsAnError) {
    const Json baseline = RunOf("pyramid", 1, 3);  // -0.003, and a tolerance of 0.001
    const auto isWorse = [&](const Json& accuracy) {
        Json now = baseline;
        now["accuracy"] = accuracy;
        const auto runs = Compared(now, baseline);
        EXPECT_EQ(ExitStatusOf(runs), runs[0].isAccuracyWorse ? 1 : 0);
        return runs[0].isAccuracyWorse;
    };
    EXPECT_FALSE(isWorse(-0.0039));
    EXPECT_FALSE(isWorse(0.0039)) << "it is the magnitude that counts";
    EXPECT_TRUE(isWorse(-0.0041));
    EXPECT_TRUE(isWorse(0.0041));
    EXPECT_TRUE(isWorse(nullptr)) << "not finite";
    Json frozen = baseline;
    frozen["nonfinite"] = 1;
    EXPECT_TRUE(Compared(frozen, baseline)[0].isAccuracyWorse);
}

TEST(Comparison, AMedianAccuracyIsNotComparedWithThatOfOneRun) {
    Json now = RunOf("pyramid", 1, 3);
    now["accuracy"] = 5;
    now["accuracy_of_runs"] = {5, 5, 5};
    const ComparedRun run = Compared(now, RunOf("pyramid", 1, 3))[0];
    EXPECT_FALSE(run.isAccuracyWorse);
    EXPECT_TRUE(Says(run.remark, "accuracy is not compared"));
}

TEST(Comparison, OtherSettingsAreNamed) {
    Json now = RunOf("pyramid", 1, 3);
    now["settings"]["substeps"] = 8;
    now["steps"] = 100;
    EXPECT_EQ(Compared(now, RunOf("pyramid", 1, 3))[0].remark, "steps 300 -> 100; substeps 4 -> 8");
}

TEST(Comparison, ABaselineWithoutTheSceneOrWithTooFewRunsIsRefused) {
    SavedRuns baseline = Parsed(DocumentOf({RunOf("pyramid", 1, 3), RunOf("drum", 2, 3)}));
    EXPECT_FALSE(CheckComparable(baseline, "pyramid", 1));
    EXPECT_EQ(CheckComparable(baseline, "drum", 1)->message,
              "file.json: has no run of drum with 1 thread; it has pyramid (1), drum (2)");
    baseline.runs[0].relativeTimes.resize(4);
    EXPECT_TRUE(Says(CheckComparable(baseline, "pyramid", 1)->message, "has only 4 runs of pyramid with 1 thread"));
}

TEST(Comparison, OtherMachinesAreNamed) {
    const SavedRuns now = Parsed(DocumentOf({}));
    SavedRuns baseline = now;
    EXPECT_TRUE(DifferencesOfMachines(now, baseline).empty());
    baseline.cpu = "Some processor";
    baseline.compiler = "Some compiler";
    ASSERT_EQ(DifferencesOfMachines(now, baseline).size(), 2u);
    EXPECT_TRUE(Says(DifferencesOfMachines(now, baseline)[0], "processor: Some processor -> "));
}

TEST(History, IsByDateAndRelativeToTheFirst) {
    SavedRuns early = Parsed(DocumentOf({RunOf("pyramid", 1, 2)}), "early.json"),
              late = Parsed(DocumentOf({RunOf("pyramid", 1, 3), RunOf("drum", 2, 8)}), "late.json");
    early.date = "2026-01-01T00:00:00Z";
    late.date = "2026-02-01T00:00:00Z";
    const std::string text = HistoryText({late, early}, {});
    EXPECT_LT(text.find("early.json"), text.find("late.json"));
    EXPECT_TRUE(Says(text, "pyramid            1  ▆█    1.000   1.500")) << text;
    EXPECT_TRUE(Says(text, "drum               2   █        -   1.000")) << text;
    EXPECT_FALSE(Says(HistoryText({late, early}, {"drum"}), "pyramid "));
}

}  // namespace
}  // namespace fulcrum
