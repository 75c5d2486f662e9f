#include <Fulcrum/Samples/Runner/ReplayCommands.h>

#include <Fulcrum/Assets/Meshes/ChildProcess.h>
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Physics/Recording/Replay.h>
#include <Fulcrum/Samples/Runner/Progress.h>
#include <Fulcrum/Samples/Runner/Simulation.h>

#include <algorithm>
#include <cstdio>

namespace fulcrum {

namespace {

int FailWith(const std::string& message) {
    std::fprintf(stderr, "fulcrum: %s\n", message.c_str());
    return 1;
}

std::string SizeText(const ProgramSize& size) {
    return std::to_string(size.bodies) + " bodies, " + std::to_string(size.steps) + " steps, " +
           std::to_string(size.calls) + " calls";
}

FailureCheck FailureOf(const ShrinkOptions& options) {
    if (options.speed) return FailureOfSpeed(static_cast<float>(*options.speed));
    if (options.below) return FailureOfHeight(*options.below);
    return options.differs ? FailureOfDifference() : FailureOfFrozenBody();
}

}  // namespace

IsolatedRun RunInAProcess(const Function<void(const CallRecorder::Sink& send)>& play) {
    ProcessRun run = RunInProcess(play);
    return {.hasDied = run.end == ProcessEnd::Died, .sent = std::move(run.sent)};
}

int ReplayFile(const Command& command) {
    const Result<CallRecording> recording = CallRecording::ReadFile(command.file.string());
    if (!recording) return FailWith(recording.GetError().message);
    ThreadPool jobs(static_cast<uint32_t>(command.options.threads));
    const Result<ReplayReport> report = [&] {
        Progress progress(command.file.stem().c_str(),
                          static_cast<int>(std::max(recording.Value().Steps(), uint64_t{1})));
        return Replay(recording.Value(), {.jobs = &jobs, .afterStep = [&](PhysicsSystem&) {
                                              progress.Advance();
                                              return true;
                                          }});
    }();
    const std::string file = command.file.string();
    if (!report) return FailWith(file + ": " + report.GetError().message);
    const ReplayReport& played = report.Value();
    std::printf("%s: %llu calls, %llu steps%s\n", file.c_str(), static_cast<unsigned long long>(played.calls),
                static_cast<unsigned long long>(played.steps),
                recording.Value().IsComplete() ? "" : "; its end is missing, as of a program that crashed");
    if (played.divergence) return FailWith(file + ": " + played.divergence->what);
    std::printf("The same bits as when it was recorded, state hash %s\n", HashText(played.stateHash).c_str());
    return 0;
}

int ShrinkFile(const Command& command) {
    const Result<CallRecording> recording = CallRecording::ReadFile(command.file.string());
    if (!recording) return FailWith(recording.GetError().message);
    std::filesystem::path out = command.shrink.out;
    if (out.empty())
        out =
            command.file.parent_path() / (command.file.stem().string() + ".small" + command.file.extension().string());
    if (const Status writable = CheckWritable(out); !writable) return FailWith(writable.GetError().message);
    ThreadPool jobs(static_cast<uint32_t>(command.options.threads));
    ThreadPool several(static_cast<uint32_t>(std::max(command.options.threads, 4)));
    ShrinkSettings settings{.jobs = {&jobs}};
    if (command.shrink.differs) settings.jobs = {nullptr, &several};
    if (command.shrink.crashes) {
        settings.jobs = {nullptr};
        settings.isolation = RunInAProcess;
    }
    settings.progress = [](size_t replays, size_t calls) {
        if (replays % 100 == 0) std::fprintf(stderr, "%zu programs tried, %zu calls\n", replays, calls);
    };
    const Result<ShrinkReport> report = Shrink(recording.Value(), FailureOf(command.shrink), settings);
    if (!report) return FailWith(command.file.string() + ": " + report.GetError().message);
    const std::vector<std::byte>& bytes = report.Value().recording;
    if (const Status written = WriteWholeFile(out, {{reinterpret_cast<const char*>(bytes.data()), bytes.size()}});
        !written)
        return FailWith(written.GetError().message);
    std::printf("%s: %s\n%s: %s, found in %zu replays\n", command.file.c_str(), SizeText(report.Value().before).c_str(),
                out.c_str(), SizeText(report.Value().after).c_str(), report.Value().replays);
    return 0;
}

}  // namespace fulcrum
