// Contacts of a shape that is no body, and casts that pass what they touch and leave.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

// A box that sinks 0.1 m into the floor and 0.2 m into a wall: four points each, along their normals.
TEST(CollideShape, GivesAllContactsWithTheirDepths) {
    TestWorld world;
    const BodyId floor = world.AddFloor();
    const BodyId wall = world.Add({.shape = BoxOf(0.5f, 5, 5), .motion = MotionType::Static, .position = {1.3, 4, 0}});
    const ShapePtr box = CubeOf(0.5f);
    std::vector<WorldContact> contacts;
    world.System().Queries().CollideShape({box.get(), {{0.5, 0.4, 0}, {}}}, 0, contacts);
    ASSERT_EQ(contacts.size(), 2u);
    EXPECT_EQ(contacts[0].body, floor);
    EXPECT_EQ(contacts[1].body, wall);
    EXPECT_LT(Length(Vector3(contacts[0].normal - Vector3(0, 1, 0))), 1e-5f);
    EXPECT_LT(Length(Vector3(contacts[1].normal - Vector3(-1, 0, 0))), 1e-5f);
    for (const WorldContact& contact : contacts) {
        const double depth = contact.body == floor ? 0.1 : 0.2;
        EXPECT_EQ(contact.pointCount, 4u);
        for (const WorldContact::Point& point : contact.Points()) {
            EXPECT_NEAR(point.separation, -depth, 1e-5);
            const Position between =
                point.onQuery - point.onBody - contact.normal.cast<double>() * double{point.separation};
            EXPECT_LT(between.norm(), 1e-5);
        }
    }
}

TEST(CollideShape, PointsThatAreOnlyNearAreGivenWhereTheyAreAskedFor) {
    TestWorld world;
    world.AddFloor();
    const ShapePtr ball = SphereOf(0.5f);
    const PlacedShape above{ball.get(), {{0, 0.6, 0}, {}}};
    std::vector<WorldContact> contacts;
    world.System().Queries().CollideShape(above, 0.05f, contacts);
    EXPECT_TRUE(contacts.empty());
    world.System().Queries().CollideShape(above, 0.2f, contacts);
    ASSERT_EQ(contacts.size(), 1u);
    ASSERT_EQ(contacts[0].pointCount, 1u);
    EXPECT_NEAR(contacts[0].points[0].separation, 0.1, 1e-5);
    EXPECT_LT((contacts[0].points[0].onQuery - Position(0, 0.1, 0)).norm(), 1e-5);
}

TEST(CollideShape, SeesPiecesTrianglesAndPlanes) {
    TestWorld world;
    const std::vector<Vector3> vertices{{-5, 0, -5}, {5, 0, -5}, {5, 0, 5}, {-5, 0, 5}};
    const std::vector<uint32_t> indices{0, 2, 1, 0, 3, 2};
    const BodyId mesh =
        world.Add({.shape = ShapePtr(TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value()),
                   .motion = MotionType::Static});
    const BodyId plane = world.Add({.shape = ShapePtr(Plane::Create().Value()),
                                    .motion = MotionType::Static,
                                    .position = {0, -0.1, 0},
                                    .layer = 1});
    const ShapePtr dumbbell = CompoundOf({{SphereOf(0.5f), {-2, 0, 0}}, {SphereOf(0.5f), {2, 0, 0}}});
    const PlacedShape placed{dumbbell.get(), {{0, 0.3, 0}, {}}};
    std::vector<WorldContact> contacts;
    world.System().Queries().CollideShape(placed, 0, contacts);
    ASSERT_EQ(contacts.size(), 4u);
    for (uint32_t i = 0; i < 4; ++i) {
        EXPECT_EQ(contacts[i].body, i < 2 ? mesh : plane);
        EXPECT_EQ(contacts[i].childOfQuery, i % 2);
        EXPECT_EQ(contacts[i].subShape.triangle == kNoTriangle, i >= 2);
        EXPECT_NEAR(contacts[i].points[0].separation, i < 2 ? -0.2 : -0.1, 1e-5);
    }
    world.System().Queries().CollideShape(placed, 0, contacts, {.layers = 2});
    EXPECT_EQ(contacts.size(), 2u);
}

// A box on the floor that slides along it, and one that is lifted, are stopped by nothing but the wall ahead.
TEST(IgnoreSeparating, ACastAlongTheFloorGoesOnToTheWall) {
    TestWorld world;
    const BodyId floor = world.AddFloor();
    const BodyId wall = world.Add({.shape = CubeOf(1), .motion = MotionType::Static, .position = {5, 1, 0}});
    const auto box = std::static_pointer_cast<const ConvexShape>(CubeOf(0.5f));
    MovingShape moving{box.get(), {{0, 0.499, 0}, {}}, {10, 0, 0}};
    WorldShapeHit hit;
    const QueryInterface& queries = world.System().Queries();
    ASSERT_TRUE(queries.CastShape(moving, hit));
    EXPECT_EQ(hit.body, floor);
    EXPECT_EQ(hit.fraction, 0);
    const ShapeCastSettings leaving{.ignoreSeparating = true};
    ASSERT_TRUE(queries.CastShape(moving, hit, leaving));
    EXPECT_EQ(hit.body, wall);
    EXPECT_NEAR(hit.fraction, 0.35, 1e-4);
    moving.displacement = Vector3(0, 5, 0);
    EXPECT_FALSE(queries.CastShape(moving, hit, leaving));
    moving.displacement = Vector3(5, -0.5f, 0);  // into the floor it is
    ASSERT_TRUE(queries.CastShape(moving, hit, leaving));
    EXPECT_EQ(hit.body, floor);
    EXPECT_EQ(hit.fraction, 0);
    EXPECT_NEAR(hit.depth, 0.001, 1e-5);
    ASSERT_TRUE(queries.CastShape(moving, hit, {.ignoreSeparating = true, .measureDepth = false}));
    EXPECT_EQ(hit.depth, 0);
}

TEST(IgnoreSeparating, HoldsForPlanesAndTrianglesToo) {
    TestWorld world;
    world.Add({.shape = ShapePtr(Plane::Create().Value()), .motion = MotionType::Static});
    const auto ball = std::static_pointer_cast<const ConvexShape>(SphereOf(0.5f));
    const ShapeCastSettings leaving{.ignoreSeparating = true};
    WorldShapeHit hit;
    const QueryInterface& queries = world.System().Queries();
    EXPECT_FALSE(queries.CastShape({ball.get(), {{0, 0.4, 0}, {}}, {3, 0, 0}}, hit, leaving));
    EXPECT_TRUE(queries.CastShape({ball.get(), {{0, 0.4, 0}, {}}, {3, -1, 0}}, hit, leaving));
    EXPECT_TRUE(queries.CastShape({ball.get(), {{0, 0.4, 0}, {}}, {3, 0, 0}}, hit));
}

}  // namespace
}  // namespace fulcrum::testing
