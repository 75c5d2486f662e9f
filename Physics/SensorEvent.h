// What a sensor reports: which body came in, stayed, or left. From PhysicsSystem::SensorEvents.
#pragma once

#include <Fulcrum/Physics/Settings.h>

namespace fulcrum {

struct SensorEvent {
    enum class Kind : uint8_t {
        Begin,  // it came to overlap the sensor
        Stay,   // it was inside when the step began and when it ended
        End,    // it overlaps it no longer, or is no longer seen; or the body or the sensor was removed
    };
    BodyId sensor, body;
    Kind kind = Kind::Begin;
    float time = 0;  // 0 .. 1, of the step; 1 for Stay; 0 for what changed between two steps
    friend bool operator==(const SensorEvent&, const SensorEvent&) = default;
};

}  // namespace fulcrum
