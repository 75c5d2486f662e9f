// Log messages of the engine: misuse that no Result can report, and why the program is about to be aborted. They go to
// standard error, or to a handler of the program. For all worlds, from any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdio>

namespace fulcrum {

enum class LogLevel : uint8_t {
    Warning,  // a call that was not allowed had no effect
    Fatal,    // the program is aborted as soon as the handler returns
};

// `message` is a line without its end, valid during the call. It must not throw, nor call a world.
using LogHandler = void (*)(LogLevel level, const char* message);

inline std::atomic<LogHandler>& TheLogHandler() {
    static std::atomic<LogHandler> handler{nullptr};
    return handler;
}

// Null: standard error again, each line after "fulcrum: ".
inline void SetLogHandler(LogHandler handler) { TheLogHandler().store(handler, std::memory_order_release); }

inline void Log(LogLevel level, const char* message) {
    if (const LogHandler handler = TheLogHandler().load(std::memory_order_acquire)) handler(level, message);
    else std::fprintf(stderr, "fulcrum: %s\n", message);
}

}  // namespace fulcrum
