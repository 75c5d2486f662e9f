// Contact events as tests look at them.
#pragma once

#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {

inline SystemSettings WithContactEvents(SystemSettings settings = {}) {
    settings.events.contacts = true;
    return settings;
}
inline SystemSettings WithAllEvents(SystemSettings settings = {}) {
    settings.events = {.contacts = true, .stays = true, .bodies = true};
    return settings;
}

// N s, that the contacts and hits of the last step gave a body.
inline Vector3 ImpulseOn(TestWorld& world, BodyId body) {
    Vector3 sum = Vector3::Zero();
    for (const ContactEvent& event : world.System().Events().contacts) {
        if (event.bodyB == body) sum += event.Impulse();
        if (event.bodyA == body) sum -= event.Impulse();
    }
    return sum;
}

// How many events of a kind the last step has.
inline int CountEvents(TestWorld& world, ContactEvent::Kind kind) {
    int count = 0;
    for (const ContactEvent& event : world.System().Events().contacts) count += event.kind == kind;
    return count;
}

}  // namespace fulcrum::testing
