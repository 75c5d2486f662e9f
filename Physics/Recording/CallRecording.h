// A recording of calls (CallRecorder.h) that was read and checked. Immutable: any number of threads may use one.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fulcrum {

enum class EntryKind : uint8_t;

class CallRecording {
public:
    // Errors: Unsupported (no recording, of another version, with calls that this version does not have or that have
    // other arguments), Degenerate (damaged). A recording whose end is missing, as of a program that crashed, is valid
    // up to there.
    static Result<CallRecording> Read(std::vector<std::byte> bytes);
    // Errors also: Unsupported (it cannot be opened or read). They begin with the file's name.
    static Result<CallRecording> ReadFile(const std::string& file);

    uint64_t Calls() const { return calls_; }
    uint64_t Steps() const { return steps_; }  // begun
    // Whether it has an end.
    bool IsComplete() const { return isComplete_; }

    // Its parts, for Replay.h and Shrink.h.
    struct Entry {
        EntryKind kind;
        uint16_t row = 0;  // of a call, in CallRows()
        size_t begin = 0, size = 0;
    };
    std::span<const Entry> Entries() const { return entries_; }
    std::span<const std::byte> DataOf(const Entry& entry) const {
        return std::span<const std::byte>(bytes_).subspan(entry.begin, entry.size);
    }

private:
    struct Parser;
    std::vector<std::byte> bytes_;
    std::vector<Entry> entries_;
    uint64_t calls_ = 0, steps_ = 0;
    bool isComplete_ = false;
};

}  // namespace fulcrum
