// Cylinders, cones, tapered capsules and custom shapes in simulations: they stand, roll and come to rest.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

double Lean(TestWorld& world, BodyId id) {  // of the body's y axis from the vertical, rad
    const Vector3 up = Rotate(world.Bodies().GetPose(id).rotation, Vector3(0, 1, 0));
    return std::sqrt(double{up.x()} * up.x() + double{up.z()} * up.z());
}

TEST(ConvexShapes, AColumnOfCylindersStands) {
    TestWorld world;
    world.AddFloor();
    const ShapePtr drum = Cylinder::Create(0.25f, 0.5f).Value();
    std::vector<BodyId> drums;
    for (int i = 0; i < 5; ++i) {
        drums.push_back(world.Add(
            {.shape = drum, .position = {0, 0.25 + 0.5 * i, 0}, .rotation = RotationAbout(Vector3(0, 1, 0), 0.3 * i)}));
    }
    world.Run(10);
    for (size_t i = 0; i < drums.size(); ++i) {
        const Position place = world.PositionOf(drums[i]);
        // Each interface settles within the slop that a box's does, 5 mm; the column stays where it is.
        EXPECT_NEAR(place.y(), 0.25 + 0.5 * static_cast<double>(i), 0.005 * static_cast<double>(i + 1));
        EXPECT_LE(std::hypot(place.x(), place.z()), 0.002);
        EXPECT_LE(Lean(world, drums[i]), 0.002);
        EXPECT_FALSE(world.Bodies().IsAwake(drums[i]));
    }
}

TEST(ConvexShapes, ACylinderRollsDownASlopeAsTheClosedFormSays) {
    // Rolling without slip: a = g sin(angle) / (1 + I / (m r^2)) = 2/3 g sin(angle).
    constexpr double kAngle = 15 * kDegree;
    for (const float rounding : {0.0f, 0.05f}) {
        TestWorld world;
        const Quaternion slope = RotationAbout(Vector3(0, 0, 1), -kAngle);
        world.Add({.shape = BoxOf(30, 0.5f, 5),
                   .motion = MotionType::Static,
                   .rotation = slope,
                   .material = {.friction = 1}});
        const Position up(std::sin(kAngle), std::cos(kAngle), 0), along(std::cos(kAngle), -std::sin(kAngle), 0);
        // Its axis is y: laid along z.
        const Position start = up * (0.5 + 0.5) - along * 15.0;
        const BodyId wheel = world.Add({.shape = Cylinder::Create(0.4f, 0.5f, rounding).Value(),
                                        .position = start,
                                        .rotation = slope * RotationAbout(Vector3(1, 0, 0), 90 * kDegree),
                                        .material = {.friction = 1}});
        world.Run(1);
        const double v1 = Dot<double>(world.VelocityOf(wheel).cast<double>(), along);
        world.Run(2);
        const double v3 = Dot<double>(world.VelocityOf(wheel).cast<double>(), along);
        const double expected = 2.0 / 3 * kGravity * std::sin(kAngle);
        // Peers are within 0.2 %; the contact is a line whose place under the axis is exact to the slop over the
        // radius.
        EXPECT_NEAR((v3 - v1) / 2, expected, 2e-3 * expected) << rounding;
        EXPECT_NEAR(world.PositionOf(wheel).z(), 0, 1e-3);
    }
}

TEST(ConvexShapes, AConeAndAFrustumStandOnTheirBases) {
    TestWorld world;
    world.AddFloor();
    const ShapePtr cone = Cylinder::CreateCone(0.5f, 0.4f).Value(),
                   frustum = Cylinder::CreateTapered(0.5f, 0.2f, 0.4f).Value();
    const BodyId ids[2] = {world.Add({.shape = cone, .position = {0, 0.5, 0}}),
                           world.Add({.shape = frustum, .position = {2, 0.5, 0}})};
    world.Run(5);
    for (const BodyId id : ids) {
        EXPECT_LE(Lean(world, id), 0.002);
        EXPECT_FALSE(world.Bodies().IsAwake(id));
        EXPECT_NEAR(world.PositionOf(id).y(), 0.5, 0.005);
    }
}

class Egg final : public CustomConvex {
public:
    Vector3 FarthestPoint(const Vector3& d) const override {
        const Vector3 radii(0.3f, 0.5f, 0.3f), scaled = d.cwiseProduct(radii);
        return scaled.cwiseProduct(radii) * (1.0f / Length(scaled));
    }
};

TEST(ConvexShapes, AllKindsFallIntoAPileAndStayAboveTheFloor) {
    TestWorld world({}, 2);
    world.AddFloor();
    const ShapePtr shapes[] = {
        Cylinder::Create(0.3f, 0.2f).Value(),
        Cylinder::CreateCone(0.3f, 0.3f).Value(),
        Cylinder::CreateTapered(0.3f, 0.15f, 0.3f, 0.03f).Value(),
        TaperedCapsule::Create(0.3f, 0.1f, 0.25f).Value(),
        CreateCustom<Egg>().Value(),
        CubeOf(0.25f),
        SphereOf(0.25f),
        CapsuleOf(0.2f, 0.15f),
        Triangle::Create(Vector3(0, 0, 0), Vector3(0.8f, 0, 0), Vector3(0, 0, 0.6f), 0.03f).Value()};
    std::vector<BodyId> ids;
    for (int i = 0; i < 72; ++i) {
        ids.push_back(world.Add({.shape = shapes[i % 9],
                                 .position = {0.35 * (i % 3), 0.5 + 0.4 * i, 0.3 * (i / 3 % 2)},
                                 .rotation = RotationAbout(Vector3(0.6f, 0, 0.8f), 0.7 * i)}));
    }
    world.Run(15);
    EXPECT_TRUE(world.AllFinite());
    for (const BodyId id : ids) {
        const Position place = world.PositionOf(id);
        EXPECT_GT(place.y(), 0.0) << id.index;
        EXPECT_LT(place.y(), 5.0) << id.index;
        EXPECT_LT(Length(world.VelocityOf(id)),
                  15.0f);  // bodies that roll off the pile roll on: the height gives 24 m/s at most
    }
}

TEST(ConvexShapes, ABodyOfAnEmptyShapeFallsThroughEverything) {
    TestWorld world;
    world.AddFloor();
    const BodyId ghost = world.Add({.shape = EmptyShape::Create(), .position = {0, 1, 0}, .mass = 2});
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(ghost).y(), 1 - kGravity / 2, 1e-3);
    EXPECT_EQ(world.Bodies().GetMass(ghost), 2);
    EXPECT_TRUE(world.Bodies().Remove(ghost));
}

}  // namespace
}  // namespace fulcrum::testing
