// Poses of bodies at the start of a step, for queries: they are let in again while continuous collision, which may be
// most of a step, follows the bodies that have moved already. Written by the step, read under the world's lock.
#pragma once

#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/WorldLock.h>

namespace fulcrum {

class SeenPoses {
public:
    // Before bodies are moved: notes the poses of all that are awake. The poses of others must not change while the
    // noted ones are shown.
    void Note(const BodyStore& bodies, JobSystem& jobs);
    // Called while no query is inside.
    void Show() { areShown_ = true; }
    void Hide() { areShown_ = false; }
    bool AreShown() const { return areShown_; }

    // The center pose of a body on the grid, and the exact one, as of the last step. The step's own callbacks get the
    // current ones.
    Pose PoseOf(const WorldLock& lock, const BodyStore& bodies, uint32_t body) const {
        const Seen* seen = Find(lock, body);
        return seen ? seen->pose : bodies.CenterPoseOf(body);
    }
    Pose ExactPoseOf(const WorldLock& lock, const BodyStore& bodies, uint32_t body) const {
        const Seen* seen = Find(lock, body);
        if (!seen) return bodies.ExactCenterPoseOf(body);
        return {seen->pose.position + seen->remainder, seen->pose.rotation};
    }
    size_t MemoryUsed() const { return seen_.capacity() * sizeof(Seen); }

private:
    struct Seen {
        Pose pose;
        Position remainder = Position::Zero();  // of the position, m
        uint64_t note = 0;
    };
    const Seen* Find(const WorldLock& lock, uint32_t body) const {
        if (!areShown_ || body >= seen_.size() || seen_[body].note != note_) return nullptr;
        return WorldLock::OfThisThread(lock) == WorldLock::Access::Changes ? nullptr : &seen_[body];
    }

    Array<Seen> seen_;   // by body; those of the last note count
    uint64_t note_ = 0;  // number of notes
    bool areShown_ = false;
};

}  // namespace fulcrum
