// Log messages of the engine: misuse that no Result can report, and why the program is about to be aborted. They go to
// standard error, or to a handler of the program. For all worlds, from any thread.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

#include <cstdint>
#include <cstdio>

namespace fulcrum {

enum class LogLevel : uint8_t {
    Warning,  // a call that was not allowed had no effect
    Fatal,    // the program is aborted as soon as the handler returns
};

// `message` is a line without its end, valid during the call. It must not throw, nor call a world.
using LogHandler = void (*)(LogLevel level, const char* message);

// Read and written by the functions below only, atomically. The standard's atomics would take long to compile.
inline LogHandler theLogHandler = nullptr;

// Null: standard error again, each line after "fulcrum: ".
inline void SetLogHandler(LogHandler handler) { __atomic_store_n(&theLogHandler, handler, __ATOMIC_RELEASE); }

inline void Log(LogLevel level, const char* message) {
    if (const LogHandler handler = __atomic_load_n(&theLogHandler, __ATOMIC_ACQUIRE)) handler(level, message);
    else std::fprintf(stderr, "fulcrum: %s\n", message);
}

}  // namespace fulcrum
