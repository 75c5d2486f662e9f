#include <Fulcrum/Samples/Runner/ReplayCommands.h>

#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Physics/Recording/Replay.h>
#include <Fulcrum/Samples/Runner/Progress.h>
#include <Fulcrum/Samples/Runner/Simulation.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

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
    int ends[2];
    IsolatedRun run;
    if (pipe(ends) != 0) return run;
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        const rlimit none{0, 0};
        setrlimit(RLIMIT_CORE, &none);
        for (FILE* const output : {stdout, stderr})
            if (!std::freopen("/dev/null", "w", output)) _exit(0);
        play([end = ends[1]](std::span<const std::byte> bytes) {
            while (!bytes.empty()) {
                const ssize_t sent = write(end, bytes.data(), bytes.size());
                if (sent <= 0) return false;
                bytes = bytes.subspan(static_cast<size_t>(sent));
            }
            return true;
        });
        _exit(0);
    }
    close(ends[1]);
    std::array<std::byte, 65536> room;
    for (ssize_t got = 0; (got = read(ends[0], room.data(), room.size())) > 0;)
        run.sent.insert(run.sent.end(), room.begin(), room.begin() + got);
    close(ends[0]);
    int status = 0;
    run.hasDied = child > 0 && waitpid(child, &status, 0) == child && status != 0;
    return run;
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
    std::ofstream stream(out, std::ios::binary);
    const std::vector<std::byte>& bytes = report.Value().recording;
    stream.write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
    stream.close();
    if (!stream) return FailWith(out.string() + ": it cannot be written");
    std::printf("%s: %s\n%s: %s, found in %zu replays\n", command.file.c_str(), SizeText(report.Value().before).c_str(),
                out.c_str(), SizeText(report.Value().after).c_str(), report.Value().replays);
    return 0;
}

}  // namespace fulcrum
