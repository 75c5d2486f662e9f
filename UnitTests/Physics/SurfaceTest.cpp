// Bodies on triangle meshes and height fields: they rest, slide and roll as on solid ground, and edges between
// triangles that are no edges of the surface are not felt.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <functional>
#include <vector>

namespace fulcrum::testing {
namespace {

// A grid of cells x cells squares of `size` meters over x and z from (x0, z0), two triangles each.
struct Grid {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;

    Grid(
        int cells, float size, float x0, float z0,
        const std::function<float(float, float)>& height = [](float, float) { return 0.0f; }) {
        const auto at = [&](int x, int z) { return static_cast<uint32_t>(z * (cells + 1) + x); };
        for (int z = 0; z <= cells; ++z)
            for (int x = 0; x <= cells; ++x) {
                const float px = x0 + size * static_cast<float>(x), pz = z0 + size * static_cast<float>(z);
                vertices.emplace_back(px, height(px, pz), pz);
            }
        for (int z = 0; z < cells; ++z)
            for (int x = 0; x < cells; ++x)
                indices.insert(indices.end(),
                               {at(x, z), at(x, z + 1), at(x + 1, z), at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)});
    }
    std::shared_ptr<const TriangleMesh> Mesh(TriangleMeshSettings settings = {}) const {
        settings.vertices = vertices;
        settings.indices = indices;
        auto mesh = TriangleMesh::Create(settings);
        EXPECT_TRUE(mesh) << (mesh ? "" : mesh.GetError().message);
        return mesh ? mesh.Value() : nullptr;
    }
};

std::shared_ptr<HeightField> FieldOf(uint32_t samples, float cell, const Vector3& origin) {
    const std::vector<float> heights(size_t(samples) * samples, 0.0f);
    auto field = HeightField::Create({.sampleCountX = samples,
                                      .sampleCountZ = samples,
                                      .heights = heights,
                                      .cellSizeX = cell,
                                      .cellSizeZ = cell,
                                      .origin = origin});
    EXPECT_TRUE(field);
    return field ? field.Value() : nullptr;
}

BodyId AddGround(TestWorld& world, const ShapePtr& shape, float friction = 0.5f,
                 const Position& position = Position::Zero()) {
    return world.Add(
        {.shape = shape, .motion = MotionType::Static, .position = position, .material = {.friction = friction}});
}

// A cube of 0.2 m that slides without friction at 3 m/s hardly notices what it slides over.
void SlidesOver(TestWorld& world, float angle) {
    const Vector3 along(std::cos(angle), 0, std::sin(angle));
    const BodyId cube = world.Add({.shape = CubeOf(0.1f),
                                   .position = (along * -4.0f + Vector3(0, 0.1f, 0)).cast<double>(),
                                   .linearVelocity = along * 3,
                                   .material = {.friction = 0}});
    for (int i = 0; i < 150; ++i) {
        world.Step();
        const Vector3 v = world.VelocityOf(cube);
        const float forward = Dot(v, along);
        ASSERT_LT(std::fabs(v.y()), 0.01f) << "step " << i << " angle " << angle;
        ASSERT_LT(Length(Vector3(v - along * forward - Vector3(0, v.y(), 0))), 0.01f)
            << "step " << i << " angle " << angle;
        ASSERT_NEAR(forward, 3, 0.01) << "step " << i << " angle " << angle;
        ASSERT_NEAR(world.PositionOf(cube).y(), 0.1, 1e-3) << "step " << i << " angle " << angle;
    }
}

TEST(Surface, InternalEdgesOfAMeshDoNotDisturbSliding) {
    for (float angle : {0.0f, 0.3f, 0.785f, 2.0f, -1.0f}) {
        TestWorld world(NoSleep());
        AddGround(world, Grid(40, 0.25f, -5, -5).Mesh(), 0);
        SlidesOver(world, angle);
    }
}

TEST(Surface, InternalEdgesOfAHeightFieldDoNotDisturbSliding) {
    for (float angle : {0.0f, 0.3f, 0.785f, 2.0f, -1.0f}) {
        TestWorld world(NoSleep());
        AddGround(world, FieldOf(41, 0.25f, {-5, 0, -5}), 0);
        SlidesOver(world, angle);
    }
}

TEST(Surface, SeamsBetweenTwoMeshesDoNotDisturbSliding) {
    for (float angle : {0.0f, 0.3f, 0.785f, 2.0f, -1.0f}) {
        TestWorld world(NoSleep());
        AddGround(world, Grid(40, 0.25f, -10, -5).Mesh(), 0);
        AddGround(world, Grid(40, 0.25f, 0, -5).Mesh(), 0);
        SlidesOver(world, angle);
    }
}

TEST(Surface, SeamsBetweenTwoHeightFieldsDoNotDisturbSliding) {
    for (float angle : {0.0f, 0.3f, 0.785f, 2.0f, -1.0f}) {
        TestWorld world(NoSleep());
        AddGround(world, FieldOf(41, 0.25f, {-10, 0, -5}), 0);
        AddGround(world, FieldOf(41, 0.25f, {0, 0, -5}), 0);
        SlidesOver(world, angle);
    }
}

TEST(Surface, SeamsBetweenBoxesDoNotDisturbSliding) {
    for (float angle : {0.0f, 0.3f, 0.785f, 2.0f, -1.0f}) {
        TestWorld world(NoSleep());
        for (int x = -12; x <= 12; ++x)
            for (int z = -12; z <= 12; ++z) AddGround(world, BoxOf(0.25f, 0.25f, 0.25f), 0, {0.5 * x, -0.25, 0.5 * z});
        SlidesOver(world, angle);
    }
}

TEST(Surface, ABoxRestsOnAMeshWithItsWeight) {
    TestWorld world(NoSleep());
    const BodyId ground = AddGround(world, Grid(10, 1, -5, -5).Mesh());
    const BodyId box = world.Add({.shape = BoxOf(0.7f, 0.5f, 0.9f), .position = {0.1, 0.6, 0.2}});
    world.Run(3);
    const double weight = double(world.Bodies().GetMass(box)) * kGravity;
    EXPECT_NEAR(world.ForceBetween(box, ground), weight, 1e-3 * weight);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 1e-3);
    EXPECT_LT(Length(world.VelocityOf(box)), 1e-3f);
    // One direction: one manifold, of the four corners.
    EXPECT_EQ(world.Report().contacts, 1u);
    EXPECT_EQ(world.Report().contactPoints, 4u);
}

TEST(Surface, ALargeBodyOverThousandsOfTrianglesRestsOnFourPoints) {
    TestWorld world(NoSleep());
    AddGround(world, Grid(100, 0.1f, -5, -5).Mesh());
    const BodyId plate = world.Add({.shape = BoxOf(4, 0.2f, 4), .position = {0, 0.25, 0}});
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(plate).y(), 0.2, 1e-3);
    EXPECT_EQ(world.Report().contactPoints, 4u);
    const Vector3 up = Rotate(world.Bodies().GetPose(plate).rotation, Vector3(0, 1, 0));
    EXPECT_GT(up.y(), 0.99999f);
}

TEST(Surface, EveryShapeRestsOnAMeshAsOnABox) {
    struct Case {
        ShapePtr shape;
        double height;  // of its origin at rest, m
    };
    const auto cylinder = Cylinder::Create(0.4f, 0.3f);
    const auto cone = Cylinder::CreateCone(0.4f, 0.3f);
    ASSERT_TRUE(cylinder && cone);
    const Case cases[] = {{SphereOf(0.3f), 0.3},
                          {CubeOf(0.25f), 0.25},
                          {HullOf({{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 1, 0}}), 0},
                          {cylinder.Value(), 0.4},
                          {cone.Value(), 0.4}};
    for (const Case& c : cases) {
        TestWorld world(NoSleep());
        AddGround(world, Grid(20, 0.37f, -3.7f, -3.7f).Mesh());
        const BodyId body = world.Add({.shape = c.shape, .position = {0.05, c.height + 0.05, 0.11}});
        world.Run(3);
        EXPECT_NEAR(world.PositionOf(body).y(), c.height, 2e-3) << ShapeTypeName(c.shape->Type());
        EXPECT_LT(Length(world.VelocityOf(body)), 0.01f) << ShapeTypeName(c.shape->Type());
    }
}

TEST(Plane, EveryShapeRestsOnIt) {
    const auto plane = Plane::Create(Vector3(0, 1, 0), 2);
    const auto cylinder = Cylinder::Create(0.4f, 0.3f), rounded = Cylinder::Create(0.4f, 0.3f, 0.05f);
    const auto cone = Cylinder::CreateCone(0.4f, 0.3f);
    ASSERT_TRUE(plane && cylinder && rounded && cone);
    for (const ShapePtr& shape : {SphereOf(0.4f), CubeOf(0.4f), ShapePtr(cylinder.Value()), ShapePtr(rounded.Value()),
                                  ShapePtr(cone.Value())}) {
        TestWorld world(NoSleep());
        AddGround(world, plane.Value());
        const BodyId body = world.Add({.shape = shape, .position = {3, 2.5, 1}});
        world.Run(3);
        EXPECT_NEAR(world.PositionOf(body).y(), 2.4, 1e-3) << ShapeTypeName(shape->Type());
        EXPECT_LT(Length(world.VelocityOf(body)), 0.01f) << ShapeTypeName(shape->Type());
    }
}

TEST(Surface, ASphereRollsDownAMeshWithFiveSeventhsOfGravity) {
    const double angle = 15 * kDegree;
    const float slope = static_cast<float>(std::tan(angle));
    TestWorld world(NoSleep());
    AddGround(world, Grid(100, 0.5f, -25, -25, [&](float x, float) { return x * slope; }).Mesh(), 0.9f);
    const Vector3 normal(static_cast<float>(-std::sin(angle)), static_cast<float>(std::cos(angle)), 0);
    const BodyId ball = world.Add({.shape = SphereOf(0.5f),
                                   .position = (Vector3(20, 20 * slope, 0.1f) + normal * 0.5f).cast<double>(),
                                   .material = {.friction = 0.9f}});
    world.Run(1);
    const double v1 = double(Length(world.VelocityOf(ball)));
    world.Run(2);
    const double v3 = double(Length(world.VelocityOf(ball)));
    EXPECT_NEAR((v3 - v1) / 2, 1.8136, 2e-3 * 1.8136);
}

TEST(Surface, ARidgeCarriesABoxOnItsEdge) {
    // A roof of 30 degrees: its ridge is an edge of the surface. A box held level over it meets the ridge.
    TestWorld world(NoSleep());
    const float slope = static_cast<float>(std::tan(30 * kDegree));
    AddGround(world, Grid(20, 0.5f, -5, -5, [&](float x, float) { return -std::fabs(x) * slope; }).Mesh());
    const BodyId box =
        world.Add({.shape = BoxOf(0.5f, 0.25f, 0.5f),
                   .position = {0, 0.26, 0.1},
                   .material = {.friction = 0, .frictionRule = CombineRule::Multiply},
                   .lockedAxes = LockedAxes::Rotation | LockedAxes::TranslationX | LockedAxes::TranslationZ});
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.25, 1e-3);
    const double weight = double(world.Bodies().GetMass(box)) * kGravity;
    // Of the ridge's normal and of those of both slopes, which share the load as it comes.
    double upwards = 0;
    world.System().VisitContacts([&](const ContactView& contact) {
        for (const ContactView::Point& point : contact.points)
            upwards -= double{contact.normal.y()} * double{point.impulse};
    });
    EXPECT_NEAR(upwards * world.System().Settings().solver.substeps / kStep, weight, 1e-3 * weight);
}

TEST(Surface, OneSidedTrianglesLetPassWhatComesFromBehind) {
    for (const bool twoSided : {false, true}) {
        TestWorld world(NoGravity());
        AddGround(world, Grid(10, 1, -5, -5).Mesh({.isTwoSided = twoSided}));
        const BodyId ball =
            world.Add({.shape = SphereOf(0.25f), .position = {0.2, -2, 0.3}, .linearVelocity = {0, 3, 0}});
        world.Run(2);
        const double height = world.PositionOf(ball).y();
        EXPECT_TRUE(twoSided ? height < -0.2 : std::fabs(height - 4) < 1e-3) << height;
    }
}

TEST(Surface, EachTriangleHasItsOwnFriction) {
    // Stops after v^2 / (2 mu g). The half x < 0 has no friction.
    Grid grid(40, 1, -20, -20);
    std::vector<uint8_t> materials;
    for (size_t i = 0; i < grid.indices.size(); i += 3) {
        float x = 0;
        for (size_t k = 0; k < 3; ++k) x += grid.vertices[grid.indices[i + k]].x();
        materials.push_back(x < 0 ? 0 : 1);
    }
    const SurfaceMaterial palette[] = {{.friction = 0}, {.friction = 0.4f}};
    TestWorld world(NoSleep());
    AddGround(world, grid.Mesh({.triangleMaterials = materials, .materials = palette}));
    const Material rough{.friction = 0.4f};
    const BodyId onIce =
        world.Add({.shape = CubeOf(0.2f), .position = {-10, 0.2, 5}, .linearVelocity = {0, 0, -4}, .material = rough});
    const BodyId onRough =
        world.Add({.shape = CubeOf(0.2f), .position = {10, 0.2, 5}, .linearVelocity = {0, 0, -4}, .material = rough});
    world.Run(2);
    EXPECT_NEAR(world.VelocityOf(onIce).z(), -4, 0.01);
    EXPECT_NEAR(5 - world.PositionOf(onRough).z(), 16 / (2 * 0.4 * kGravity), 0.02);
}

TEST(Surface, WhatRestsOnAMeshSleepsAndWakes) {
    TestWorld world;
    AddGround(world, Grid(10, 1, -5, -5).Mesh());
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0.1, 0.51, 0.2}});
    world.Run(3);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    ASSERT_TRUE(world.Bodies().AddImpulse(box, {0, 3000, 0}));
    world.Run(0.25);
    EXPECT_GT(world.PositionOf(box).y(), 0.6);
    world.Run(3);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 1e-3);
}

TEST(Surface, AMovingMeshCarriesWhatStandsOnIt) {
    TestWorld world(NoSleep());
    const BodyId lift = world.Add(
        {.shape = Grid(4, 1, -2, -2).Mesh(), .motion = MotionType::Kinematic, .linearVelocity = {0.5f, 1, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.25f), .position = {0, 0.26, 0}});
    world.Run(3);
    EXPECT_NEAR(world.PositionOf(box).y() - world.PositionOf(lift).y(), 0.25, 5e-3);
    EXPECT_NEAR(world.VelocityOf(box).x(), 0.5, 0.01);
}

TEST(Surface, ASettledStepAllocatesNothing) {
    TestWorld world(NoSleep());
    AddGround(world, Grid(20, 0.5f, -5, -5).Mesh());
    AddGround(world, FieldOf(21, 0.5f, {5, 0, -5}));
    const auto cylinder = Cylinder::Create(0.2f, 0.2f);
    ASSERT_TRUE(cylinder);
    const ShapePtr shapes[] = {CubeOf(0.2f), SphereOf(0.2f), CapsuleOf(0.2f, 0.15f), cylinder.Value()};
    for (int i = 0; i < 64; ++i) world.Add({.shape = shapes[i % 4], .position = {-4.0 + 2 * (i % 8), 1, -3.5 + i / 8}});
    world.Steps(400);
    const uint64_t before = AllocationCount();
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(world.System().Update(kStep));
    EXPECT_EQ(AllocationCount() - before, 0u);
    EXPECT_GE(world.Report().contacts, 64u);
}

TEST(Surface, ADynamicBodyCannotBeASurface) {
    TestWorld world;
    const Result<BodyId> body = world.Bodies().Create({.shape = Grid(2, 1, 0, 0).Mesh(), .mass = 1});
    ASSERT_FALSE(body);
    EXPECT_EQ(body.GetError().code, ErrorCode::Unsupported);
    EXPECT_NE(body.GetError().message.find("triangle mesh"), std::string::npos) << body.GetError().message;
}

TEST(Surface, WhatLiesInAHoleFallsThrough) {
    TestWorld world(NoSleep());
    std::vector<uint8_t> cells(10 * 10, 0);
    cells[5 * 10 + 5] = kHoleCell;
    const std::vector<float> heights(11 * 11, 0.0f);
    auto field = HeightField::Create(
        {.sampleCountX = 11, .sampleCountZ = 11, .heights = heights, .origin = {-5.5f, 0, -5.5f}, .cells = cells});
    ASSERT_TRUE(field);
    AddGround(world, field.Value());
    const BodyId falls = world.Add({.shape = SphereOf(0.2f), .position = {0, 0.5, 0}});
    const BodyId stays = world.Add({.shape = SphereOf(0.2f), .position = {2, 0.5, 0}});
    world.Run(2);
    EXPECT_LT(world.PositionOf(falls).y(), -5);
    EXPECT_NEAR(world.PositionOf(stays).y(), 0.2, 1e-3);
}

// A ball at rest in a groove keeps its two manifolds, both of one pair. Once it has no friction, a push does not turn
// it.
TEST(Surface, AMaterialSetLaterReachesAllManifoldsOfAPair) {
    TestWorld world(NoSleep());
    AddGround(world, Grid(8, 1, -4, -4, [](float x, float) { return std::fabs(x); }).Mesh());
    const BodyId ball = world.Add({.shape = SphereOf(0.3f), .position = {0, 0.3 * std::sqrt(2.0), -3}});
    world.Steps(30);
    ASSERT_TRUE(world.Bodies().SetMaterial(ball, {.friction = 0}));
    ASSERT_TRUE(world.Bodies().SetVelocity(ball, Vector3(0, 0, 1), Vector3::Zero()));
    world.Step();
    EXPECT_GT(world.Report().keptManifolds, 0u);
    world.Steps(30);
    EXPECT_LT(Length(world.Bodies().GetAngularVelocity(ball)), 1e-3f);
    EXPECT_NEAR(world.VelocityOf(ball).z(), 1, 1e-3f);
}

}  // namespace
}  // namespace fulcrum::testing
