// All joints, as arrays by index: data gathered by the solver are separate from the rest. Indices of removed joints are
// reused with another generation. Written by JointInterface between steps and by the stages during one. Each body has a
// list of its joints.
#pragma once

#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Constraints/Joints/JointBatch.h>
#include <Fulcrum/Constraints/Joints/JointType.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/JointSettings.h>
#include <Fulcrum/Physics/World/IndexSet.h>

#include <algorithm>
#include <memory>

namespace fulcrum {

// Minimum substeps and iterations of an island; 0: the system's are sufficient.
struct LeastEffort {
    uint8_t substeps = 0, velocityIterations = 0, positionIterations = 0;

    bool IsAny() const { return substeps > 0 || velocityIterations > 0 || positionIterations > 0; }
    // Whether any number exceeds the settings'.
    bool Exceeds(const SolverSettings& settings) const {
        return substeps > settings.substeps || velocityIterations > settings.velocityIterations ||
               positionIterations > settings.positionIterations;
    }
    // Component-wise maximum. Returns whether any number increased.
    bool Raise(const LeastEffort& to) {
        const LeastEffort before = *this;
        substeps = std::max(substeps, to.substeps);
        velocityIterations = std::max(velocityIterations, to.velocityIterations);
        positionIterations = std::max(positionIterations, to.positionIterations);
        return *this != before;
    }
    friend bool operator==(const LeastEffort&, const LeastEffort&) = default;
};
// From settings in 0..255; the position correction is the same for all islands.
inline LeastEffort ToLeastEffort(const SolverSettings& settings) {
    return {static_cast<uint8_t>(settings.substeps), static_cast<uint8_t>(settings.velocityIterations),
            static_cast<uint8_t>(settings.positionIterations)};
}

struct Joint {
    uint32_t body[2] = {0, 0};      // A and B
    uint32_t next[2] = {~0u, ~0u};  // the next joint of A and of B
    std::unique_ptr<JointType> type;
    JointLocks locks;        // locks of the type, as known to the layout
    uint32_t maxRows = 0;    // MaxRows of the type, likewise
    uint32_t neighbors = 0;  // JointBatch::neighbors, likewise
    ColorSlot color;
    uint32_t generation = 0;
    bool exists = false;
    bool enabled = true;
    bool collideConnected = false;
    bool overridesMass = false;      // massOverride is not none
    bool fixed[2] = {false, false};  // the body is immovable: static, kinematic or frozen
    // Has been since it was colored, see JointStrain.h.
    bool isStrained = false, wasPastLimit = false;
    // Likewise: its gap has exceeded its target (Stages/ContactLoads.h), or does so for so many steps.
    bool isBeyondTarget = false;
    uint8_t stepsBeyond = 0;
    JointPriority priority = JointPriority::Normal;
    float breakForce = 0, breakTorque = 0;
    LeastEffort effort;     // minimum effort for its island
    float errorTarget = 0;  // see JointSettings
    MassOverride massOverride;
    uint64_t userData = 0;

    void SetMassOverride(const MassOverride& o) {
        massOverride = o;
        overridesMass = !o.IsNone();
    }
    int SideOf(uint32_t index) const { return body[0] == index ? 0 : 1; }
};

size_t HeapBytes(const Joint& joint);

// A body with joints that the user has put elsewhere since the last step, and its center frame before.
struct MovedBody {
    uint32_t body = 0;
    Pose before;
};

class JointStore {
public:
    static constexpr uint32_t kNone = ~0u;

    // By index; all of the same size.
    Array<JointRecord> records;
    Array<JointType*> types;
    Array<Joint> joints;
    IndexSet breakable;
    uint32_t targetCount = 0;    // joints with an errorTarget
    uint64_t strainVersion = 0;  // incremented when a joint begins to be strained, past a limit or beyond its target
    Array<MovedBody> moved;      // in the order in which they were moved first; empty after a step

    uint32_t Count() const { return count_; }
    // Room for more joints of bodies below `bodies`, and to free all.
    void Reserve(size_t more, size_t bodies);
    uint32_t Allocate();        // an index with default values; exists is set
    void Free(uint32_t index);  // must be neither linked nor colored
    bool Find(JointId id) const {
        return id.index < joints.size() && joints[id.index].exists && joints[id.index].generation == id.generation;
    }
    JointId IdOf(uint32_t index) const { return {index, joints[index].generation}; }

    void SetErrorTarget(uint32_t index, float target) {
        targetCount += (target > 0) - (joints[index].errorTarget > 0);
        joints[index].errorTarget = target;
    }
    // Clears its impulses and forces.
    void Forget(uint32_t index);

    // Adds the joint to the lists of its two bodies, or removes it.
    void Link(uint32_t index);
    void Unlink(uint32_t index);
    // Visits the joints of a body, the newest first. The visitor may remove the one it is called with.
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
    // Whether some joint disables collisions between the two bodies.
    bool ForbidsContact(uint32_t bodyA, uint32_t bodyB) const;
    friend size_t HeapBytes(const JointStore& store);

private:
    friend struct SnapshotAccess;
    Array<uint32_t> first_;  // by body
    Array<uint32_t> free_;
    uint32_t count_ = 0;
};

}  // namespace fulcrum
