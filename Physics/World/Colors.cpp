#include <Fulcrum/Physics/World/Colors.h>

namespace fulcrum {

using Coloring = ConstraintColoring;

void ColorPair(PairStore& pairs, ConstraintColoring& coloring, uint32_t index) {
    const Pair& pair = pairs.pairs[index];
    ColorSlot& color = pairs.contacts[pair.contact].color;
    if (color.color != 0xFF) return;
    // Contacts with immovable bodies are solved last, so they win.
    color = coloring.Add(KindOf(pair), EntryOf(pair), pair.fixedB);
}

void UncolorPair(PairStore& pairs, ConstraintColoring& coloring, uint32_t index) {
    const Pair& pair = pairs.pairs[index];
    if (pair.contact == PairStore::kNone) return;
    ColorSlot& color = pairs.contacts[pair.contact].color;
    if (color.color == 0xFF) return;
    const uint32_t moved = coloring.Remove(KindOf(pair), EntryOf(pair), color);
    pairs.contacts[moved].color.slot = color.slot;
    color = {};
}

void RemovePair(PairStore& pairs, ConstraintColoring& coloring, uint32_t index) {
    while (index != PairStore::kNone) {
        const uint32_t next = pairs.MoreOf(index);
        UncolorPair(pairs, coloring, index);
        pairs.Remove(index);
        index = next;
    }
}

bool MovesAwake(const BodyStore& bodies, const JointStore& joints, uint32_t index) {
    const Joint& joint = joints.joints[index];
    const auto isAwake = [&](int side) { return !joint.fixed[side] && bodies.dynamics[joint.body[side]].awake; };
    return isAwake(0) || isAwake(1);
}

void ColorJoint(const BodyStore& bodies, JointStore& joints, ConstraintColoring& coloring, uint32_t index) {
    Joint& joint = joints.joints[index];
    if (joint.color.color != 0xFF || !joint.enabled || !MovesAwake(bodies, joints, index)) return;
    coloring.ReserveBodies(bodies.Size());
    const bool late = joint.priority == JointPriority::High || joint.fixed[0] || joint.fixed[1];
    joint.color = coloring.Add(Coloring::Kind::Joint, EntryOf(joint, index), late);
}

void UncolorJoint(JointStore& joints, ConstraintColoring& coloring, uint32_t index) {
    Joint& joint = joints.joints[index];
    if (joint.color.color == 0xFF) return;
    const uint32_t moved = coloring.Remove(Coloring::Kind::Joint, EntryOf(joint, index), joint.color);
    joints.joints[moved].color.slot = joint.color.slot;
    joint.color = {};
    joint.isStrained = joint.wasPastLimit = joint.isBeyondTarget = false;
    joint.stepsBeyond = 0;
}

void RecolorJointsOf(const BodyStore& bodies, JointStore& joints, ConstraintColoring& coloring, uint32_t body) {
    joints.VisitOf(body, [&](uint32_t index) {
        Joint& joint = joints.joints[index];
        bool& fixed = joint.fixed[joint.SideOf(body)];
        if (fixed == !bodies.CanMove(body)) return;
        UncolorJoint(joints, coloring, index);
        fixed = !fixed;
        ColorJoint(bodies, joints, coloring, index);
    });
}

}  // namespace fulcrum
