// Shapes that are edited in place under the bodies that have them, in any number of worlds: height fields. An edit does
// not know of worlds. Each world knows the latest version that it has heeded, and looks for edits since at the start of
// each change and step, and before its state is saved or hashed: at the bodies with such shapes, and only if the
// process had any edit.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

inline bool IsEditable(const Shape& shape) { return shape.Type() == ShapeType::HeightField; }

// Whether the shape of some body was edited after a version.
bool AreShapesEditedSince(const BodyStore& bodies, uint64_t version);

// Brings bounds, trees, radii and manifolds in line with edits since the last call, and wakes the bodies at the changed
// parts. The world must be locked for a change.
void HeedShapeEditsUntil(WorldState& world, uint64_t latest);
inline void HeedShapeEdits(WorldState& world) {
    const uint64_t latest = LatestShapeVersion();
    if (latest != world.heededShapeVersion) HeedShapeEditsUntil(world, latest);
}

}  // namespace fulcrum
