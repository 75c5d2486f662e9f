// Which bodies of a crowd overlap which others (Crowd.h). Each search ends at the first few found, so that its cost
// does not grow with the crowd. Used by FindPairs, StartDispersing, EndDispersing and NoteDeepOverlap; reads only, from
// any number of threads.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

#include <span>

namespace fulcrum {

// A body that deeply overlaps so many others disperses; contacts still separate fewer. In the densest packing of equal
// spheres each touches twelve others, and overlaps none of them deeply.
inline constexpr size_t kManyOverlaps = 12;

// Two shapes overlap deeply where their centers are nearer than this, m: a part of the sum of their inner radii.
// Contacts that give way under load leave far less overlap than that, so bodies that overlap deeply were put there.
inline float DeepOverlapDistance(const Shape& a, const Shape& b) { return 0.8f * (a.InnerRadius() + b.InnerRadius()); }

// Whether two colliders belong to dynamic bodies and overlap deeply.
bool OverlapDeeply(const CollisionView& view, uint32_t colliderA, uint32_t colliderB);

// Bodies connected by joints form a group, which disperses as one. Those of a group may overlap: they were built so.
class JointedGroups {
public:
    JointedGroups(uint32_t bodyCount, const JointStore& joints, ScratchArena& scratch);
    // The body of the lowest index in a body's group: that itself where it has no joints.
    uint32_t RootOf(uint32_t body) const { return roots_.empty() ? body : roots_[body]; }

private:
    std::span<uint32_t> roots_;
};

// Of a dynamic body and the dynamic bodies of other groups with which it may collide. pairs: what the listener allowed.
bool OverlapsAnother(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body);
bool OverlapsMany(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body);
bool OverlapsManyDeeply(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body);
bool OverlapsDispersingDeeply(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups,
                              uint32_t body);

}  // namespace fulcrum
