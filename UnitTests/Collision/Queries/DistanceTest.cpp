// Closest points, overlap and containment of single shapes.
#include "QueryTesting.h"

#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/Collision/Queries/ConvexDistance.h>
#include <Fulcrum/Collision/Queries/CoreShapes.h>
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

TEST(Distance, OfConvexShapesIsWhatLibccdAndTheirPointsSay) {
    RandomPoses random(21);
    int apart = 0, overlapping = 0, shallow = 0;
    for (const NamedShape& a : QueryShapes()) {
        for (const NamedShape& b : QueryShapes()) {
            for (int i = 0; i < Cases(2100); ++i) {
                const Vector3 direction = random.Direction();
                const RelativePose pose{direction * random.Between(0.1f, 2.5f), random.Rotation()};
                ClosestPoints found;
                ASSERT_TRUE(FindClosestPoints(*a.shape, *b.shape, pose, 100, found));
                EXPECT_EQ(Overlap(*a.shape, *b.shape, pose), found.distance <= 0)
                    << a.name << b.name << i << " " << found.distance;
                const double along = SeparationAlong(*a.shape, *b.shape, pose, found.normal);
                EXPECT_NEAR(along, found.distance, 2e-5) << a.name << " " << b.name << " " << i;
                EXPECT_NEAR(Dot(found.normal, Vector3(found.onB - found.onA)), found.distance, 2e-5);
                if (found.distance > 0) {
                    ++apart;
                    // The points prove that it is not less, the axis that it is not more.
                    EXPECT_NEAR(Length(Vector3(found.onB - found.onA)), found.distance, 2e-5);
                    EXPECT_LT(MeasureConvex(*a.shape, PointCore(), {found.onA, {}}, 100).separation, 1e-5f);
                    EXPECT_LT(
                        MeasureConvex(*b.shape, PointCore(), {pose.InverseTransform(found.onB), {}}, 100).separation,
                        1e-5f);
                } else {
                    ++overlapping;
                    const LibccdResult ccd = LibccdPenetration(*a.shape, *b.shape, pose, 0, LibccdAlgorithm::Epa);
                    if (ccd.status != LibccdResult::Status::Found) continue;
                    // Its own depth is not always that of its direction; ours is the least to 3e-5 of the size.
                    shallow +=
                        found.distance < SeparationAlong(*a.shape, *b.shape, pose, ccd.normal.cast<float>()) - 2e-4;
                }
            }
        }
    }
    EXPECT_GT(apart, Cases(50000));
    EXPECT_GT(overlapping, Cases(10000));
    EXPECT_LE(shallow, overlapping / 5000 + 1);
    std::printf("  %d apart, %d overlapping, %d deeper than libccd's\n", apart, overlapping, shallow);
}

TEST(Distance, OfCompoundsAndSurfacesIsThatOfTheirClosestParts) {
    RandomPoses random(22);
    const auto compound = MakeCompound(random, 20, 2), second = MakeCompound(random, 6, 1);
    const auto terrain = MakeTerrain(8, 0.6f, [](float x, float z) { return 0.3f * std::sin(3 * x) + 0.2f * z; });
    const std::vector<NamedShape> shapes = QueryShapes();
    for (int i = 0; i < 1500; ++i) {
        const RelativePose pose{random.InCube() * 5, random.Rotation()};
        const ConvexShape& convex = *shapes[static_cast<size_t>(i) % shapes.size()].shape;
        float best = 1e9f, bestOfTwo = 1e9f, bestOfTerrain = 1e9f;
        for (const Compound::Child& child : compound->Children()) {
            const auto measure = [&](const ConvexShape& other, const RelativePose& at) {
                return MeasureConvex(*child.shape, other, Inverse(child.pose) * at, 1e6f).separation;
            };
            best = std::min(best, measure(convex, pose));
            for (const Compound::Child& other : second->Children())
                bestOfTwo = std::min(bestOfTwo, measure(*other.shape, pose * other.pose));
        }
        for (uint32_t t = 0; t < terrain->TriangleCount(); ++t) {
            const TriangleCore triangle(terrain->GetTriangle(t), Vector3::Zero());
            bestOfTerrain = std::min(bestOfTerrain, MeasureConvex(triangle, convex, pose, 1e6f).separation);
        }
        ClosestPoints found;
        // Depths are exact to 3e-5 of sizes of up to 7 m; positions in another frame round by 1e-6.
        ASSERT_TRUE(FindClosestPoints(*compound, convex, pose, 1000, found));
        EXPECT_NEAR(found.distance, best, 2e-4f) << i;
        ASSERT_TRUE(FindClosestPoints(convex, *compound, Inverse(pose), 1000, found));
        EXPECT_NEAR(found.distance, best, 2e-4f) << i;
        ASSERT_TRUE(FindClosestPoints(*compound, *second, pose, 1000, found));
        EXPECT_NEAR(found.distance, bestOfTwo, 2e-4f) << i;
        ASSERT_TRUE(FindClosestPoints(*terrain, convex, pose, 1000, found));
        if (bestOfTerrain > 0) {
            EXPECT_NEAR(found.distance, bestOfTerrain, 2e-5f) << i;
        }
        EXPECT_EQ(FindClosestPoints(*compound, convex, pose, best - 1e-3f, found), false) << i;
        if (std::abs(best) > 1e-4f) {
            EXPECT_EQ(Overlap(*compound, convex, pose), best < 0);
        }
    }
}

TEST(Distance, PointsInsideAreInside) {
    RandomPoses random(23);
    const ConvexPtr box = MakeBox(Vector3(0.5f, 0.4f, 0.7f));
    const auto terrain = MakeTerrain(4, 1, [](float, float) { return 0.0f; });
    for (int i = 0; i < 20000; ++i) {
        const Vector3 p = random.InCube();
        const float outside = Vector3(p.cwiseAbs() - Vector3(0.5f, 0.4f, 0.7f)).maxCoeff();
        if (std::abs(outside) > 1e-5f) {
            EXPECT_EQ(Contains(*box, p), outside < 0);
        }
        ClosestPoints found;
        ASSERT_TRUE(FindClosestPoint(*terrain, p, 10, found));
        EXPECT_NEAR(found.distance, std::abs(p.y()), 1e-5f);
        EXPECT_FALSE(Contains(*terrain, p));
    }
    ClosestPoints found;
    EXPECT_FALSE(FindClosestPoint(*box, Vector3(std::numeric_limits<float>::quiet_NaN(), 0, 0), 10, found));
    EXPECT_FALSE(FindClosestPoint(*box, Vector3(3, 0, 0), 1, found));
}

}  // namespace
}  // namespace fulcrum::testing
