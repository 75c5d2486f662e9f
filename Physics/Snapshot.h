// Snapshots of a world's whole state, for rollback and saved games: PhysicsSystem::SaveSnapshot and RestoreSnapshot.
// Declares the external objects needed for restoring, and deltas, which contain the changes from one snapshot to
// another. Deltas are computed by pure functions of bytes, on any thread. Docs/Snapshots.md describes the contents.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Math/List.h>
#include <Fulcrum/Physics/GroupFilter.h>
#include <Fulcrum/Physics/JointSettings.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace fulcrum {

// Objects that a snapshot references but does not contain. Needed only if the world does not have them; objects of the
// world's bodies are found without.
struct SnapshotSources {
    List<ShapePtr> shapes{};  // shapes that may be referenced; identified by their content, see ContentHash
    List<std::shared_ptr<const GroupFilter>> groupFilters{};  // identified by GroupFilter::ContentHash, in this order
    // Creates the type of a user-defined joint that the world does not have, as when the joint was created; its
    // settings, state and controls are then overwritten. Null: unknown.
    Function<std::unique_ptr<JointType>(JointId joint)> makeJoint{};
};

// Computes the changes from one snapshot to another. The size depends on the amount of change: a few bytes for resting
// bodies. `delta` is overwritten, its memory reused. Errors: Unsupported (one of them is not a snapshot, or they are of
// different builds), Degenerate (damaged).
Status MakeSnapshotDelta(std::span<const std::byte> base, std::span<const std::byte> snapshot,
                         std::vector<std::byte>& delta);
// Reconstructs the snapshot from the same base. On error `snapshot` is empty. Errors: Unsupported (not a delta, or of
// another build), Degenerate (damaged, or another base).
Status ApplySnapshotDelta(std::span<const std::byte> base, std::span<const std::byte> delta,
                          std::vector<std::byte>& snapshot);

}  // namespace fulcrum
