// Bodies whose pose the user sets, and what follows for joints, bounds and contacts. Called between steps, under the
// world's lock.
#pragma once

#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <span>

namespace fulcrum {

// A body, and where its own frame is to be.
struct BodyPlace {
    uint32_t body = 0;
    Pose pose{};  // the rotation is a unit quaternion
};

// Of bodies that are teleported, where they were.
class PosesBefore {
public:
    PosesBefore(const BodyStore& bodies, std::span<const BodyPlace> places);
    // Whether joints hold the body to one that was not moved, or to which it was not moved along with it.
    bool IsTorn(const JointStore& joints, uint32_t body) const;

private:
    bool MovedTogether(uint32_t a, uint32_t b) const;
    const BodyPlace* Find(uint32_t body) const;

    const BodyStore& bodies_;
    Array<BodyPlace> before_;  // center frames
};

// Puts bodies, each named once, there at once; they wake, with what rested on them and what they now touch. Mechanisms
// whose joints are no farther apart than before do not notice. A frozen body is free again. before: made just before.
void Teleport(WorldState& world, std::span<const BodyPlace> places, const PosesBefore& before);
// The same, by a displacement of each body, in ascending order, m. Asks for no memory.
void Teleport(WorldState& world, std::span<const uint32_t> bodies, FunctionRef<Vector3(uint32_t)> displacementOf);

}  // namespace fulcrum
