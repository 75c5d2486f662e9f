// Creates and updates the colliders of a body from its shape and edits of its children. Called by BodyInterface between
// steps, under the world's lock. Fat bounds and trees are up to date afterwards, pairs at the next FindPairs.
#pragma once

#include <Fulcrum/Collision/Shapes/CompoundShape.h>
#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// The shape and pose of a child of a compound; empty if it was removed.
ColliderShape PieceOfChild(const CompoundShape& compound, const CompoundShape::Child& child);
// A body's shape, and of a mutable compound its own copy.
struct OwnShape {
    explicit OwnShape(const ShapePtr& shape);
    ShapePtr shape;
    std::unique_ptr<BodyChildren> children;
};
// Sets a body's shape; then adds its colliders to the trees.
void SetShapeOf(WorldState& world, uint32_t body, OwnShape&& own);
const ShapePtr& ShapeOfWorldBody();
uint32_t ColliderCountOf(const Shape& shape);
void MakeColliders(WorldState& world, uint32_t body);
// Removes them with their pairs; asks for no memory after Additions::removedPairs and ColliderStore::ReserveFree.
void DropColliders(WorldState& world, uint32_t body);

// After the body became a sensor, static or movable, or ceased to be one: its pairs are searched again.
void MoveToItsTree(WorldState& world, uint32_t body);

// Colliders of the body's runs: a child of a higher index needs a further run.
uint32_t ColliderRoomOf(const WorldState& world, uint32_t body);
// Updates the collider of a child of a mutable compound that was added, removed, moved or has another shape. Wakes the
// bodies near its old and new places.
void UpdateChildCollider(WorldState& world, uint32_t body, uint32_t child);

// The sum of the relative masses of a shape's children; for shapes without children the volume, m3.
double RelativeMassOf(const Shape& shape);

// Wakes bodies whose bounds overlap the body's fat bounds.
void WakeNeighbors(WorldState& world, uint32_t body);

// Moves the center of mass within the body's own frame. Material points, joints and contacts keep their positions,
// material points their velocities, forces their lines of action.
void MoveCenterOfMass(WorldState& world, uint32_t body, const Vector3& from, const Vector3& to);

}  // namespace fulcrum
