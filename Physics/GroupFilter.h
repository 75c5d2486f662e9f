// Which bodies of a group collide with one another: the parts of a machine that overlap, a ragdoll's limbs. A filter is
// shared by the bodies that name it in BodySettings::group; it never changes, so any thread may ask it.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

namespace fulcrum {

// Decides about two bodies only if the groups of both name this filter object.
class GroupFilter {
public:
    struct Member {
        uint32_t group = 0;     // for GroupFilterTable: e.g. which ragdoll
        uint32_t subGroup = 0;  // and which of its parts
    };

    virtual ~GroupFilter() = default;
    // Asked from several threads at once when two bodies come near: a pure function of its arguments, the same for (b,
    // a).
    virtual bool Collides(const Member& a, const Member& b) const = 0;
    // By which snapshots (Snapshot.h) know the filter again: the same for filters that decide the same, and another for
    // others. 0: all filters of the class do, as far as snapshots are concerned.
    virtual uint64_t ContentHash() const { return 0; }
};

// Pairs of subgroups that do not collide within one group. All other subgroups collide, and so do members of different
// groups.
class GroupFilterTable final : public GroupFilter {
public:
    struct Pair {
        uint32_t first, second;  // subgroups, 0..1023; the same twice: its members pass through each other
    };
    static constexpr uint32_t kMaxSubGroups = 1024;

    // Error: OutOfRange.
    static Result<std::shared_ptr<const GroupFilterTable>> Create(std::span<const Pair> apart);
    static Result<std::shared_ptr<const GroupFilterTable>> Create(std::initializer_list<Pair> apart);

    bool Collides(const Member& a, const Member& b) const override;
    uint64_t ContentHash() const override;

private:
    GroupFilterTable() = default;

    uint32_t subGroups_ = 0;   // that the table has
    std::vector<bool> apart_;  // by first * subGroups_ + second, both ways round
};

// A body's place in a group.
struct CollisionGroup {
    std::shared_ptr<const GroupFilter> filter;  // null: no group, whatever the numbers
    uint32_t group = 0, subGroup = 0;           // of GroupFilter::Member
};

}  // namespace fulcrum
