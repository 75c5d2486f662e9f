// Rays, moving boxes and nearest boxes of a tree against a loop over all boxes, in double.
#include <Fulcrum/Collision/BroadPhase/BoundsTreeCasts.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace fulcrum {
namespace {

class BoundsTreeCasts : public ::testing::Test {
protected:
    float Between(float low, float high) { return low + (high - low) * static_cast<float>(engine_() >> 8) * 0x1p-24f; }
    Vector3 InCube(float half) {
        const float x = Between(-half, half), y = Between(-half, half), z = Between(-half, half);
        return Vector3(x, y, z);
    }
    // Rebuilt, with recent insertions and holes.
    void Fill(int count, const Position& origin) {
        for (int i = 0; i < count; ++i) {
            const Vector3 center = InCube(10), half = InCube(0.5f).cwiseAbs();
            boxes_.push_back(RoundedOutwards(origin + Position((center - half).cast<double>()),
                                             origin + Position((center + half).cast<double>())));
            tree_.Insert(static_cast<uint32_t>(i), boxes_.back());
            if (i == count / 2) tree_.Rebuild();
        }
        for (uint32_t i = 0; i < static_cast<uint32_t>(count); i += 7) tree_.Remove(i);
    }
    // The fraction at which the enlarged box is entered; negative: not hit.
    double Entry(size_t box, const Position& o, const Vector3& d, const Vector3& half) const {
        double enter = 0, leave = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double lower = double{boxes_[box].lower[axis]} - half[axis],
                         upper = double{boxes_[box].upper[axis]} + half[axis];
            if (d[axis] == 0) {
                if (o[axis] < lower || o[axis] > upper) return -1;
                continue;
            }
            const double a = (lower - o[axis]) / d[axis], b = (upper - o[axis]) / d[axis];
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter <= leave ? enter : -1;
    }

    std::mt19937 engine_{3};
    BoundsTree tree_;
    std::vector<Bounds> boxes_;
};

TEST_F(BoundsTreeCasts, RaysAndMovingBoxesFindAllThatALoopFinds) {
    for (const Position& origin : {Position(0, 0, 0), Position(1e5, -1e5, 1e5)}) {
        tree_ = {};
        boxes_.clear();
        Fill(1000, origin);
        size_t found = 0, extra = 0;
        for (int i = 0; i < 3000; ++i) {
            const Position o = origin + InCube(12).cast<double>();
            Vector3 d = InCube(20);
            if (i % 5 == 0) d[i % 3] = 0;
            if (i % 11 == 0) d = Vector3(0, i % 2 == 0 ? 15.0f : -15.0f, 0);
            const Vector3 half = i % 2 == 0 ? Vector3(Vector3::Zero()) : Vector3(InCube(1).cwiseAbs());
            std::vector<uint8_t> seen(boxes_.size());
            float limit = 1;
            tree_.CastRay(TreeRay(o, d, half), limit, [&](uint32_t id) { ++seen[id]; });
            for (size_t b = 0; b < boxes_.size(); ++b) {
                const bool expected = b % 7 != 0 && Entry(b, o, d, half) >= 0;
                ASSERT_LE(seen[b], 1);
                if (expected) {
                    ASSERT_EQ(seen[b], 1) << i << " " << b;
                }
                found += expected;
                extra += seen[b] != 0 && !expected;
            }
        }
        // Superfluous leaves by rounding are rare; at 10^5 m floats are 0.008 m apart.
        EXPECT_GT(found, 3000u);
        EXPECT_LT(extra, found / (origin.x() == 0 ? 1000 : 10));
    }
}

TEST_F(BoundsTreeCasts, ALoweredLimitLeavesOutWhatIsFarther) {
    Fill(1000, Position::Zero());
    size_t visited = 0, all = 0;
    for (int i = 0; i < 2000; ++i) {
        const Position o = InCube(12).cast<double>();
        const Vector3 d = InCube(20);
        float limit = 1;
        double best = 2;
        tree_.CastRay(TreeRay(o, d), limit, [&](uint32_t id) {
            ++visited;
            best = std::min(best, Entry(id, o, d, Vector3::Zero()));
            limit = std::min(limit, static_cast<float>(best));
        });
        double expected = 2;
        for (size_t b = 0; b < boxes_.size(); ++b) {
            const double entry = b % 7 != 0 ? Entry(b, o, d, Vector3::Zero()) : -1;
            if (entry >= 0) expected = std::min(expected, entry), ++all;
        }
        EXPECT_NEAR(best, expected, 1e-6);
        int calls = 0;
        limit = 1;
        tree_.CastRay(TreeRay(o, d), limit, [&](uint32_t) { ++calls, limit = -1; });
        EXPECT_LE(calls, 1);
    }
    EXPECT_LT(visited, all);
}

TEST_F(BoundsTreeCasts, NearBoxesAreFoundByTheirDistance) {
    Fill(1000, Position::Zero());
    for (int i = 0; i < 2000; ++i) {
        Bounds box;
        box.lower = InCube(15);
        box.upper = box.lower + InCube(1).cwiseAbs();
        const auto distance = [&](size_t b) {
            const Vector3 gap =
                Vector3(boxes_[b].lower - box.upper).cwiseMax(box.lower - boxes_[b].upper).cwiseMax(0.0f);
            return double{Length(gap)};
        };
        float limit = std::numeric_limits<float>::infinity();
        double best = 1e9, expected = 1e9;
        tree_.VisitNear(box, limit, [&](uint32_t id) {
            best = std::min(best, distance(id));
            limit = static_cast<float>(best);
        });
        size_t near = 0, found = 0;
        for (size_t b = 0; b < boxes_.size(); ++b) {
            if (b % 7 == 0) continue;
            expected = std::min(expected, distance(b));
            near += distance(b) <= 3;
        }
        EXPECT_NEAR(best, expected, 1e-5);
        float three = 3;
        tree_.VisitNear(box, three, [&](uint32_t) { ++found; });
        EXPECT_NEAR(static_cast<double>(found), static_cast<double>(near), 1);
    }
}

}  // namespace
}  // namespace fulcrum
