// The tree against brute force over a list of boxes.
#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <thread>
#include <vector>

namespace fulcrum {
namespace {

// Box coordinates from a fixed sequence: the same on every standard library, unlike the distributions of <random>.
class Random {
public:
    float Uniform(float low, float high) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) / 16777216.0f;
    }
    uint32_t Below(uint32_t n) { return static_cast<uint32_t>(engine_() % n); }
    Vector3 Vector(float low, float high) {
        const float x = Uniform(low, high), y = Uniform(low, high), z = Uniform(low, high);
        return Vector3(x, y, z);
    }
    Bounds Box(float range, float largest) {
        Bounds box;
        const Vector3 center = Vector(-range, range), half = Vector(0, largest);
        box.lower = center - half;
        box.upper = center + half;
        return box;
    }

private:
    std::mt19937 engine_{1};
};

Bounds Box(const Vector3& lower, const Vector3& upper) {
    Bounds box;
    box.lower = lower;
    box.upper = upper;
    return box;
}

std::vector<uint32_t> Found(const BoundsTree& tree, const Bounds& bounds) {
    std::vector<uint32_t> ids;
    tree.Query(bounds, [&](uint32_t id) { ids.push_back(id); });
    std::sort(ids.begin(), ids.end());
    return ids;
}

// The tree beside the list that it must agree with.
class Reference {
public:
    BoundsTree tree;

    void Insert(uint32_t id, const Bounds& box) {
        if (id >= boxes_.size()) boxes_.resize(id + 1);
        boxes_[id] = box;
        tree.Insert(id, box);
    }
    void Update(uint32_t id, const Bounds& box) {
        boxes_[id] = box;
        tree.Update(id, box);
    }
    void Remove(uint32_t id) {
        boxes_[id] = Bounds{};
        tree.Remove(id);
    }
    bool Contains(uint32_t id) const { return id < boxes_.size() && !boxes_[id].IsEmpty(); }
    std::vector<uint32_t> Overlapping(const Bounds& bounds) const {
        std::vector<uint32_t> ids;
        for (uint32_t id = 0; id < boxes_.size(); ++id)
            if (Contains(id) && boxes_[id].Overlaps(bounds)) ids.push_back(id);
        return ids;
    }
    void ExpectSame(const Bounds& bounds) const { ASSERT_EQ(Found(tree, bounds), Overlapping(bounds)); }

private:
    std::vector<Bounds> boxes_;
};

TEST(BoundsTree, AgreesWithBruteForceUnderRandomOperations) {
    Random random;
    Reference reference;
    for (int operation = 0; operation < 20000; ++operation) {
        const uint32_t id = random.Below(600);
        const uint32_t kind = random.Below(100);
        if (!reference.Contains(id)) {
            if (kind < 70) reference.Insert(id, random.Box(20, 1));
        } else if (kind < 20) {
            reference.Remove(id);
        } else if (kind < 90) {
            reference.Update(id, random.Box(20, kind == 20 ? 30.0f : 1.0f));
        }
        if (kind == 99) reference.tree.Optimize();
        if (operation % 3000 == 2999) reference.tree.Rebuild();
        if (operation % 20 == 0) reference.ExpectSame(random.Box(20, 3));
        if (operation % 200 == 0) reference.tree.Validate();
        ASSERT_EQ(reference.tree.Contains(id), reference.Contains(id));
    }
}

// Recent insertions are found before and after Optimize and Rebuild.
TEST(BoundsTree, FindsTenThousandBoxesBeforeAndAfterTheBuild) {
    Random random;
    Reference reference;
    const auto expectSame = [&] {
        reference.tree.Validate();
        for (int i = 0; i < 50; ++i) reference.ExpectSame(random.Box(50, 4));
    };
    for (uint32_t id = 0; id < 10000; ++id) reference.Insert(id, random.Box(50, 1));
    EXPECT_EQ(reference.tree.Size(), 10000u);
    expectSame();
    reference.tree.Optimize();
    expectSame();
    for (uint32_t id = 10000; id < 10500; ++id) reference.Insert(id, random.Box(50, 1));
    expectSame();
    for (uint32_t id = 0; id < 10500; id += 3) reference.Remove(id);
    expectSame();
    reference.tree.Optimize();
    expectSame();
    reference.tree.Rebuild();
    expectSame();
}

// One by one, at every size around those at which nodes fill and the tree grows in height.
TEST(BoundsTree, IsValidAtEverySize) {
    Random random;
    for (uint32_t count = 1; count <= 600; count += count < 140 ? 1 : 37) {
        Reference reference;
        for (uint32_t id = 0; id < count; ++id) reference.Insert(id, random.Box(5, 1));
        reference.tree.Validate();
        reference.ExpectSame(random.Box(5, 5));
        reference.tree.Rebuild();
        reference.tree.Validate();
        reference.ExpectSame(random.Box(5, 5));
        for (uint32_t id = 0; id < count; ++id) {
            reference.Remove(id);
            if (id % 7 == 0) reference.tree.Validate();
        }
        EXPECT_EQ(reference.tree.Size(), 0u);
    }
}

TEST(BoundsTree, FindsAllOfFourThousandBoxesInOnePlace) {
    const Bounds box = Box(Vector3(1, 2, 3), Vector3(2, 3, 4));
    Reference reference;
    for (uint32_t id = 0; id < 4096; ++id) reference.Insert(id, box);
    for (int build = 0; build < 2; ++build) {
        reference.tree.Validate();
        reference.ExpectSame(box);
        reference.ExpectSame(Box(Vector3(2.5f, 2, 3), Vector3(3, 3, 4)));
        reference.tree.Rebuild();
    }
}

TEST(BoundsTree, FindsHugeFloorsAmongSmallBoxes) {
    Random random;
    Reference reference;
    for (uint32_t id = 0; id < 2000; ++id)
        reference.Insert(id,
                         id % 500 == 7 ? Box(Vector3(-1e4f, -1, -1e4f), Vector3(1e4f, 0, 1e4f)) : random.Box(50, 0.5f));
    reference.tree.Optimize();
    reference.tree.Validate();
    for (int i = 0; i < 100; ++i) reference.ExpectSame(random.Box(60, 2));
    reference.ExpectSame(Box(Vector3(9e3f, -0.5f, 9e3f), Vector3(9e3f, -0.5f, 9e3f)));
}

// A floor below thousand boxes is one more box to test in the root; as a leaf like any other it would be in every node
// above it, and a line would visit these too.
TEST(BoundsTree, VisitsLessThanOneNodeMoreBecauseOfAFloor) {
    Random random;
    BoundsTree tree;
    for (uint32_t id = 0; id < 1000; ++id) tree.Insert(id, random.Box(16, 0.5f));
    tree.Rebuild();
    const float without = tree.Cost();
    Bounds floor = tree.TotalBounds();
    floor.upper.y() = floor.lower.y() + 1;
    tree.Insert(1000, floor);
    tree.Rebuild();
    EXPECT_LT(tree.Cost(), without + 1);
    tree.Validate();
}

// Points on a line whose distances span all of the floats: no equal halves in space, no area, sums beyond the floats.
TEST(BoundsTree, ClampsCoordinatesBeyondTheFarthest) {
    const float infinite = std::numeric_limits<float>::infinity();
    BoundsTree tree;
    tree.Insert(0, Box(Vector3::Constant(3e38f), Vector3::Constant(infinite)));
    tree.Insert(1, Box(Vector3::Constant(-infinite), Vector3::Constant(-2e38f)));
    tree.Optimize();
    tree.Validate();
    EXPECT_EQ(Found(tree, Box(Vector3::Constant(BoundsTree::kFarthest), Vector3::Constant(BoundsTree::kFarthest))),
              std::vector<uint32_t>{0});
    EXPECT_EQ(Found(tree, Box(Vector3::Constant(-BoundsTree::kFarthest), Vector3::Zero())), std::vector<uint32_t>{1});
}

TEST(BoundsTree, FindsPointsAtAllScales) {
    Reference reference;
    uint32_t id = 0;
    for (float x = BoundsTree::kFarthest; x > 1e-44f; x *= 0.5f) {
        reference.Insert(id++, Box(Vector3::Constant(x), Vector3::Constant(x)));
        reference.Insert(id++, Box(Vector3::Constant(-x), Vector3::Constant(-x)));
        reference.Insert(id++, Box(Vector3(x, 0, 0), Vector3(x, 0, 0)));
    }
    for (int build = 0; build < 3; ++build) {
        reference.tree.Validate();
        for (float x = BoundsTree::kFarthest; x > 1e-44f; x *= 0.25f) {
            reference.ExpectSame(Box(Vector3::Constant(x), Vector3::Constant(x)));
            reference.ExpectSame(Box(Vector3::Constant(-x), Vector3(x, 0, 0)));
        }
        if (build == 0) reference.tree.Optimize();
        else reference.tree.Rebuild();
    }
    EXPECT_GE(reference.tree.Cost(), 1.0f);
}

TEST(BoundsTree, CountsTouchingBoxesAsOverlapping) {
    BoundsTree tree;
    tree.Insert(3, Box(Vector3(0, 0, 0), Vector3(1, 1, 1)));
    EXPECT_EQ(Found(tree, Box(Vector3(1, 1, 1), Vector3(2, 2, 2))), std::vector<uint32_t>{3});
    EXPECT_EQ(Found(tree, Box(Vector3(std::nextafter(1.0f, 2.0f), 1, 1), Vector3(2, 2, 2))), std::vector<uint32_t>{});
}

TEST(BoundsTree, FindsEachLeafOnceWithinInfiniteBounds) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    Random random;
    Reference reference;
    for (uint32_t id = 0; id < 100; ++id) reference.Insert(id, random.Box(5, 1));
    reference.tree.Rebuild();
    for (uint32_t id = 0; id < 100; id += 2) reference.Remove(id);
    reference.ExpectSame(Box(Vector3::Constant(-kInfinity), Vector3::Constant(kInfinity)));
    reference.ExpectSame(Box(Vector3::Constant(-kInfinity), Vector3(kInfinity, 0, kInfinity)));
}

TEST(BoundsTree, IsEmptyBeforeAndAfterItsLeaves) {
    const Bounds box = Box(Vector3(0, 0, 0), Vector3(1, 1, 1));
    BoundsTree tree;
    for (int round = 0; round < 3; ++round) {
        tree.Optimize();
        tree.Rebuild();
        tree.Validate();
        EXPECT_EQ(tree.Size(), 0u);
        EXPECT_EQ(tree.Cost(), 0.0f);
        EXPECT_TRUE(tree.TotalBounds().IsEmpty());
        EXPECT_FALSE(tree.Contains(5));
        EXPECT_EQ(Found(tree, box), std::vector<uint32_t>{});
        tree.Insert(5, box);
        EXPECT_TRUE(tree.Contains(5));
        EXPECT_FALSE(tree.Contains(4));
        EXPECT_FALSE(tree.Contains(6));
        EXPECT_EQ(Found(tree, box), std::vector<uint32_t>{5});
        if (round == 1) tree.Optimize();
        if (round == 2) tree.Clear();
        else tree.Remove(5);
    }
}

TEST(BoundsTree, TellsTheBoundsOfALeafAndOfAll) {
    Random random;
    BoundsTree tree;
    std::vector<Bounds> boxes;
    for (uint32_t id = 0; id < 300; ++id) {
        boxes.push_back(random.Box(10, 1));
        tree.Insert(id, boxes.back());
    }
    tree.Optimize();
    boxes[17] = Box(Vector3(40, 50, 60), Vector3(41, 51, 61));
    tree.Update(17, boxes[17]);
    EXPECT_EQ(tree.TotalBounds().upper, Vector3(41, 51, 61));
    tree.Remove(17);
    tree.Optimize();
    Bounds total;
    for (uint32_t id = 0; id < 300; ++id) {
        if (id == 17) continue;
        total.Include(boxes[id]);
        EXPECT_EQ(tree.GetBounds(id).lower, boxes[id].lower);
        EXPECT_EQ(tree.GetBounds(id).upper, boxes[id].upper);
    }
    EXPECT_EQ(tree.TotalBounds().lower, total.lower);
    EXPECT_EQ(tree.TotalBounds().upper, total.upper);
}

// Every leaf moves each step. A rebuild is due when the summed excess of the nodes' area over that of the last build
// exceeds 0.3, so none larger remains; two builds of the same leaves differ by less than 0.1.
TEST(BoundsTree, StaysAlmostAsGoodAsNewWhileAllLeavesMove) {
    Random random;
    std::vector<Vector3> centers, velocities;
    BoundsTree tree;
    const auto boxAt = [](const Vector3& center) {
        return Box(center - Vector3::Constant(0.3f), center + Vector3::Constant(0.3f));
    };
    for (uint32_t id = 0; id < 4000; ++id) {
        centers.push_back(random.Vector(-6, 6));
        velocities.push_back(random.Vector(-1, 1));
        tree.Insert(id, boxAt(centers[id]));
    }
    for (int step = 0; step < 60; ++step) {
        for (uint32_t id = 0; id < 4000; ++id) {
            centers[id] += 0.1f * velocities[id];
            tree.Update(id, boxAt(centers[id]));
        }
        tree.Optimize();
    }
    BoundsTree fresh = tree;
    fresh.Rebuild();
    EXPECT_LT(tree.Cost(), 1.4f * fresh.Cost());
}

// MemoryUsed counts the capacities of all buffers.
TEST(BoundsTree, HoldsLittleMemoryAndNoMoreInASteadyState) {
    constexpr uint32_t kCount = 10000;
    Random random;
    BoundsTree tree;
    for (uint32_t id = 0; id < kCount; ++id) tree.Insert(id, random.Box(20, 0.3f));
    tree.Optimize();
    EXPECT_LT(tree.MemoryUsed(), 85u * kCount);
    const size_t before = tree.MemoryUsed();
    for (int step = 0; step < 50; ++step) {
        for (uint32_t id = step % 5; id < kCount; id += 5) tree.Update(id, random.Box(20, 0.3f));
        tree.Optimize();
    }
    tree.Rebuild();
    EXPECT_EQ(tree.MemoryUsed(), before);
}

TEST(BoundsTree, AnswersQueriesOfManyThreads) {
    Random random;
    Reference reference;
    for (uint32_t id = 0; id < 3000; ++id) reference.Insert(id, random.Box(20, 1));
    reference.tree.Optimize();
    std::vector<Bounds> queries;
    std::vector<std::vector<uint32_t>> found(200);
    for (size_t i = 0; i < found.size(); ++i) queries.push_back(random.Box(20, 2));
    std::vector<std::thread> threads;
    for (size_t thread = 0; thread < 4; ++thread)
        threads.emplace_back([&, thread] {
            for (size_t i = thread; i < found.size(); i += 4) found[i] = Found(reference.tree, queries[i]);
        });
    for (std::thread& thread : threads) thread.join();
    for (size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], reference.Overlapping(queries[i]));
}

#ifdef FULCRUM_ASSERTIONS
TEST(BoundsTreeDeathTest, RejectsInvalidBoxesAndMissingLeaves) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Bounds box = Box(Vector3(0, 0, 0), Vector3(1, 1, 1));
    BoundsTree tree;
    tree.Insert(0, box);
    EXPECT_DEATH(tree.Insert(1, Box(Vector3(0, nan, 0), Vector3(1, 1, 1))), "assertion");
    EXPECT_DEATH(tree.Update(0, Bounds{}), "assertion");
    EXPECT_DEATH(tree.Insert(0, box), "assertion");
    EXPECT_DEATH(tree.Update(1, box), "assertion");
    EXPECT_DEATH(tree.Remove(1), "assertion");
}
#endif

}  // namespace
}  // namespace fulcrum
