// The sensors and the bodies inside them. Written by BodyInterface between steps and by the Sense stage; only events
// and lists are read by others.
#pragma once

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/SensorEvent.h>
#include <Fulcrum/Physics/World/HeapBytes.h>

#include <algorithm>

namespace fulcrum {

struct Sensor {
    BodyId id;
    SensorSees sees = SensorSees::Default;
    bool reportsStay = true;
    bool removed = false;  // since the last step: the next one reports the end events
    Array<BodyId> inside;  // ascending, at the end of the last step
    Array<BodyId> insideNext;
    Array<SensorEvent> events;  // of this step
};

struct SensorStore {
    Array<Sensor> sensors;  // ascending by id
    // Bodies that were created, placed or given other settings since the last step; unordered, with repetitions.
    Array<uint32_t> changed;
    Array<SensorEvent> events;  // of the last step

    bool IsEmpty() const { return sensors.empty(); }
    // The index of a sensor, or where it would be inserted.
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
        changed.push_back(id.index);
    }
    // The body must be a sensor.
    void Remove(BodyId id) { sensors[PlaceOf(id)].removed = true; }
};

inline size_t HeapBytes(const Sensor& sensor) {
    const auto& [id, sees, reportsStay, removed, inside, insideNext, events] = sensor;
    return HeapBytes(id, sees, reportsStay, removed, inside, insideNext, events);
}
inline size_t HeapBytes(const SensorStore& store) {
    const auto& [sensors, changed, events] = store;
    return HeapBytes(sensors, changed, events);
}

}  // namespace fulcrum
