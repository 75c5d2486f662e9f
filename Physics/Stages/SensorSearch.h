// What the Sense stage works with: who may be inside of which sensor in this step, and when.
#pragma once

#include <Fulcrum/Physics/Stages/SweepStore.h>

#include <cstdint>
#include <vector>

namespace fulcrum {

// A stretch of the step during which a body overlaps a sensor.
struct SensorVisit {
    uint32_t sensor = 0, body = 0;  // place in SensorStore::sensors; index
    float from = 0, until = 0;      // fractions of the step
    bool atStart = false, atEnd = false;
};

// A straight part of a body's way: its sweep, from sweep.from until then.
struct MotionSegment {
    Sweep sweep;
    float until = 1;
};

struct SensorSearch {
    std::vector<uint64_t> touchedIn;   // by body: the last step in which SensorStore::touched had it
    std::vector<uint64_t> candidates;  // place of a sensor, index of a body that may overlap it in this step; sorted
    std::vector<SensorVisit> visits;   // sorted
    std::vector<MotionSegment> cut;    // ways of several parts, by body and time
};

inline size_t HeapBytes(const SensorSearch& search) {
    const auto& [touchedIn, candidates, visits, cut] = search;
    return HeapBytes(touchedIn, candidates, visits, cut);
}

}  // namespace fulcrum
