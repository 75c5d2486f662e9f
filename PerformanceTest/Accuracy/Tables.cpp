// The summary in Markdown.
#include <Fulcrum/PerformanceTest/Accuracy/Output.h>

#include <Fulcrum/PerformanceTest/Accuracy/Curves.h>
#include <Fulcrum/PerformanceTest/Peers/Peer.h>
#include <Fulcrum/Physics/Files/WholeFile.h>

#include <cmath>
#include <cstdio>

namespace fulcrum::accuracy {
namespace {

constexpr const char* kPresets[] = {"fast", "balanced", "accurate", "reference"};

// Where nothing is solved all presets are the same.
const RunRecord* PresetOf(const SceneRuns& each, const char* preset) {
    const RunRecord* run = FindPreset(each.runs, preset);
    return run ? run : FindPreset(each.runs, "balanced");
}

std::string ErrorText(const RunRecord* run) {
    if (!run) return "–";
    return run->blewUp ? "blew up" : ShortNumber(run->Error());
}

std::string CostText(const RunRecord* run) { return run ? ShortNumber(run->microseconds) : "never"; }

std::string Heading(const std::vector<std::string>& cells) {
    std::string names, rule;
    for (const std::string& cell : cells) {
        names += "| " + cell + " ";
        rule += "| --- ";
    }
    return names + "|\n" + rule + "|\n";
}

std::string CurveCells(const SceneRuns& each) {
    const double slope = SlopeOverDt(each.runs);
    char text[16];
    std::snprintf(text, sizeof text, "%.1f", slope);
    std::string cells =
        std::string(" | ") + (std::isfinite(slope) ? text : "–") + " | " + ShortNumber(Floor(each.runs));
    for (const double error : {0.1, 0.01, 0.001}) cells += " | " + CostText(CheapestFor(each.runs, error));
    return cells;
}

std::string AccuracyTable(std::span<const SceneRuns> scenes, bool isExtreme) {
    std::vector<std::string> heading = {"scene"};
    for (const char* preset : kPresets) heading.push_back(preset);
    for (const char* name : {"slope", "floor", "10 %", "1 %", "0.1 %"}) heading.push_back(name);
    if (isExtreme) heading.insert(heading.end(), {"cheapest that passes", "requirements that the default fails"});
    std::string table = Heading(heading);
    for (const SceneRuns& each : scenes) {
        if (each.scene->isExtreme != isExtreme) continue;
        table += "| `" + each.scene->FullName() + "`";
        for (const char* preset : kPresets) {
            const RunRecord* run = PresetOf(each, preset);
            table += " | " + ErrorText(run) + (run ? " @ " + CostText(run) : "");
        }
        table += CurveCells(each);
        if (isExtreme) {
            std::string conditions;
            if (const RunRecord* run = PresetOf(each, "balanced"))
                for (const std::string& condition : run->failedConditions)
                    conditions += (conditions.empty() ? "" : "; ") + condition;
            const RunRecord* passing = CheapestThatPasses(each.runs);
            table += " | " + (passing ? passing->setting.Key() : "none") + " | " +
                     (conditions.empty() ? "none" : conditions);
        }
        table += " |\n";
    }
    return table;
}

std::string EnvelopeTable(std::span<const SceneRuns> scenes) {
    std::string table = Heading({"scene", "envelope: setting: error @ cost"});
    for (const SceneRuns& each : scenes) {
        table += "| `" + each.scene->FullName() + "` | ";
        bool isFirst = true;
        for (const size_t i : Envelope(each.runs)) {
            const RunRecord& run = each.runs[i];
            table += (isFirst ? "" : "; ") + run.setting.Key() + ": " + ErrorText(&run) + " @ " + CostText(&run);
            isFirst = false;
        }
        table += std::string(isFirst ? "none: all blew up" : "") + " |\n";
    }
    return table;
}

}  // namespace

std::string ShortNumber(double value) {
    if (!std::isfinite(value)) return "–";
    if (value == 0) return "0";
    char text[32];
    if (value >= 999.5e3) std::snprintf(text, sizeof text, "%.3gM", value / 1e6);
    else if (value >= 999.5) std::snprintf(text, sizeof text, "%.3gk", value / 1e3);
    else if (value >= 99.5) std::snprintf(text, sizeof text, "%.0f", value);
    else std::snprintf(text, sizeof text, "%.2g", value);
    std::string shortened = text;
    if (const size_t zero = shortened.find("e-0"); zero != std::string::npos) shortened.erase(zero + 2, 1);
    return shortened;
}

std::string PeerTable(std::span<const SceneRuns> scenes, const Peer& peer) {
    std::string table = Heading({"scene", "Fulcrum", peer.Label()}), lacking;
    for (const SceneRuns& each : scenes) {
        const std::string name = "`" + each.scene->FullName() + "`";
        if (!each.peerLacks.empty()) lacking += (lacking.empty() ? "" : "; ") + name + ": " + each.peerLacks;
        const RunRecord *ours = PresetOf(each, "balanced"), *its = FindPreset(each.peerRuns, "default");
        if (!ours || !its) continue;
        table += "| " + name + " | " + ErrorText(ours) + " @ " + CostText(ours) + " | " + ErrorText(its) + " @ " +
                 CostText(its) + " |\n";
    }
    return table + (lacking.empty() ? ""
                                    : "\nNot run in " + peer.Label() +
                                          ", where the lab has no counterpart of what they need: " + lacking + ".\n");
}

std::string TablesOf(std::span<const SceneRuns> scenes, const Circumstances& circumstances) {
    return std::string("Made by `./fulcrum accuracy") + (circumstances.isQuick ? " --quick" : "") +
           " --table Docs/Accuracy.md`. Each cell: error @ cost, microseconds of work per simulated second.\n\n" +
           AccuracyTable(scenes, false) + "\n" + AccuracyTable(scenes, true) +
           "\n<details>\n<summary>Envelopes</summary>\n\n" + EnvelopeTable(scenes) + "\n</details>\n" +
           (circumstances.peer ? "\n" + PeerTable(scenes, *circumstances.peer) : "");
}

Status WriteTables(const std::string& tables, const std::filesystem::path& path, const std::string& name) {
    const std::string beginMark = "<!-- accuracy " + name + ": begin -->",
                      endMark = "<!-- accuracy " + name + ": end -->";
    const Result<std::string> read = ReadWholeFile(path);
    if (!read) return read.GetError();
    const std::string& text = read.Value();
    const size_t begin = text.find(beginMark + "\n"), end = text.find(endMark);
    if (begin == std::string::npos || end == std::string::npos || end < begin)
        return Error{ErrorCode::OutOfRange, path.string() + " has no lines " + beginMark + " and " + endMark};
    const size_t first = begin + beginMark.size() + 1;
    const std::string_view whole = text;
    return WriteWholeFile(path, {whole.substr(0, first), "\n", tables, "\n", whole.substr(end)});
}

}  // namespace fulcrum::accuracy
