// Spin-waits for another thread that is expected within microseconds, up to a time limit. Used by ThreadPool and
// RunPhases. The pause hint below is the only processor-specific code outside Math/Wide.h, which Jobs does not include.
#pragma once

#include <chrono>
#include <cstdint>

namespace fulcrum {

// Tells the core that this is a spin loop: saves power and resources of the other hyper-thread.
inline void PauseCore() {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
}

// A loop calls Pause() until its condition is met. The limit is a time, because the hint's duration differs by a factor
// of ten and more between processors.
class Spin {
public:
    explicit Spin(std::chrono::nanoseconds limit) : limit_(limit) {}

    // Pauses briefly. False once the limit has passed: sleep, or yield before each further call.
    bool Pause() {
        PauseCore();
        if (++pauses_ % kPausesPerClock != 0) return !expired_;
        const auto now = std::chrono::steady_clock::now();
        if (pauses_ == kPausesPerClock) start_ = now;
        expired_ = now - start_ >= limit_;
        return !expired_;
    }

private:
    static constexpr uint32_t kPausesPerClock = 32;  // reading the clock costs about as much as one to ten hints

    std::chrono::nanoseconds limit_;
    std::chrono::steady_clock::time_point start_;
    uint32_t pauses_ = 0;
    bool expired_ = false;
};

}  // namespace fulcrum
