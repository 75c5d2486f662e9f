#include <Fulcrum/Physics/World/WorldState.h>

#include <Fulcrum/Physics/World/HeapBytes.h>

namespace fulcrum {

size_t HeapBytes(const WorldState& world) {
    const auto& [settings, jobs, listener, observer, callObserver, bodies, colliders, pairs, joints, coloring, sleeping,
                 sensors, removed, step, lock, outsideFatBounds, pendingTrees, seenPoses, heededShapeVersion, lifts] =
        world;
    return HeapBytes(settings, listener, bodies, colliders, pairs, joints, coloring, sleeping, sensors, removed, step,
                     outsideFatBounds, seenPoses, heededShapeVersion, lifts);
}

void KeepForEvents(WorldState& world) {
    const EventSettings& events = world.settings.events;
    world.pairs.KeepReported(events.contacts);
    world.bodies.notesSleepChanges = events.contacts || events.bodies;
    if (!world.bodies.notesSleepChanges) world.bodies.sleepChanges = {};
}

}  // namespace fulcrum
