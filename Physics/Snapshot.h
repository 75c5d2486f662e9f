// Snapshots of a world's whole state, for rollback and saved games: PhysicsSystem::SaveSnapshot and RestoreSnapshot.
// What they need besides to be restored, and deltas, which hold the changes from one snapshot to another. Deltas are
// made by pure functions of bytes, for any thread. Docs/Snapshots.md says what is in them.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Physics/GroupFilter.h>
#include <Fulcrum/Physics/JointSettings.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace fulcrum {

// What a snapshot names and does not contain, where the world that it is restored to does not have it any more, or not
// yet. What bodies of that world have is found without.
struct SnapshotSources {
    std::span<const ShapePtr> shapes{};  // any that may be named; known by their content, see ContentHash
    std::span<const std::shared_ptr<const GroupFilter>> groupFilters{};  // by GroupFilter::ContentHash, in their order
    // Makes the type of a joint that is not of the engine's kinds, and that the world does not have: one as it was when
    // the joint was made, of which settings, state and controls are then overwritten. Null: unknown.
    Function<std::unique_ptr<JointType>(JointId joint)> makeJoint{};
};

// The changes from one snapshot to another, in bytes whose number follows what changed: nothing but a few for what
// rests. `delta` is overwritten, its memory reused. Errors: Unsupported (one of the two is no snapshot, or they are of
// different builds), Degenerate (damaged).
Status MakeSnapshotDelta(std::span<const std::byte> base, std::span<const std::byte> snapshot,
                         std::vector<std::byte>& delta);
// The snapshot again, from the same base. After an error `snapshot` is empty. Errors: Unsupported (no delta, or of
// another build), Degenerate (damaged, or the base is another one).
Status ApplySnapshotDelta(std::span<const std::byte> base, std::span<const std::byte> delta,
                          std::vector<std::byte>& snapshot);

}  // namespace fulcrum
