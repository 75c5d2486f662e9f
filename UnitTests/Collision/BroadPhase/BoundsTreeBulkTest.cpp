// Bulk updates and pair searches of a tree, against single updates and queries.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeBulk.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

namespace fulcrum {
namespace {

using testing::RandomPoses;
using Pair = std::pair<uint32_t, uint32_t>;

Bounds RandomBox(RandomPoses& random, float range, float largest) {
    const Vector3 center = random.InCube() * range, half = random.InCube().cwiseAbs() * largest;
    Bounds box;
    box.lower = center - half;
    box.upper = center + half;
    return box;
}

// In ranges of a few nodes, as threads would share them.
std::vector<Pair> PairsOf(const BoundsTree& tree) {
    std::vector<Pair> pairs;
    for (uint32_t begin = 0; begin < tree.NodeCount(); begin += 3)
        tree.VisitPairs(begin, std::min(begin + 3, tree.NodeCount()),
                        [&](uint32_t a, uint32_t b) { pairs.push_back(std::minmax(a, b)); });
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

void ExpectAllPairs(const BoundsTree& tree, const std::vector<Bounds>& boxes) {
    std::vector<Pair> expected;
    for (uint32_t a = 0; a < boxes.size(); ++a)
        for (uint32_t b = a + 1; b < boxes.size(); ++b)
            if (tree.Contains(a) && tree.Contains(b) && boxes[a].Overlaps(boxes[b])) expected.push_back({a, b});
    EXPECT_EQ(PairsOf(tree), expected);
}

void ExpectAllGroups(const BoundsTree& tree, const std::vector<Bounds>& boxes) {
    std::multiset<uint32_t> seen;
    tree.VisitGroups(0, tree.NodeCount(), [&](const Bounds& all, std::span<const uint32_t> ids) {
        for (uint32_t id : ids) {
            seen.insert(id);
            EXPECT_TRUE(all.Contains(boxes[id])) << id;
        }
    });
    EXPECT_EQ(seen.size(), tree.Size());
    for (uint32_t id = 0; id < boxes.size(); ++id) EXPECT_EQ(seen.count(id), tree.Contains(id) ? 1u : 0u);
}

// Rebuilt, with recent insertions, with holes, and with a floor that hangs in the root.
TEST(BoundsTreeBulk, FindsEachPairOnceAndEachLeafOnce) {
    for (uint32_t size : {1u, 2u, 9u, 64u, 65u, 500u}) {
        RandomPoses random(size);
        BoundsTree tree;
        std::vector<Bounds> boxes;
        const auto insert = [&](const Bounds& box) {
            tree.Insert(static_cast<uint32_t>(boxes.size()), box);
            boxes.push_back(box);
        };
        for (uint32_t i = 0; i < size; ++i) insert(RandomBox(random, 10, 1.5f));
        ExpectAllPairs(tree, boxes);
        tree.Rebuild();
        ExpectAllPairs(tree, boxes);
        for (uint32_t i = 0; i < size / 3; ++i) insert(RandomBox(random, 10, 1.5f));
        for (uint32_t i = 0; i < size; i += 7) tree.Remove(i);
        Bounds floor;
        floor.lower = Vector3(-20, -2, -20);
        floor.upper = Vector3(20, 0, 20);
        insert(floor);
        ExpectAllPairs(tree, boxes);
        tree.Rebuild();
        ExpectAllPairs(tree, boxes);
        ExpectAllGroups(tree, boxes);
    }
}

TEST(BoundsTreeBulk, WritesAllLeavesAndStaysValid) {
    RandomPoses random(5);
    BoundsTree tree;
    std::vector<Bounds> boxes(600);
    for (uint32_t id = 0; id < boxes.size(); ++id) tree.Insert(id, boxes[id] = RandomBox(random, 10, 1));
    for (int round = 0; round < 12; ++round) {
        for (Bounds& box : boxes) box = RandomBox(random, 10 + static_cast<float>(round), 1);
        for (uint32_t begin = 0; begin < tree.NodeCount(); begin += 5)
            tree.UpdateLeaves(begin, std::min(begin + 5, tree.NodeCount()), [&](uint32_t id) { return boxes[id]; });
        tree.NoteUpdated(static_cast<uint32_t>(boxes.size()));
        tree.Optimize();
        tree.Validate();
        for (uint32_t id = 0; id < boxes.size(); ++id)
            ASSERT_TRUE(tree.GetBounds(id).lower == boxes[id].lower && tree.GetBounds(id).upper == boxes[id].upper);
        ExpectAllPairs(tree, boxes);
    }
}

// Ancestors are as tight as after single updates.
TEST(BoundsTreeBulk, LeavesTheTreeAsGoodAsSingleUpdatesDo) {
    RandomPoses random(6);
    BoundsTree together, single;
    std::vector<Bounds> boxes(400);
    for (uint32_t id = 0; id < boxes.size(); ++id) {
        boxes[id] = RandomBox(random, 10, 0.5f);
        together.Insert(id, boxes[id]);
        single.Insert(id, boxes[id]);
    }
    together.Rebuild();
    single.Rebuild();
    for (uint32_t id = 0; id < boxes.size(); ++id) {
        boxes[id].lower += Vector3(0.01f, 0.02f, 0);
        boxes[id].upper += Vector3(0.01f, 0.02f, 0);
        single.Update(id, boxes[id]);
    }
    together.UpdateLeaves(0, together.NodeCount(), [&](uint32_t id) { return boxes[id]; });
    together.NoteUpdated(static_cast<uint32_t>(boxes.size()));
    together.Optimize();
    single.Optimize();
    EXPECT_EQ(together.Cost(), single.Cost());
}

}  // namespace
}  // namespace fulcrum
