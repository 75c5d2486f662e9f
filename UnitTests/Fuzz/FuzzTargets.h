// Functions that take arbitrary bytes and must hold their promises for all of them. FuzzTest.cpp runs each with mutated
// seeds for a moment, LibFuzzer.cpp as long as one likes, with coverage (./fulcrum fuzz). A broken promise ends the
// process, as fuzzers expect it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace fulcrum::testing {

using FuzzBytes = std::vector<uint8_t>;

struct FuzzTarget {
    const char* name;
    void (*run)(std::span<const uint8_t> bytes);
    // Valid inputs to start from.
    std::vector<FuzzBytes> (*seeds)();
    int quickRuns;  // of FuzzTest.cpp: about a second
};

std::span<const FuzzTarget> FuzzTargets();

// A table of targets per file.
extern const FuzzTarget kShapeFileTarget, kHullTarget, kMeshTarget, kSnapshotTarget, kSnapshotDeltaTarget,
    kRecordingTarget, kSceneTarget, kCborTarget, kRagdollTarget, kProgramTarget;

// Ends the process with a message where a promise is broken.
void Promise(bool holds, const char* what);

// Takes values from the bytes; zeros beyond their end.
class FuzzReader {
public:
    explicit FuzzReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
    template <class T>
    T Get() {
        T value{};
        const size_t size = std::min(sizeof(T), bytes_.size());
        if (size > 0) std::memcpy(&value, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
        return value;
    }
    size_t Left() const { return bytes_.size(); }
    std::span<const uint8_t> Rest() const { return bytes_; }

private:
    std::span<const uint8_t> bytes_;
};

// The opposite, for seeds.
template <class T>
void Append(FuzzBytes& bytes, const T& value) {
    const auto* begin = reinterpret_cast<const uint8_t*>(&value);
    bytes.insert(bytes.end(), begin, begin + sizeof(T));
}

}  // namespace fulcrum::testing
