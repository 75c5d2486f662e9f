#include <Fulcrum/Physics/Stages/FindIslands.h>

#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/Stages/IslandEfforts.h>
#include <Fulcrum/Physics/World/UnionFind.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

constexpr uint32_t kLargeIsland = 768;  // constraints: larger islands are solved by all workers together
constexpr uint32_t kSmallGroup = 192;  // minimum number of constraints of a group of small islands, about 60 KB of rows
constexpr uint32_t kColors = ConstraintColoring::kColors;

using Entry = ConstraintColoring::Entry;
using Kind = ConstraintColoring::Kind;

// A chain under load vibrates like a string, with a frequency proportional to the square root of the load. Substeps
// must resolve that, or the chain becomes unstable, however exact its joints. Measured on 16 links of 0.5 m.
int SubstepsUnder(float load) { return std::min(static_cast<int>(std::ceil(0.8f * std::sqrt(load))), 64); }

int SubstepsOf(float rope, int usual) {
    return std::min(static_cast<int>(std::ceil(rope * static_cast<float>(usual))), 64);
}

// The substeps required by trees and ropes of an island.
struct JointSubsteps {
    int substeps = 0;
    uint32_t body = ~0u;
};

// usual: the system's substeps.
void SetEffort(SolverGroup& group, const IslandEffort& effort, const JointSubsteps& joints, int usual) {
    group.effort = effort.least;
    group.culprit = effort.culprit;
    if (group.effort.Raise({.substeps = static_cast<uint8_t>(joints.substeps)})) group.culprit = joints.body;
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

}  // namespace

Islands FindIslands(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
                    const JointStore& joints, const PairStore& pairs, const JointTrees& trees,
                    const Array<SavedEffort>* saved, Array<SolverGroup>& groups, ScratchArena& scratch) {
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
    const std::span<bool> overflows = scratch.Allocate<bool>(coloring.HasOverflow() ? count : 0);
    std::fill(overflows.begin(), overflows.end(), false);
    for (Kind kind : {Kind::Moving, Kind::Fixed, Kind::Joint})
        VisitEntries(coloring, kind, [&](uint32_t c, const Entry& entry) {
            const uint32_t root = sets.Find(placeOf(MovingBodyOf(entry)));
            ++sizes[root];
            if (c == kColors) overflows[root] = true;
        });
    const int usual = step.settings.solver.substeps;
    const std::span<const IslandEffort> efforts =
        saved ? EffortsOf(*saved, bodies, sets, scratch)
              : FindEfforts(step, bodies, coloring, joints, pairs, sizes,
                            step.settings.accuracy.largeIslands ? ~0u : kLargeIsland - 1, sets, scratch);
    // By root; empty if there are neither trees nor ropes.
    const size_t room = trees.trees.empty() && trees.ropes.empty() ? 0 : count;
    std::span<JointSubsteps> ofTrees = scratch.Allocate<JointSubsteps>(room),
                             ofRopes = scratch.Allocate<JointSubsteps>(room);
    std::fill(ofTrees.begin(), ofTrees.end(), JointSubsteps{});
    std::fill(ofRopes.begin(), ofRopes.end(), JointSubsteps{});
    const auto raise = [&](std::span<JointSubsteps> all, int substeps, uint32_t body) {
        JointSubsteps& most = all[sets.Find(placeOf(body))];
        if (most.substeps < substeps) most = {substeps, body};
    };
    for (const JointTrees::Tree& tree : trees.trees)
        raise(ofTrees, SubstepsUnder(tree.load), trees.slots[tree.slotsEnd - 1].body);
    for (const JointTrees::Rope& rope : trees.ropes) raise(ofRopes, SubstepsOf(rope.substeps, usual), rope.body);

    Islands result;
    result.groupOf = scratch.Allocate<uint32_t>(count);
    groups.assign(1, {.isLarge = true});
    uint32_t inGroup = kSmallGroup;  // so that the first small island starts a group
    uint32_t open = 0;
    IslandEffort overflowing;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t root = sets.Find(i);
        if (root != i) {
            result.groupOf[i] = result.groupOf[root];  // the root is the smallest index, so its group is known
            continue;
        }
        result.groupOf[i] = Islands::kNone;
        if (sizes[i] == 0) continue;
        ++result.islands;
        // Constraints without a color are solved with the first group.
        const bool isOverflowing = !overflows.empty() && overflows[i];
        const bool large = sizes[i] >= kLargeIsland || isOverflowing;
        const JointSubsteps tree = room > 0 ? ofTrees[i] : JointSubsteps{},
                            rope = room > 0 && !large ? ofRopes[i] : JointSubsteps{};
        const bool hasTree = tree.substeps > 0;
        const IslandEffort& effort = efforts[i];
        // A group of one island is solved by one worker: too slow for a large island, unless required.
        if (!isOverflowing && (effort.least.IsAny() || rope.substeps > 0 || (hasTree && !large))) {
            result.groupOf[i] = static_cast<uint32_t>(groups.size());
            groups.push_back({.isLarge = large && !hasTree});
            SetEffort(groups.back(), effort, rope.substeps > tree.substeps ? rope : tree, usual);
            continue;
        }
        if (large) {
            result.groupOf[i] = Islands::kLargeGroup;
            if (isOverflowing && effort.least.IsAny()) Raise(overflowing, effort);
            continue;
        }
        if (inGroup >= kSmallGroup) {
            open = static_cast<uint32_t>(groups.size());
            groups.push_back({});
            inGroup = 0;
        }
        result.groupOf[i] = open;
        inGroup += sizes[i];
    }
    if (overflowing.least.IsAny()) SetEffort(groups[Islands::kLargeGroup], overflowing, {}, usual);
    if (saved) SetEfforts(*saved, bodies, result, groups);
    result.groups = static_cast<uint32_t>(groups.size());
    return result;
}

}  // namespace fulcrum
