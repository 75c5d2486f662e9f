// fulcrum-accuracy: what ./fulcrum accuracy and ./fulcrum advise start.
#include <Fulcrum/PerformanceTest/Accuracy/Advice.h>
#include <Fulcrum/PerformanceTest/Accuracy/Baseline.h>
#include <Fulcrum/PerformanceTest/Accuracy/Options.h>
#include <Fulcrum/PerformanceTest/Accuracy/Targets.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Samples/Runner/StandardOutput.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fulcrum::accuracy {
namespace {

int Fail(const std::string& message) {
    std::fprintf(stderr, "fulcrum: %s\n", message.c_str());
    return 1;
}

int Advise(const LabCommand& command, std::span<const SceneRuns> scenes) {
    for (const SceneRuns& scene : scenes) {
        if (command.adviseError) std::printf("%s\n", AdviceForError(scene, *command.adviseError).c_str());
        if (command.adviseBudget) std::printf("%s\n", AdviceForBudget(scene, *command.adviseBudget).c_str());
    }
    return 0;
}

// Files in the lab's folder, and the document's tables. Returns the exit status.
int Write(const LabCommand& command, std::span<const SceneRuns> scenes) {
    const Peer* peer = command.lab.peer;
    const Circumstances circumstances{command.commit, command.lab.isQuick, command.lab.threads, peer};
    const nlohmann::ordered_json json = JsonOf(scenes, circumstances);
    const std::string tables = TablesOf(scenes, circumstances);
    const std::filesystem::path& folder = command.lab.folder;
    for (const auto& [name, text] : {std::pair<const char*, std::string>("runs.csv", CsvOf(scenes)),
                                     {"runs.json", json.dump(1) + "\n"},
                                     {"tables.md", tables}})
        if (const Status written = WriteWholeFile(folder / name, {text}); !written)
            return Fail(written.GetError().message);
    if (const Status written = WriteReport(json, folder / "report.html"); !written)
        return Fail(written.GetError().message);
    if (!command.table.empty())
        if (const Status written = peer ? WriteTables(PeerTable(scenes, *peer), command.table, "peer")
                                        : WriteTables(tables, command.table);
            !written)
            return Fail(written.GetError().message);
    if (command.baseline.empty()) std::printf("%s\n", tables.c_str());
    std::printf("Wrote %s\n", (folder / "report.html").c_str());
    return 0;
}

int ReportSoak(std::span<const RunRecord> runs) {
    bool holds = true;
    for (const RunRecord& run : runs) {
        std::printf("%s, %s: %.3g us of work per simulated second\n", run.scene.c_str(), run.setting.Key().c_str(),
                    run.microseconds);
        for (const auto* list : {&run.errors, &run.figures})
            for (const NamedValue& each : *list) std::printf("  %s  %.3g\n", each.name.c_str(), each.value);
        for (const std::string& condition : run.failedConditions)
            std::printf("  does not hold: %s\n", condition.c_str());
        holds &= run.failedConditions.empty();
    }
    return holds ? 0 : 1;
}

int Compare(const LabCommand& command, std::span<const RunRecord> runs) {
    const Result<std::string> content = ReadWholeFile(command.baseline);
    if (!content) return Fail("cannot read " + content.GetError().message);
    const Result<Comparison> compared = CompareWithBaseline(content.Value(), runs, command.lab.isQuick);
    if (!compared) return Fail(command.baseline.string() + ": " + compared.GetError().message);
    const Comparison& comparison = compared.Value();
    for (const std::string& line : comparison.better) std::printf("better: %s\n", line.c_str());
    for (const std::string& line : comparison.worse) std::printf("worse: %s\n", line.c_str());
    std::printf("%zu worse, %zu better; errors: %zu the same\n", comparison.worse.size(), comparison.better.size(),
                comparison.same);
    double sum = 0;
    const Comparison::CostRatio *most = nullptr, *least = nullptr;
    for (const Comparison::CostRatio& cost : comparison.costs) {
        sum += std::log(cost.ratio);
        if (!most || cost.ratio > most->ratio) most = &cost;
        if (!least || cost.ratio < least->ratio) least = &cost;
    }
    if (most)
        std::printf("traversals over those of the baseline: %.4f (geometric mean); most %.4f, %s; least %.4f, %s\n",
                    std::exp(sum / static_cast<double>(comparison.costs.size())), most->ratio, most->run.c_str(),
                    least->ratio, least->run.c_str());
    return comparison.worse.empty() ? 0 : 1;
}

int ReportTargets(const LabCommand& command, std::span<const SceneRuns> scenes) {
    const std::string table = TargetTable(scenes);
    std::printf("%s", table.c_str());
    if (!command.table.empty())
        if (const Status written = WriteTables(table, command.table, "targets"); !written)
            return Fail(written.GetError().message);
    return 0;
}

int Run(const LabCommand& command) {
    for (const std::filesystem::path& file : {command.save, std::filesystem::path(command.table)})
        if (const Status writable = file.empty() ? Status(Done{}) : CheckWritable(file); !writable)
            return Fail(writable.GetError().message);
    Result<std::vector<RunRecord>> runs = RunLab(command.lab);
    if (!runs) return Fail(runs.GetError().message);
    if (!command.save.empty())
        if (const Status saved = SaveBaseline(command.save, runs.Value(), command.lab.isQuick); !saved)
            return Fail(saved.GetError().message);
    if (command.soaks) return ReportSoak(runs.Value());
    const int comparison = command.baseline.empty() ? 0 : Compare(command, runs.Value());
    if (command.recordings.AreWanted())
        if (const Status written = WriteRecordings(runs.Value(), command.recordings, command.lab.folder); !written)
            return Fail(written.GetError().message);
    FindRecordings(runs.Value(), command.lab.folder);
    const std::vector<SceneRuns> scenes = ByScene(std::move(runs.Value()));
    if (command.adviseError || command.adviseBudget) return Advise(command, scenes);
    if (command.lab.comparesTargets) return ReportTargets(command, scenes);
    return std::max(Write(command, scenes), comparison);
}

}  // namespace
}  // namespace fulcrum::accuracy

int main(int argc, char** argv) {
    const auto command = fulcrum::accuracy::ParseLabCommand(std::vector<std::string>(argv + 1, argv + argc));
    if (!command) return fulcrum::accuracy::Fail(command.GetError().message);
    return fulcrum::WithStandardOutput([&] {
        if (command.Value().help.empty()) return fulcrum::accuracy::Run(command.Value());
        std::printf("%s", command.Value().help.c_str());
        return 0;
    });
}
