// The colored constraints as the solver runs them: groups of islands, in each group color after color, in each color
// batches of lanes, joints before contacts. Written by the BuildIslands stage where constraints began or ended, with
// the constraints and bodies of the batches; their rows are filled by Prepare.
#pragma once

#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Constraints/Contacts/ContactBatch.h>
#include <Fulcrum/Constraints/Contacts/ContactNote.h>
#include <Fulcrum/Constraints/Direct/DirectPattern.h>
#include <Fulcrum/Constraints/Joints/BallBatch.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Physics/Stages/HardMechanisms.h>

namespace fulcrum {

// Islands that are solved together. The first group contains the large islands, which are solved color by color on all
// workers. Each other group contains some small islands, which one worker solves from start to end, in its own cache
// and without barriers. The grouping does not influence results. Islands share a group if they have the same effort,
// and joints or none of them. An island that is solved directly, or a large one with joints, has a group of its own.
struct SolverGroup {
    bool isLarge = false;                          // solved color by color on all workers
    bool hasJoints = false;                        // all islands of it have joints, or it is solved directly: see Solve
    uint32_t colorsBegin = 0, colorsEnd = 0;       // into SolverLayout::colors
    uint32_t bodiesBegin = 0, bodiesEnd = 0;       // into SolverLayout::bodies
    LeastEffort effort{};                          // minimum effort, if more than the system's
    bool isDirect = false;                         // one island, solved directly: see DirectIsland.h
    bool isLoaded = false;                         // then: its contacts, because of loads; it has no joints
    bool isResting = false;                        // then: it is at rest in this step, which takes one substep
    bool mayContradict = false;                    // then: it has loops of joints, or contacts
    uint32_t patternBegin = 0, patternBlocks = 0;  // then: into SolverLayout::patternWords; DirectPattern::Blocks
    bool IsOwn() const { return isDirect || effort.IsAny(); }
};

// An island with an effort of its own, or that is solved directly because of loads, or will be once it is calm; or all
// large ones that share one.
struct IslandWithEffort {
    uint32_t body = ~0u;  // the lowest index; ~0u: large ones
    uint32_t culprit;     // the body that requires most of it
    uint32_t bodies = 0;  // their number
    uint32_t group;
    bool isWaiting = false;  // to be calm
};
struct WaitingBody {
    uint32_t island;  // into SolverLayout::efforts
    uint32_t body;
};

// Kinds of batches of a color, in the order of solving.
enum BatchKind : uint32_t { kBalls, kJoints, kMovingContacts, kFixedContacts, kBatchKinds };

// Batches [begin, end) of a kind.
struct BatchRange {
    uint32_t begin = 0, end = 0;
    uint32_t Count() const { return end - begin; }
};

struct ColorBatches {
    BatchRange of[kBatchKinds];
    uint32_t Count() const {
        uint32_t count = 0;
        for (const BatchRange& range : of) count += range.Count();
        return count;
    }
};

// The batches of a kind, by group and color.
template <class Batch>
struct BatchList {
    Array<Batch> batches;  // never shrinks, to keep memory
    uint32_t count = 0;    // in use
};
template <class Batch>
size_t HeapBytes(const BatchList<Batch>& list) {
    return list.batches.capacity() * sizeof(Batch);
}

// A joint with a color. Batches contain joints with the same locks, preferably with the same number of rows.
struct ListedJoint {
    uint32_t kind;  // JointKind << 8 | number of rows
    uint32_t joint;
    uint32_t body;  // a dynamic body of it
    uint32_t color;
    friend auto operator<=>(const ListedJoint&, const ListedJoint&) = default;
};

struct SolverLayout {
    Array<SolverGroup> groups;  // empty: nothing to solve
    Array<IslandWithEffort> efforts;
    Array<WaitingBody> waiting;  // of those islands
    Array<ColorBatches> colors;
    Array<uint32_t> bodies;    // dynamic bodies with constraints, by group; sorted in groups with joints
    Array<uint32_t> islandOf;  // by place in `bodies`, of groups with joints: the island, from 0 in each group
    BatchList<BallBatch<kLanes>> balls;
    BatchList<JointBatch<kLanes>> joints;
    BatchList<ContactBatch<kLanes, false>> moving;
    BatchList<ContactBatch<kLanes, true>> fixed;
    // Constraints without a color, of groups that are not solved directly: solved serially after the first group's
    // colors.
    Array<JointBatch<1>> overflowJoints;
    Array<ContactBatch<1, false>> overflowMoving;
    Array<ContactBatch<1, true>> overflowFixed;
    Array<JointRows<kLanes>> jointRows;  // storage of the batches' rows
    Array<JointRows<1>> overflowRows;
    Array<ListedJoint> listedJoints;  // sorted
    Array<uint32_t> rowJoints;        // by body: joints with rows while they are counted, else 0
    uint64_t jointVersion = 0;        // version of the coloring from which the list was made
    HardMechanisms hard;
    Array<uint32_t> patternWords;  // DirectPattern::Words of groups that are solved directly
    Array<ContactNote> notes;      // by contact, zero if not in a batch; empty without contact events
    uint32_t colorCount = 0;       // colors in use
    uint32_t uncolored = 0;        // number of constraints without a color
    uint32_t islands = 0;
    uint64_t version = 0;      // version of the coloring from which this was made
    uint64_t loadVersion = 0;  // version of PairStore's loads

    bool HasJoints() const { return balls.count + joints.count > 0 || !overflowJoints.empty(); }
    size_t OverflowCount() const;  // their number
    std::span<const uint32_t> BodiesOf(const SolverGroup& group) const {
        return std::span(bodies).subspan(group.bodiesBegin, group.bodiesEnd - group.bodiesBegin);
    }
    // Of a group that is solved directly: of its bodies in their order.
    DirectPattern PatternOf(const SolverGroup& group) const {
        const uint32_t count = group.bodiesEnd - group.bodiesBegin;
        return {count, group.patternBlocks, {}, std::span(patternWords).subspan(group.patternBegin)};
    }
};

// Calls f(list, BatchKind) for each kind of batch. A new kind needs an enumerator, a list and a line here, and
// overloads for its batches in the stages.
template <class Layout, class F>
void ForEachBatchList(Layout& layout, F&& f) {
    f(layout.balls, kBalls);
    f(layout.joints, kJoints);
    f(layout.moving, kMovingContacts);
    f(layout.fixed, kFixedContacts);
}

// Calls visit(batch) for all batches of a group in the order of solving, but for those without a color.
template <class Layout, class Visit>
void VisitBatches(Layout& layout, const SolverGroup& group, Visit&& visit) {
    for (uint32_t c = group.colorsBegin; c < group.colorsEnd; ++c)
        ForEachBatchList(layout, [&](auto& list, BatchKind kind) {
            const BatchRange& range = layout.colors[c].of[kind];
            for (uint32_t i = range.begin; i < range.end; ++i) visit(list.batches[i]);
        });
}

// The second body of a lane; the first if the second is static or kinematic and the batch does not use it.
template <int N>
uint32_t SecondBody(const ContactBatch<N, true>& batch, int lane) {
    return batch.bodyA[lane];
}
template <class Batch>
uint32_t SecondBody(const Batch& batch, int lane) {
    return batch.bodyB[lane];
}

// Calls f(batches) for each kind of batches without a color, in the order of solving.
template <class Layout, class F>
void ForEachOverflowList(Layout& layout, F&& f) {
    f(layout.overflowJoints);
    f(layout.overflowMoving);
    f(layout.overflowFixed);
}

inline size_t SolverLayout::OverflowCount() const {
    size_t count = 0;
    ForEachOverflowList(*this, [&](const auto& batches) { count += batches.size(); });
    return count;
}

size_t HeapBytes(const SolverLayout& layout);

}  // namespace fulcrum
