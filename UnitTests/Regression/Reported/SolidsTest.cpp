// Reported of shapes elsewhere: inertia of compounds with offsets, depths of a ball inside a box, cones that are taken
// for cylinders. The references are the same solid as one box, and the distance to a profile.
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

// The largest difference of two inertia tensors, the second one given in a frame turned by q, over the trace.
double Difference(const SymmetricMatrix3& a, const SymmetricMatrix3& b, const Quaternion& q) {
    double worst = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const Vector3 u = Vector3::Unit(i), v = Vector3::Unit(j);
            const double other = Dot(InverseRotate(q, u), b * InverseRotate(q, v));
            worst = std::max(worst, std::fabs(double{Dot(u, a * v)} - other));
        }
    return worst / (double{b.xx} + b.yy + b.zz);
}

// A box cut into three slices, turned and up to 5 m aside: sums of squares of 75 m2 beside a box of 0.01 m2 and more
// lose up to that ratio of a float's 6e-8 where they are taken in floats, as those of a compound that is edited.
TEST(Solids, ACompoundOfSlicesHasTheInertiaOfTheWhole) {
    RandomPoses random(4);
    for (int i = 0; i < 60; ++i) {
        const Vector3 half(random.Between(0.1f, 1), random.Between(0.1f, 1), random.Between(0.1f, 1)),
            offset = random.InBox(5), slice(half.x(), half.y() / 3, half.z());
        const Quaternion q = random.Rotation();
        std::vector<CompoundShape::ChildSettings> slices;
        for (const int k : {-1, 0, 1})
            slices.push_back({.shape = BoxOf(slice.x(), slice.y(), slice.z()),
                              .position = offset + Rotate(q, Vector3(0, 2 * slice.y() * static_cast<float>(k), 0)),
                              .rotation = q});
        TestWorld world;
        const BodyId whole = world.Add({.shape = BoxOf(half.x(), half.y(), half.z())}),
                     compound = world.Add({.shape = Compound::Create(slices).Value(), .position = {50, 0, 0}}),
                     edited = world.Add({.shape = MutableCompound::Create(slices).Value(), .position = {100, 0, 0}});
        const SymmetricMatrix3 reference = world.Bodies().GetInertia(whole);
        EXPECT_LT(Difference(world.Bodies().GetInertia(compound), reference, q), 2e-5) << i;
        EXPECT_LT(Difference(world.Bodies().GetInertia(edited), reference, q), 1e-4) << i;
    }
}

// A cube of 2 m and density 1000: m (a2 / 6 + d2) with the edge a, the center moved by d = 0.5 m along x.
TEST(Solids, ABallastAddsItsParallelAxis) {
    TestWorld world;
    const BodyId body = world.Add({.shape = OffsetCenterOfMass(CubeOf(1), {0.5f, 0.2f, 0}).Value()});
    EXPECT_NEAR(world.Bodies().GetInertia(body).yy / (8000 * (4 / 6.0 + 0.25)), 1, 1e-4);
}

// A ball of 5 mm goes through the top of a box, down to 7 cm below it. Distances are those of floats at 0.1 m.
TEST(Solids, ABallIsAsDeepInABoxAsItIs) {
    TestWorld world;
    world.Add({.shape = BoxOf(0.5f, 0.25f, 0.5f), .motion = MotionType::Static, .position = {0, -0.25, 0}});
    const ShapePtr ball = SphereOf(0.005f);
    for (int i = 0; i < 400; ++i) {
        const double height = 0.01 - 2e-4 * i;
        const PlacedShape placed{ball.get(), {{0.1, height, 0.05}, {}}};
        WorldClosest closest;
        ASSERT_TRUE(world.System().Queries().FindClosest(placed, 1, closest)) << height;
        EXPECT_NEAR(closest.distance, height - 0.005, 2e-6) << height;
        std::vector<WorldContact> contacts;
        world.System().Queries().CollideShape(placed, 0.02f, contacts);
        ASSERT_EQ(contacts.size(), 1u) << height;
        EXPECT_NEAR(contacts[0].points[0].separation, height - 0.005, 2e-6) << height;
    }
}

// The distance of (r, y) to the segment from a to b.
double ToSegment(double r, double y, const double (&a)[2], const double (&b)[2]) {
    const double dx = b[0] - a[0], dy = b[1] - a[1],
                 t = std::clamp(((r - a[0]) * dx + (y - a[1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
    return std::hypot(r - a[0] - t * dx, y - a[1] - t * dy);
}

// Of points within 2 m of a cone and a tapered cylinder of 2 m height: the signed distance to the profile, (0, -1) to
// (1, -1) to (top, 1) to (0, 1).
TEST(Solids, AConeIsNoCylinder) {
    RandomPoses random(2);
    for (const double top : {0.0, 0.3}) {
        const auto shape = top > 0 ? Cylinder::CreateTapered(1, static_cast<float>(top), 1).Value()
                                   : Cylinder::CreateCone(1, 1).Value();
        for (int i = 0; i < 2000; ++i) {
            const Vector3 point = random.InBox(2);
            const double r = std::hypot(double{point.x()}, double{point.z()}), y = point.y();
            double distance = std::min(ToSegment(r, y, {0, -1}, {1, -1}), ToSegment(r, y, {1, -1}, {top, 1}));
            if (top > 0) distance = std::min(distance, ToSegment(r, y, {top, 1}, {0, 1}));
            if (std::fabs(y) < 1 && r < 1 + (top - 1) * (y + 1) / 2) distance = -distance;
            ClosestPoints closest;
            ASSERT_TRUE(FindClosestPoint(*shape, Vector3(point - shape->Mass().centerOfMass), 10, closest));
            EXPECT_NEAR(closest.distance, distance, 1e-4) << i;
        }
    }
}

}  // namespace
}  // namespace fulcrum::testing
