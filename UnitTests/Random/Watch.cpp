#include <Fulcrum/UnitTests/Random/Watch.h>

#include <Fulcrum/UnitTests/Support/Cases.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <thread>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
extern "C" void __sanitizer_set_death_callback(void (*callback)());
#endif

namespace fulcrum::testing {

namespace {

std::atomic<uint32_t> seedNow{0};
std::atomic<size_t> callNow{0};
std::atomic<const char*> nameNow{""};
std::atomic<uint64_t> count{0};

void Say() {
    std::fprintf(stderr, "\nrandom program %u, call %zu %s\n", seedNow.load(), callNow.load(), nameNow.load());
    std::fflush(stderr);
}

void Crash(int signal) {
    Say();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

}  // namespace

struct Watch::Sentry {
    std::mutex mutex;
    std::condition_variable ended;
    bool isEnding = false;
    std::thread thread;

    void Run(double seconds) {
        uint64_t last = count.load();
        double waited = 0;
        std::unique_lock lock(mutex);
        while (!ended.wait_for(lock, std::chrono::seconds(1), [&] { return isEnding; })) {
            const uint64_t now = count.load();
            waited = now == last ? waited + 1 : 0;
            last = now;
            if (waited < seconds) continue;
            std::fprintf(stderr, "\na call does not return:");
            Say();
            std::_Exit(3);
        }
    }
};

Watch::Watch(double seconds) : sentry_(new Sentry) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    __sanitizer_set_death_callback(Say);
#else
    for (const int signal : {SIGSEGV, SIGFPE, SIGILL, SIGABRT}) std::signal(signal, Crash);
#endif
    sentry_->thread = std::thread([this, seconds] { sentry_->Run(seconds); });
}

Watch::~Watch() {
    {
        const std::lock_guard lock(sentry_->mutex);
        sentry_->isEnding = true;
    }
    sentry_->ended.notify_one();
    sentry_->thread.join();
    delete sentry_;
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    for (const int signal : {SIGSEGV, SIGFPE, SIGILL, SIGABRT}) std::signal(signal, SIG_DFL);
#endif
}

void Watch::Note(uint32_t seed, size_t call, const char* name) {
    seedNow = seed;
    callNow = call;
    nameNow = name;
    ++count;
}

}  // namespace fulcrum::testing
