// Constraints get a color when they become active and lose it when they become inactive: contacts when they begin and
// end, joints when they are created, removed, wake or fall asleep. One thread.
#pragma once

#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/JointStore.h>
#include <Fulcrum/Physics/World/PairStore.h>

namespace fulcrum {

// Arguments of the coloring for a pair or a joint.
inline ConstraintColoring::Kind KindOf(const Pair& pair) {
    return pair.fixedB ? ConstraintColoring::Kind::Fixed : ConstraintColoring::Kind::Moving;
}
inline ConstraintColoring::Entry EntryOf(const Joint& joint, uint32_t index) {
    return {index, joint.body[0], joint.body[1], joint.fixed[0], joint.fixed[1]};
}
// Of the pair's contact.
inline ConstraintColoring::Entry EntryOf(const Pair& pair) {
    return {pair.contact, pair.bodyA, pair.bodyB, false, pair.fixedB};
}

// Assigns a color to a pair's contact, or removes it; no effect if it already has one, or none.
void ColorPair(PairStore& pairs, ConstraintColoring& coloring, uint32_t pair);
void UncolorPair(PairStore& pairs, ConstraintColoring& coloring, uint32_t pair);
// Removes a pair with all its manifolds and their colors.
void RemovePair(PairStore& pairs, ConstraintColoring& coloring, uint32_t pair);

// Whether a joint has an awake body that can move.
bool MovesAwake(const BodyStore& bodies, const JointStore& joints, uint32_t joint);
// As for pairs; only enabled joints with MovesAwake get a color.
void ColorJoint(const BodyStore& bodies, JointStore& joints, ConstraintColoring& coloring, uint32_t joint);
void UncolorJoint(JointStore& joints, ConstraintColoring& coloring, uint32_t joint);
// Updates a body's joints after it became immovable (frozen) or movable again.
void RecolorJointsOf(const BodyStore& bodies, JointStore& joints, ConstraintColoring& coloring, uint32_t body);

}  // namespace fulcrum
