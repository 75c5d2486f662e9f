// GJK and EPA against the full separating axis test.
#include "NarrowPhaseTesting.h"

#include <Fulcrum/Collision/NarrowPhase/AxisSearch.h>
#include <Fulcrum/Collision/NarrowPhase/Epa.h>
#include <Fulcrum/Collision/NarrowPhase/Gjk.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

TEST(Epa, FindsTheDepthThatTheSearchThroughAllAxesFinds) {
    const std::vector<NamedShape> shapes = {{"box", MakeBox(Vector3(0.5f, 0.4f, 0.7f))},
                                            {"capsule", MakeCapsule(0.5f, 0.25f)},
                                            {"hull", MakeRoundHull(32, 0.6f)},
                                            {"prism", MakePrism(8, 0.5f, 0.4f)}};
    RandomPoses random(2);
    int overlapping = 0, gaveUp = 0;
    for (const NamedShape& a : shapes) {
        for (const NamedShape& b : shapes) {
            if (a.name == "capsule" && b.name == "capsule") continue;  // two segments have no volume between them
            PolyhedronStorage storageA, storageB;
            const Polyhedron coreA = CoreOf(*a.shape, storageA), coreB = CoreOf(*b.shape, storageB);
            for (int i = 0; i < 1000; ++i) {
                RelativePose pose{random.InCube(), i % 3 == 0 ? random.QuarterTurns() : random.Rotation()};
                const PolyhedronPair pair(coreA, coreB, pose);
                const GjkResult<MinkowskiVertex> gjk = Gjk(pair, Normalized(pose.position), 0.02f);
                const FoundAxis search = SearchAllAxes(pair);
                if (gjk.status != GjkStatus::Overlapping) {
                    // The face and edge axes find no more than the distance, which GJK finds.
                    EXPECT_GT(gjk.separation, -1e-5f);
                    EXPECT_GE(gjk.separation, std::min(search.separation, 0.02f) - 1e-5f)
                        << a.name << " " << b.name << " " << i;
                    continue;
                }
                ++overlapping;
                EXPECT_LE(search.separation, 1e-5f);
                const EpaResult epa = Epa(pair, gjk.simplex);
                if (epa.status != EpaResult::Status::Found) {
                    ++gaveUp;
                    continue;
                }
                // Both to a few roundings of positions of about 2 m.
                EXPECT_NEAR(epa.separation, search.separation, 2e-5f) << a.name << " " << b.name << " " << i;
            }
        }
    }
    EXPECT_GT(overlapping, 3000);
    // If it gives up, the full separating axis test is used, 100 times slower.
    EXPECT_LE(gaveUp, overlapping / 50);
    RecordProperty("overlapping", overlapping);
    RecordProperty("gaveUp", gaveUp);
    std::printf("  EPA gave up in %d of %d overlaps\n", gaveUp, overlapping);
}

// GJK ends with fewer than four vertices where the origin lies on them: a corner, the middle of a diagonal, a triangle
// with that for a side. EPA adds what is missing. Two boxes of half sizes h about one center: their difference is a box
// of 2 h, its least depth that of the smallest, and v and -v are corners of it.
TEST(Epa, GrowsASimplexOfFewerThanFourVertices) {
    const Vector3 half(0.5f, 0.4f, 0.7f);
    const ConvexPtr box = MakeBox(half);
    PolyhedronStorage storageA, storageB;
    const Polyhedron coreA = CoreOf(*box, storageA), coreB = CoreOf(*box, storageB);
    const PolyhedronPair inside(coreA, coreB, {Vector3::Zero(), {}});
    const Vector3 diagonals[] = {{1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {1, 1, -1}};
    for (const Vector3& diagonal : diagonals) {
        Simplex<MinkowskiVertex> simplex;
        simplex.vertices[0] = inside.Support(diagonal);
        simplex.vertices[1] = inside.Support(-diagonal);
        simplex.vertices[2] = inside.Support(Vector3(-diagonal.x(), diagonal.y(), diagonal.z()));
        for (int count = 2; count <= 3; ++count) {
            simplex.count = count;
            const EpaResult epa = Epa(inside, simplex);
            ASSERT_EQ(epa.status, EpaResult::Status::Found) << count;
            EXPECT_NEAR(epa.separation, -0.8f, 1e-6f);
            EXPECT_NEAR(std::abs(epa.axis.y()), 1, 1e-6f);
        }
        // Moved by 2 h along the diagonal they touch with a corner, the vertex 0 of the difference.
        const PolyhedronPair touching(coreA, coreB, {2 * diagonal.cwiseProduct(half), {}});
        simplex.vertices[0] = touching.Support(diagonal);
        simplex.count = 1;
        EXPECT_LT(Length(simplex.vertices[0].w), 1e-6f);
        const EpaResult epa = Epa(touching, simplex);
        ASSERT_EQ(epa.status, EpaResult::Status::Found);
        EXPECT_NEAR(epa.separation, 0, 1e-6f);
    }
    // Two triangles in one plane have no volume between them: nothing grows.
    const Vector3 corners[3] = {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}};
    const Polyhedron triangle = CoreOf(corners, Vector3(0, -1, 0), 0, storageA);
    const PolyhedronPair flat(triangle, triangle, {Vector3(0.1f, 0, 0.1f), {}});
    Simplex<MinkowskiVertex> simplex;
    simplex.vertices[0] = flat.Support(Vector3(1, 0, 0));
    simplex.count = 1;
    EXPECT_EQ(Epa(flat, simplex).status, EpaResult::Status::Failed);
}

// The separating axis test is used if EPA gives up, mostly for flat shapes: no direction may separate better than its
// axis.
TEST(AxisSearch, FindsTheBestOfAllDirectionsForFlatPolyhedraToo) {
    const std::vector<NamedShape> shapes = {
        {"triangle",
         Triangle::Create(Vector3(-0.6f, 0, -0.5f), Vector3(0.7f, 0.1f, -0.4f), Vector3(0, 0, 0.8f)).Value()},
        {"needle", Triangle::Create(Vector3(-1, 0, 0), Vector3(1, 0, 0), Vector3(0, 0, 1e-3f)).Value()},
        {"plate", MakeBox(Vector3(0.5f, 1e-3f, 0.4f))},
        {"hull", MakeRoundHull(16, 0.6f)}};
    RandomPoses random(4);
    for (const NamedShape& a : shapes) {
        for (const NamedShape& b : shapes) {
            PolyhedronStorage storageA, storageB;
            const Polyhedron coreA = CoreOf(*a.shape, storageA), coreB = CoreOf(*b.shape, storageB);
            for (int i = 0; i < Cases(100); ++i) {
                const RelativePose pose{random.InCube() * 0.4f, i % 3 == 0 ? random.QuarterTurns() : random.Rotation()};
                const PolyhedronPair pair(coreA, coreB, pose);
                const FoundAxis found = SearchAllAxes(pair);
                ASSERT_NEAR(Length(found.axis), 1, 1e-5f) << a.name << " " << b.name << " " << i;
                EXPECT_NEAR(pair.SeparationAlong(found.axis), found.separation, 1e-6f)
                    << a.name << " " << b.name << " " << i;
                // Of two that are apart it finds the best of the axes of faces and edges, which says no more than that
                // they are.
                if (found.separation > 0) continue;
                for (int k = 0; k < 300; ++k)
                    EXPECT_LE(pair.SeparationAlong(random.Direction()), found.separation + 1e-6f)
                        << a.name << " " << b.name << " " << i;
            }
        }
    }
}

TEST(AxisSearch, ATriangleInABoxIsPushedOutTheNearestWay) {
    const ConvexPtr box = MakeBox(Vector3(1, 0.5f, 1));
    PolyhedronStorage storageA, storageB;
    const Polyhedron coreA = CoreOf(*box, storageA);
    const Vector3 corners[3] = {{-0.3f, 0, -0.2f}, {0.3f, 0, -0.2f}, {0, 0, 0.4f}};
    const Polyhedron coreB = CoreOf(corners, Vector3(0, -1, 0), 0, storageB);
    for (const float height : {0.3f, -0.45f, 0.5f}) {
        const FoundAxis found = SearchAllAxes(PolyhedronPair(coreA, coreB, {Vector3(0.1f, height, 0.1f), {}}));
        EXPECT_NEAR(found.separation, std::abs(height) - 0.5f, 1e-6f);
        EXPECT_NEAR(found.axis.y(), height > 0 ? 1 : -1, 1e-6f);
    }
}

}  // namespace
}  // namespace fulcrum::testing
