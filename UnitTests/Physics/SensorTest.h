// Helpers of the tests of the sensors: settings, and events that failed tests can print.
#pragma once

#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <ostream>

namespace fulcrum {

inline std::ostream& operator<<(std::ostream& out, const SensorEvent& e) {
    const char* kinds[] = {"Begin", "Stay", "End"};
    return out << kinds[static_cast<int>(e.kind)] << " of " << e.body.index << " in " << e.sensor.index << " at "
               << e.time;
}

}  // namespace fulcrum

namespace fulcrum::testing {

inline constexpr SensorEvent::Kind kBegin = SensorEvent::Kind::Begin, kStay = SensorEvent::Kind::Stay,
                                   kEnd = SensorEvent::Kind::End;

inline BodySettings SensorOf(ShapePtr shape, const Position& position = Position::Zero(),
                             MotionType motion = MotionType::Static) {
    BodySettings settings;
    settings.shape = std::move(shape);
    settings.motion = motion;
    settings.position = position;
    settings.isSensor = true;
    return settings;
}

inline std::vector<SensorEvent> EventsOf(TestWorld& world) {
    const std::span<const SensorEvent> events = world.System().SensorEvents();
    return {events.begin(), events.end()};
}
inline std::vector<BodyId> InsideOf(TestWorld& world, BodyId sensor) {
    const std::span<const BodyId> inside = world.System().BodiesInside(sensor);
    return {inside.begin(), inside.end()};
}

// Events of the step: so many, of these kinds.
inline void ExpectKinds(TestWorld& world, std::initializer_list<SensorEvent::Kind> kinds) {
    const std::vector<SensorEvent> events = EventsOf(world);
    std::vector<SensorEvent::Kind> found;
    for (const SensorEvent& e : events) found.push_back(e.kind);
    EXPECT_EQ(found, std::vector<SensorEvent::Kind>(kinds)) << ::testing::PrintToString(events);
}

}  // namespace fulcrum::testing
