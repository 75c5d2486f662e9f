// Sorts the colored constraints into groups of islands. Small islands are packed into groups that fit a worker's cache
// and are solved there whole; that saves them all barriers and most of the memory traffic. Done only in steps in which
// a constraint began or ended. Serial; the islands follow from the constraints alone.
#include <Fulcrum/Physics/Islands/UnionFind.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

constexpr uint32_t kLargeIsland = 768;  // constraints: from here on all workers solve it together
constexpr uint32_t kSmallGroup = 192;   // constraints that a group of small islands has at least, about 60 KB of rows
constexpr uint32_t kColors = ConstraintColoring::kColors;
constexpr uint32_t kLargeGroup = 0;

using Entry = ConstraintColoring::Entry;
using Kind = ConstraintColoring::Kind;

struct Islands {
    std::span<uint32_t> groupOf;  // by place in bodies.awake: the group, or kNone where no constraint touches
    uint32_t groups = 0;
    uint32_t islands = 0;
    static constexpr uint32_t kNone = ~0u;
};

template <class Visit>
void VisitEntries(const WorldState& world, Kind kind, Visit&& visit) {
    for (uint32_t c = 0; c <= kColors; ++c)
        for (const Entry& entry : world.coloring.At(static_cast<int>(c)).Of(kind)) visit(c, entry);
}

uint32_t MovingBodyOf(const Entry& entry) { return entry.stillA ? entry.bodyB : entry.bodyA; }

// A link under the pull of a load swings like a string, the faster the heavier the load: as its square root. Substeps
// must resolve that, or the chain whips itself apart, however exact its joints. Measured on 16 links of 0.5 m.
int SubstepsUnder(float load) { return std::min(static_cast<int>(std::ceil(0.8f * std::sqrt(load))), 64); }

// What an island is to be solved with: of each number the largest that its joints ask for.
SolverSettings Larger(const SolverSettings& a, const SolverSettings& b) {
    return {std::max(a.substeps, b.substeps), std::max(a.velocityIterations, b.velocityIterations),
            std::max(a.positionIterations, b.positionIterations)};
}

// By the root of the island, or empty where no joint asks for an effort of its own.
std::span<SolverSettings> FindEfforts(WorldState& world, UnionFind& sets, size_t count) {
    std::span<SolverSettings> efforts;
    VisitEntries(world, Kind::Joint, [&](uint32_t, const Entry& entry) {
        const Joint& joint = world.joints.joints[entry.constraint];
        if (!joint.HasOwnEffort()) return;
        if (efforts.empty()) {
            efforts = world.scratch.Allocate<SolverSettings>(count);
            std::fill(efforts.begin(), efforts.end(), SolverSettings{0, 0, 0});
        }
        SolverSettings& effort = efforts[sets.Find(world.bodies.cold[MovingBodyOf(entry)].awakePlace)];
        effort = Larger(effort, joint.effort);
    });
    return efforts;
}

Islands FindIslands(WorldState& world) {
    const auto placeOf = [&](uint32_t body) { return world.bodies.cold[body].awakePlace; };
    const size_t count = world.bodies.awake.size();
    UnionFind sets(world.scratch.Allocate<uint32_t>(count));
    std::span<uint32_t> sizes = world.scratch.Allocate<uint32_t>(count);
    std::fill(sizes.begin(), sizes.end(), 0u);
    const auto unite = [&](uint32_t, const Entry& entry) {
        if (!entry.stillA && !entry.stillB) sets.Unite(placeOf(entry.bodyA), placeOf(entry.bodyB));
    };
    VisitEntries(world, Kind::Moving, unite);
    VisitEntries(world, Kind::Joint, unite);
    // A body beyond all colors makes its island a large one.
    for (Kind kind : {Kind::Moving, Kind::Fixed, Kind::Joint})
        VisitEntries(world, kind, [&](uint32_t c, const Entry& entry) {
            sizes[sets.Find(placeOf(MovingBodyOf(entry)))] += c == kColors ? kLargeIsland : 1;
        });
    const std::span<const SolverSettings> efforts = FindEfforts(world, sets, count);
    std::span<float> treeLoads = world.scratch.Allocate<float>(count);
    std::fill(treeLoads.begin(), treeLoads.end(), 0.0f);
    for (const JointTrees::Tree& tree : world.solver.trees.trees) {
        float& load = treeLoads[sets.Find(placeOf(world.solver.trees.slots[tree.slotsEnd - 1].body))];
        load = std::max(load, tree.load);
    }

    Islands result;
    result.groupOf = world.scratch.Allocate<uint32_t>(count);
    std::vector<SolverGroup>& groups = world.solver.groups;
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
        const bool large = sizes[i] >= kLargeIsland, overflows = world.coloring.HasOverflow() && large;
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
            result.groupOf[i] = kLargeGroup;
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

// Turns counts into the index of the first of each, in order; returns the sum.
uint32_t ExclusivePrefixSum(std::span<uint32_t> counts) {
    uint32_t sum = 0;
    for (uint32_t& count : counts) {
        const uint32_t n = count;
        count = sum;
        sum += n;
    }
    return sum;
}

void SortBodies(WorldState& world, const Islands& islands) {
    SolverLayout& layout = world.solver;
    std::span<uint32_t> next = world.scratch.Allocate<uint32_t>(islands.groups);
    std::fill(next.begin(), next.end(), 0u);
    for (uint32_t group : islands.groupOf)
        if (group != Islands::kNone) ++next[group];
    layout.bodies.resize(ExclusivePrefixSum(next));
    for (uint32_t g = 0; g < islands.groups; ++g) layout.groups[g].bodiesBegin = next[g];
    for (size_t i = 0; i < islands.groupOf.size(); ++i)
        if (islands.groupOf[i] != Islands::kNone) layout.bodies[next[islands.groupOf[i]]++] = world.bodies.awake[i];
    for (uint32_t g = 0; g < islands.groups; ++g) layout.groups[g].bodiesEnd = next[g];
}

BatchRange MakeRange(uint32_t first, uint32_t contacts, uint32_t& batches) {
    BatchRange range{first, contacts, batches, 0};
    batches += (contacts + kLanes - 1) / kLanes;
    range.end = batches;
    return range;
}

template <class Batch>
void GrowTo(std::vector<Batch>& batches, uint32_t count) {
    if (batches.size() < count) batches.resize(count + count / 4);
}

uint32_t GroupOf(const WorldState& world, const Islands& islands, const Entry& entry) {
    return islands.groupOf[world.bodies.cold[MovingBodyOf(entry)].awakePlace];
}

// Joints of one kind may share a batch: they have the same locks, or are balls (BallBatch.h), of round bodies or of
// any.
enum JointKind : uint32_t { kRoundBall = 9, kBall = 10 };
uint32_t KindOf(uint32_t kind) { return kind >> 8; }
bool IsBall(uint32_t kind) { return KindOf(kind) >= kRoundBall; }

uint32_t KindOf(const WorldState& world, const Joint& joint) {
    if (joint.locks.linear != LinearLock::Point || joint.locks.angular != AngularLock::None || joint.maxRows > 0)
        return static_cast<uint32_t>(joint.locks.linear) * 3 + static_cast<uint32_t>(joint.locks.angular);
    const auto isRound = [&](int side) {
        const BodyDynamics& d = world.bodies.dynamics[joint.body[side]];
        return joint.still[side] || (d.spherical && !d.LocksRotation());
    };
    return isRound(0) && isRound(1) ? kRoundBall : kBall;
}

// Brings what the layout knows of the joints up to date, and their order within a color.
void ListJoints(WorldState& world) {
    SolverLayout& layout = world.solver;
    layout.listedJoints.clear();
    VisitEntries(world, Kind::Joint, [&](uint32_t c, const Entry& entry) {
        Joint& joint = world.joints.joints[entry.constraint];
        joint.locks = joint.type->Locks();
        const uint32_t before = joint.maxRows;
        joint.maxRows = joint.type->MaxRows();
        // Batches without room for rows store none: what the last ones did must not stay.
        if (joint.maxRows == 0 && before > 0) {
            joint.type->impulses.fill(0.0f);
            joint.type->forces.fill(0.0f);
        }
        JointRecord& record = world.joints.records[entry.constraint];
        record.lineAxis = joint.locks.line;
        record.freeAxis = joint.locks.axis;
        if (c == kColors) return;
        layout.listedJoints.push_back(
            {KindOf(world, joint) << 8 | joint.maxRows, entry.constraint, MovingBodyOf(entry), c});
    });
    std::sort(layout.listedJoints.begin(), layout.listedJoints.end());
}

// A joint with its place: group * kColors + color.
struct SortedJoint {
    uint32_t place, kind, joint;
};

// By place, and within each in the order of the list.
std::span<const SortedJoint> SortJoints(WorldState& world, const Islands& islands) {
    SolverLayout& layout = world.solver;
    if (layout.jointVersion != world.coloring.JointVersion()) ListJoints(world);
    layout.jointVersion = world.coloring.JointVersion();
    const size_t count = layout.listedJoints.size();
    std::span<SortedJoint> placed = world.scratch.Allocate<SortedJoint>(count),
                           sorted = world.scratch.Allocate<SortedJoint>(count);
    std::span<uint32_t> next = world.scratch.Allocate<uint32_t>(size_t(islands.groups) * kColors);
    std::fill(next.begin(), next.end(), 0u);
    for (size_t i = 0; i < count; ++i) {
        const ListedJoint& listed = layout.listedJoints[i];
        placed[i] = {islands.groupOf[world.bodies.cold[listed.body].awakePlace] * kColors + listed.color, listed.kind,
                     listed.joint};
        ++next[placed[i].place];
    }
    ExclusivePrefixSum(next);
    for (const SortedJoint& joint : placed) sorted[next[joint.place]++] = joint;
    return sorted;
}

// What every kind of batch knows of its joints, at most N; lanes beyond them repeat the last one and are never written.
template <class Batch, size_t N>
void FillLanes(const WorldState& world, Batch& batch, const uint32_t (&)[N], std::span<const SortedJoint> joints) {
    batch.count = static_cast<int32_t>(joints.size());
    batch.fixedA = batch.fixedB = batch.kinematicA = batch.kinematicB = 0;
    for (size_t lane = 0; lane < N; ++lane) {
        const uint32_t index = joints[std::min(lane, joints.size() - 1)].joint;
        const Joint& joint = world.joints.joints[index];
        const auto bit = [&](bool set) { return static_cast<uint32_t>(set) << lane; };
        const auto isKinematic = [&](int side) {
            return world.bodies.dynamics[joint.body[side]].motion == MotionType::Kinematic;
        };
        batch.joint[lane] = index;
        batch.bodyA[lane] = joint.body[0];
        batch.bodyB[lane] = joint.body[1];
        batch.fixedA |= bit(joint.still[0]);
        batch.fixedB |= bit(joint.still[1]);
        batch.kinematicA |= bit(isKinematic(0));
        batch.kinematicB |= bit(isKinematic(1));
    }
}

template <int N>
void FillBatch(const WorldState& world, JointBatch<N>& batch, std::span<const SortedJoint> joints) {
    FillLanes(world, batch, batch.joint, joints);
    batch.rowCount = batch.rowRoom = 0;
    for (const SortedJoint& sorted : joints) {
        const Joint& joint = world.joints.joints[sorted.joint];
        batch.linear = joint.locks.linear;
        batch.angular = joint.locks.angular;
        batch.rowRoom = std::max(batch.rowRoom, joint.maxRows);
    }
}
template <int N>
void FillBatch(const WorldState& world, BallBatch<N>& batch, std::span<const SortedJoint> joints) {
    FillLanes(world, batch, batch.joint, joints);
    batch.round = KindOf(joints.front().kind) == kRoundBall;
}

template <class Batch>
Batch& NextBatch(std::vector<Batch>& batches, uint32_t& count) {
    if (batches.size() == count) batches.resize(count + count / 4 + 1);
    return batches[count++];
}

// Cuts the joints of one color into batches, from the front of `sorted`. Trees know the parts of JointBatch alone.
void MakeJointBatches(WorldState& world, uint32_t place, bool hasTrees, std::span<const SortedJoint>& sorted,
                      ColorBatches& color) {
    SolverLayout& layout = world.solver;
    color.jointsBegin = layout.jointCount;
    color.ballsBegin = layout.ballCount;
    while (!sorted.empty() && sorted.front().place == place) {
        size_t n = 1;
        while (n < kLanes && n < sorted.size() && sorted[n].place == place &&
               KindOf(sorted[n].kind) == KindOf(sorted[0].kind))
            ++n;
        if (IsBall(sorted.front().kind) && !hasTrees)
            FillBatch(world, NextBatch(layout.balls, layout.ballCount), sorted.first(n));
        else FillBatch(world, NextBatch(layout.joints, layout.jointCount), sorted.first(n));
        sorted = sorted.subspan(n);
    }
    color.jointsEnd = layout.jointCount;
    color.ballsEnd = layout.ballCount;
}

uint32_t GroupOf(const WorldState& world, const Islands& islands, const JointTrees::Tree& tree) {
    return islands.groupOf[world.bodies.cold[world.solver.trees.slots[tree.slotsEnd - 1].body].awakePlace];
}

// By group: whether it is solved with trees. Groups of several islands are not: theirs are parts of islands that are
// too large.
std::span<bool> FindGroupsWithTrees(WorldState& world, const Islands& islands) {
    std::span<bool> hasTrees = world.scratch.Allocate<bool>(islands.groups);
    std::fill(hasTrees.begin(), hasTrees.end(), false);
    for (const JointTrees::Tree& tree : world.solver.trees.trees) hasTrees[GroupOf(world, islands, tree)] = true;
    hasTrees[kLargeGroup] = false;
    return hasTrees;
}

// Hands the trees to the groups that solve them, and tells them where the parts of their joints are.
void PlaceTrees(WorldState& world, const Islands& islands) {
    SolverLayout& layout = world.solver;
    layout.treesByGroup.clear();
    if (layout.trees.trees.empty()) return;
    const auto groupOf = [&](uint32_t tree) { return GroupOf(world, islands, layout.trees.trees[tree]); };
    std::span<JointPlaceInBatch> places = world.scratch.Allocate<JointPlaceInBatch>(world.joints.joints.size());
    std::fill(places.begin(), places.end(), JointPlaceInBatch{});  // balls have none, nor do the trees that they are in
    for (uint32_t b = 0; b < layout.jointCount; ++b)
        for (uint32_t lane = 0; lane < static_cast<uint32_t>(layout.joints[b].count); ++lane)
            places[layout.joints[b].joint[lane]] = {b, lane};
    for (JointTreeSlot& slot : layout.trees.slots)
        if (slot.joint != JointTreeSlot::kNone) slot.place = places[slot.joint];
    for (JointTreeAnchor& anchor : layout.trees.anchors) anchor.place = places[anchor.joint];
    std::span<uint64_t> sorted = world.scratch.Allocate<uint64_t>(layout.trees.trees.size());
    for (uint32_t t = 0; t < sorted.size(); ++t) sorted[t] = uint64_t(groupOf(t)) << 32 | t;
    std::sort(sorted.begin(), sorted.end());
    for (uint64_t entry : sorted) {
        SolverGroup& group = layout.groups[entry >> 32];
        // Groups of several islands are solved without trees: theirs are parts of islands that are too large.
        if (entry >> 32 == kLargeGroup) continue;
        if (!group.HasTrees()) group.treesBegin = static_cast<uint32_t>(layout.treesByGroup.size());
        layout.treesByGroup.push_back(static_cast<uint32_t>(entry));
        group.treesEnd = static_cast<uint32_t>(layout.treesByGroup.size());
    }
}

// Gives every batch its room for rows.
template <int N>
void ShareRows(std::span<JointBatch<N>> batches, std::vector<JointRows<N>>& rows) {
    size_t count = 0;
    for (const JointBatch<N>& batch : batches) count += batch.rowRoom;
    if (rows.size() < count) rows.resize(count + count / 4);
    count = 0;
    for (JointBatch<N>& batch : batches) {
        batch.rows = rows.data() + count;
        count += batch.rowRoom;
    }
}

void SortConstraints(WorldState& world, const Islands& islands) {
    SolverLayout& layout = world.solver;
    const auto keyOf = [&](uint32_t color, const Entry& entry) {
        return GroupOf(world, islands, entry) * kColors + color;
    };
    const size_t keys = size_t(islands.groups) * kColors;
    std::span<uint32_t> moving = world.scratch.Allocate<uint32_t>(keys), fixed = world.scratch.Allocate<uint32_t>(keys);
    const auto count = [&](Kind kind, std::span<uint32_t> counts) {
        std::fill(counts.begin(), counts.end(), 0u);
        VisitEntries(world, kind, [&](uint32_t c, const Entry& entry) {
            if (c < kColors) ++counts[keyOf(c, entry)];
        });
    };
    count(Kind::Moving, moving);
    count(Kind::Fixed, fixed);
    std::span<const SortedJoint> joints = SortJoints(world, islands);
    const std::span<const bool> hasTrees = FindGroupsWithTrees(world, islands);
    layout.colors.clear();
    uint32_t movingFirst = 0, fixedFirst = 0;
    uint64_t used = 0;
    for (uint32_t g = 0; g < islands.groups; ++g) {
        layout.groups[g].colorsBegin = static_cast<uint32_t>(layout.colors.size());
        for (uint32_t c = 0; c < kColors; ++c) {
            const uint32_t key = g * kColors + c;
            const uint32_t m = moving[key], f = fixed[key];
            if (m + f == 0 && (joints.empty() || joints.front().place != key)) continue;
            used |= uint64_t(1) << c;
            ColorBatches color;
            color.moving = MakeRange(movingFirst, m, layout.movingCount);
            color.fixed = MakeRange(fixedFirst, f, layout.fixedCount);
            MakeJointBatches(world, key, hasTrees[g], joints, color);
            layout.colors.push_back(color);
            movingFirst += m;
            fixedFirst += f;
        }
        layout.groups[g].colorsEnd = static_cast<uint32_t>(layout.colors.size());
    }
    layout.colorCount = static_cast<uint32_t>(std::popcount(used));
    const auto sort = [&](Kind kind, std::span<uint32_t> next, std::vector<Entry>& sorted) {
        sorted.resize(ExclusivePrefixSum(next));
        VisitEntries(world, kind, [&](uint32_t c, const Entry& entry) {
            if (c < kColors) sorted[next[keyOf(c, entry)]++] = entry;
        });
    };
    sort(Kind::Moving, moving, layout.movingContacts);
    sort(Kind::Fixed, fixed, layout.fixedContacts);
}

void MakeOverflow(WorldState& world) {
    SolverLayout& layout = world.solver;
    const ConstraintColoring::Color& overflow = world.coloring.At(ConstraintColoring::kOverflow);
    layout.overflowMoving.resize(overflow.Of(Kind::Moving).size());
    layout.overflowFixed.resize(overflow.Of(Kind::Fixed).size());
    layout.overflowJoints.resize(overflow.Of(Kind::Joint).size());
    for (size_t i = 0; i < layout.overflowJoints.size(); ++i) {
        const SortedJoint joint{0, 0, overflow.Of(Kind::Joint)[i].constraint};
        FillBatch(world, layout.overflowJoints[i], std::span(&joint, 1));
    }
}

}  // namespace

void BuildIslands(WorldState& world) {
    SolverLayout& layout = world.solver;
    if (layout.version == world.coloring.Version()) return;
    layout.version = world.coloring.Version();
    layout.movingCount = layout.fixedCount = layout.ballCount = layout.jointCount = 0;
    FindJointTrees(world, layout.trees);
    const Islands islands = FindIslands(world);
    layout.islands = islands.islands;
    SortBodies(world, islands);
    SortConstraints(world, islands);
    PlaceTrees(world, islands);
    GrowTo(layout.moving, layout.movingCount);
    GrowTo(layout.fixed, layout.fixedCount);
    MakeOverflow(world);
    ShareRows(std::span(layout.joints).first(layout.jointCount), layout.jointRows);
    ShareRows(std::span(layout.overflowJoints), layout.overflowRows);
}

}  // namespace fulcrum
