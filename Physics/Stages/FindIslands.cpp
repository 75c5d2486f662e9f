#include <Fulcrum/Physics/Stages/FindIslands.h>

#include <Fulcrum/Physics/World/UnionFind.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

constexpr uint32_t kLargeIsland = 768;  // constraints: from here on all workers solve it together
constexpr uint32_t kSmallGroup = 192;   // constraints that a group of small islands has at least, about 60 KB of rows
constexpr uint32_t kColors = ConstraintColoring::kColors;

using Entry = ConstraintColoring::Entry;
using Kind = ConstraintColoring::Kind;

// A link under the pull of a load swings like a string, the faster the heavier the load: as its square root. Substeps
// must resolve that, or the chain whips itself apart, however exact its joints. Measured on 16 links of 0.5 m.
int SubstepsUnder(float load) { return std::min(static_cast<int>(std::ceil(0.8f * std::sqrt(load))), 64); }

// What an island is to be solved with: of each number the largest that its joints ask for.
SolverSettings Larger(const SolverSettings& a, const SolverSettings& b) {
    return {std::max(a.substeps, b.substeps), std::max(a.velocityIterations, b.velocityIterations),
            std::max(a.positionIterations, b.positionIterations)};
}

// By the root of the island, or empty where no joint asks for an effort of its own.
std::span<SolverSettings> FindEfforts(const BodyStore& bodies, const ConstraintColoring& coloring,
                                      const JointStore& joints, UnionFind& sets, ScratchArena& scratch) {
    const size_t count = bodies.awake.size();
    std::span<SolverSettings> efforts;
    VisitEntries(coloring, Kind::Joint, [&](uint32_t, const Entry& entry) {
        const Joint& joint = joints.joints[entry.constraint];
        if (!joint.HasOwnEffort()) return;
        if (efforts.empty()) {
            efforts = scratch.Allocate<SolverSettings>(count);
            std::fill(efforts.begin(), efforts.end(), SolverSettings{0, 0, 0});
        }
        SolverSettings& effort = efforts[sets.Find(bodies.cold[MovingBodyOf(entry)].awakePlace)];
        effort = Larger(effort, joint.effort);
    });
    return efforts;
}

}  // namespace

Islands FindIslands(const BodyStore& bodies, const ConstraintColoring& coloring, const JointStore& joints,
                    const JointTrees& trees, std::vector<SolverGroup>& groups, ScratchArena& scratch) {
    const auto placeOf = [&](uint32_t body) { return bodies.cold[body].awakePlace; };
    const size_t count = bodies.awake.size();
    UnionFind sets(scratch.Allocate<uint32_t>(count));
    std::span<uint32_t> sizes = scratch.Allocate<uint32_t>(count);
    std::fill(sizes.begin(), sizes.end(), 0u);
    const auto unite = [&](uint32_t, const Entry& entry) {
        if (!entry.stillA && !entry.stillB) sets.Unite(placeOf(entry.bodyA), placeOf(entry.bodyB));
    };
    VisitEntries(coloring, Kind::Moving, unite);
    VisitEntries(coloring, Kind::Joint, unite);
    // A body beyond all colors makes its island a large one.
    for (Kind kind : {Kind::Moving, Kind::Fixed, Kind::Joint})
        VisitEntries(coloring, kind, [&](uint32_t c, const Entry& entry) {
            sizes[sets.Find(placeOf(MovingBodyOf(entry)))] += c == kColors ? kLargeIsland : 1;
        });
    const std::span<const SolverSettings> efforts = FindEfforts(bodies, coloring, joints, sets, scratch);
    std::span<float> treeLoads = scratch.Allocate<float>(count);
    std::fill(treeLoads.begin(), treeLoads.end(), 0.0f);
    for (const JointTrees::Tree& tree : trees.trees) {
        float& load = treeLoads[sets.Find(placeOf(trees.slots[tree.slotsEnd - 1].body))];
        load = std::max(load, tree.load);
    }

    Islands result;
    result.groupOf = scratch.Allocate<uint32_t>(count);
    groups.assign(1, {});
    uint32_t inGroup = kSmallGroup;  // so that the first small island opens a group
    uint32_t open = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t root = sets.Find(i);
        if (root != i) {
            result.groupOf[i] = result.groupOf[root];  // the root is the smallest, so it has its group
            continue;
        }
        result.groupOf[i] = Islands::kNone;
        if (sizes[i] == 0) continue;
        ++result.islands;
        const bool large = sizes[i] >= kLargeIsland, overflows = coloring.HasOverflow() && large;
        const bool hasTree = treeLoads[i] > 0;
        SolverSettings effort = efforts.empty() ? SolverSettings{0, 0, 0} : efforts[i];
        const bool ownEffort = !(effort == SolverSettings{0, 0, 0});
        // One worker solves an island of its own: too slow for a large one that did not ask for it.
        if (!overflows && (ownEffort || (hasTree && !large))) {
            result.groupOf[i] = static_cast<uint32_t>(groups.size());
            groups.push_back({});
            if (hasTree) effort.substeps = std::max(effort.substeps, SubstepsUnder(treeLoads[i]));
            groups.back().effort = effort;
            continue;
        }
        if (sizes[i] >= kLargeIsland) {
            result.groupOf[i] = Islands::kLargeGroup;
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
    result.groups = static_cast<uint32_t>(groups.size());
    return result;
}

}  // namespace fulcrum
