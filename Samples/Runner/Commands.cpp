#include <Fulcrum/Samples/Runner/Commands.h>

#include <Fulcrum/Assets/Meshes/MeshImport.h>
#include <Fulcrum/Assets/SceneFile.h>
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Math/Wide.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Physics/Recording/CallRecorder.h>
#include <Fulcrum/Samples/Runner/FileScene.h>
#include <Fulcrum/Samples/Runner/JsonOutput.h>
#include <Fulcrum/Samples/Runner/Progress.h>
#include <Fulcrum/Samples/Runner/Recorder.h>
#include <Fulcrum/Samples/Runner/RunEnvironment.h>
#include <Fulcrum/Samples/Runner/ReplayCommands.h>
#include <Fulcrum/Samples/Runner/RunReport.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Samples/Viewer/GlbWriter.h>
#include <Fulcrum/Samples/Viewer/HtmlWriter.h>
#include <Fulcrum/Version.h>

#include <nlohmann/json.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <vector>

namespace fulcrum {
namespace {

constexpr double kDroppedSize = 1;  // m, largest extent of a dropped mesh

int Fail(const std::string& message) {
    std::fprintf(stderr, "fulcrum: %s\n", message.c_str());
    return 1;
}

// What to simulate, report and record.
struct Job {
    const Scene& scene;
    SceneInput input;
    const RunOptions& options;
    const JsonOutput& json;
    std::string name;  // of the report and of the files in options.out
    std::string description;
    std::string file{};  // of the scene, if it is of one

    std::string ErrorOf(const Error& error) const { return (file.empty() ? name : file) + ": " + error.message; }
};

std::filesystem::path OutputOf(const RunOptions& options, const std::string& name, const char* extension) {
    std::filesystem::path path = options.out / name;
    return path += extension;
}

// Before the simulation, so that it is not run in vain if the folder is misspelled or must not be written. Returns an
// empty text if all is well.
std::string CheckOutputs(const RunOptions& options, const std::string& name, const JsonOutput& json) {
    std::error_code error;
    if (options.recordHtml || options.recordGlb) {
        std::filesystem::create_directories(options.out, error);
        if (error) return "cannot create the folder " + options.out.string() + ": " + error.message();
    }
    std::vector<std::filesystem::path> files;
    if (options.recordHtml) files.push_back(OutputOf(options, name, ".html"));
    if (options.recordGlb) files.push_back(OutputOf(options, name, ".glb"));
    if (!options.calls.empty()) files.push_back(options.calls);
    for (const std::filesystem::path& file : files)
        if (const Status writable = CheckWritable(file); !writable) return writable.GetError().message;
    return json.Check();
}

// Writes the files that the options name. Returns an empty text, or what went wrong.
std::string WriteOutputs(const Job& job, const Recorder* recorder, const RunFigures& figures) {
    const auto write = [&](const char* extension, auto writer) -> std::string {
        const std::filesystem::path path = OutputOf(job.options, job.name, extension);
        const Status status = writer(recorder->recording, path);
        if (!status) return status.GetError().message;
        std::error_code error;
        const auto bytes = static_cast<double>(std::filesystem::file_size(path, error));
        if (!job.options.isQuiet) std::printf("Wrote %s (%.1f MB)\n", path.c_str(), error ? 0 : bytes / 1e6);
        return {};
    };
    std::string trouble;
    if (job.options.recordHtml) trouble = write(".html", WriteHtml);
    if (trouble.empty() && job.options.recordGlb) trouble = write(".glb", WriteGlb);
    if (trouble.empty() && job.json.IsWanted())
        trouble = job.json.Write(RunDocument(job.scene, job.name, figures, job.input.seed), !job.options.isQuiet);
    return trouble;
}

int RunJob(const Job& job) {
    const std::string trouble = CheckOutputs(job.options, job.name, job.json);
    if (!trouble.empty()) return Fail(trouble);

    std::optional<ThreadPool> pool;
    if (job.options.threads > 1) pool.emplace(static_cast<uint32_t>(job.options.threads));
    SceneInput input = job.input;
    std::optional<Result<std::unique_ptr<CallRecorder>>> calls;
    if (!job.options.calls.empty())
        input.created = [&](PhysicsSystem& system) {
            calls = CallRecorder::ToFile(system, job.options.calls.string());
        };
    auto created = SceneWorld::Create(job.scene, input, pool ? &*pool : nullptr);
    if (!created) return Fail(job.ErrorOf(created.GetError()));
    SceneWorld& world = *created.Value();
    if (calls && !*calls) return Fail(calls->GetError().message);
    std::unique_ptr<CallRecorder> callRecorder;  // goes before the world
    if (calls) callRecorder = std::move(calls->Value());

    const int steps = job.options.StepsOf(job.scene);
    std::optional<Recorder> recorder;
    if (job.options.recordHtml || job.options.recordGlb) {
        recorder.emplace(world, steps, job.options.dt);
        recorder->recording.title = job.name;
        std::replace(recorder->recording.title.begin(), recorder->recording.title.end(), '_', ' ');
        recorder->recording.description = job.description;
    }
    Result<RunFigures> run = [&] {
        std::optional<Progress> progress;
        if (!job.options.isQuiet) progress.emplace(job.name.c_str(), steps);
        return Simulate(world, 0, steps, job.options.dt, pool ? pool->WorkerCount() : 1, [&] {
            if (recorder) recorder->AfterStep();
            if (progress) progress->Advance();
        });
    }();
    if (!run) return Fail(job.ErrorOf(run.GetError()));
    if (callRecorder && !callRecorder->GetStatus()) return Fail(callRecorder->GetStatus().GetError().message);

    const std::vector<ReportLine> lines = ReportLines(job.scene, run.Value(), job.input.seed);
    if (recorder) recorder->recording.report = lines;
    if (!job.options.isQuiet)
        std::printf("%s: %s\n%s", job.name.c_str(), job.description.c_str(), ReportText(lines).c_str());
    const std::string unwritten = WriteOutputs(job, recorder ? &*recorder : nullptr, run.Value());
    if (!unwritten.empty()) return Fail(unwritten);
    if (VerdictOf(job.scene, run.Value()) == AccuracyVerdict::Fail)
        return Fail(job.name + ": accuracy " + AccuracyText(job.scene, run.Value()));
    return 0;
}

// A broken file may claim a huge size: this limit makes allocations fail while it is read instead of swapping.
class AddressSpaceLimit {
public:
    explicit AddressSpaceLimit(rlim_t bytes) {
        getrlimit(RLIMIT_AS, &before_);
        rlimit limited = before_;
        limited.rlim_cur = std::min(before_.rlim_cur, bytes);
        setrlimit(RLIMIT_AS, &limited);
    }
    ~AddressSpaceLimit() { setrlimit(RLIMIT_AS, &before_); }
    AddressSpaceLimit(const AddressSpaceLimit&) = delete;
    AddressSpaceLimit& operator=(const AddressSpaceLimit&) = delete;

private:
    rlimit before_{};
};

template <class Import>
auto ReadWithinMemory(const Import& import) {
    const AddressSpaceLimit limit(rlim_t{8} << 30);
    return import();
}

void PrintGround(const std::string& name, const ImportedMesh& ground) {
    const MeshReport& report = ground.report;
    std::printf("%s: a mesh of %u triangles and %u vertices; %.4g units are %.4g m here\n", name.c_str(),
                ground.mesh->TriangleCount(), ground.mesh->VertexCount(), ground.fileSize,
                ground.scale * ground.fileSize);
    if (ground.isTwoSided)
        std::printf("  both sides are solid: %u edges end the surface, at %u others its fronts disagree\n",
                    report.boundaryEdges, report.irregularEdges);
    for (const std::string& repair : ground.repairs) std::printf("  repaired: %s\n", repair.c_str());
}

int Drop(const Command& command, SceneInput input, const JsonOutput& json) {
    const Result<ImportedShape> imported = ReadWithinMemory([&] { return ImportShape(command.file, kDroppedSize); });
    if (!imported) return Fail(imported.GetError().message);
    const ImportedShape& model = imported.Value();
    const std::string name = command.file.filename().string();
    for (const std::string& warning : model.warnings) std::fprintf(stderr, "fulcrum: warning: %s\n", warning.c_str());
    if (!command.options.isQuiet)
        std::printf("%s: %zu points became %zu hull%s of %zu vertices in all; %.4g units are %g m here\n", name.c_str(),
                    model.points, model.hulls, model.hulls == 1 ? "" : "s", model.hullVertices, model.fileSize,
                    kDroppedSize);
    input.shape = model.shape;
    input.count = command.count;
    const std::string dropped = std::to_string(command.count) + " of " + name,
                      title = "drop_" + command.file.stem().string();
    if (command.onto.empty())
        return RunJob({*command.scene, input, command.options, json, title, dropped + " in a heap"});

    const Result<ImportedMesh> ground =
        ReadWithinMemory([&] { return ImportMesh(command.onto, command.ontoSettings); });
    if (!ground) return Fail(ground.GetError().message);
    if (!command.options.isQuiet) PrintGround(command.onto.filename().string(), ground.Value());
    input.ground = ground.Value().mesh;
    return RunJob({*command.scene, input, command.options, json, title + "_onto_" + command.onto.stem().string(),
                   dropped + " dropped onto " + command.onto.filename().string()});
}

int RunFile(const Command& command, SceneInput input, const JsonOutput& json) {
    const Result<SceneDescription> read = ReadWithinMemory([&] { return ReadScene(command.file); });
    if (!read) return Fail(read.GetError().message);
    for (const std::string& note : read.Value().notes)
        std::fprintf(stderr, "fulcrum: note: %s: %s\n", command.file.c_str(), note.c_str());
    const std::string name = command.file.stem().string();
    const Scene scene = SceneOf(name, read.Value());
    RunOptions options = command.options;
    options.dt = options.givenDt.value_or(read.Value().dt);
    input.description = &read.Value();
    return RunJob({scene, input, options, json, name, scene.description, command.file.string()});
}

int Export(const Command& command) {
    const Result<ExportedScene> exported = ExportScene(*command.scene, {});
    if (!exported) return Fail(std::string(command.scene->name) + ": " + exported.GetError().message);
    for (const std::string& missing : exported.Value().warnings)
        std::fprintf(stderr, "fulcrum: warning: the file does not have %s\n", missing.c_str());
    const Status written = WriteScene(command.file, exported.Value().description);
    if (!written) return Fail(written.GetError().message);
    std::printf("Wrote %s: %zu bodies, %zu joints, %zu ragdolls\n", command.file.c_str(),
                exported.Value().description.bodies.size(), exported.Value().description.joints.size(),
                exported.Value().description.ragdolls.size());
    return 0;
}

int PrintVersion() {
    const std::string commit = CommitText();
    std::printf("Fulcrum %s\ncommit    %s\ncompiler  %s\nlanes     %d\n", FULCRUM_VERSION_STRING,
                commit.empty() ? "unknown" : commit.c_str(), CompilerName().c_str(), kLanes);
    return 0;
}

int ListScenes() {
    size_t width = 0;
    for (const Scene* scene : AllScenes()) width = std::max(width, std::string(scene->name).size());
    for (SceneKind kind : {SceneKind::Performance, SceneKind::Sample}) {
        std::printf("%s\n",
                    kind == SceneKind::Performance ? "Performance scenes, timed by ./fulcrum bench" : "Samples");
        for (const Scene* scene : AllScenes())
            if (scene->kind == kind)
                std::printf("  %-*s  %s\n", static_cast<int>(width), scene->name, scene->description);
    }
    return 0;
}

}  // namespace

int Execute(const Command& command) {
    const JsonOutput json(command.options.json);
    SceneInput input;
    input.seed = command.options.seed;
    input.solver = command.options.solver;
    input.narrowPhase = command.options.narrowPhase;
    input.measuresErrors = command.options.errors;
    switch (command.kind) {
        case CommandKind::Run:
            return RunJob(
                {*command.scene, input, command.options, json, command.scene->name, command.scene->description});
        case CommandKind::RunFile: return RunFile(command, input, json);
        case CommandKind::Export: return Export(command);
        case CommandKind::Drop: return Drop(command, input, json);
        case CommandKind::Replay: return ReplayFile(command);
        case CommandKind::Shrink: return ShrinkFile(command);
        case CommandKind::List: return ListScenes();
        case CommandKind::Version: return PrintVersion();
        default: std::printf("%s", command.help.c_str()); return 0;
    }
}

}  // namespace fulcrum
