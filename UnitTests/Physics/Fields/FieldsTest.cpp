// Buoyancy, wind and fields of force, against closed forms; and that what they hold still falls asleep.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Physics/Fields/Fields.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

void Sail(TestWorld& world, Fields& fields, double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / kStep + 0.5); ++i) {
        ASSERT_TRUE(fields.Apply(world.System(), kStep));
        world.Step();
    }
}

// Of 40 % of the density of water 40 % are below the surface. Asleep it stays.
TEST(Water, ABoxFloatsAtItsDensityAndSleeps) {
    TestWorld world;
    Fields sea{.waters = {{.level = 2}}};
    const BodyId box = world.Add({.shape = BoxOf(1, 0.5f, 1), .position = {0, 3, 0}, .density = 400});
    ASSERT_TRUE(world.Bodies().SetAllowSleep(box, false));
    Sail(world, sea, 30);
    EXPECT_NEAR(world.PositionOf(box).y(), 2 + 0.5 - 0.4, 1e-5);
    ASSERT_TRUE(world.Bodies().SetAllowSleep(box, true));
    Sail(world, sea, 1);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    const BodyBits before = BitsOf(world, box);
    Sail(world, sea, 5);
    EXPECT_EQ(BitsOf(world, box), before);
    // The tide wakes it, and takes it along.
    sea.waters[0].level = 2.5;
    Sail(world, sea, 20);
    // Slow enough to sleep it is where it heaves by less than 0.05 m/s over its w = sqrt(g / draft).
    EXPECT_NEAR(world.PositionOf(box).y(), 2.6, 0.05 / std::sqrt(kGravity / 0.4));
    EXPECT_FALSE(world.Bodies().IsAwake(box));
}

// A ball of half the density of water is half below it, a heavier one sinks to the floor.
TEST(Water, LightBallsFloatAndHeavyOnesSink) {
    TestWorld world;
    world.AddFloor({}, {0, -5, 0});
    Fields sea{.waters = {Water{}}};
    const BodyId light = world.Add({.shape = SphereOf(0.5f), .position = {0, -2, 0}, .density = 500});
    const BodyId heavy = world.Add({.shape = SphereOf(0.5f), .position = {3, 1, 0}, .density = 1500});
    Sail(world, sea, 60);
    EXPECT_NEAR(world.PositionOf(light).y(), 0, 0.01);  // asleep, see above
    EXPECT_NEAR(world.PositionOf(heavy).y(), -4.5, 0.005);
    EXPECT_FALSE(world.Bodies().IsAwake(light));
    EXPECT_FALSE(world.Bodies().IsAwake(heavy));
}

// Heaving without drag: m z'' = -rho g A z. With drag c of the displaced water c m / 2 takes energy; here none.
TEST(Water, ABoxHeavesWithItsPeriod) {
    TestWorld world(NoSleep());
    Fields sea{.waters = {{.drag = 0, .angularDrag = 0}}};
    const BodyId box = world.Add({.shape = BoxOf(1, 0.5f, 1), .position = {0, 0.02, 0}, .density = 500});
    int crossings = 0, first = 0, last = 0;
    double before = 1;
    for (int i = 1; i <= 1200; ++i) {
        ASSERT_TRUE(sea.Apply(world.System(), kStep));
        world.Step();
        const double y = world.PositionOf(box).y();
        if (before < 0 && y >= 0) {
            if (crossings++ == 0) first = i;
            last = i;
        }
        before = y;
    }
    ASSERT_GT(crossings, 5);
    const double draft = 0.5;  // w^2 = g / draft
    const double period = 2 * kPi * std::sqrt(draft / kGravity);
    EXPECT_NEAR((last - first) * kStep / (crossings - 1), period, 0.01 * period);
}

// v' = -drag v and L' = -drag L of what has the density of water and is below it.
TEST(Water, DragIsExponential) {
    TestWorld world;
    Fields sea{.waters = {{.drag = 0.5f, .angularDrag = 2}}};
    const BodyId ball = world.Add({.shape = SphereOf(0.5f),
                                   .position = {0, -10, 0},
                                   .linearVelocity = {3, 0, 0},
                                   .angularVelocity = {0, 0, 4},
                                   .density = 1000});
    Sail(world, sea, 2);
    EXPECT_NEAR(world.VelocityOf(ball).x(), 3 * std::exp(-1.0), 1e-3);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(ball).z(), 4 * std::exp(-4.0), 1e-3);
    EXPECT_NEAR(world.PositionOf(ball).y(), -10, 1e-3);
    // A current takes it along; drag beyond measure stops it and no more.
    sea.waters[0].velocity = Vector3(0, 0, 1);
    sea.waters[0].drag = 1e6f;
    Sail(world, sea, 0.1);
    EXPECT_LT(Length(Vector3(world.VelocityOf(ball) - Vector3(0, 0, 1))), 1e-4f);
}

// A barge, beam 4, height 2, length 10 m, of half the density of water: its center of mass is below the metacenter.
// Heeled by 40 degrees it comes back, and rolls with T = 2 pi sqrt(I / (m g GM)) where it hardly heels.
class Ship : public ::testing::Test {
protected:
    BodyId AddShip(double heel) {
        return world.Add({.shape = BoxOf(2, 1, 5), .rotation = RotationAbout({0, 0, 1}, heel), .density = 500});
    }
    TestWorld world{NoSleep()};
    Fields sea{.waters = {{.drag = 0.5f, .angularDrag = 0.5f}}};
};

TEST_F(Ship, RightsItself) {
    const BodyId ship = AddShip(40 * kDegree);
    Sail(world, sea, 60);
    const Vector3 up = Rotate(world.Bodies().GetPose(ship).rotation, Vector3(0, 1, 0));
    EXPECT_GT(up.y(), std::cos(0.2 * kDegree));
    EXPECT_NEAR(world.PositionOf(ship).y(), 0, 0.01);
}

// GM = KB + BM - KG with BM = beam^2 / (12 draft) of a box.
TEST_F(Ship, RollsWithThePeriodOfItsMetacentricHeight) {
    sea.waters[0].drag = sea.waters[0].angularDrag = 0;
    const BodyId ship = AddShip(1 * kDegree);
    const double draft = 1, metacentric = draft / 2 + 16 / (12 * draft) - 1;
    const double inertia = (4.0 * 4 + 2 * 2) / 12;  // per kg, about the length
    int crossings = 0, first = 0, last = 0;
    double before = 1;
    for (int i = 1; i <= 3000; ++i) {
        ASSERT_TRUE(sea.Apply(world.System(), kStep));
        world.Step();
        const double heel = world.Bodies().GetPose(ship).rotation.z;
        if (before < 0 && heel >= 0) {
            if (crossings++ == 0) first = i;
            last = i;
        }
        before = heel;
    }
    ASSERT_GT(crossings, 4);
    const double period = 2 * kPi * std::sqrt(inertia / (kGravity * metacentric));
    EXPECT_NEAR((last - first) * kStep / (crossings - 1), period, 0.02 * period);
}

// A square beam of half the density of water is unstable on its face: BM = 1/6 of its edge, KG - KB = 1/4. It comes to
// rest on an edge.
TEST(Water, ASquareBeamTurnsOntoItsEdge) {
    TestWorld world(NoSleep());
    Fields sea{.waters = {{.angularDrag = 1}}};
    const BodyId beam =
        world.Add({.shape = BoxOf(0.5f, 0.5f, 3), .rotation = RotationAbout({0, 0, 1}, 2 * kDegree), .density = 500});
    Sail(world, sea, 60);
    const Vector3 up = Rotate(world.Bodies().GetPose(beam).rotation, Vector3(0, 1, 0));
    EXPECT_NEAR(std::fabs(up.x()), std::sqrt(0.5), 1e-3);
}

// A compound has the lift of its pieces: a catamaran of two hulls floats at their density.
TEST(Water, PiecesOfACompoundLiftTogether) {
    TestWorld world(NoSleep());
    Fields sea{.waters = {Water{}}};
    const ShapePtr cat = CompoundOf({{.shape = BoxOf(0.25f, 0.25f, 2), .position = {-1.5f, 0, 0}},
                                     {.shape = BoxOf(0.25f, 0.25f, 2), .position = {1.5f, 0, 0}}});
    const BodyId id = world.Add({.shape = cat, .position = {0, 0.2, 0}, .density = 300});
    Sail(world, sea, 30);
    EXPECT_NEAR(world.PositionOf(id).y(), 0.25 - 0.15, 0.002);
    const Lift lift = SubmergedVolume(world.Bodies(), id, {0, 1, 0}, 0);
    EXPECT_NEAR(lift.volume, 0.3 * 2 * 0.5 * 0.5 * 4, 0.005);
}

// v' = -k v^2 in still air: v0 / (1 + k v0 t).
TEST(Wind, StillAirSlowsByTheSquare) {
    TestWorld world(NoGravity());
    Fields air{.winds = {{.density = 1.2f, .dragCoefficient = 0.5f}}};
    const BodyId ball = world.Add({.shape = SphereOf(1), .linearVelocity = {20, 0, 0}, .mass = 10});
    Sail(world, air, 3);
    const double k = 0.5 * 1.2 * 0.5 * kPi / 10;
    EXPECT_NEAR(world.VelocityOf(ball).x(), 20 / (1 + k * 20 * 3), 0.01);
}

// A falling ball reaches the speed at which drag is its weight.
TEST(Wind, ABallFallsAtItsTerminalSpeed) {
    TestWorld world;
    Fields air{.winds = {{.density = 1.2f, .dragCoefficient = 0.5f}}};
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .position = {0, 2000, 0}, .mass = 5});
    Sail(world, air, 30);
    const double area = kPi * 0.25, terminal = std::sqrt(2 * 5 * kGravity / (1.2 * 0.5 * area));
    EXPECT_NEAR(world.VelocityOf(ball).y(), -terminal, 0.01 * terminal);
}

// In its region alone; a box that friction holds against it sleeps, until the wind grows.
TEST(Wind, LetsSleepWhatItDoesNotMove) {
    TestWorld world;
    world.AddFloor();
    Fields air{.winds = {{.region = {.lower = {-5, -5, -5}, .upper = {5, 5, 5}}, .velocity = {10, 0, 0}}}};
    const BodyId held = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 20});
    const BodyId outside = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 20}, .mass = 1});
    Sail(world, air, 3);
    EXPECT_FALSE(world.Bodies().IsAwake(held));
    EXPECT_NEAR(world.PositionOf(held).x(), 0, 1e-3);
    EXPECT_NEAR(world.PositionOf(outside).x(), 0, 1e-3);
    air.winds[0].velocity = Vector3(40, 0, 0);
    Sail(world, air, 3);
    EXPECT_GT(world.PositionOf(held).x(), 1);
}

TEST(ForceField, AcceleratesAllAlike) {
    TestWorld world(NoGravity());
    Fields fields;
    fields.forces.push_back({.acceleration = {0, 2, 0}});
    // A planet at the origin: g = 100 / r^2.
    fields.forces.push_back(
        {.region = {.lower = {-50, -50, -50}, .upper = {50, 50, 50}}, .accelerationAt = [](const Position& at) {
             const Vector3 r = at.cast<float>();
             const float length = Length(r);
             return Vector3(r * (-100 / (length * length * length)));
         }});
    const BodyId far = world.Add({.shape = SphereOf(0.5f), .position = {100, 0, 0}, .mass = 3});
    // On its orbit: v^2 = 100 / r, but for the field of all.
    Fields planet{.forces = {fields.forces[1]}};
    const BodyId moon =
        world.Add({.shape = SphereOf(0.5f), .position = {10, 0, 0}, .linearVelocity = {0, 0, std::sqrt(10.0f)}});
    for (int i = 0; i < 60; ++i) {
        ASSERT_TRUE(fields.Apply(world.System(), kStep, {.ignore = {&moon, 1}}));
        ASSERT_TRUE(planet.Apply(world.System(), kStep, {.ignore = {&far, 1}}));
        world.Step();
    }
    EXPECT_NEAR(world.PositionOf(far).y(), 1, 1e-4);
    const Position at = world.PositionOf(moon);
    EXPECT_NEAR(at.norm(), 10, 0.05);
    const double angle = std::sqrt(10.0) / 10;
    EXPECT_NEAR(std::atan2(at.z(), at.x()), angle, 0.01);
}

TEST(Fields, RefuseWhatMakesNoSenseAndAddNothing) {
    TestWorld world;
    const BodyId box = world.Add({.shape = CubeOf(0.5f)});
    const uint64_t before = world.System().HashState();
    const auto codeOf = [&](Fields fields, double dt = kStep) {
        const Status status = fields.Apply(world.System(), dt);
        return status ? ErrorCode::UnknownId : status.GetError().code;
    };
    EXPECT_EQ(codeOf({.waters = {{.up = {0, 2, 0}}}}), ErrorCode::Unnormalized);
    EXPECT_EQ(codeOf({.waters = {{.density = -1}}}), ErrorCode::Negative);
    EXPECT_EQ(codeOf({.waters = {{.level = NAN}}}), ErrorCode::NonFinite);
    EXPECT_EQ(codeOf({.winds = {{.velocity = {INFINITY, 0, 0}}}}), ErrorCode::NonFinite);
    EXPECT_EQ(codeOf({.forces = {{.acceleration = {NAN, 0, 0}}}}), ErrorCode::NonFinite);
    EXPECT_EQ(codeOf({.waters = {Water{}}}, 0), ErrorCode::NonPositive);
    EXPECT_EQ(codeOf({.waters = {Water{}}}, 2), ErrorCode::OutOfRange);
    EXPECT_EQ(world.System().HashState(), before);
    const Status status = Fields{.waters = {Water{}, {.drag = -1}}}.Apply(world.System(), kStep);
    EXPECT_NE(status.GetError().message.find("waters[1].drag"), std::string::npos);
    EXPECT_TRUE(world.Bodies().Exists(box));
}

}  // namespace
}  // namespace fulcrum::testing
