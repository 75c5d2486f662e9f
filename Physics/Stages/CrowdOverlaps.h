// Tests which bodies of a crowd overlap others (Crowd.h). Each search ends after the first few hits, so that its cost
// does not grow with the crowd. Used by FindPairs, StartDispersing and EndDispersing; read-only, any number of threads.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

#include <span>

namespace fulcrum {

// A body that deeply overlaps this many others disperses; fewer are separated by contacts. In the densest packing of
// equal spheres each touches twelve others, and overlaps none of them deeply.
inline constexpr size_t kManyOverlaps = 12;

// Two shapes overlap deeply if their centers are closer than this, m: a fraction of the sum of their inner radii.
// Contacts under load leave far less overlap, so bodies that overlap deeply were placed there.
inline float DeepOverlapDistance(const Shape& a, const Shape& b) { return 0.8f * (a.InnerRadius() + b.InnerRadius()); }

// Whether two colliders belong to dynamic bodies and overlap deeply.
bool OverlapDeeply(const CollisionView& view, uint32_t colliderA, uint32_t colliderB);

// Bodies connected by joints form a group, which disperses as one. Bodies of a group may overlap by design.
class JointedGroups {
public:
    JointedGroups(uint32_t bodyCount, const JointStore& joints, ScratchArena& scratch);
    // The body of the lowest index in a body's group: the body itself if it has no joints.
    uint32_t RootOf(uint32_t body) const { return roots_.empty() ? body : roots_[body]; }

private:
    std::span<uint32_t> roots_;
};

// Whether a dynamic body overlaps a dynamic body of another group with which it may collide. pairs: allowed by the
// listener.
bool OverlapsAnother(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body);
bool OverlapsMany(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body);
bool OverlapsManyDeeply(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups, uint32_t body);
bool OverlapsDispersingDeeply(const CollisionView& view, const PairStore& pairs, const JointedGroups& groups,
                              uint32_t body);

}  // namespace fulcrum
