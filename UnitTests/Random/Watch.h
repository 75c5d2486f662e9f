// Says which random program was at which call when the process crashes, a sanitizer ends it, or a call does not return.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fulcrum::testing {

class Watch {
public:
    // Starts the watchdog: a call that takes longer than `seconds` ends the process.
    explicit Watch(double seconds);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    static void Note(uint32_t seed, size_t call, const char* name);

private:
    struct Sentry;
    Sentry* sentry_;
};

}  // namespace fulcrum::testing
