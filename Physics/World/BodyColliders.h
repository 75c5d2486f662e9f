// The colliders of a body, as its shape and its children's edits ask for. Called by BodyInterface between steps, under
// the world's lock. Fat bounds and trees are up to date afterwards, pairs at the next FindPairs.
#pragma once

#include <Fulcrum/Collision/Shapes/CompoundShape.h>
#include <Fulcrum/Physics/World/WorldState.h>

namespace fulcrum {

// The piece that a child of a compound is; empty where it has been removed.
ColliderShape PieceOfChild(const CompoundShape& compound, const CompoundShape::Child& child);
// Gives a body its shape, of a mutable compound a copy of its own; then what it is made of, in the trees.
void SetShapeOf(WorldState& world, uint32_t body, const ShapePtr& shape);
void MakeColliders(WorldState& world, uint32_t body);
// Takes them away again, with their pairs.
void DropColliders(WorldState& world, uint32_t body);

// After the body became a sensor, static or movable, or ceased to be one: what meets it is searched anew.
void MoveToItsTree(WorldState& world, uint32_t body);

// Brings the collider of a child of a mutable compound in line with it, new, removed, moved or of another shape. Wakes
// what was or is near.
void UpdateChildCollider(WorldState& world, uint32_t body, uint32_t child);

// What the children of a shape weigh relative to each other, in all; of shapes without children the volume, m3.
double RelativeMassOf(const Shape& shape);

// Wakes what overlaps the body's fat bounds: what it may rest on, or what may rest on it.
void WakeNeighbors(WorldState& world, uint32_t body);

// Moves the center of mass from one place in the body's own frame to another. Material points, joints and contacts keep
// their places, material points their velocities, forces their lines.
void MoveCenterOfMass(WorldState& world, uint32_t body, const Vector3& from, const Vector3& to);

}  // namespace fulcrum
