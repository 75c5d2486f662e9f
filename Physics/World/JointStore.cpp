#include <Fulcrum/Physics/World/JointStore.h>

#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/ReserveMore.h>

#include <algorithm>

namespace fulcrum {

uint32_t JointStore::Allocate() {
    uint32_t index;
    if (!free_.empty()) {
        index = free_.back();
        free_.pop_back();
    } else {
        index = static_cast<uint32_t>(joints.size());
        joints.emplace_back();
        records.emplace_back();
        types.emplace_back();
        breakable.Reserve(index + 1);
    }
    const uint32_t generation = joints[index].generation;
    joints[index] = {};
    joints[index].generation = generation;
    joints[index].exists = true;
    records[index] = {};
    ++count_;
    return index;
}

void JointStore::Reserve(size_t more, size_t bodies) {
    const size_t grown = more - std::min(more, free_.size());
    ReserveMore(joints, grown);
    ReserveMore(records, grown);
    ReserveMore(types, grown);
    const size_t size = joints.size() + grown;
    if (size == 0) return;
    breakable.ReserveRoom(static_cast<uint32_t>(size));
    ReserveRoom(first_, bodies);
    ReserveRoom(free_, size);
}

void JointStore::Free(uint32_t index) {
    Joint& joint = joints[index];
    SetErrorTarget(index, 0);
    joint.type.reset();
    joint.exists = false;
    ++joint.generation;
    types[index] = nullptr;
    breakable.Erase(index);
    // As with bodies: after the last generation the index is not used again.
    if (joint.generation != 0) free_.push_back(index);
    --count_;
}

void JointStore::Forget(uint32_t index) {
    JointRecord& record = records[index];
    for (float(*impulse)[3] : {&record.ownImpulse, &record.ownAngularImpulse, &record.lockForce, &record.lockTorque,
                               &record.totalForce, &record.totalTorque})
        std::fill(std::begin(*impulse), std::end(*impulse), 0.0f);
    types[index]->impulses.fill(0.0f);
    types[index]->forces.fill(0.0f);
}

void JointStore::Link(uint32_t index) {
    Joint& joint = joints[index];
    const uint32_t last = std::max(joint.body[0], joint.body[1]);
    if (first_.size() <= last) first_.resize(last + 1, kNone);
    for (int side = 0; side < 2; ++side) {
        joint.next[side] = first_[joint.body[side]];
        first_[joint.body[side]] = index;
    }
}

void JointStore::Unlink(uint32_t index) {
    const Joint& joint = joints[index];
    for (int side = 0; side < 2; ++side) {
        uint32_t* link = &first_[joint.body[side]];
        while (*link != index) link = &joints[*link].next[joints[*link].SideOf(joint.body[side])];
        *link = joint.next[side];
    }
}

bool JointStore::ForbidsContact(uint32_t bodyA, uint32_t bodyB) const {
    if (!HasAny(bodyA) || !HasAny(bodyB)) return false;
    bool forbids = false;
    VisitOf(bodyA, [&](uint32_t index) {
        const Joint& joint = joints[index];
        forbids |= joint.enabled && !joint.collideConnected && joint.body[1 - joint.SideOf(bodyA)] == bodyB;
    });
    return forbids;
}

// A lower bound: derived types may be larger.
size_t HeapBytes(const Joint& joint) { return joint.type ? sizeof(JointType) : 0; }

size_t HeapBytes(const JointStore& store) {
    const auto& [records, types, joints, breakable, targetCount, strainVersion, moved, first, free, count] = store;
    return HeapBytes(records, types, joints, breakable, targetCount, strainVersion, moved, first, free, count);
}

}  // namespace fulcrum
