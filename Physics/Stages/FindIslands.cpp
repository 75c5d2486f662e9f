#include <Fulcrum/Physics/Stages/FindIslands.h>

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

// usual: the system's substeps.
void SetEffort(SolverGroup& group, const IslandEffort& effort, int usual) {
    group.effort = effort.least;
    group.culprit = effort.culprit;
    if (!effort.isLoaded || group.effort.substeps < usual) return;
    group.wantedStiffness = StiffnessOf(group.effort.substeps, usual, effort.longer);
    group.stiffness = effort.stiffness == 0 ? group.wantedStiffness : std::min(effort.stiffness, group.wantedStiffness);
}

// By root; only efforts for which an island gets a group of its own.
std::span<const IslandEffort> EffortsOf(const Array<SavedEffort>& saved, const BodyStore& bodies, UnionFind& sets,
                                        ScratchArena& scratch) {
    std::span<IslandEffort> efforts = scratch.Allocate<IslandEffort>(bodies.awake.size());
    std::fill(efforts.begin(), efforts.end(), IslandEffort{});
    for (const SavedEffort& group : saved)
        if (group.body != ~0u) efforts[sets.Find(bodies.cold[group.body].awakePlace)].least = group.effort;
    return efforts;
}

void SetEfforts(const Array<SavedEffort>& saved, const BodyStore& bodies, const Islands& islands,
                Array<SolverGroup>& groups) {
    for (const SavedEffort& from : saved) {
        SolverGroup& group =
            groups[from.body == ~0u ? Islands::kLargeGroup : islands.groupOf[bodies.cold[from.body].awakePlace]];
        group.effort = from.effort;
        group.culprit = from.culprit;
        group.stiffness = from.stiffness;
        group.wantedStiffness = from.wantedStiffness;
    }
}

// Finds the patterns of hard islands, where these cost little.
class PatternFinder {
public:
    PatternFinder(const BodyStore& bodies, const ConstraintColoring& coloring, std::span<const uint32_t> rootOf,
                  std::span<const bool> isHard, Array<uint32_t>& words, ScratchArena& scratch)
        : words_(words),
          scratch_(scratch),
          begins_(scratch.Allocate<uint32_t>(rootOf.size() + 1)),
          memberBegins_(scratch.Allocate<uint32_t>(rootOf.size() + 1)) {
        words.clear();
        std::ranges::fill(begins_, 0u);
        std::ranges::fill(memberBegins_, 0u);
        const auto visitMembers = [&](auto&& member) {
            for (size_t i = 0; i < rootOf.size(); ++i)
                if (isHard[rootOf[i]]) member(rootOf[i], bodies.awake[i]);
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
                    if (isHard[root]) edge(root, DirectEdge{entry.bodyA, entry.bodyB});
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
                    const JointStore& joints, const PairStore& pairs, const HardMechanisms& hard,
                    const Array<SavedEffort>* saved, Array<SolverGroup>& groups, Array<uint32_t>& patternWords,
                    ScratchArena& scratch) {
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
    const bool areAnyHard = !hard.open.empty() || !hard.contradicting.empty();
    const std::span<bool> overflows = scratch.Allocate<bool>(coloring.HasOverflow() ? count : 0),
                          hasJoints = scratch.Allocate<bool>(count),
                          hasContacts = scratch.Allocate<bool>(areAnyHard ? count : 0);
    std::fill(overflows.begin(), overflows.end(), false);
    std::fill(hasJoints.begin(), hasJoints.end(), false);
    std::fill(hasContacts.begin(), hasContacts.end(), false);
    for (Kind kind : {Kind::Moving, Kind::Fixed, Kind::Joint})
        VisitEntries(coloring, kind, [&](uint32_t c, const Entry& entry) {
            const uint32_t root = sets.Find(placeOf(MovingBodyOf(entry)));
            ++sizes[root];
            if (c == kColors) overflows[root] = true;
            if (kind == Kind::Joint) hasJoints[root] = true;
            else if (!hasContacts.empty()) hasContacts[root] = true;
        });
    bool jointsOverflow = false;  // constraints without a color are solved with the first group
    for (size_t i = 0; i < overflows.size(); ++i) jointsOverflow |= overflows[i] && hasJoints[i];
    const int usual = step.settings.solver.substeps;
    const std::span<const IslandEffort> efforts =
        saved ? EffortsOf(*saved, bodies, sets, scratch)
              : FindEfforts(step, bodies, coloring, joints, pairs, sizes,
                            step.settings.accuracy.largeIslands ? ~0u : kLargeIsland - 1, sets, scratch);
    Islands result;
    result.groupOf = scratch.Allocate<uint32_t>(count);
    result.rootOf = scratch.Allocate<uint32_t>(count);
    for (uint32_t i = 0; i < count; ++i) result.rootOf[i] = sets.Find(i);
    // Bodies of hard islands by root, ascending.
    const std::span<bool> isHard = scratch.Allocate<bool>(areAnyHard ? count : 0);
    std::ranges::fill(isHard, false);
    for (const uint32_t body : hard.open) isHard[result.rootOf[placeOf(body)]] = true;
    // Contradictions only where nothing touches: contacts that are iterated against stiff ones keep heaps awake.
    for (const uint32_t body : hard.contradicting) {
        const uint32_t root = result.rootOf[placeOf(body)];
        isHard[root] = isHard[root] || !hasContacts[root];
    }
    // Whose joints may contradict contacts, or each other.
    const std::span<bool> mayContradict = hasContacts;
    for (const uint32_t body : hard.contradicting) mayContradict[result.rootOf[placeOf(body)]] = true;
    std::optional<PatternFinder> patterns;
    if (areAnyHard) patterns.emplace(bodies, coloring, result.rootOf, isHard, patternWords, scratch);
    groups.assign(1, {.isLarge = true, .hasJoints = jointsOverflow});
    // The groups that small islands are added to, those without joints and with joints.
    struct OpenGroup {
        uint32_t group = 0, constraints = kSmallGroup;  // so that the first small island starts a group
    } open[2];
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
        const bool isOverflowing = !overflows.empty() && overflows[i];
        const bool large = sizes[i] >= kLargeIsland || isOverflowing;
        SolverGroup own;
        if (areAnyHard && isHard[i] && !isOverflowing) patterns->Find(i, own);
        own.mayContradict = own.isDirect && mayContradict[i];
        const IslandEffort& effort = efforts[i];
        const bool differs = large && hasJoints[i] != jointsOverflow;  // from the first group
        // A group of one island is solved by one worker: too slow for a large island, unless required.
        if (!isOverflowing && (effort.least.IsAny() || own.isDirect || differs)) {
            result.groupOf[i] = static_cast<uint32_t>(groups.size());
            own.isLarge = large && !own.isDirect;
            own.hasJoints = hasJoints[i];
            SetEffort(own, effort, usual);
            groups.push_back(own);
            continue;
        }
        if (large) {
            result.groupOf[i] = Islands::kLargeGroup;
            if (isOverflowing && effort.least.IsAny()) Raise(overflowing, effort);
            continue;
        }
        OpenGroup& to = open[hasJoints[i]];
        if (to.constraints >= kSmallGroup) {
            to = {static_cast<uint32_t>(groups.size()), 0};
            groups.push_back({.hasJoints = hasJoints[i]});
        }
        result.groupOf[i] = to.group;
        to.constraints += sizes[i];
    }
    if (overflowing.least.IsAny()) SetEffort(groups[Islands::kLargeGroup], overflowing, usual);
    if (saved) SetEfforts(*saved, bodies, result, groups);
    result.groups = static_cast<uint32_t>(groups.size());
    return result;
}

}  // namespace fulcrum
