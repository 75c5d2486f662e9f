// How a thread waits for another that is expected within microseconds: it keeps its core for a while and then gives up.
// Used by ThreadPool and RunPhases. The processor's hint below is the only such line outside Math/Wide.h: Jobs stands
// alone, and the hint changes no result.
#pragma once

#include <chrono>
#include <cstdint>

namespace fulcrum {

// Tells the core that this is a waiting loop: saves power and leaves the other hyper-thread its share.
inline void PauseCore() {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
}

// A loop calls Turn() as long as what it waits for has not come. The limit is a time, because the hint's duration
// differs by a factor of ten and more between processors.
class Spin {
public:
    explicit Spin(std::chrono::nanoseconds limit) : limit_(limit) {}

    // Waits a moment. False once the limit has passed: sleep, or yield before each further turn.
    bool Turn() {
        PauseCore();
        if (++turns_ % kTurnsPerClock != 0) return !expired_;
        const auto now = std::chrono::steady_clock::now();
        if (turns_ == kTurnsPerClock) start_ = now;
        expired_ = now - start_ >= limit_;
        return !expired_;
    }

private:
    static constexpr uint32_t kTurnsPerClock = 32;  // reading the clock costs about as much as one to ten hints

    std::chrono::nanoseconds limit_;
    std::chrono::steady_clock::time_point start_;
    uint32_t turns_ = 0;
    bool expired_ = false;
};

}  // namespace fulcrum
