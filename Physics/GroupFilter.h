// Collision filter within a group of bodies: overlapping parts of a machine, limbs of a ragdoll. Shared by the bodies
// that refer to it in BodySettings::group. Immutable, so any thread may call it.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

namespace fulcrum {

// Called for two bodies only if the groups of both refer to this filter object.
class GroupFilter {
public:
    struct Member {
        uint32_t group = 0;     // for GroupFilterTable: e.g. index of the ragdoll
        uint32_t subGroup = 0;  // and index of the part
    };

    virtual ~GroupFilter() = default;
    // Called from several threads at once when the bounds of two bodies begin to overlap. Must be a pure function of
    // its arguments, symmetric in a and b.
    virtual bool Collides(const Member& a, const Member& b) const = 0;
    // Identifies the filter in snapshots (Snapshot.h): equal for filters that decide alike, different for others. 0:
    // snapshots treat all filters of the class as equal.
    virtual uint64_t ContentHash() const { return 0; }
};

// Pairs of subgroups that do not collide within one group. All other subgroups, and members of different groups,
// collide.
class GroupFilterTable final : public GroupFilter {
public:
    struct Pair {
        uint32_t first, second;  // subgroups, 0..1023; twice the same: its members do not collide with each other
    };
    static constexpr uint32_t kMaxSubGroups = 1024;

    // Error: OutOfRange.
    static Result<std::shared_ptr<const GroupFilterTable>> Create(std::span<const Pair> apart);
    static Result<std::shared_ptr<const GroupFilterTable>> Create(std::initializer_list<Pair> apart);

    bool Collides(const Member& a, const Member& b) const override;
    uint64_t ContentHash() const override;
    // The pairs that it was created from, sorted, each once, first <= second.
    std::vector<Pair> Pairs() const;

private:
    GroupFilterTable() = default;

    uint32_t subGroups_ = 0;   // number of subgroups in the table
    std::vector<bool> apart_;  // by first * subGroups_ + second, symmetric
};

// A body's place in a group.
struct CollisionGroup {
    std::shared_ptr<const GroupFilter> filter;  // null: no group
    uint32_t group = 0, subGroup = 0;           // of GroupFilter::Member
};

}  // namespace fulcrum
