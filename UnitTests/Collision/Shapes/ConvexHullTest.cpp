#include <Fulcrum/Collision/Shapes/ConvexHull.h>

#include <Fulcrum/UnitTests/Collision/Shapes/PointSets.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <set>

namespace fulcrum {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();

Error Refusal(const std::vector<Vector3>& points, const ConvexHullSettings& settings = {}) {
    const auto hull = ConvexHull::Create(points, settings);
    EXPECT_FALSE(hull);
    return hull ? Error{ErrorCode::UnknownId, ""} : hull.GetError();
}
bool Contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

TEST(ConvexHull, RefusesPointsWithoutVolumeAndSaysWhy) {
    const std::vector<Vector3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (size_t count = 0; count <= 3; ++count) {
        const Error error = Refusal({corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(count)});
        EXPECT_EQ(error.code, ErrorCode::Degenerate);
        EXPECT_TRUE(Contains(error.message, (std::to_string(count) + " points").c_str()));
    }
    EXPECT_TRUE(Contains(Refusal(std::vector<Vector3>(9, Vector3(1, 2, 3))).message, "the 9 points coincide"));
    std::vector<Vector3> nearly, line, plane;
    test::Random random(4);
    const Quaternion turn = random.Rotation();
    for (int i = 0; i < 50; ++i) {
        nearly.push_back(Vector3(1, 1, 1) + (random.InCube() * 1e-7).cast<float>());
        line.push_back(Rotate(turn, Vector3(static_cast<float>(random.Symmetric()), 0, 0)) + Vector3(1, 2, 3));
        plane.push_back(Rotate(turn, random.InCube().cast<float>().cwiseProduct(Vector3(1, 1, 0))));
    }
    EXPECT_TRUE(Contains(Refusal(nearly).message, "coincide"));
    EXPECT_TRUE(Contains(Refusal(line).message, "collinear"));
    EXPECT_TRUE(Contains(Refusal(plane).message, "coplanar"));
    EXPECT_EQ(Refusal(plane).code, ErrorCode::Degenerate);
}

TEST(ConvexHull, RefusesNumbersThatAreNotFinite) {
    for (const float bad : {kNaN, kInfinity, -kInfinity}) {
        std::vector<Vector3> points = test::BoxCorners(Vector3(1, 1, 1));
        points[5].y() = bad;
        const Error error = Refusal(points);
        EXPECT_EQ(error.code, ErrorCode::NonFinite);
        EXPECT_TRUE(Contains(error.message, "point 5"));
        EXPECT_EQ(Refusal(test::BoxCorners(Vector3(1, 1, 1)), {.convexRadius = bad}).code, ErrorCode::NonFinite);
    }
}

TEST(ConvexHull, RefusesSettingsOutOfRange) {
    const std::vector<Vector3> box = test::BoxCorners(Vector3(1, 2, 3));
    EXPECT_EQ(Refusal(box, {.maxVertices = 3}).code, ErrorCode::OutOfRange);
    EXPECT_EQ(Refusal(box, {.maxVertices = 256}).code, ErrorCode::OutOfRange);
    EXPECT_EQ(Refusal(box, {.convexRadius = -0.1f}).code, ErrorCode::OutOfRange);
    EXPECT_EQ(Refusal(box, {.convexRadius = 1}).code, ErrorCode::OutOfRange);
    EXPECT_TRUE(Contains(Refusal(box, {.convexRadius = 2}).message, "inner radius, 1 m"));
}

TEST(ConvexHull, RefusesSizesWhoseInertiaIsNoNormalFloat) {
    EXPECT_EQ(Refusal(test::BoxCorners(Vector3(1, 1, 1) * 1e-9f)).code, ErrorCode::OutOfRange);
    EXPECT_EQ(Refusal(test::BoxCorners(Vector3(1, 1, 1) * 1e30f)).code, ErrorCode::OutOfRange);
    EXPECT_TRUE(ConvexHull::Create(test::BoxCorners(Vector3(1, 1, 1) * 1e-7f)));
    EXPECT_TRUE(ConvexHull::Create(test::BoxCorners(Vector3(1, 1, 1) * 1e6f)));
}

// Faces, edges, vertices and lanes are consistent, whatever the points.
void ExpectConsistent(const ConvexHull& hull) {
    const auto vertices = hull.Vertices();
    const auto faces = hull.Faces();
    ASSERT_EQ(vertices.size() + faces.size(), hull.Edges().size() + 2);
    const float size = hull.OuterRadius();
    std::set<std::pair<int, int>> halves;
    for (size_t f = 0; f < faces.size(); ++f) {
        EXPECT_GT(faces[f].offset, 0);
        EXPECT_NEAR(Length(faces[f].normal), 1, 2e-7);
        // Rounded once each: the normal's and the vertex's components, the offset.
        for (const Vector3& v : vertices) EXPECT_LE(Dot(faces[f].normal, v), faces[f].offset + 5e-7f * size);
        for (int i = 0; i < faces[f].cornerCount; ++i) {
            const int from = hull.Indices()[faces[f].firstIndex + i];
            const int to = hull.Indices()[faces[f].firstIndex + (i + 1) % faces[f].cornerCount];
            halves.insert({from, to});
        }
    }
    EXPECT_EQ(halves.size(), 2 * hull.Edges().size());
    for (const ConvexHull::Edge& edge : hull.Edges()) {
        EXPECT_TRUE(halves.count({edge.from, edge.to}) == 1 && halves.count({edge.to, edge.from}) == 1);
        const auto runsAlong = [&](int face, int from, int to) {
            for (int i = 0; i < faces[face].cornerCount; ++i) {
                if (hull.Indices()[faces[face].firstIndex + i] != from) continue;
                return hull.Indices()[faces[face].firstIndex + (i + 1) % faces[face].cornerCount] == to;
            }
            return false;
        };
        EXPECT_TRUE(runsAlong(edge.left, edge.from, edge.to));
        EXPECT_TRUE(runsAlong(edge.right, edge.to, edge.from));
    }
    ASSERT_EQ(hull.PaddedVertexCount() % 16, 0);
    ASSERT_GE(hull.PaddedVertexCount(), static_cast<int>(vertices.size()));
    EXPECT_EQ(reinterpret_cast<uintptr_t>(hull.LaneX()) % 64, 0u);
    EXPECT_EQ(reinterpret_cast<uintptr_t>(hull.LaneY()) % 64, 0u);
    for (int i = 0; i < hull.PaddedVertexCount(); ++i) {
        const Vector3& v = vertices[i < static_cast<int>(vertices.size()) ? i : 0];
        EXPECT_EQ(Vector3(hull.LaneX()[i], hull.LaneY()[i], hull.LaneZ()[i]), v);
    }
}

TEST(ConvexHull, IsConsistentForAllKindsOfPoints) {
    for (int kind = 0; kind < static_cast<int>(test::PointSet::Count); ++kind) {
        for (int seed = 0; seed < 40; ++seed) {
            SCOPED_TRACE("kind " + std::to_string(kind) + " seed " + std::to_string(seed));
            const auto points = test::MakePointSet(static_cast<test::PointSet>(kind), seed);
            const auto hull = ConvexHull::Create(points, {.maxVertices = 4 + seed});
            if (!hull) continue;
            ExpectConsistent(*hull.Value());
            EXPECT_LE(hull.Value()->Vertices().size(), static_cast<size_t>(4 + seed));
        }
    }
}

TEST(ConvexHull, FitsItsIndicesWithTheLargestVertexLimit) {
    // 255 vertices in general position would have 506 faces; faces count to 255 too.
    const auto hull = ConvexHull::Create(test::FibonacciSphere(3000, 1), {.maxVertices = 255}).Value();
    ExpectConsistent(*hull);
    EXPECT_LE(hull->Faces().size(), 255u);
    EXPECT_GE(hull->Vertices().size(), 120u);
}

TEST(ConvexHull, SupportIsTheFarthestVertexAndTheFirstOfEquals) {
    test::Random random(6);
    for (int seed = 0; seed < 50; ++seed) {
        const auto hull = ConvexHull::Create(test::MakePointSet(test::PointSet::OnSphere, seed)).Value();
        for (int i = 0; i < 100; ++i) {
            const Vector3 direction = random.InBall().cast<float>();
            size_t best = 0;
            for (size_t v = 1; v < hull->Vertices().size(); ++v)
                if (Dot(hull->Vertices()[v], direction) > Dot(hull->Vertices()[best], direction)) best = v;
            EXPECT_EQ(hull->SupportCore(direction), hull->Vertices()[best]);
        }
    }
    const auto box = ConvexHull::Create(test::BoxCorners(Vector3(1, 1, 1))).Value();
    size_t first = 0;
    while (box->Vertices()[first].y() < 0) ++first;
    EXPECT_EQ(box->SupportCore(Vector3(0, 2, 0)), box->Vertices()[first]);
    EXPECT_TRUE(IsFinite(box->SupportCore(Vector3(kNaN, 0, 0))));
}

TEST(ConvexHull, CenterFrameIsTheUsersFrameMovedToTheCenterOfMass) {
    const Vector3 offset(10, -20, 5);
    std::vector<Vector3> points = test::BoxCorners(Vector3(1, 2, 3));
    for (Vector3& p : points) p += offset;
    const auto hull = ConvexHull::Create(points).Value();
    EXPECT_LT(Length(hull->Mass().centerOfMass - offset), 1e-5f);
    for (const Vector3& v : hull->Vertices()) EXPECT_LT(Length(v.cwiseAbs() - Vector3(1, 2, 3)), 1e-5f);
    EXPECT_LT(Length(hull->LocalBounds().upper - Vector3(1, 2, 3)), 1e-5f);
    EXPECT_NEAR(hull->InnerRadius(), 1, 1e-5);
}

TEST(ConvexHull, ConvexRadiusRoundsWithinTheSharpHull) {
    test::Random random(8);
    for (int seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        const auto points = test::MakePointSet(seed % 2 ? test::PointSet::TurnedPrism : test::PointSet::InBall, seed);
        const auto sharp = ConvexHull::Create(points).Value();
        const float radius = sharp->InnerRadius() * (0.1f + 0.8f * static_cast<float>(random.Unit()));
        // Corners of many faces split into several, so the core needs more vertices than the hull.
        const auto rounded = ConvexHull::Create(points, {.maxVertices = 255, .convexRadius = radius});
        ASSERT_TRUE(rounded) << rounded.GetError().message;
        const ConvexHull& hull = *rounded.Value();
        ExpectConsistent(hull);
        EXPECT_EQ(hull.ConvexRadius(), radius);
        EXPECT_EQ(hull.Mass().volume, sharp->Mass().volume);
        for (const Vector3& v : hull.Vertices())
            for (const ConvexHull::Face& face : sharp->Faces())
                EXPECT_LE(Dot(face.normal, v) + radius, face.offset + 2e-6f);
        // The sphere about the center touches the same face before and after.
        EXPECT_NEAR(hull.InnerRadius(), sharp->InnerRadius(), 2e-6f);
        EXPECT_LE(hull.OuterRadius(), sharp->OuterRadius() + 1e-6f);
        EXPECT_TRUE(sharp->LocalBounds().upper.x() + 1e-6f >= hull.LocalBounds().upper.x());
    }
}

TEST(ConvexHull, ConvexRadiusOfABoxLeavesABox) {
    const auto hull = ConvexHull::Create(test::BoxCorners(Vector3(1, 2, 3)), {.convexRadius = 0.25f}).Value();
    EXPECT_EQ(hull->Vertices().size(), 8u);
    EXPECT_EQ(hull->Faces().size(), 6u);
    EXPECT_LT(Length(hull->SupportCore(Vector3(1, 1, 1)) - Vector3(0.75f, 1.75f, 2.75f)), 1e-6f);
    EXPECT_NEAR(hull->InnerRadius(), 1, 1e-6);
    EXPECT_LT(Length(hull->LocalBounds().upper - Vector3(1, 2, 3)), 1e-6f);
}

}  // namespace
}  // namespace fulcrum
