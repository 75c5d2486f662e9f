// Casts with ignoreSeparating of what stands or glides on a floor of triangles or tiles: the next one only continues
// the floor and is not hit; steps, ridges, ramps and walls are, with the right normals.
#include <Fulcrum/Collision/Queries/ShapeCast.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace fulcrum::testing {
namespace {

constexpr float kRadius = 0.3f, kHalf = 0.6f;  // m: of all that glides; the half height of those that are long
constexpr float kLength = 5;                   // m, of a cast
constexpr ShapeCastSettings kWalking{.ignoreSeparating = true};

using ConvexPtr = std::shared_ptr<const ConvexShape>;
struct Glider {
    const char* name;
    ConvexPtr shape;
    float height;  // m, of its center when it stands
    bool isRound;  // below
};

std::vector<Glider> Gliders() {
    return {{"capsule", Capsule::Create(kHalf, kRadius).Value(), kHalf + kRadius, true},
            {"ball", Sphere::Create(kRadius).Value(), kRadius, true},
            {"box", Box::Create({kRadius, kHalf, kRadius}).Value(), kHalf, false},
            {"cylinder", Cylinder::Create(kHalf, kRadius).Value(), kHalf, false}};
}

// A profile of heights along x, extruded along z.
struct Corner {
    float x, y;
};
using Profile = std::vector<Corner>;
constexpr float kEdge = 12, kCell = 0.37f;

// Corners of the profile, with more in between, at most a cell apart.
Profile Divided(const Profile& profile) {
    Profile all{profile.front()};
    for (size_t i = 1; i < profile.size(); ++i) {
        const Corner from = profile[i - 1], to = profile[i];
        const int parts = std::max(1, static_cast<int>(std::ceil(std::hypot(to.x - from.x, to.y - from.y) / kCell)));
        for (int k = 1; k <= parts; ++k) {
            const float t = static_cast<float>(k) / static_cast<float>(parts);
            all.push_back({from.x + (to.x - from.x) * t, from.y + (to.y - from.y) * t});
        }
    }
    return all;
}

ShapePtr MeshOf(const Profile& corners, bool isTwoSided = false) {
    const Profile profile = Divided(corners);
    const auto rows = static_cast<uint32_t>(2 * kEdge / kCell);
    const auto count = static_cast<uint32_t>(profile.size());
    TriangleMeshSettings settings{.isTwoSided = isTwoSided};
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    for (uint32_t z = 0; z <= rows; ++z)
        for (const Corner& corner : profile)
            vertices.emplace_back(corner.x, corner.y, kCell * static_cast<float>(z) - kEdge);
    for (uint32_t z = 0; z < rows; ++z)
        for (uint32_t i = 0; i + 1 < count; ++i) {
            const uint32_t first = z * count + i;
            for (const uint32_t corner : {first, first + count, first + 1, first + 1, first + count, first + count + 1})
                indices.push_back(corner);
        }
    settings.vertices = vertices;
    settings.indices = indices;
    return TriangleMesh::Create(settings).Value();
}

Profile Flat() { return {{-kEdge, 0}, {kEdge, 0}}; }

enum class Floor { Mesh, TwoSidedMesh, Field, Boxes, GappedBoxes, Children };
constexpr Floor kFloors[] = {Floor::Mesh,  Floor::TwoSidedMesh, Floor::Field,
                             Floor::Boxes, Floor::GappedBoxes,  Floor::Children};

// Flat, through the origin, turned.
void AddFloor(TestWorld& world, Floor floor, const Quaternion& rotation = {}) {
    const auto add = [&](const ShapePtr& shape, const Vector3& at = Vector3::Zero()) {
        world.Add({.shape = shape,
                   .motion = MotionType::Static,
                   .position = Rotate(rotation, at).cast<double>(),
                   .rotation = rotation});
    };
    constexpr float kTile = 0.7f;  // m
    std::vector<Compound::ChildSettings> children;
    const float gap = floor == Floor::GappedBoxes ? 1e-3f : 0.0f;
    const ShapePtr tile = BoxOf(0.5f * (kTile - gap), 0.1f, 0.5f * (kTile - gap));
    switch (floor) {
        case Floor::Mesh: return add(MeshOf(Flat()));
        case Floor::TwoSidedMesh: return add(MeshOf(Flat(), true));
        case Floor::Field:
            return add(HeightField::Create({.sampleCountX = 49,
                                            .sampleCountZ = 49,
                                            .heights = std::vector<float>(49 * 49, 0.0f),
                                            .cellSizeX = 0.5f,
                                            .cellSizeZ = 0.5f,
                                            .origin = Vector3(-kEdge, 0, -kEdge)})
                           .Value());
        default: break;
    }
    for (float x = -kEdge; x <= kEdge; x += kTile)
        for (float z = -kEdge; z <= kEdge; z += kTile) {
            if (floor != Floor::Children) add(tile, Vector3(x, -0.1f, z));
            else children.push_back({tile, Vector3(x, -0.1f, z)});
        }
    if (floor == Floor::Children) add(Compound::Create(children).Value());
}

// m, into the floor: touching, resting, pushed in, and within the height that counts as flush.
constexpr float kDepths[] = {0, 1e-5f, 1e-3f, 0.02f, -2e-4f};

TEST(CastAlongFloor, IsNotHitByWhatContinuesIt) {
    for (const Floor floor : kFloors)
        for (const double slope : {0.0, 0.35}) {
            TestWorld world;
            const Quaternion turned = RotationAbout(Vector3(0.6f, 0, 0.8f), slope);
            AddFloor(world, floor, turned);
            std::mt19937 random(7);
            std::uniform_real_distribution<float> place(-4, 4), angle(0, 6.28f);
            for (const Glider& glider : Gliders())
                for (const float depth : kDepths) {
                    int hits = 0;
                    for (int i = 0; i < 40; ++i) {
                        const float yaw = angle(random);
                        const Vector3 at(place(random), glider.height - depth, place(random));
                        const Vector3 along(kLength * std::cos(yaw), 0, kLength * std::sin(yaw));
                        WorldShapeHit hit;
                        hits += world.System().Queries().CastShape(
                            {glider.shape.get(), {Rotate(turned, at).cast<double>(), turned}, Rotate(turned, along)},
                            hit, kWalking);
                    }
                    EXPECT_EQ(hits, 0) << glider.name << " " << depth << " m in floor " << static_cast<int>(floor)
                                       << ", slope " << slope;
                }
        }
}

// The edges of the tiles beside a gap are touched at a slant by what stands over it.
TEST(CastAlongFloor, IsNotHitOverAGap) {
    TestWorld world;
    const ShapePtr tile = BoxOf(1, 0.1f, 3);
    for (const double x : {-1.0005, 1.0005})
        world.Add({.shape = tile, .motion = MotionType::Static, .position = {x, -0.1, 0}});
    for (const Glider& glider : Gliders())
        for (const double offset : {0.0, 1e-4, -3e-4}) {
            WorldShapeHit hit;
            EXPECT_FALSE(world.System().Queries().CastShape(
                {glider.shape.get(), {{offset, double{glider.height} - 1e-3, 0}, {}}, {1.5f, 0, 0.2f}}, hit, kWalking))
                << glider.name << " " << offset;
        }
}

// The moving shape's center where it touches a step's upper edge, m before it, from the height of the edge above the
// floor and the depth in it.
float BeforeEdge(const Glider& glider, float step, float depth) {
    if (!glider.isRound || step + depth >= kRadius) return kRadius;
    const float below = kRadius - depth - step;
    return std::sqrt(kRadius * kRadius - below * below);
}

// A step of a mesh, of tiles and of a wall on them: the fraction and the normal of a cast that starts at rest.
TEST(CastAlongFloor, IsHitByStepsAndWalls) {
    for (const float step : {0.004f, 0.05f, 0.2f, 1.0f})
        for (const bool isMesh : {true, false}) {
            TestWorld world;
            constexpr float kStepAt = 2;
            if (isMesh) {
                world.Add({.shape = MeshOf({{-kEdge, 0}, {kStepAt, 0}, {kStepAt, step}, {kEdge, step}}),
                           .motion = MotionType::Static});
            } else {
                AddFloor(world, Floor::Boxes);
                world.Add({.shape = BoxOf(2, 0.5f, 5),
                           .motion = MotionType::Static,
                           .position = {kStepAt + 2, double{step} - 0.5, 0}});
            }
            for (const Glider& glider : Gliders())
                for (const float depth : {0.0f, 1e-3f}) {
                    WorldShapeHit hit;
                    ASSERT_TRUE(world.System().Queries().CastShape(
                        {glider.shape.get(), {{0.11, double{glider.height - depth}, 0.07}, {}}, {kLength, 0, 0}}, hit,
                        kWalking))
                        << glider.name << " " << step;
                    const float before = BeforeEdge(glider, step, depth);
                    // A round shape meets a low edge at a slant: its height, exact to 1e-6 m, counts by as much more.
                    EXPECT_NEAR(hit.fraction * kLength, kStepAt - 0.11f - before, 5e-6f * kRadius / before)
                        << glider.name << " " << step << " " << depth;
                    const float x = -before / kRadius;
                    EXPECT_NEAR(hit.normal.x(), x, 1e-4f) << glider.name << " " << step;
                    EXPECT_NEAR(hit.normal.y(), std::sqrt(std::max(0.0f, 1 - x * x)), 1e-3f)
                        << glider.name << " " << step;
                }
        }
}

// Where a floor of triangles begins to rise, the edge is inactive: the normal is that of the face beyond it, also if
// the shape, which stands a little in the floor, reaches the edge first.
TEST(CastAlongFloor, IsHitByTheFaceWhereTheFloorRises) {
    for (const double degrees : {1.0, 3.0, 10.0, 40.0}) {
        TestWorld world;
        const float slope = static_cast<float>(degrees * kDegree), rise = 4 * std::tan(slope);
        world.Add({.shape = MeshOf({{-kEdge, 0}, {2, 0}, {6, rise}, {kEdge, rise}}), .motion = MotionType::Static});
        for (const Glider& glider : Gliders())
            for (const float depth : {0.0f, 1e-3f}) {
                WorldShapeHit hit;
                ASSERT_TRUE(world.System().Queries().CastShape(
                    {glider.shape.get(), {{0.11, double{glider.height - depth}, 0.07}, {}}, {kLength, 0, 0}}, hit,
                    kWalking))
                    << glider.name << " " << degrees;
                EXPECT_NEAR(hit.normal.x(), -std::sin(slope), 1e-4f) << glider.name << " " << degrees << " " << depth;
                EXPECT_NEAR(hit.normal.y(), std::cos(slope), 1e-4f) << glider.name << " " << degrees << " " << depth;
            }
    }
}

// A ridge across the way, 5 mm high and steep on both sides: its upper edge is active. Beyond a crest the floor falls:
// what glides on does not hit it.
TEST(CastAlongFloor, IsHitByARidgeButNotByAFallingFloor) {
    TestWorld ridge, crest;
    ridge.Add({.shape = MeshOf({{-kEdge, 0}, {1.999f, 0}, {2, 0.005f}, {2.001f, 0}, {kEdge, 0}}),
               .motion = MotionType::Static});
    crest.Add({.shape = MeshOf({{-kEdge, 0}, {2, 0}, {kEdge, -3}}), .motion = MotionType::Static});
    for (const Glider& glider : Gliders()) {
        const MovingShape moving{glider.shape.get(), {{0.11, double{glider.height} - 1e-3, 0.07}, {}}, {kLength, 0, 0}};
        WorldShapeHit hit;
        ASSERT_TRUE(ridge.System().Queries().CastShape(moving, hit, kWalking)) << glider.name;
        EXPECT_NEAR(hit.fraction * kLength, 2 - 0.11f - BeforeEdge(glider, 0.005f, 1e-3f), 2e-3f) << glider.name;
        EXPECT_LT(hit.normal.x(), -0.1f) << glider.name;
        EXPECT_FALSE(crest.System().Queries().CastShape(moving, hit, kWalking)) << glider.name;
    }
}

// From below, a floor seen from behind bears nothing: the wall behind it is hit.
TEST(CastAlongFloor, IsHitByAWallUnderAFloorThatItTouchesFromBelow) {
    TestWorld world;
    world.Add({.shape = MeshOf(Flat()), .motion = MotionType::Static});
    world.Add({.shape = BoxOf(0.5f, 1, 5), .motion = MotionType::Static, .position = {2.5, -1.2, 0}});
    for (const Glider& glider : Gliders()) {
        WorldShapeHit hit;
        ASSERT_TRUE(world.System().Queries().CastShape(
            {glider.shape.get(), {{0.11, 1e-3 - double{glider.height}, 0.07}, {}}, {kLength, 0, 0}}, hit, kWalking))
            << glider.name;
        EXPECT_NEAR(hit.normal.x(), -1, 1e-4f) << glider.name;
    }
}

// A box that tips over while it moves digs its edge into the next tile; one that turns about the vertical does not.
TEST(CastAlongFloor, HeedsRotationIntoTheFloor) {
    TestWorld world;
    AddFloor(world, Floor::Boxes);
    const ConvexPtr box = Box::Create({kRadius, kHalf, kRadius}).Value();
    const Pose standing{{0, kHalf, 0}, {}};
    WorldShapeHit hit;
    EXPECT_FALSE(world.System().Queries().CastShape({box.get(), standing, {kLength, 0, 0}, {0, 3, 0}}, hit, kWalking));
    EXPECT_TRUE(world.System().Queries().CastShape({box.get(), standing, {kLength, 0, 0}, {0, 0, -1}}, hit, kWalking));
}

// The same of a single shape, without a world.
TEST(CastAlongFloor, HoldsForSingleShapes) {
    const ShapePtr mesh = MeshOf(Flat());
    for (const Glider& glider : Gliders()) {
        const ShapeMotion motion{{{0.1, double{glider.height} - 1e-3, 0.2}, {}}, {kLength, 0, 1}};
        ShapeHit hit;
        EXPECT_FALSE(ShapeCaster(*glider.shape, motion).CastClosest(*mesh, {}, kWalking, hit)) << glider.name;
        EXPECT_TRUE(ShapeCaster(*glider.shape, motion).CastClosest(*mesh, {}, {}, hit)) << glider.name;
    }
}

}  // namespace
}  // namespace fulcrum::testing
