// The sensors and what is inside them. Written by BodyInterface between steps and by the Sense stage, which alone reads
// it but for the events and lists that it leaves to the user.
#pragma once

#include <Fulcrum/Physics/SensorEvent.h>
#include <Fulcrum/Physics/World/HeapBytes.h>

#include <algorithm>
#include <vector>

namespace fulcrum {

struct Sensor {
    BodyId id;
    SensorSees sees = SensorSees::Default;
    bool reportsStay = true;
    bool removed = false;        // since the last step: the next one reports what leaves it
    std::vector<BodyId> inside;  // ascending, as the last step ended
    std::vector<BodyId> insideNext;
    std::vector<SensorEvent> events;  // of this step
};

struct SensorStore {
    std::vector<Sensor> sensors;  // ascending by id
    // Bodies that were created, placed or given other settings since the last step; in no order, repeated.
    std::vector<uint32_t> changed;
    std::vector<SensorEvent> events;  // of the last step

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
        changed.push_back(id.index);
    }
    // It is one.
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
