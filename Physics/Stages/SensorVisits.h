// When a body overlaps a sensor within a step. Called by the Sense stage, for different pairs from any number of
// threads at once.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>

#include <span>

namespace fulcrum {

// The parts of the way of a body that continuous collision made bounce in this step; empty for all others. `cut`: see
// SensorSearch.
std::span<const MotionSegment> CutSegmentsOf(std::span<const MotionSegment> cut, uint32_t body);

// A body's way in this step: one straight part, or several where continuous collision made it bounce.
class Way {
public:
    Way(const WorldState& world, const SweepStore& sweeps, std::span<const MotionSegment> cut, uint32_t body);
    Way(const Way&) = delete;
    Way& operator=(const Way&) = delete;

    uint32_t Body() const { return body_; }
    std::span<const MotionSegment> Parts() const { return parts_; }
    // Of the center frame; the time is within the part.
    Pose PoseAt(const MotionSegment& part, float time) const;

private:
    uint32_t body_;
    Pose end_;
    MotionSegment own_;
    std::span<const MotionSegment> parts_;
};

// Whether a body of one piece overlaps a sensor of one piece where they are at the end of the step.
bool OverlapAtEnd(const WorldState& world, uint32_t sensor, uint32_t body);

// Bounds of a collider of the body all along its way.
Bounds PieceBounds(const WorldState& world, const Way& way, uint32_t collider);

// Whether a body overlaps a sensor as the step begins, where that is known.
enum class AtStart : uint8_t { Unknown, Outside, Inside };

// Appends the stretches of the step during which the two overlap, ascending and apart from each other. `sensor` is a
// place in SensorStore::sensors. Bounds of the sensor's colliders hold their ways. A convex piece that turns counts as
// inside from when it first to when it last touches a piece of the sensor in a straight part of its way; a mesh or
// height field counts as one piece. Of two of these, or half spaces, only the ends of the step are looked at.
void FindVisits(const WorldState& world, uint32_t sensor, const Way& sensorWay, const Way& bodyWay, AtStart atStart,
                std::vector<SensorVisit>& visits);

}  // namespace fulcrum
