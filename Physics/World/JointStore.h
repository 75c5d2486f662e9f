// All joints, by index: what the solver gathers lies together, the rest apart. Indices of removed joints are reused
// with another generation. Written by JointInterface between steps and by the stages during one. Each body knows its
// joints.
#pragma once

#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Constraints/Joints/JointBatch.h>
#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Physics/JointSettings.h>
#include <Fulcrum/Physics/World/IndexSet.h>
#include <Fulcrum/Physics/World/LoadLevel.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace fulcrum {

// Numbers of substeps and passes with which an island is to be solved at least; 0: the system's do.
struct LeastEffort {
    uint8_t substeps = 0, velocityIterations = 0, positionIterations = 0;

    bool IsAny() const { return substeps > 0 || velocityIterations > 0 || positionIterations > 0; }
    // Whether it is more than the settings have.
    bool Exceeds(const SolverSettings& settings) const {
        return substeps > settings.substeps || velocityIterations > settings.velocityIterations ||
               positionIterations > settings.positionIterations;
    }
    // Sets each number to that of the other where it is less. Returns whether one was.
    bool Raise(const LeastEffort& to) {
        const LeastEffort before = *this;
        substeps = std::max(substeps, to.substeps);
        velocityIterations = std::max(velocityIterations, to.velocityIterations);
        positionIterations = std::max(positionIterations, to.positionIterations);
        return *this != before;
    }
    friend bool operator==(const LeastEffort&, const LeastEffort&) = default;
};
// Of settings from 0 to 255; how errors are corrected is the same for all islands.
inline LeastEffort ToLeastEffort(const SolverSettings& settings) {
    return {static_cast<uint8_t>(settings.substeps), static_cast<uint8_t>(settings.velocityIterations),
            static_cast<uint8_t>(settings.positionIterations)};
}

struct Joint {
    uint32_t body[2] = {0, 0};      // A and B
    uint32_t next[2] = {~0u, ~0u};  // the next joint of A and of B
    std::unique_ptr<JointType> type;
    JointLocks locks;      // of the type, as the layout has them
    uint32_t maxRows = 0;  // likewise
    ColorSlot color;
    uint32_t generation = 0;
    bool exists = false;
    bool enabled = true;
    bool collideConnected = false;
    bool overridesMass = false;      // massOverride is not none
    bool still[2] = {false, false};  // the body is immovable: static, kinematic or frozen
    JointPriority priority = JointPriority::Normal;
    float breakForce = 0, breakTorque = 0;
    LeastEffort effort;  // of its island
    MassOverride massOverride;
    uint64_t userData = 0;
    uint64_t teleportedBefore = 0;  // the step before which a body of its mechanism was teleported last

    void SetMassOverride(const MassOverride& o) {
        massOverride = o;
        overridesMass = !o.IsNone();
    }
    int SideOf(uint32_t index) const { return body[0] == index ? 0 : 1; }
};

size_t HeapBytes(const Joint& joint);

class JointStore {
public:
    static constexpr uint32_t kNone = ~0u;

    // By index; all of the same size.
    std::vector<JointRecord> records;
    std::vector<JointType*> types;
    std::vector<Joint> joints;
    std::vector<LoadLevel> gaps;  // how far the anchors are apart
    IndexSet breakable;

    uint32_t Count() const { return count_; }
    uint32_t Allocate();        // an index with fresh values; exists is set
    void Free(uint32_t index);  // not linked, not colored
    bool Find(JointId id) const {
        return id.index < joints.size() && joints[id.index].exists && joints[id.index].generation == id.generation;
    }
    JointId IdOf(uint32_t index) const { return {index, joints[index].generation}; }

    // Its impulses and forces are zero from now on.
    void Forget(uint32_t index);

    // Puts the joint on the lists of its two bodies, or takes it off them.
    void Link(uint32_t index);
    void Unlink(uint32_t index);
    // The joints of a body, the newest first. The visitor may remove the one that it is at.
    template <class Visit>
    void VisitOf(uint32_t body, Visit&& visit) const {
        if (body >= first_.size()) return;
        for (uint32_t index = first_[body]; index != kNone;) {
            const Joint& joint = joints[index];
            const uint32_t next = joint.next[joint.SideOf(body)];
            visit(index);
            index = next;
        }
    }
    bool HasAny(uint32_t body) const { return body < first_.size() && first_[body] != kNone; }
    // Whether some joint keeps the two bodies from colliding.
    bool ForbidsContact(uint32_t bodyA, uint32_t bodyB) const;
    friend size_t HeapBytes(const JointStore& store);

private:
    friend struct SnapshotAccess;
    std::vector<uint32_t> first_;  // by body
    std::vector<uint32_t> free_;
    uint32_t count_ = 0;
};

}  // namespace fulcrum
