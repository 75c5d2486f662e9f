#include <Fulcrum/Assets/Meshes/ChildProcess.h>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>

namespace fulcrum {

namespace {

template <class Resource>  // int, or an enumeration of the C library
void Limit(Resource resource, rlim_t most) {
    rlimit limit{};
    getrlimit(resource, &limit);
    limit.rlim_cur = std::min({limit.rlim_cur, limit.rlim_max, most});  // RLIM_INFINITY is the largest
    setrlimit(resource, &limit);
}

// Beyond what the process has already, such as the reserved memory of a sanitizer.
void LimitMemory(uint64_t bytes) {
    unsigned long pages = 0;
    FILE* const file = std::fopen("/proc/self/statm", "r");
    const bool isKnown = file && std::fscanf(file, "%*u %*u %*u %*u %*u %lu", &pages) == 1;
    if (file) std::fclose(file);
    if (isKnown) Limit(RLIMIT_DATA, pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + bytes);
}

// A crash is not this program's: no report of it, no core file. Runs in the child.
void BecomeQuiet() {
    Limit(RLIMIT_CORE, 0);
    for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU, SIGALRM}) std::signal(number, SIG_DFL);
    std::signal(SIGPIPE, SIG_IGN);
    const int nowhere = open("/dev/null", O_WRONLY);
    for (const int output : {STDOUT_FILENO, STDERR_FILENO})
        if (nowhere < 0 || dup2(nowhere, output) < 0) _exit(1);
}

[[noreturn]] void RunChild(const Function<void(const SendBytes& send)>& work, const ProcessLimits& limits, int pipe) {
    BecomeQuiet();
    if (limits.seconds > 0) {
        Limit(RLIMIT_CPU, limits.seconds);
        alarm(10 * limits.seconds);
    }
    if (limits.bytes > 0) LimitMemory(limits.bytes);
    try {
        work([pipe](std::span<const std::byte> bytes) {
            while (!bytes.empty()) {
                const ssize_t sent = write(pipe, bytes.data(), bytes.size());
                if (sent < 0 && errno == EINTR) continue;
                if (sent <= 0) return false;
                bytes = bytes.subspan(static_cast<size_t>(sent));
            }
            return true;
        });
    } catch (...) {
        _exit(1);
    }
    _exit(0);
}

// Null: it has been waited for by someone else, who ignores children.
int StatusOf(pid_t child) {
    int status = 0;
    pid_t waited;
    do waited = waitpid(child, &status, 0);
    while (waited < 0 && errno == EINTR);
    return waited == child ? status : 0;
}

}  // namespace

ProcessRun RunInProcess(const Function<void(const SendBytes& send)>& work, const ProcessLimits& limits) {
    ProcessRun run;
    int ends[2];
    if (pipe(ends) != 0) return run;
    for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        RunChild(work, limits, ends[1]);
    }
    close(ends[1]);
    std::array<std::byte, 65536> room;
    while (child > 0) {
        const ssize_t got = read(ends[0], room.data(), room.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        if (run.sent.size() + static_cast<size_t>(got) > limits.mostSent) {
            run.end = ProcessEnd::SentTooMuch;
            break;
        }
        run.sent.insert(run.sent.end(), room.begin(), room.begin() + got);
    }
    close(ends[0]);
    if (child <= 0) return run;
    if (run.end == ProcessEnd::SentTooMuch) kill(child, SIGKILL);
    const int status = StatusOf(child);
    if (run.end == ProcessEnd::SentTooMuch) return run;
    const bool isLate = WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM);
    run.end = isLate ? ProcessEnd::TookTooLong : status != 0 ? ProcessEnd::Died : ProcessEnd::Returned;
    return run;
}

}  // namespace fulcrum
