// Friction against the closed forms: inclines, stopping distances, rolling, spinning, and how two coefficients combine.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <vector>

namespace fulcrum::testing {
namespace {

// A plane that rises along x, through the origin, and the rotation of what lies on it.
Quaternion AddIncline(TestWorld& world, double angle, float friction) {
    const Quaternion rotation = RotationAbout({0, 0, 1}, angle);
    const Position below = Rotate(rotation, Vector3(0, -1, 0)).cast<double>();
    world.Add({.shape = BoxOf(200, 1, 20),
               .motion = MotionType::Static,
               .position = below,
               .rotation = rotation,
               .material = {.friction = friction}});
    return rotation;
}

BodyId AddOnIncline(TestWorld& world, const Quaternion& rotation, const ShapePtr& shape, float height, float friction) {
    const Position position = Rotate(rotation, Vector3(0, height, 0)).cast<double>();
    return world.Add({.shape = shape, .position = position, .rotation = rotation, .material = {.friction = friction}});
}

TEST(Incline, SlidesWithGravityMinusFriction) {
    TestWorld world(NoSleep());
    const Quaternion rotation = AddIncline(world, 30 * kDegree, 0.3f);
    const BodyId box = AddOnIncline(world, rotation, CubeOf(0.5f), 0.5f, 0.3f);
    // From a second on, so that the way in which the contact settles does not count.
    world.Run(1);
    const double v1 = double(Length(world.VelocityOf(box)));
    world.Run(2);
    const double v3 = double(Length(world.VelocityOf(box)));
    const double expected = kGravity * (std::sin(30 * kDegree) - 0.3 * std::cos(30 * kDegree));
    EXPECT_NEAR((v3 - v1) / 2, expected, 1e-3 * expected);
}

TEST(Incline, HoldsWhatItsFrictionCanHold) {
    TestWorld world(NoSleep());
    const Quaternion rotation = AddIncline(world, 40 * kDegree, 0.9f);
    const BodyId box = AddOnIncline(world, rotation, CubeOf(0.5f), 0.5f, 0.9f);
    world.Run(5);
    const Position settled = world.PositionOf(box);
    world.Run(55);
    // Separations are rounded to 6e-8 m, which pushes move a body by, a tenth of that aside, in each substep: some
    // hundredths of a millimeter a minute.
    EXPECT_LT((world.PositionOf(box) - settled).norm(), 2e-5);
}

TEST(Incline, ASphereRollsDownWithFiveSeventhsOfGravity) {
    TestWorld world(NoSleep());
    const Quaternion rotation = AddIncline(world, 15 * kDegree, 0.9f);
    const BodyId ball = AddOnIncline(world, rotation, SphereOf(0.5f), 0.5f, 0.9f);
    world.Run(1);
    const double v1 = double(Length(world.VelocityOf(ball)));
    world.Run(2);
    const double v3 = double(Length(world.VelocityOf(ball)));
    EXPECT_NEAR((v3 - v1) / 2, 1.8136, 1e-3 * 1.8136);
    // It does not slip.
    EXPECT_NEAR(double(Length(world.Bodies().GetAngularVelocity(ball))) * 0.5, v3, 1e-3 * v3);
}

TEST(Friction, StopsBoxesAlikeInAllDirections) {
    TestWorld world(NoSleep());
    world.AddFloor({.friction = 0.6f});
    std::vector<BodyId> boxes;
    std::vector<Vector3> headings;
    for (int i = 0; i < 32; ++i) {
        const double angle = i * kPi / 16;
        headings.push_back(Vector3(static_cast<float>(std::cos(angle)), 0, static_cast<float>(std::sin(angle))));
        const Vector3 start = headings.back() * 10;
        boxes.push_back(world.Add({.shape = CubeOf(0.5f),
                                   .position = {start.x(), 0.5, start.z()},
                                   .linearVelocity = headings.back() * 25.0f,
                                   .material = {.friction = 0.6f}}));
    }
    world.Run(6);
    const double expected = 25.0 * 25.0 / (2 * 0.6 * kGravity);  // 53.09 m
    double least = 1e9, most = 0, sum = 0;
    for (size_t i = 0; i < 32; ++i) {
        const Position start = (headings[i] * 10).cast<double>() + Position(0, 0.5, 0);
        const Position way = world.PositionOf(boxes[i]) - start;
        const double along = way.dot(headings[i].cast<double>());
        const double sideways = (way - along * headings[i].cast<double>() - Position(0, way.y(), 0)).norm();
        EXPECT_LT(sideways, 1e-3 * expected) << i;
        const Vector3 x = Rotate(world.Bodies().GetPose(boxes[i]).rotation, Vector3(1, 0, 0));
        EXPECT_LT(std::fabs(x.z()), 0.1 * kDegree) << i;
        EXPECT_LT(Length(world.VelocityOf(boxes[i])), 1e-3f);
        least = std::min(least, along);
        most = std::max(most, along);
        sum += along / 32;
    }
    // Velocities change at the beginning of each substep h: v h / 2 = 0.052 m, a thousandth, too short.
    EXPECT_NEAR(sum, expected, 1.5e-3 * expected);
    EXPECT_LT((most - least) / expected, 5e-4);
}

TEST(Friction, TurnsSlidingIntoRolling) {
    TestWorld world(NoSleep());
    world.AddFloor({.friction = 0.3f});
    const BodyId ball = world.Add({.shape = SphereOf(0.5f),
                                   .position = {0, 0.5, 0},
                                   .linearVelocity = {10, 0, 0},
                                   .material = {.friction = 0.3f}});
    const double dt = 1.0 / 240;
    double time = 0, x = 0;
    for (int i = 0; i < 480; ++i) {
        world.Step(dt);
        const double slip =
            double(world.VelocityOf(ball).x()) + 0.5 * double(world.Bodies().GetAngularVelocity(ball).z());
        if (time == 0 && slip < 1e-3) {
            time = (i + 1) * dt;
            x = world.PositionOf(ball).x();
        }
    }
    const double expected = 2 * 10 / (7 * 0.3 * kGravity);
    EXPECT_NEAR(time, expected, dt + 1e-3 * expected);
    EXPECT_NEAR(x, 8.3214, 10 * dt + 1e-3 * 8.3);
    EXPECT_NEAR(world.VelocityOf(ball).x(), 50.0 / 7, 1e-3 * 50 / 7);
}

// A hull whose points of contact are not spread about its center of mass, and that resists turns differently about
// different axes: friction acts against the slip, where what would stop the point of contact points 8 % aside.
TEST(Friction, LetsWhatIsLopsidedSlideStraight) {
    const ShapePtr hull = HullOf({{0, -0.3f, 0},
                                  {3, -0.3f, 0},
                                  {0.6f, -0.3f, 1},
                                  {0, -0.3f, 1},
                                  {0, 0.3f, 0},
                                  {3, 0.3f, 0},
                                  {0.6f, 0.3f, 1},
                                  {0, 0.3f, 1}});
    for (const int substeps : {4, 16})
        for (const double heading : {0.0, 0.5 * kPi, 0.7, 2.0, 4.0}) {
            SystemSettings settings = NoSleep();
            settings.solver.substeps = substeps;
            TestWorld world(settings);
            world.AddFloor();
            const Vector3 along(static_cast<float>(std::cos(heading)), 0, static_cast<float>(std::sin(heading)));
            const BodyId id = world.Add({.shape = hull, .position = {0, 0.3, 0}, .linearVelocity = along * 4});
            world.Run(2);
            const Position moved = world.PositionOf(id) - Position(0, 0.3, 0);
            const double way = moved.x() * double{along.x()} + moved.z() * double{along.z()};
            EXPECT_NEAR(way, 16 / (2 * 0.5 * kGravity), 0.01 * way) << heading;
            EXPECT_LT(std::fabs(moved.x() * double{along.z()} - moved.z() * double{along.x()}), 2e-3) << heading;
            EXPECT_LT(std::fabs(world.Bodies().GetPose(id).rotation.y), 1e-3f) << heading;
        }
}

TEST(Friction, StopsASpinningBoxAtItsMeanRadius) {
    const float a = 0.5f, mu = 0.5f;
    TestWorld world(NoSleep());
    world.AddFloor({.friction = mu});
    const BodyId box = world.Add(
        {.shape = CubeOf(a), .position = {0, 0.5, 0}, .angularVelocity = {0, 10, 0}, .material = {.friction = mu}});
    // Torque mu m g r with r = 0.7652 a, I = 2/3 m a^2.
    const double slowing = 0.5 * kGravity * 0.7652 * 0.5 / (2.0 / 3 * 0.25);
    world.Run(0.5);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(box).y(), 10 - slowing * 0.5, 0.01 * 10);
    world.Run(0.5);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(box).y(), 0, 1e-3);  // at 0.888 s
    EXPECT_LT((world.PositionOf(box) - Position(0, 0.5, 0)).norm(), 1e-3);
}

TEST(Friction, HoldsAgainstATwistThatIsTooWeak) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 10});
    // It holds mu m g r = 0.5 * 10 * 9.81 * 0.3826 = 18.8 N m.
    for (int i = 0; i < 120; ++i) {
        ASSERT_TRUE(world.Bodies().AddTorque(box, {0, 17, 0}));
        world.Step();
    }
    EXPECT_LT(std::fabs(world.Bodies().GetAngularVelocity(box).y()), 1e-3f);
    for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(world.Bodies().AddTorque(box, {0, 21, 0}));
        world.Step();
    }
    // I = 2/3 m a^2 = 1.667.
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(box).y(), (21 - 18.77) / (10.0 * 2 / 3 * 0.25), 0.02);
}

// Deceleration of a sliding box over g, with the friction that its material and the floor's combine to.
double CombinedFriction(const Material& box, const Material& floor) {
    TestWorld world(NoSleep());
    world.AddFloor(floor);
    const BodyId id = world.Add(
        {.shape = BoxOf(0.5f, 0.1f, 0.5f), .position = {0, 0.1, 0}, .linearVelocity = {20, 0, 0}, .material = box});
    world.Run(0.25);
    const double before = double(world.VelocityOf(id).x());
    world.Run(0.5);
    return (before - double(world.VelocityOf(id).x())) / (0.5 * kGravity);
}

TEST(Friction, CombinesByTheRule) {
    const auto with = [](float mu, CombineRule rule) { return Material{.friction = mu, .frictionRule = rule}; };
    const double tolerance = 2e-3;  // of friction 0.9 at most: the impulses' relative error
    EXPECT_NEAR(CombinedFriction(with(0.4f, CombineRule::GeometricMean), with(0.9f, CombineRule::GeometricMean)), 0.6,
                tolerance);
    EXPECT_NEAR(CombinedFriction(with(0.4f, CombineRule::Average), with(0.9f, CombineRule::Average)), 0.65, tolerance);
    EXPECT_NEAR(CombinedFriction(with(0.4f, CombineRule::Minimum), with(0.9f, CombineRule::Minimum)), 0.4, tolerance);
    EXPECT_NEAR(CombinedFriction(with(0.4f, CombineRule::Multiply), with(0.9f, CombineRule::Multiply)), 0.36,
                tolerance);
    EXPECT_NEAR(CombinedFriction(with(0.4f, CombineRule::Maximum), with(0.9f, CombineRule::Maximum)), 0.9, tolerance);
}

TEST(Friction, TheLaterRuleWins) {
    const auto with = [](float mu, CombineRule rule) { return Material{.friction = mu, .frictionRule = rule}; };
    EXPECT_NEAR(CombinedFriction(with(0.4f, CombineRule::Minimum), with(0.9f, CombineRule::Average)), 0.4, 2e-3);
    EXPECT_NEAR(CombinedFriction(with(0.4f, CombineRule::GeometricMean), with(0.9f, CombineRule::Maximum)), 0.9, 2e-3);
}

TEST(Friction, ANewMaterialTakesEffectOnContactsThatExist) {
    TestWorld world(NoSleep());
    world.AddFloor({.friction = 0});
    const BodyId box = world.Add(
        {.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .linearVelocity = {5, 0, 0}, .material = {.friction = 0}});
    world.Run(1);
    // What the box gains by rocking as it settles stays far below what friction will take.
    EXPECT_NEAR(world.VelocityOf(box).x(), 5, 1e-3);
    ASSERT_TRUE(world.Bodies().SetMaterial(box, {.friction = 0.5f, .frictionRule = CombineRule::Maximum}));
    world.Run(0.5);
    EXPECT_NEAR(world.VelocityOf(box).x(), 5 - 0.25 * kGravity, 0.01);
}

}  // namespace
}  // namespace fulcrum::testing
