// Sorts the colored constraints into groups of islands. Small islands are packed into groups that fit a worker's cache
// and are solved entirely by one worker, which avoids all barriers and most of the memory traffic. Done only in steps
// in which a constraint began or ended. Serial; the islands depend on the constraints only.
//   HardMechanisms.h  mechanisms that are solved directly
//   FindIslands.h     the islands and their groups
//   JointBatches.h    joints in lanes
#include <Fulcrum/Physics/Stages/ContactLoads.h>
#include <Fulcrum/Physics/Stages/FindIslands.h>
#include <Fulcrum/Physics/Stages/JointBatches.h>
#include <Fulcrum/Physics/Stages/Stages.h>

#include <algorithm>
#include <bit>

namespace fulcrum {

namespace {

constexpr uint32_t kColors = ConstraintColoring::kColors;
// Slower than gravity makes a body in this part of a step.
constexpr float kResting = 0.01f;

using Entry = ConstraintColoring::Entry;
using Kind = ConstraintColoring::Kind;

// The contents are rewritten. Room for an eighth more: resize would double it.
template <class T>
void ResizeTo(Array<T>& list, size_t count) {
    if (count > list.capacity()) {
        list.clear();
        list.reserve(count + count / 8);
    }
    list.resize(count);
}

// Numbers the islands of groups with joints, and sorts their bodies: sums over an island depend on the order of these,
// which is another one in `awake` after a snapshot was restored.
void NumberIslands(const BodyStore& bodies, const Islands& islands, SolverLayout& layout, ScratchArena& scratch) {
    ResizeTo(layout.islandOf, layout.bodies.size());
    std::span<uint32_t> numbers = scratch.Allocate<uint32_t>(islands.rootOf.size());
    std::fill(numbers.begin(), numbers.end(), Islands::kNone);
    for (const SolverGroup& group : layout.groups) {
        if (!group.hasJoints) continue;
        const auto first = layout.bodies.begin() + group.bodiesBegin, last = layout.bodies.begin() + group.bodiesEnd;
        if (!std::is_sorted(first, last)) std::sort(first, last);
        uint32_t count = 0;
        for (uint32_t i = group.bodiesBegin; i < group.bodiesEnd; ++i) {
            uint32_t& number = numbers[islands.rootOf[bodies.cold[layout.bodies[i]].awakePlace]];
            if (number == Islands::kNone) number = count++;
            layout.islandOf[i] = number;
        }
    }
}

void SortBodies(const BodyStore& bodies, const Islands& islands, SolverLayout& layout, ScratchArena& scratch) {
    std::span<uint32_t> next = scratch.Allocate<uint32_t>(islands.groups);
    std::fill(next.begin(), next.end(), 0u);
    for (uint32_t group : islands.groupOf)
        if (group != Islands::kNone) ++next[group];
    ResizeTo(layout.bodies, ExclusivePrefixSum(next));
    for (uint32_t g = 0; g < islands.groups; ++g) layout.groups[g].bodiesBegin = next[g];
    for (size_t i = 0; i < islands.groupOf.size(); ++i)
        if (islands.groupOf[i] != Islands::kNone) layout.bodies[next[islands.groupOf[i]]++] = bodies.awake[i];
    for (uint32_t g = 0; g < islands.groups; ++g) layout.groups[g].bodiesEnd = next[g];
    NumberIslands(bodies, islands, layout, scratch);
}

BatchRange MakeRange(uint32_t contacts, uint32_t& batches) {
    BatchRange range{batches, 0};
    batches += (contacts + kLanes - 1) / kLanes;
    range.end = batches;
    return range;
}

// Reserves a sixteenth more than needed: resize would double the largest buffers of a step. The contents are rewritten.
template <class Batch>
void GrowTo(Array<Batch>& batches, uint32_t count) {
    if (batches.size() >= count) return;
    batches.clear();
    batches.reserve(count + count / 16 + 1);
    batches.resize(batches.capacity());
}

template <int N, bool kFixedB>
void SetContact(ContactBatch<N, kFixedB>& batch, int lane, const Entry& entry) {
    batch.contact[lane] = entry.constraint;
    batch.bodyA[lane] = entry.bodyA;
    batch.bodyB[lane] = entry.bodyB;
}

// The remaining lanes repeat the last contact, and are never written back.
template <int N, bool kFixedB>
void RepeatLast(ContactBatch<N, kFixedB>& batch, int count) {
    batch.count = count;
    for (int lane = count; lane < N; ++lane) {
        batch.contact[lane] = batch.contact[count - 1];
        batch.bodyA[lane] = batch.bodyA[count - 1];
        batch.bodyB[lane] = batch.bodyB[count - 1];
    }
}

// A batch for each contact without a color; but for those that are solved directly, which SortConstraints has sorted.
template <bool kFixedB, class IsDirect>
void SetContacts(Array<ContactBatch<1, kFixedB>>& batches, const Array<Entry>& entries, const IsDirect& isDirect) {
    batches.resize(entries.size());
    size_t count = 0;
    for (const Entry& entry : entries) {
        if (isDirect(entry)) continue;
        batches[count].count = 1;
        SetContact(batches[count++], 0, entry);
    }
    batches.resize(count);
}

// Contacts without a color that are solved directly: each is a color of its group.
class Singles {
public:
    Singles(const ConstraintColoring& coloring, ScratchArena& scratch)
        : overflow_(coloring.At(ConstraintColoring::kOverflow)),
          singles_(scratch.Allocate<Single>(overflow_.Of(Kind::Moving).size() + overflow_.Of(Kind::Fixed).size())) {}

    template <class IsIn>
    void AddColors(SolverLayout& layout, const IsIn& isIn) {
        const auto add = [&](Kind kind, BatchKind batches, auto& list) {
            for (const Entry& entry : overflow_.Of(kind)) {
                if (!isIn(entry)) continue;
                singles_[count_++] = {batches, list.count, entry};
                ColorBatches color;
                ForEachBatchList(layout, [&](const auto& each, BatchKind k) {
                    color.of[k] = {each.count, each.count};
                });
                color.of[batches].end = ++list.count;
                layout.colors.push_back(color);
            }
        };
        add(Kind::Moving, kMovingContacts, layout.moving);
        add(Kind::Fixed, kFixedContacts, layout.fixed);
    }
    // Once there is room for all batches.
    void Set(SolverLayout& layout) const {
        const auto set = [](auto& batch, const Entry& entry) {
            SetContact(batch, 0, entry);
            RepeatLast(batch, 1);
        };
        for (const Single& single : singles_.first(count_)) {
            if (single.kind == kMovingContacts) set(layout.moving.batches[single.batch], single.entry);
            else set(layout.fixed.batches[single.batch], single.entry);
        }
    }

private:
    struct Single {
        BatchKind kind;
        uint32_t batch;
        Entry entry;
    };
    const ConstraintColoring::Color& overflow_;
    std::span<Single> singles_;
    size_t count_ = 0;
};

void SortConstraints(const BodyStore& bodies, const ConstraintColoring& coloring, const Islands& islands,
                     JointStore& store, SolverLayout& layout, ScratchArena& scratch) {
    const auto keyOf = [&](uint32_t color, const Entry& entry) {
        return GroupOf(bodies, islands, entry) * kColors + color;
    };
    const size_t keys = size_t(islands.groups) * kColors;
    std::span<uint32_t> moving = scratch.Allocate<uint32_t>(keys), fixed = scratch.Allocate<uint32_t>(keys);
    const auto count = [&](Kind kind, std::span<uint32_t> counts) {
        std::fill(counts.begin(), counts.end(), 0u);
        VisitEntries(coloring, kind, [&](uint32_t c, const Entry& entry) {
            if (c < kColors) ++counts[keyOf(c, entry)];
        });
    };
    count(Kind::Moving, moving);
    count(Kind::Fixed, fixed);
    std::span<const SortedJoint> joints = SortJoints(bodies, coloring, islands, store, layout, scratch);
    layout.colors.clear();
    Singles singles(coloring, scratch);
    uint64_t used = 0;
    for (uint32_t g = 0; g < islands.groups; ++g) {
        layout.groups[g].colorsBegin = static_cast<uint32_t>(layout.colors.size());
        for (uint32_t c = 0; c < kColors; ++c) {
            const uint32_t key = g * kColors + c;
            uint32_t &m = moving[key], &f = fixed[key];
            if (m + f == 0 && (joints.empty() || joints.front().place != key)) continue;
            used |= uint64_t(1) << c;
            ColorBatches color;
            color.of[kMovingContacts] = MakeRange(m, layout.moving.count);
            color.of[kFixedContacts] = MakeRange(f, layout.fixed.count);
            m = color.of[kMovingContacts].begin * kLanes;
            f = color.of[kFixedContacts].begin * kLanes;
            MakeJointBatches(bodies, store, key, joints, layout, color);
            layout.colors.push_back(color);
        }
        if (layout.groups[g].isDirect)
            singles.AddColors(layout, [&](const Entry& entry) { return GroupOf(bodies, islands, entry) == g; });
        layout.groups[g].colorsEnd = static_cast<uint32_t>(layout.colors.size());
    }
    layout.colorCount = static_cast<uint32_t>(std::popcount(used));
    const auto sort = [&](Kind kind, std::span<uint32_t> next, auto& list) {
        GrowTo(list.batches, list.count);
        for (uint32_t i = 0; i < list.count; ++i) list.batches[i].count = kLanes;
        VisitEntries(coloring, kind, [&](uint32_t c, const Entry& entry) {
            if (c == kColors) return;
            const uint32_t place = next[keyOf(c, entry)]++;
            SetContact(list.batches[place / kLanes], static_cast<int>(place % kLanes), entry);
        });
        // Each place is now the end of its contacts, which is within their last batch unless that is full.
        for (const uint32_t place : next)
            if (place % kLanes > 0) RepeatLast(list.batches[place / kLanes], static_cast<int>(place % kLanes));
    };
    sort(Kind::Moving, moving, layout.moving);
    sort(Kind::Fixed, fixed, layout.fixed);
    singles.Set(layout);
}

// What rests stays where it is with substeps of any length, if it is solved directly. Not where that has taken long
// lately: were it to fail, iterations would have one long substep.
void NoteResting(const StepContext& step, const BodyStore& bodies, SolverLayout& layout) {
    const float most = kResting * Length(step.settings.gravity) * step.dt;
    for (SolverGroup& group : layout.groups) {
        if (!group.isLoaded) continue;
        group.isResting = std::ranges::all_of(layout.BodiesOf(group), [&](uint32_t body) {
            const float speed = Length(bodies.LinearVelocityOf(body)) +
                                Length(bodies.AngularVelocityOf(body)) * SizeOf(bodies.dynamics[body]);
            return speed < most && bodies.cold[body].directMisses == 0;
        });
    }
}

}  // namespace

void DescribeEfforts(const SolverLayout& layout, const ConstraintColoring& coloring, const PairStore& pairs,
                     const SavedEfforts& restored, SavedEfforts& described) {
    if (restored.areRestored) {
        described = restored;
        described.areCurrent = restored.AreTaken(coloring, pairs);
        if (!described.areCurrent) described.groups.clear();
        return;
    }
    described.areCurrent = layout.version == coloring.Version() && layout.loadVersion == pairs.loadVersion;
    described.groups.clear();
    if (!described.areCurrent) return;
    for (const IslandWithEffort& island : layout.efforts) {
        const SolverGroup& group = layout.groups[island.group];
        described.groups.push_back({island.body, island.culprit, group.effort, group.isLoaded, island.isWaiting});
    }
    std::ranges::sort(described.groups, {}, &SavedEffort::body);
}

void BuildIslands(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
                  std::span<const uint32_t> began, PairStore& pairs, JointStore& joints, SolverLayout& layout,
                  SavedEfforts& saved, ScratchArena& scratch) {
    NoteWeights(step, began, bodies, joints, pairs, scratch);
    if (step.Lengthens()) NoteForces(step, coloring, bodies, joints, pairs);
    if (layout.version == coloring.Version() && layout.loadVersion == pairs.loadVersion)
        return NoteResting(step, bodies, layout);
    layout.version = coloring.Version();
    layout.loadVersion = pairs.loadVersion;
    const bool asSaved = saved.AreTaken(coloring, pairs);
    ForEachBatchList(layout, [](auto& list, BatchKind) { list.count = 0; });
    FindHardMechanisms(bodies, coloring, joints, step.settings, layout.hard, scratch);
    const Islands islands =
        FindIslands(step, bodies, coloring, joints, pairs, asSaved ? &saved.groups : nullptr, layout, scratch);
    layout.islands = islands.islands;
    SortBodies(bodies, islands, layout, scratch);
    SortConstraints(bodies, coloring, islands, joints, layout, scratch);
    ForEachBatchList(layout, [](auto& list, BatchKind) { GrowTo(list.batches, list.count); });
    const ConstraintColoring::Color& overflow = coloring.At(ConstraintColoring::kOverflow);
    layout.uncolored = static_cast<uint32_t>(overflow.Of(Kind::Joint).size() + overflow.Of(Kind::Moving).size() +
                                             overflow.Of(Kind::Fixed).size());
    const auto isDirect = [&](const Entry& entry) { return layout.groups[GroupOf(bodies, islands, entry)].isDirect; };
    SetContacts(layout.overflowMoving, overflow.Of(Kind::Moving), isDirect);
    SetContacts(layout.overflowFixed, overflow.Of(Kind::Fixed), isDirect);
    MakeOverflowJoints(bodies, joints, coloring, layout.overflowJoints);
    ShareRows(layout);
    NoteResting(step, bodies, layout);
    saved.areRestored = false;
}

}  // namespace fulcrum
