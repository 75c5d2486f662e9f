#include <Fulcrum/Collision/Shapes/HullBuilder.h>

#include <Fulcrum/UnitTests/Collision/Shapes/PointSets.h>
#include <Fulcrum/UnitTests/Collision/Shapes/QhullVolume.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <gtest/gtest.h>

#include <cmath>

namespace fulcrum {
namespace {

using test::MakePointSet;
using test::PointSet;

constexpr int kUnlimited = 1 << 20;

// Twice the distance that the input's rounding may account for, from Quickhull.h; thinner sets are refused.
double LeastThickness(std::span<const Position> points) {
    Position largest = Position::Zero();
    for (const Position& p : points) largest = largest.cwiseMax(p.cwiseAbs());
    return 4 * 0x1p-24 * largest.sum();
}

double Diameter(std::span<const Position> points) {
    Position lower = points[0], upper = points[0];
    for (const Position& p : points) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
    }
    return (upper - lower).norm();
}

// How far a point lies outside a face, and a face's corner from its plane, at most.
struct Deviations {
    double outside = 0, unevenness = 0;
};
Deviations Measure(const HullMesh& mesh, std::span<const Position> points) {
    Deviations d;
    for (const HullMesh::Face& face : mesh.faces) {
        for (const Position& p : points) d.outside = std::max(d.outside, face.normal.dot(p) - face.offset);
        for (int i = 0; i < face.corners.cornerCount; ++i) {
            const Position& corner = mesh.vertices[mesh.indices[face.corners.firstIndex + i]];
            d.unevenness = std::max(d.unevenness, face.offset - face.normal.dot(corner));
        }
    }
    return d;
}

TEST(HullBuilder, AgreesWithQhullOnTenThousandPointSets) {
    constexpr int kSetsPerKind = testing::Cases(800);
    int built = 0, refused = 0;
    for (int kind = 0; kind < static_cast<int>(PointSet::Count); ++kind) {
        for (int seed = 0; seed < kSetsPerKind; ++seed) {
            SCOPED_TRACE("kind " + std::to_string(kind) + " seed " + std::to_string(seed));
            const std::vector<Position> points = test::ToPositions(MakePointSet(static_cast<PointSet>(kind), seed));
            const Result<HullMesh> hull = BuildHull(points, {kUnlimited, kUnlimited});
            const std::optional<test::HullSize> expected = test::QhullSize(points);
            if (!hull) {
                // Its thickness is at most that below and above the plane of the first three points.
                const double diameter = Diameter(points);
                EXPECT_LE(expected ? expected->volume : 0, 2 * LeastThickness(points) * diameter * diameter);
                ++refused;
                continue;
            }
            ++built;
            const HullMesh& mesh = hull.Value();
            ASSERT_TRUE(IsClosedPolyhedron(mesh));
            // Sums of products of coordinates: rounding of the measurement itself.
            const double rounding = 1e-15 * points[0].norm() + 4e-12 * Diameter(points);
            const Deviations deviations = Measure(mesh, points);
            EXPECT_LE(deviations.outside, 3 * mesh.tolerance + rounding);
            EXPECT_LE(deviations.unevenness, mesh.tolerance + rounding);
            // The exact hull lies within the faces moved outwards by 3 tolerances.
            if (!expected) continue;
            const double volume = mesh.Mass().volume;
            EXPECT_NEAR(volume, expected->volume, (3 * mesh.tolerance + rounding) * expected->area);
        }
    }
    // Kinds with four random points may be thin by chance, and the flattest have few points that reach out of the
    // plane.
    EXPECT_GT(built, 50 * refused);
}

TEST(HullBuilder, MergesGridsOfABoxIntoSixQuadrilaterals) {
    for (const PointSet kind : {PointSet::BoxGrid, PointSet::TurnedBoxGrid}) {
        for (int seed = 0; seed < 200; ++seed) {
            const std::vector<Position> points = test::ToPositions(MakePointSet(kind, seed));
            const Result<HullMesh> hull = BuildHull(points);
            ASSERT_TRUE(hull);
            EXPECT_EQ(hull.Value().vertices.size(), 8u);
            ASSERT_EQ(hull.Value().faces.size(), 6u);
            for (const HullMesh::Face& face : hull.Value().faces) EXPECT_EQ(face.corners.cornerCount, 4);
        }
    }
}

TEST(HullBuilder, CopiesAtATenMillionthAddNoVertex) {
    std::vector<Position> points;
    test::Random random(7);
    for (const Vector3& corner : test::BoxCorners(Vector3(1, 1, 1)))
        for (int copy = 0; copy < 20; ++copy) points.push_back(corner.cast<double>() + random.InCube() * 1e-7);
    const Result<HullMesh> hull = BuildHull(points);
    ASSERT_TRUE(hull);
    EXPECT_EQ(hull.Value().vertices.size(), 8u);
    EXPECT_EQ(hull.Value().faces.size(), 6u);
}

TEST(HullBuilder, VertexLimitKeepsTheHullInsideAndMostOfItsVolume) {
    test::Random random(3);
    std::vector<Position> points;
    for (int i = 0; i < 3000; ++i) points.push_back(random.OnSphere());
    const Result<HullMesh> exact = BuildHull(points, {kUnlimited, kUnlimited});
    ASSERT_TRUE(exact);
    double previous = 0;
    for (const int limit : {4, 8, 16, 32, 64, 128, 255}) {
        const Result<HullMesh> hull = BuildHull(points, {.maxVertices = limit});
        ASSERT_TRUE(hull);
        const HullMesh& mesh = hull.Value();
        EXPECT_TRUE(IsClosedPolyhedron(mesh));
        EXPECT_LE(static_cast<int>(mesh.vertices.size()), limit);
        EXPECT_LE(mesh.faces.size(), 255u);
        for (const Position& v : mesh.vertices) EXPECT_NEAR(Measure(exact.Value(), std::span(&v, 1)).outside, 0, 1e-6);
        const double volume = mesh.Mass().volume;
        EXPECT_GT(volume, previous);
        previous = volume;
        // n vertices make 2 (n - 2) triangles of area a = 4 pi / (2 (n - 2)); the cap above an equilateral one is
        // a / (2 sqrt 3) high on average. So the best polytope loses sqrt 3 pi / (n - 2) of the ball; the greedy choice
        // is allowed half as much again.
        if (limit < 32) continue;
        const double loss = std::sqrt(3.0) * test::kPi / (static_cast<double>(mesh.vertices.size()) - 2);
        EXPECT_GT(volume, exact.Value().Mass().volume * (1 - 1.5 * loss));
    }
}

TEST(HullBuilder, IsTheSameWhateverTheScale) {
    // Powers of two scale exactly, so the meshes must be equal bit by bit but for the scale.
    std::vector<Position> points = test::ToPositions(MakePointSet(PointSet::InBall, 1)), scaled = points;
    for (Position& p : scaled) p *= 0x1p-30;
    const Result<HullMesh> a = BuildHull(points), b = BuildHull(scaled);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a.Value().indices, b.Value().indices);
    EXPECT_EQ(a.Value().sources, b.Value().sources);
    EXPECT_EQ(a.Value().tolerance * 0x1p-30, b.Value().tolerance);
}

TEST(Quickhull, OrientationIsExactWhereDoublesAreNot) {
    // Of two planes through nearly the same points: the determinant of the last is 1 of products near 2^123.
    const double big = 0x1p40;
    const Position a(-big, -big, -big), b(big, big, big), c(big, big - 1, big);
    EXPECT_EQ(ExactOrientation(a, b, c, Position(0, 0, 0)), 0);
    EXPECT_EQ(ExactOrientation(a, b, c, Position(1, 0, 0)), -ExactOrientation(a, b, c, Position(-1, 0, 0)));
    EXPECT_NE(ExactOrientation(a, b, c, Position(1, 0, 0)), 0);
    EXPECT_EQ(ExactOrientation(Position(0, 0, 0), Position(1, 0, 0), Position(0, 1, 0), Position(0, 0, 1)), 1);
}

}  // namespace
}  // namespace fulcrum
