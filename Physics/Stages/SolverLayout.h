// The colored constraints as the solver runs them: groups of islands, in each group color after color, in each color
// batches of lanes, joints before contacts. Written by the BuildIslands stage where constraints began or ended; rows
// are filled by Prepare.
#pragma once

#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Constraints/Contacts/ContactBatch.h>
#include <Fulcrum/Constraints/Contacts/ContactNote.h>
#include <Fulcrum/Constraints/Joints/BallBatch.h>
#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Physics/Stages/JointTrees.h>

#include <vector>

namespace fulcrum {

// Islands that are solved together. The first group holds the large islands, which are solved
// color by color on all workers. Each of the others is a handful of small islands that one worker solves from beginning
// to end, in its own cache and without a barrier. Which islands share a group has no influence on any result.
// An island that is to be solved with an effort of its own, or that has trees of joints, has a group of its own; a
// large one without trees is solved on all workers, too.
struct SolverGroup {
    bool isLarge = false;                     // solved color by color on all workers
    uint32_t colorsBegin = 0, colorsEnd = 0;  // into SolverLayout::colors
    uint32_t bodiesBegin = 0, bodiesEnd = 0;  // into SolverLayout::bodies
    LeastEffort effort{};                     // beyond the system's
    uint32_t culprit = ~0u;                   // the body that asked for most of it
    // Of islands under load: how long the substeps are for which springs are not too stiff, as a part of the system's:
    // 2^(-(i - 1) / 16). It follows the substeps slowly where they become shorter: springs that were suddenly stiffer
    // would throw apart what softer ones have let sink. 0: those of the substeps.
    uint8_t stiffness = 0, wantedStiffness = 0;
    uint32_t treesBegin = 0, treesEnd = 0;  // into SolverLayout::treesByGroup
    bool HasTrees() const { return treesEnd > treesBegin; }
    bool IsOwn() const { return HasTrees() || effort.IsAny(); }
};

// What a color is solved in: kinds of batches, in this order.
enum BatchKind : uint32_t { kBalls, kJoints, kMovingContacts, kFixedContacts, kBatchKinds };

// Batches [begin, end) of a kind; of contacts, those that hold [first, first + contacts) of its list.
struct BatchRange {
    uint32_t first = 0, contacts = 0;
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
    std::vector<Batch> batches;  // as many as were ever in use
    uint32_t count = 0;          // in use
};
template <class Batch>
size_t HeapBytes(const BatchList<Batch>& list) {
    return list.batches.capacity() * sizeof(Batch);
}
template <bool kFixedB>
struct ContactBatchList : BatchList<ContactBatch<kLanes, kFixedB>> {
    std::vector<ConstraintColoring::Entry> contacts;  // by group and color
};
template <bool kFixedB>
size_t HeapBytes(const ContactBatchList<kFixedB>& list) {
    return HeapBytes(static_cast<const BatchList<ContactBatch<kLanes, kFixedB>>&>(list)) +
           list.contacts.capacity() * sizeof(ConstraintColoring::Entry);
}

// A colored joint. Batches have joints of the same locks, and best of as many rows.
struct ListedJoint {
    uint32_t kind;  // how it is solved << 8 | rows
    uint32_t joint;
    uint32_t body;  // one that it moves
    uint32_t color;
    friend auto operator<=>(const ListedJoint&, const ListedJoint&) = default;
};

struct SolverLayout {
    std::vector<SolverGroup> groups;  // empty: nothing to solve
    std::vector<ColorBatches> colors;
    std::vector<uint32_t> bodies;  // dynamic ones that a constraint touches, by group
    BatchList<BallBatch<kLanes>> balls;
    BatchList<JointBatch<kLanes>> joints;
    ContactBatchList<false> moving;
    ContactBatchList<true> fixed;
    // Of the first group: solved one by one, at last.
    std::vector<JointBatch<1>> overflowJoints;
    std::vector<ContactBatch<1, false>> overflowMoving;
    std::vector<ContactBatch<1, true>> overflowFixed;
    std::vector<JointRows<kLanes>> jointRows;  // room for the batches' rows
    std::vector<JointRows<1>> overflowRows;
    std::vector<ListedJoint> listedJoints;  // in order
    uint64_t jointVersion = 0;              // of the coloring that this list was made from
    JointTrees trees;
    std::vector<uint32_t> treesByGroup;  // indices of trees
    std::vector<ContactNote> notes;      // by pair, zero but of those in batches; empty without contact events
    uint32_t colorCount = 0;             // colors in use
    uint32_t islands = 0;
    uint64_t version = 0;      // of the coloring that this was made from
    uint64_t loadVersion = 0;  // PairStore's

    bool HasJoints() const { return balls.count + joints.count > 0 || !overflowJoints.empty(); }
    size_t OverflowCount() const;  // of constraints
};

// Calls f(list, BatchKind) for each kind of batch. A new kind is an enumerator, a list and a line here; what stages do
// with it are overloads for its batches.
template <class Layout, class F>
void ForEachBatchList(Layout& layout, F&& f) {
    f(layout.balls, kBalls);
    f(layout.joints, kJoints);
    f(layout.moving, kMovingContacts);
    f(layout.fixed, kFixedContacts);
}

// Calls f(batches) for each kind of what fitted no color, in the order in which it is solved.
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
