#include <Fulcrum/Physics/Stages/FindIslands.h>

#include <Fulcrum/Physics/Stages/DirectContacts.h>
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/Stages/IslandEfforts.h>
#include <Fulcrum/Physics/World/UnionFind.h>

#include <algorithm>
#include <optional>

namespace fulcrum {

namespace {

constexpr uint32_t kLargeIsland = 768;  // constraints: larger islands are solved by all workers together
constexpr uint32_t kSmallGroup = 192;  // minimum number of constraints of a group of small islands, about 60 KB of rows
constexpr uint32_t kColors = ConstraintColoring::kColors;

using Entry = ConstraintColoring::Entry;
using Kind = ConstraintColoring::Kind;

// Of an island that is solved directly, at most, by body: what a factorization costs (a pyramid of 15 layers has 7.7
// kflop, a chain less than 1), and the number of bodies, whose pattern is found where constraints begin or end.
constexpr DirectCost kMostCost = {10000, 6.5};
constexpr uint32_t kMostBodies = 1024;

// Of small islands: by root, what was saved of them, or null.
std::span<const SavedEffort*> SavedOf(const Array<SavedEffort>& saved, const BodyStore& bodies, UnionFind& sets,
                                      ScratchArena& scratch) {
    std::span<const SavedEffort*> result = scratch.Allocate<const SavedEffort*>(bodies.awake.size());
    std::ranges::fill(result, nullptr);
    for (const SavedEffort& effort : saved)
        if (effort.body != ~0u) result[sets.Find(bodies.cold[effort.body].awakePlace)] = &effort;
    return result;
}
std::span<const IslandEffort> EffortsOf(std::span<const SavedEffort* const> saved, ScratchArena& scratch) {
    std::span<IslandEffort> efforts = scratch.Allocate<IslandEffort>(saved.size());
    for (size_t i = 0; i < saved.size(); ++i) {
        efforts[i] = {};
        if (!saved[i]) continue;
        efforts[i].least = saved[i]->effort;
        efforts[i].culprit = saved[i]->culprit;
        efforts[i].isHard = saved[i]->isLoaded || saved[i]->isWaiting;
    }
    return efforts;
}

// The groups that small islands are added to, one for each effort.
class OpenGroups {
public:
    // efforts: at most so many different ones.
    OpenGroups(Array<SolverGroup>& groups, size_t efforts, ScratchArena& scratch)
        : groups_(groups), open_(scratch.Allocate<Open>(2 * efforts)) {}

    // The index of the group that an island of so many constraints is added to: one like `own`.
    uint32_t Add(const SolverGroup& own, uint32_t constraints) {
        const auto end = open_.begin() + count_;
        auto to = std::find_if(open_.begin(), end, [&](const Open& open) {
            const SolverGroup& group = groups_[open.group];
            return group.hasJoints == own.hasJoints && group.effort == own.effort;
        });
        if (to == end || to->constraints >= kSmallGroup) {
            if (to == end) ++count_;
            *to = {static_cast<uint32_t>(groups_.size()), 0};
            groups_.push_back(own);
        }
        to->constraints += constraints;
        return to->group;
    }

private:
    struct Open {
        uint32_t group, constraints;
    };
    Array<SolverGroup>& groups_;
    std::span<Open> open_;
    ptrdiff_t count_ = 0;
};

// By root.
struct IslandTraits {
    bool overflows : 1 = false;  // some constraint has no color
    bool hasJoints : 1 = false, hasContacts : 1 = false;
    bool hasHardJoints : 1 = false;  // they are solved directly, whatever touches them
    bool mayContradict : 1 = false;  // some joints may contradict each other
    bool isIterated : 1 = false;     // contacts may not be solved directly
    bool isLoaded : 1 = false;       // they are, because of loads
    bool isMoving : 1 = false;       // some body does
    bool isWaiting : 1 = false;      // they will be once no body does
    bool wasDirect : 1 = false;      // some body was solved directly since it woke
    bool isHard : 1 = false;         // some are solved directly, where that costs little
};

// Finds the patterns of hard islands, where these cost little.
class PatternFinder {
public:
    PatternFinder(const BodyStore& bodies, const ConstraintColoring& coloring, std::span<const uint32_t> rootOf,
                  std::span<const IslandTraits> traits, Array<uint32_t>& words, ScratchArena& scratch)
        : words_(words),
          scratch_(scratch),
          begins_(scratch.Allocate<uint32_t>(rootOf.size() + 1)),
          memberBegins_(scratch.Allocate<uint32_t>(rootOf.size() + 1)) {
        words.clear();
        std::ranges::fill(begins_, 0u);
        std::ranges::fill(memberBegins_, 0u);
        const auto visitMembers = [&](auto&& member) {
            for (size_t i = 0; i < rootOf.size(); ++i)
                if (traits[rootOf[i]].isHard) member(rootOf[i], bodies.awake[i]);
        };
        visitMembers([&](uint32_t root, uint32_t) { ++memberBegins_[root]; });
        members_ = scratch.Allocate<uint32_t>(ExclusivePrefixSum(memberBegins_));
        visitMembers([&](uint32_t root, uint32_t body) { members_[memberBegins_[root]++] = body; });
        MoveBack(memberBegins_);
        const auto visit = [&](auto&& edge) {
            for (const Kind kind : {Kind::Moving, Kind::Joint})
                VisitEntries(coloring, kind, [&](uint32_t, const Entry& entry) {
                    if (entry.fixedA || entry.fixedB) return;
                    const uint32_t root = rootOf[bodies.cold[entry.bodyA].awakePlace];
                    if (traits[root].isHard) edge(root, DirectEdge{entry.bodyA, entry.bodyB});
                });
        };
        visit([&](uint32_t root, const DirectEdge&) { ++begins_[root]; });
        edges_ = scratch.Allocate<DirectEdge>(ExclusivePrefixSum(begins_));
        visit([&](uint32_t root, const DirectEdge& edge) { edges_[begins_[root]++] = edge; });
        MoveBack(begins_);
    }

    // Does nothing if it is too costly.
    void Find(uint32_t root, SolverGroup& group) {
        const std::span<uint32_t> members =
            members_.subspan(memberBegins_[root], memberBegins_[root + 1] - memberBegins_[root]);
        if (members.size() > kMostBodies) return;
        std::ranges::sort(members);
        const std::span<DirectEdge> edges = edges_.subspan(begins_[root], begins_[root + 1] - begins_[root]);
        const auto localOf = [&](uint32_t body) {
            return static_cast<uint32_t>(std::ranges::lower_bound(members, body) - members.begin());
        };
        for (DirectEdge& edge : edges) edge = {localOf(edge.a), localOf(edge.b)};
        const std::optional<DirectPattern> pattern =
            FindDirectPattern(static_cast<uint32_t>(members.size()), edges, scratch_, kMostCost);
        if (!pattern) return;
        group.patternBegin = static_cast<uint32_t>(words_.size());
        group.patternBlocks = pattern->Blocks();
        group.isDirect = true;
        words_.insert(words_.end(), pattern->Words().begin(), pattern->Words().end());
    }

private:
    // From ends to begins.
    static void MoveBack(std::span<uint32_t> ends) {
        for (size_t i = ends.size(); i-- > 1;) ends[i] = ends[i - 1];
        ends[0] = 0;
    }

    Array<uint32_t>& words_;
    ScratchArena& scratch_;
    // By root, and one more: of the edges and the bodies of hard islands.
    std::span<uint32_t> begins_, memberBegins_;
    std::span<DirectEdge> edges_;
    std::span<uint32_t> members_;
};

}  // namespace

Islands FindIslands(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
                    const JointStore& joints, const PairStore& pairs, const Array<SavedEffort>* saved,
                    SolverLayout& layout, ScratchArena& scratch) {
    const HardMechanisms& hard = layout.hard;
    Array<SolverGroup>& groups = layout.groups;
    const auto placeOf = [&](uint32_t body) { return bodies.cold[body].awakePlace; };
    const size_t count = bodies.awake.size();
    UnionFind sets(scratch.Allocate<uint32_t>(count));
    std::span<uint32_t> sizes = scratch.Allocate<uint32_t>(count);
    std::fill(sizes.begin(), sizes.end(), 0u);
    const auto unite = [&](uint32_t, const Entry& entry) {
        if (!entry.fixedA && !entry.fixedB) sets.Unite(placeOf(entry.bodyA), placeOf(entry.bodyB));
    };
    VisitEntries(coloring, Kind::Moving, unite);
    VisitEntries(coloring, Kind::Joint, unite);
    const std::span<IslandTraits> traits = scratch.Allocate<IslandTraits>(count);
    std::ranges::fill(traits, IslandTraits{});
    for (Kind kind : {Kind::Moving, Kind::Fixed, Kind::Joint})
        VisitEntries(coloring, kind, [&](uint32_t c, const Entry& entry) {
            const uint32_t root = sets.Find(placeOf(MovingBodyOf(entry)));
            ++sizes[root];
            IslandTraits& its = traits[root];
            if (c == kColors) its.overflows = true;
            if (kind == Kind::Joint) {
                its.hasJoints = true;
                return;
            }
            its.hasContacts = true;
            const uint32_t other = entry.fixedA ? entry.bodyA : entry.bodyB;
            its.isIterated |= !MayBeSolvedDirectly(bodies, pairs, entry.constraint, other);
        });
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t root = sets.Find(i);
        if (!MayBeSolvedDirectly(bodies, bodies.awake[i], sizes[root])) traits[root].isIterated = true;
    }
    bool jointsOverflow = false;  // constraints without a color are solved with the first group
    if (coloring.HasOverflow())
        for (const IslandTraits& its : traits) jointsOverflow |= its.overflows && its.hasJoints;
    const std::span<const SavedEffort* const> savedOf =
        saved ? SavedOf(*saved, bodies, sets, scratch) : std::span<const SavedEffort*>();
    const std::span<const IslandEffort> efforts =
        saved ? EffortsOf(savedOf, scratch)
              : FindEfforts(step, bodies, coloring, joints, pairs, sizes, kLargeIsland - 1, sets, scratch);
    Islands result;
    result.groupOf = scratch.Allocate<uint32_t>(count);
    result.rootOf = scratch.Allocate<uint32_t>(count);
    for (uint32_t i = 0; i < count; ++i) result.rootOf[i] = sets.Find(i);
    for (const uint32_t body : hard.open) traits[result.rootOf[placeOf(body)]].hasHardJoints = true;
    // Contradictions only where nothing touches: contacts that are iterated against stiff ones keep heaps awake.
    for (const uint32_t body : hard.contradicting) {
        IslandTraits& its = traits[result.rootOf[placeOf(body)]];
        its.mayContradict = true;
        if (!its.hasContacts) its.hasHardJoints = true;
    }
    // What falls or is thrown is no load yet, and its impacts take long: it begins where all are calm, and stays.
    const float calm = CalmSpeed(step.settings);
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t root = result.rootOf[i], body = bodies.awake[i];
        if (!efforts[root].isHard) continue;
        if (bodies.cold[body].wasDirect || (saved && savedOf[root]->isLoaded)) traits[root].wasDirect = true;
        if (sizes[root] > kFewContacts && !(Length(bodies.LinearVelocityOf(body)) < calm)) traits[root].isMoving = true;
    }
    bool areAnyHard = false;
    for (uint32_t i = 0; i < count; ++i) {
        IslandTraits& its = traits[i];
        const bool mayBeLoaded = efforts[i].isHard && !its.isIterated && !its.hasJoints;
        its.isLoaded = mayBeLoaded && (its.wasDirect || !its.isMoving);
        its.isWaiting = mayBeLoaded && !its.isLoaded;
        its.isHard = its.isLoaded || (its.hasHardJoints && !its.overflows);
        areAnyHard |= its.isHard;
    }
    std::optional<PatternFinder> patterns;
    if (areAnyHard) patterns.emplace(bodies, coloring, result.rootOf, traits, layout.patternWords, scratch);
    groups.assign(1, {.isLarge = true, .hasJoints = jointsOverflow});
    layout.efforts.clear();
    layout.waiting.clear();
    const auto hasEffort = [](const IslandEffort& effort) { return effort.least.IsAny() || effort.isHard; };
    const size_t ownEfforts = static_cast<size_t>(std::ranges::count_if(efforts, hasEffort));
    // By root, into layout.efforts.
    std::span<uint32_t> effortOf = scratch.Allocate<uint32_t>(ownEfforts > 0 ? count : 0);
    std::ranges::fill(effortOf, Islands::kNone);
    const auto addEffort = [&](uint32_t root, uint32_t culprit) {
        effortOf[root] = static_cast<uint32_t>(layout.efforts.size());
        layout.efforts.push_back(
            {.culprit = culprit, .group = result.groupOf[root], .isWaiting = traits[root].isWaiting});
    };
    OpenGroups open(groups, 1 + ownEfforts, scratch);
    IslandEffort overflowing;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t root = result.rootOf[i];
        if (root != i) {
            result.groupOf[i] = result.groupOf[root];  // the root is the smallest index, so its group is known
            continue;
        }
        result.groupOf[i] = Islands::kNone;
        if (sizes[i] == 0) continue;
        ++result.islands;
        const IslandTraits& its = traits[i];
        const bool large = sizes[i] >= kLargeIsland || its.overflows;
        SolverGroup own;
        if (its.isHard) patterns->Find(i, own);
        IslandEffort effort = efforts[i];
        if (own.isDirect) {
            own.mayContradict = its.mayContradict || its.hasContacts;
            own.isLoaded = its.isLoaded;
            if (own.isLoaded) effort.least = {};
        }
        const bool differs = large && its.hasJoints != jointsOverflow;  // from the first group
        if (large && !own.isDirect && (its.overflows || !(effort.least.IsAny() || differs))) {
            result.groupOf[i] = Islands::kLargeGroup;
            if (its.overflows && effort.least.IsAny()) Raise(overflowing, effort);
            if (its.isWaiting) addEffort(i, effort.culprit);
            continue;
        }
        own.hasJoints = its.hasJoints || own.isDirect;
        own.effort = effort.least;
        // A group that is not large is solved by one worker: too slow for a large island, unless required.
        own.isLarge = large && !own.isDirect;
        if (own.isLarge || own.isDirect) {
            result.groupOf[i] = static_cast<uint32_t>(groups.size());
            groups.push_back(own);
        } else {
            result.groupOf[i] = open.Add(own, sizes[i]);
        }
        if (effort.least.IsAny() || own.isLoaded || its.isWaiting) addEffort(i, effort.culprit);
    }
    for (uint32_t i = 0; i < effortOf.size(); ++i) {
        if (effortOf[result.rootOf[i]] == Islands::kNone) continue;
        IslandWithEffort& island = layout.efforts[effortOf[result.rootOf[i]]];
        island.body = std::min(island.body, bodies.awake[i]);
        ++island.bodies;
        if (island.isWaiting) layout.waiting.push_back({effortOf[result.rootOf[i]], bodies.awake[i]});
    }
    SolverGroup& first = groups[Islands::kLargeGroup];
    const auto ofAll = [&](uint32_t culprit) {
        layout.efforts.push_back({.culprit = culprit,
                                  .bodies = static_cast<uint32_t>(
                                      std::count(result.groupOf.begin(), result.groupOf.end(), Islands::kLargeGroup)),
                                  .group = Islands::kLargeGroup});
    };
    if (overflowing.least.IsAny()) {
        first.effort = overflowing.least;
        ofAll(overflowing.culprit);
    }
    if (saved)
        for (const SavedEffort& effort : *saved) {
            if (effort.body != ~0u) continue;
            first.effort = effort.effort;
            ofAll(effort.culprit);
        }
    result.groups = static_cast<uint32_t>(groups.size());
    return result;
}

}  // namespace fulcrum
