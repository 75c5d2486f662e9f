// Buffers of the Sense stage: which bodies may be inside which sensors in this step, and when.
#pragma once

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/Stages/SweepStore.h>

#include <cstdint>

namespace fulcrum {

// An interval of the step during which a body overlaps a sensor.
struct SensorVisit {
    uint32_t sensor = 0, body = 0;  // index in SensorStore::sensors; body index
    float from = 0, until = 0;      // fractions of the step
    bool atStart = false, atEnd = false;
};

// A segment of a body's path: its sweep, from sweep.from to `until`.
struct MotionSegment {
    Sweep sweep;
    float until = 1;
};

struct SensorSearch {
    Array<uint64_t> changedIn;   // by body: the last step in which SensorStore::changed had it
    Array<uint64_t> candidates;  // index of a sensor and of a body that may overlap it in this step; sorted
    Array<SensorVisit> visits;   // sorted
    Array<MotionSegment> cut;    // paths of several segments, by body and time
};

inline size_t HeapBytes(const SensorSearch& search) {
    const auto& [changedIn, candidates, visits, cut] = search;
    return HeapBytes(changedIn, candidates, visits, cut);
}

}  // namespace fulcrum
