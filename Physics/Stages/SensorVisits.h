// When a body overlaps a sensor within a step. Called by the Sense stage, for different pairs from any number of
// threads at once.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

#include <span>

namespace fulcrum {

// The path segments of a body that had hits of continuous collision in this step; empty for all others. `cut`: see
// SensorSearch.
std::span<const MotionSegment> CutSegmentsOf(std::span<const MotionSegment> cut, uint32_t body);

// A body's path in this step: one segment, or several if it had hits of continuous collision.
class MotionPath {
public:
    MotionPath(const StepContext& step, const BodyStore& bodies, const SweepStore& sweeps,
               std::span<const MotionSegment> cut, uint32_t body);
    MotionPath(const MotionPath&) = delete;
    MotionPath& operator=(const MotionPath&) = delete;

    uint32_t Body() const { return body_; }
    std::span<const MotionSegment> Segments() const { return segments_; }
    // Pose of the center frame; the time must be within the segment.
    Pose PoseAt(const MotionSegment& segment, float time) const;

private:
    uint32_t body_;
    Pose end_;
    MotionSegment own_;
    std::span<const MotionSegment> segments_;
};

// Whether a body with one collider overlaps a sensor with one collider at the end of the step.
bool OverlapAtEnd(const CollisionView& view, uint32_t sensor, uint32_t body);

// Bounds of a collider of the body along its whole path.
Bounds PieceBounds(const BodyStore& bodies, const ColliderStore& colliders, const MotionPath& path, uint32_t collider);

// Whether a body overlaps a sensor at the start of the step, if known.
enum class AtStart : uint8_t { Unknown, Outside, Inside };

// Appends the disjoint intervals of the step during which the two overlap, ascending. `sensor` is an index in
// SensorStore::sensors. Bounds of the sensor's colliders must contain their paths. A rotating convex collider counts as
// inside from its first to its last touch of a sensor's collider in a segment of its path; a mesh or height field
// counts as one collider. For two of these, or half spaces, only the ends of the step are tested.
void FindVisits(const CollisionView& view, uint32_t sensor, const MotionPath& sensorPath, const MotionPath& bodyPath,
                AtStart atStart, Array<SensorVisit>& visits);

}  // namespace fulcrum
