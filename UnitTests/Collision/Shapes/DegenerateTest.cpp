// Degenerate input (no volume, no area, NaN): repaired, with a report, or refused with the reason. A table for each
// kind; details are in the tests of the shapes.
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>

namespace fulcrum {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinite = std::numeric_limits<float>::infinity();

// The result of Create.
struct Answer {
    ShapePtr shape;  // null: refused
    ErrorCode code{};
    std::string message;
};

template <class T>
Answer AnswerOf(const Result<T>& result) {
    if (result) return {result.Value(), {}, ""};
    return {nullptr, result.GetError().code, result.GetError().message};
}

struct Case {
    const char* name;
    std::function<Answer()> create;
    std::optional<ErrorCode> refusal;  // none: it is repaired, or valid
    const char* reason = "";           // part of the message
};

void CheckCases(std::initializer_list<Case> cases) {
    for (const Case& c : cases) {
        const Answer answer = c.create();
        if (!c.refusal) {
            ASSERT_NE(answer.shape, nullptr) << c.name << ": " << answer.message;
            EXPECT_TRUE(IsFinite(answer.shape->LocalBounds().lower) && IsFinite(answer.shape->LocalBounds().upper))
                << c.name;
            continue;
        }
        ASSERT_EQ(answer.shape, nullptr) << c.name;
        EXPECT_EQ(answer.code, *c.refusal) << c.name << ": " << answer.message;
        EXPECT_NE(answer.message.find(c.reason), std::string::npos) << c.name << ": " << answer.message;
    }
}

using Points = std::vector<Vector3>;

Answer HullOf(const Points& points) { return AnswerOf(ConvexHull::Create(points)); }

Points Line(int count) {
    Points points;
    for (int i = 0; i < count; ++i) points.push_back(Vector3(0.3f, -0.2f, 0.7f) * static_cast<float>(i));
    return points;
}
Points Disc(int count, const Vector3& u, const Vector3& v) {
    Points points;
    for (int i = 0; i < count; ++i) {
        const double angle = 6.283185307 * i / count;
        points.push_back(u * static_cast<float>(std::cos(angle)) + v * static_cast<float>(std::sin(angle)));
    }
    return points;
}
const Points kTetrahedron = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

TEST(Degenerate, HullsWithoutVolumeAreRefusedWithTheReason) {
    CheckCases({
        {"no point", [] { return HullOf({}); }, ErrorCode::Degenerate, "0 points"},
        {"one point",
         [] {
             return HullOf({{1, 2, 3}});
         },
         ErrorCode::Degenerate, "1 point"},
        {"two points",
         [] {
             return HullOf({{1, 2, 3}, {0, 0, 0}});
         },
         ErrorCode::Degenerate, "2 points"},
        {"three points",
         [] {
             return HullOf({{1, 2, 3}, {0, 0, 0}, {1, 0, 0}});
         },
         ErrorCode::Degenerate, "3 points"},
        {"one point a hundred times", [] { return HullOf(Points(100, Vector3(1, 2, 3))); }, ErrorCode::Degenerate,
         "coincide"},
        {"collinear", [] { return HullOf(Line(20)); }, ErrorCode::Degenerate, "line"},
        {"coplanar", [] { return HullOf(Disc(20, Vector3(1, 0, 0), Vector3(0, 1, 0))); }, ErrorCode::Degenerate,
         "plane"},
        {"coplanar and slanting", [] { return HullOf(Disc(20, Vector3(0.6f, 0.8f, 0), Vector3(0, 0, 1))); },
         ErrorCode::Degenerate, "plane"},
        {"coplanar but for a rounding",
         [] {
             Points points = Disc(20, Vector3(1, 0, 0), Vector3(0, 1, 0));
             points[7].z() = 1e-8f;
             return HullOf(points);
         },
         ErrorCode::Degenerate, "plane"},
        {"not a number",
         [] {
             return HullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, kNan, 1}});
         },
         ErrorCode::NonFinite, "3"},
        {"infinite",
         [] {
             return HullOf({{0, 0, 0}, {1, 0, kInfinite}, {0, 1, 0}, {0, 0, 1}});
         },
         ErrorCode::NonFinite, "1"},
        {"four points", [] { return HullOf(kTetrahedron); }, {}},
    });
}

TEST(Degenerate, CopiesOfPointsAtATenMillionthAreRepaired) {
    Points points = kTetrahedron;
    for (int i = 0; i < 40; ++i)
        points.push_back(kTetrahedron[static_cast<size_t>(i) % 4] +
                         Vector3(1e-7f, -1e-7f, 1e-7f) * static_cast<float>(i % 3 - 1));
    const auto hull = ConvexHull::Create(points);
    ASSERT_TRUE(hull);
    EXPECT_EQ(hull.Value()->Vertices().size(), 4u);
    EXPECT_EQ(hull.Value()->Faces().size(), 4u);
    EXPECT_NEAR(hull.Value()->Mass().volume, 1.0f / 6, 1e-6f);
}

Answer MeshOf(const Points& vertices, const std::vector<uint32_t>& indices, MeshReport* report = nullptr) {
    return AnswerOf(TriangleMesh::Create({.vertices = vertices, .indices = indices}, report));
}

TEST(Degenerate, MeshesWithNothingLeftAreRefusedWithTheReason) {
    const Points square = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}};
    CheckCases({
        {"no triangle", [&] { return MeshOf(square, {}); }, ErrorCode::Degenerate, ""},
        {"no vertex",
         [] {
             return MeshOf({}, {0, 1, 2});
         },
         ErrorCode::OutOfRange, ""},
        {"two thirds of a triangle",
         [&] {
             return MeshOf(square, {0, 1});
         },
         ErrorCode::Degenerate, ""},
        {"an index too large",
         [&] {
             return MeshOf(square, {0, 1, 4});
         },
         ErrorCode::OutOfRange, "4"},
        {"one vertex three times",
         [&] {
             return MeshOf(square, {1, 1, 1});
         },
         ErrorCode::Degenerate, ""},
        {"on a line",
         [] {
             return MeshOf(Line(3), {0, 1, 2});
         },
         ErrorCode::Degenerate, ""},
        {"not a number",
         [] {
             return MeshOf({{0, 0, 0}, {1, 0, 0}, {0, kNan, 1}}, {0, 1, 2});
         },
         ErrorCode::NonFinite, "2"},
        {"infinite",
         [] {
             return MeshOf({{0, kInfinite, 0}, {1, 0, 0}, {0, 0, 1}}, {0, 1, 2});
         },
         ErrorCode::NonFinite, "0"},
        {"a square",
         [&] {
             return MeshOf(square, {0, 2, 1, 1, 2, 3});
         },
         {}},
    });
}

TEST(Degenerate, MeshesAreRepairedAndSayHow) {
    // A square; below it a triangle without area, a needle of no height, the first triangle again, and one of a vertex
    // that coincides with another but for a ten-millionth.
    const Points vertices = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}, {0.5f, 0, 0}, {0, 0, 1.00000005f}, {7, 7, 7}};
    const std::vector<uint32_t> indices = {0, 2, 1, 1, 2, 3, 0, 0, 1, 0, 4, 1, 2, 1, 0, 0, 5, 1};
    MeshReport report;
    const Answer answer = MeshOf(vertices, indices, &report);
    ASSERT_NE(answer.shape, nullptr) << answer.message;
    EXPECT_FALSE(report.IsClean());
    EXPECT_EQ(static_cast<const TriangleMesh&>(*answer.shape).TriangleCount(), 2u);
    EXPECT_EQ(report.degenerateTriangles.count, 2u);
    EXPECT_EQ(report.degenerateTriangles.first, 2u);
    EXPECT_EQ(report.duplicateTriangles.count,
              2u);  // the copy from another corner on, and the one with the welded vertex
    EXPECT_EQ(report.duplicateTriangles.first, 4u);
    EXPECT_EQ(report.weldedVertices.count, 1u);
    EXPECT_EQ(report.weldedVertices.first, 5u);
    EXPECT_EQ(report.unusedVertices.count, 2u);
    EXPECT_EQ(report.unusedVertices.first, 4u);
    EXPECT_EQ(report.boundaryEdges, 4u);
}

Answer FieldOf(uint32_t countX, uint32_t countZ, const std::vector<float>& heights, float cell = 1,
               const std::vector<uint8_t>& cells = {}) {
    return AnswerOf(HeightField::Create({.sampleCountX = countX,
                                         .sampleCountZ = countZ,
                                         .heights = heights,
                                         .cellSizeX = cell,
                                         .cellSizeZ = cell,
                                         .cells = cells}));
}

TEST(Degenerate, HeightFieldsAreRefusedWithTheReason) {
    const std::vector<float> flat(9, 0.0f);
    const auto with = [&](float height) {
        std::vector<float> heights = flat;
        heights[5] = height;
        return heights;
    };
    CheckCases({
        {"not a number", [&] { return FieldOf(3, 3, with(kNan)); }, ErrorCode::NonFinite, "5"},
        {"infinite", [&] { return FieldOf(3, 3, with(-kInfinite)); }, ErrorCode::NonFinite, "5"},
        {"one row", [&] { return FieldOf(9, 1, flat); }, ErrorCode::OutOfRange, "9 x 1 samples"},
        {"no sample", [] { return FieldOf(0, 0, {}); }, ErrorCode::OutOfRange, "0 x 0 samples"},
        {"too few samples", [&] { return FieldOf(3, 4, flat); }, ErrorCode::OutOfRange, "heights"},
        {"cells of no size", [&] { return FieldOf(3, 3, flat, 0); }, ErrorCode::NonPositive, "cell size"},
        {"nothing but holes", [&] { return FieldOf(3, 3, flat, 1, std::vector<uint8_t>(4, kHoleCell)); },
         ErrorCode::Degenerate, "hole"},
        {"flat", [&] { return FieldOf(3, 3, flat); }, {}},
    });
}

TEST(Degenerate, ShapesOfNoSizeAreRefusedWithTheReason) {
    CheckCases({
        {"sphere of radius 0", [] { return AnswerOf(Sphere::Create(0)); }, ErrorCode::NonPositive, "radius"},
        {"sphere of a negative radius", [] { return AnswerOf(Sphere::Create(-1)); }, ErrorCode::NonPositive, "radius"},
        {"sphere of radius NaN", [] { return AnswerOf(Sphere::Create(kNan)); }, ErrorCode::NonFinite, "radius"},
        {"sphere whose inertia is 0", [] { return AnswerOf(Sphere::Create(1e-12f)); }, ErrorCode::OutOfRange, ""},
        {"sphere whose inertia is infinite", [] { return AnswerOf(Sphere::Create(1e12f)); }, ErrorCode::OutOfRange, ""},
        {"box without width", [] { return AnswerOf(Box::Create(Vector3(1, 0, 1))); }, ErrorCode::NonPositive, "y"},
        {"box of infinite height", [] { return AnswerOf(Box::Create(Vector3(1, 1, kInfinite))); }, ErrorCode::NonFinite,
         "z"},
        {"box rounded to more than its width", [] { return AnswerOf(Box::Create(Vector3(1, 0.1f, 1), 0.2f)); },
         ErrorCode::OutOfRange, "convexRadius"},
        {"capsule of radius 0", [] { return AnswerOf(Capsule::Create(1, 0)); }, ErrorCode::NonPositive, "radius"},
        {"cylinder of height 0", [] { return AnswerOf(Cylinder::Create(0, 1)); }, ErrorCode::NonPositive, "halfHeight"},
        {"cone of radius 0", [] { return AnswerOf(Cylinder::CreateCone(1, 0)); }, ErrorCode::NonPositive, "radius"},
        {"drop of radius 0", [] { return AnswerOf(TaperedCapsule::Create(1, 0, 0)); }, ErrorCode::NonPositive, "adius"},
        {"triangle on a line",
         [] {
             return AnswerOf(Triangle::Create({0, 0, 0}, {1, 1, 1}, {2, 2, 2}));
         },
         ErrorCode::Degenerate, "line"},
        {"triangle of one point",
         [] {
             return AnswerOf(Triangle::Create({1, 1, 1}, {1, 1, 1}, {1, 1, 1}));
         },
         ErrorCode::Degenerate, ""},
        {"plane without a direction", [] { return AnswerOf(Plane::Create(Vector3(0, 0, 0), 1)); },
         ErrorCode::Degenerate, "normal"},
        {"compound of nothing", [] { return AnswerOf(Compound::Create({})); }, ErrorCode::Degenerate, ""},
        {"sphere of a micrometer", [] { return AnswerOf(Sphere::Create(1e-6f)); }, {}},
        {"sphere of a thousand kilometers", [] { return AnswerOf(Sphere::Create(1e6f)); }, {}},
        {"plate of a tenth of a millimeter", [] { return AnswerOf(Box::Create(Vector3(10, 5e-5f, 10))); }, {}},
    });
}

TEST(Degenerate, ScalesBeyondNumbersAreRefusedWithTheReason) {
    const ShapePtr box = Box::Create(Vector3(1, 1, 1)).Value();
    const Points square = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, {1, 0, 1}};
    const ShapePtr mesh = MeshOf(square, {0, 2, 1, 1, 2, 3}).shape;
    const auto scaled = [](const ShapePtr& shape, float x, float y, float z) {
        return AnswerOf(Scaled(shape, Vector3(x, y, z)));
    };
    CheckCases({
        {"a factor of 0", [&] { return scaled(box, 1, 0, 1); }, ErrorCode::OutOfRange, ""},
        {"a factor that is not a number", [&] { return scaled(box, 1, 1, kNan); }, ErrorCode::NonFinite, ""},
        {"a box of 10^30 m", [&] { return scaled(box, 1e30f, 1e30f, 1e30f); }, ErrorCode::OutOfRange, ""},
        {"a box of 10^-30 m", [&] { return scaled(box, 1e-30f, 1e-30f, 1e-30f); }, ErrorCode::OutOfRange, ""},
        {"a mesh of 10^20 m", [&] { return scaled(mesh, 1e20f, 1, 1); }, ErrorCode::OutOfRange, ""},
        {"a flat mesh", [&] { return scaled(mesh, 1, 0, 1); }, ErrorCode::OutOfRange, ""},
        {"a mirrored mesh", [&] { return scaled(mesh, -1, 2, 0.5f); }, {}},
    });
}

}  // namespace
}  // namespace fulcrum
