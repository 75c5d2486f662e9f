// Constraints get a color when they come to act and lose it when they no longer do: contacts as they begin and end,
// joints as they come and go, wake and sleep. One thread.
#pragma once

#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/JointStore.h>
#include <Fulcrum/Physics/World/PairStore.h>

namespace fulcrum {

// A pair, or a joint, as the coloring sees it.
inline ConstraintColoring::Kind KindOf(const Pair& pair) {
    return pair.fixedB ? ConstraintColoring::Kind::Fixed : ConstraintColoring::Kind::Moving;
}
inline ConstraintColoring::Entry EntryOf(const Joint& joint, uint32_t index) {
    return {index, joint.body[0], joint.body[1], joint.still[0], joint.still[1]};
}
inline ConstraintColoring::Entry EntryOf(const Pair& pair, uint32_t index) {
    return {index, pair.bodyA, pair.bodyB, false, pair.fixedB};
}

// Gives a pair's contact a color, or takes it away; nothing where it has one, or none.
void ColorPair(PairStore& pairs, ConstraintColoring& coloring, uint32_t pair);
void UncolorPair(PairStore& pairs, ConstraintColoring& coloring, uint32_t pair);
// Uncolors and removes a pair with all its manifolds.
void RemovePair(PairStore& pairs, ConstraintColoring& coloring, uint32_t pair);

// Whether a joint has a body that is awake and can move.
bool MovesAwake(const BodyStore& bodies, const JointStore& joints, uint32_t joint);
// As for pairs; only a joint that is enabled and moves awake gets a color.
void ColorJoint(const BodyStore& bodies, JointStore& joints, ConstraintColoring& coloring, uint32_t joint);
void UncolorJoint(JointStore& joints, ConstraintColoring& coloring, uint32_t joint);
// Updates a body's joints after it became immovable (frozen) or movable again (revived).
void RecolorJointsOf(const BodyStore& bodies, JointStore& joints, ConstraintColoring& coloring, uint32_t body);

}  // namespace fulcrum
