// Runs a function in a forked process, which may crash, hang or take all memory without harm to this one. Called by
// MeshFile.cpp and the runner; any thread. The function must not need other threads: they do not exist there.
#pragma once

#include <Fulcrum/Math/Function.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace fulcrum {

struct ProcessLimits {
    unsigned seconds = 0;  // of processor time, and a tenth of the wall clock's; 0: any
    uint64_t bytes = 0;    // that it may allocate, where the system can tell; 0: any
    uint64_t mostSent = std::numeric_limits<uint64_t>::max();  // bytes
};

enum class ProcessEnd : uint8_t {
    Returned,
    Died,  // a signal, or an exit by what it called
    TookTooLong,
    SentTooMuch,
    NotStarted,  // the system has no room for another process
};

struct ProcessRun {
    ProcessEnd end = ProcessEnd::NotStarted;
    std::vector<std::byte> sent;  // until then
};

// Returns false if nobody reads any more.
using SendBytes = Function<bool(std::span<const std::byte> bytes)>;

// Calls work(send). What it prints is lost, its destructors at exit do not run.
ProcessRun RunInProcess(const Function<void(const SendBytes& send)>& work, const ProcessLimits& limits = {});

}  // namespace fulcrum
