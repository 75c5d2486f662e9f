// When a body overlaps a sensor within a step. Called by the Sense stage, for different pairs from any number of
// threads at once.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

#include <span>

namespace fulcrum {

// The segments of the path of a body that continuous collision made bounce in this step; empty for all others. `cut`:
// see SensorSearch.
std::span<const MotionSegment> CutSegmentsOf(std::span<const MotionSegment> cut, uint32_t body);

// A body's path in this step: one segment, or several where continuous collision made it bounce.
class MotionPath {
public:
    MotionPath(const StepContext& step, const BodyStore& bodies, const SweepStore& sweeps,
               std::span<const MotionSegment> cut, uint32_t body);
    MotionPath(const MotionPath&) = delete;
    MotionPath& operator=(const MotionPath&) = delete;

    uint32_t Body() const { return body_; }
    std::span<const MotionSegment> Segments() const { return segments_; }
    // Of the center frame; the time is within the segment.
    Pose PoseAt(const MotionSegment& segment, float time) const;

private:
    uint32_t body_;
    Pose end_;
    MotionSegment own_;
    std::span<const MotionSegment> segments_;
};

// Whether a body of one piece overlaps a sensor of one piece where they are at the end of the step.
bool OverlapAtEnd(const CollisionView& view, uint32_t sensor, uint32_t body);

// Bounds of a collider of the body all along its path.
Bounds PieceBounds(const BodyStore& bodies, const ColliderStore& colliders, const MotionPath& path, uint32_t collider);

// Whether a body overlaps a sensor as the step begins, where that is known.
enum class AtStart : uint8_t { Unknown, Outside, Inside };

// Appends the stretches of the step during which the two overlap, ascending and apart from each other. `sensor` is a
// place in SensorStore::sensors. Bounds of the sensor's colliders contain their paths. A convex piece that turns counts
// as inside from when it first to when it last touches a piece of the sensor in a segment of its path; a mesh or height
// field counts as one piece. Of two of these, or half spaces, only the ends of the step are looked at.
void FindVisits(const CollisionView& view, uint32_t sensor, const MotionPath& sensorPath, const MotionPath& bodyPath,
                AtStart atStart, std::vector<SensorVisit>& visits);

}  // namespace fulcrum
