// The tree against a list of boxes that is searched one by one.
#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
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
    Bounds Box(float range, float largest) {
        Bounds box;
        const Vector3 centre(Uniform(-range, range), Uniform(-range, range), Uniform(-range, range));
        const Vector3 half(Uniform(0, largest), Uniform(0, largest), Uniform(0, largest));
        box.lower = centre - half;
        box.upper = centre + half;
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

}  // namespace
}  // namespace fulcrum
