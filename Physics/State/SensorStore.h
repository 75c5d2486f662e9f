// The sensors and what is inside them. Written by BodyInterface between steps and by the Sense stage, which alone reads
// it but for the events and lists that it leaves to the user.
#pragma once

#include <Fulcrum/Physics/SensorEvent.h>
#include <Fulcrum/Physics/State/SweepStore.h>

#include <algorithm>
#include <vector>

namespace fulcrum {

struct Sensor {
    BodyId id;
    SensorSees sees = SensorSees::Default;
    bool reportsStay = true;
    bool removed = false;        // gone before the next step, which still has to say so
    std::vector<BodyId> inside;  // ascending, as the last step ended
    std::vector<BodyId> insideNext;
    std::vector<SensorEvent> events;  // of this step
};

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

struct SensorStore {
    std::vector<Sensor> sensors;  // ascending by id
    std::vector<uint32_t>
        touched;  // bodies that were created, moved by hand or set otherwise since the last step; any, repeated
    std::vector<uint64_t> touchedIn;   // by body: the last step whose list had it
    std::vector<uint64_t> candidates;  // place of a sensor, index of a body that may overlap it in this step; sorted
    std::vector<SensorVisit> visits;   // sorted
    std::vector<MotionSegment> cut;    // ways of several parts, by body and time
    std::vector<SensorEvent> events;   // of the last step

    bool IsEmpty() const { return sensors.empty(); }
    // The place of a sensor, or where it would be.
    uint32_t PlaceOf(BodyId id) const {
        const auto at = std::lower_bound(sensors.begin(), sensors.end(), id,
                                         [](const Sensor& s, BodyId other) { return s.id < other; });
        return static_cast<uint32_t>(at - sensors.begin());
    }
    bool Has(BodyId id) const {
        const uint32_t place = PlaceOf(id);
        return place < sensors.size() && sensors[place].id == id && !sensors[place].removed;
    }
    void Add(BodyId id, SensorSees sees, bool reportsStay) {
        const uint32_t place = PlaceOf(id);
        if (place == sensors.size() || sensors[place].id != id) sensors.emplace(sensors.begin() + place);
        Sensor& sensor = sensors[place];
        sensor.id = id;
        sensor.sees = sees;
        sensor.reportsStay = reportsStay;
        sensor.removed = false;
        touched.push_back(id.index);
    }
    // It is one.
    void Remove(BodyId id) { sensors[PlaceOf(id)].removed = true; }

    size_t MemoryUsed() const {
        size_t bytes = sensors.capacity() * sizeof(Sensor) + touched.capacity() * sizeof(uint32_t) +
                       (touchedIn.capacity() + candidates.capacity()) * sizeof(uint64_t) +
                       visits.capacity() * sizeof(SensorVisit) + cut.capacity() * sizeof(MotionSegment) +
                       events.capacity() * sizeof(SensorEvent);
        for (const Sensor& s : sensors)
            bytes += (s.inside.capacity() + s.insideNext.capacity()) * sizeof(BodyId) +
                     s.events.capacity() * sizeof(SensorEvent);
        return bytes;
    }
};

}  // namespace fulcrum
