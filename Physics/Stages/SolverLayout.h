// The colored constraints as the solver runs them: groups of islands, in each group color after color, in each color
// batches of lanes, joints before contacts. Written by the BuildIslands stage where constraints began or ended; rows
// are filled by Prepare.
#pragma once

#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Constraints/Contacts/ContactBatch.h>
#include <Fulcrum/Constraints/Joints/BallBatch.h>
#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Physics/Stages/JointTrees.h>

#include <vector>

namespace fulcrum {

// Islands that are solved together. The first group holds the large islands, which are solved
// color by color on all workers. Each of the others is a handful of small islands that one worker solves from beginning
// to end, in its own cache and without a barrier. Which islands share a group has no influence on any result.
// An island that is to be solved with an effort of its own, or that has trees of joints, has a group of its own.
struct SolverGroup {
    uint32_t colorsBegin = 0, colorsEnd = 0;  // into SolverLayout::colors
    uint32_t bodiesBegin = 0, bodiesEnd = 0;  // into SolverLayout::bodies
    SolverSettings effort{0, 0, 0};           // 0: the system's
    uint32_t treesBegin = 0, treesEnd = 0;    // into SolverLayout::treesByGroup
    bool HasTrees() const { return treesEnd > treesBegin; }
    bool IsOwn() const { return HasTrees() || !(effort == SolverSettings{0, 0, 0}); }
};

// Contacts [first, first + contacts) of a list, in the batches [begin, end).
struct BatchRange {
    uint32_t first = 0, contacts = 0;
    uint32_t begin = 0, end = 0;
    uint32_t Count() const { return end - begin; }
};

struct ColorBatches {
    BatchRange moving, fixed;
    uint32_t jointsBegin = 0, jointsEnd = 0;  // batches
    uint32_t ballsBegin = 0, ballsEnd = 0;    // likewise, of ball joints
    uint32_t JointCount() const { return jointsEnd - jointsBegin; }
    uint32_t BallCount() const { return ballsEnd - ballsBegin; }
    uint32_t Count() const { return BallCount() + JointCount() + moving.Count() + fixed.Count(); }
};

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
    std::vector<ConstraintColoring::Entry> movingContacts, fixedContacts;  // by group and color
    std::vector<ContactBatch<kLanes, false>> moving;
    std::vector<ContactBatch<kLanes, true>> fixed;
    std::vector<ContactBatch<1, false>> overflowMoving;  // of the first group: solved one by one, at last
    std::vector<ContactBatch<1, true>> overflowFixed;
    std::vector<BallBatch<kLanes>> balls;
    std::vector<JointBatch<kLanes>> joints;
    std::vector<JointBatch<1>> overflowJoints;
    std::vector<JointRows<kLanes>> jointRows;  // room for the batches' rows
    std::vector<JointRows<1>> overflowRows;
    std::vector<ListedJoint> listedJoints;  // in order
    uint64_t jointVersion = 0;              // of the coloring that this list was made from
    JointTrees trees;
    std::vector<uint32_t> treesByGroup;                                       // indices of trees
    uint32_t movingCount = 0, fixedCount = 0, ballCount = 0, jointCount = 0;  // batches in use
    uint32_t colorCount = 0;                                                  // colors in use
    uint32_t islands = 0;
    uint64_t version = 0;  // of the coloring that this was made from

    bool HasJoints() const { return ballCount + jointCount > 0 || !overflowJoints.empty(); }
    bool HasOverflow() const { return !overflowMoving.empty() || !overflowFixed.empty() || !overflowJoints.empty(); }
};

size_t HeapBytes(const SolverLayout& layout);

}  // namespace fulcrum
