// Events of sensors: a body entered, stayed or left. From PhysicsSystem::SensorEvents.
#pragma once

#include <Fulcrum/Physics/Settings.h>

namespace fulcrum {

struct SensorEvent {
    enum class Kind : uint8_t {
        Begin,  // it began to overlap the sensor
        Stay,   // it was inside at the start and at the end of the step
        End,    // it no longer overlaps the sensor or passes its filter; or the body or the sensor was removed
    };
    BodyId sensor, body;
    Kind kind = Kind::Begin;
    float time = 0;  // fraction of the step, 0..1; 1 for Stay; 0 for changes between two steps
    friend bool operator==(const SensorEvent&, const SensorEvent&) = default;
};

}  // namespace fulcrum
