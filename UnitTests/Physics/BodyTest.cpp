// What a body is told to be: locked, layered, moved by hand, added, removed, read.
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Physics/SettingsFields.h>
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/FieldNames.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace fulcrum::testing {
namespace {

TEST(LockedAxes, LockedTranslationsStayInPlace) {
    TestWorld world;
    const BodyId hangs = world.Add({.shape = SphereOf(0.5f),
                                    .position = {0, 5, 0},
                                    .linearVelocity = {1, 1, 1},
                                    .lockedAxes = LockedAxes::TranslationY});
    world.Run(1);
    EXPECT_EQ(world.PositionOf(hangs).y(), 5);
    EXPECT_NEAR(world.PositionOf(hangs).x(), 1, 1e-5);
    EXPECT_NEAR(world.PositionOf(hangs).z(), 1, 1e-5);
}

TEST(LockedAxes, LockedRotationsNeitherTurnNorBeginTo) {
    TestWorld world(NoGravity());
    const BodyId ball =
        world.Add({.shape = SphereOf(0.5f), .angularVelocity = {1, 2, 3}, .lockedAxes = LockedAxes::Rotation});
    ASSERT_TRUE(world.Bodies().AddTorque(ball, {1000, 1000, 1000}));
    ASSERT_TRUE(world.Bodies().AddAngularImpulse(ball, {1000, 1000, 1000}));
    world.Run(1);
    const Quaternion q = world.Bodies().GetPose(ball).rotation;
    EXPECT_EQ(q.w, 1);
    EXPECT_EQ(world.Bodies().GetAngularVelocity(ball), Vector3(0, 0, 0));
}

TEST(LockedAxes, TheFreeAxisTurnsWithItsOwnInertia) {
    TestWorld world(NoGravity());
    // A rod that leans: its inertia about y alone is I_yy, not one over the y-y element of the inverse of the whole.
    const double angle = 30 * kDegree;
    const BodyId rod = world.Add({.shape = BoxOf(0.05f, 1, 0.05f),
                                  .rotation = RotationAbout({0, 0, 1}, angle),
                                  .mass = 3,
                                  .lockedAxes = LockedAxes::RotationX | LockedAxes::RotationZ});
    const double along = 3 * (0.0025 + 0.0025) / 3, across = 3 * (1 + 0.0025) / 3;
    const double inertia = along * std::cos(angle) * std::cos(angle) + across * std::sin(angle) * std::sin(angle);
    ASSERT_TRUE(world.Bodies().AddAngularImpulse(rod, {0, 1, 0}));
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(rod).y(), 1 / inertia, 1e-4 / inertia);
    EXPECT_EQ(world.Bodies().GetAngularVelocity(rod).x(), 0);
}

TEST(LockedAxes, AnUprightCapsuleDoesNotFallOver) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId walker = world.Add({.shape = CapsuleOf(0.5f, 0.3f),
                                     .position = {0, 0.8, 0},
                                     .linearVelocity = {3, 0, 0},
                                     .lockedAxes = LockedAxes::Rotation});
    world.Run(3);
    EXPECT_EQ(world.Bodies().GetPose(walker).rotation.w, 1);
    EXPECT_NEAR(world.PositionOf(walker).y(), 0.8, 0.005);
    EXPECT_NEAR(world.PositionOf(walker).x(), 9 / (2 * 0.5 * kGravity), 0.02);
}

TEST(LockedAxes, ContactsDoNotPushAlongLockedAxes) {
    TestWorld world(NoSleep());
    const BodyId rail = world.Add(
        {.shape = CubeOf(0.5f), .position = {0, 0, 0}, .gravityFactor = 0, .lockedAxes = LockedAxes::Plane2D});
    world.Add({.shape = SphereOf(0.5f), .position = {0.2, 3, 0.2}});
    world.Run(2);
    EXPECT_EQ(world.PositionOf(rail).z(), 0);
    EXPECT_LT(world.PositionOf(rail).y(), -0.1);
    const Vector3 w = world.Bodies().GetAngularVelocity(rail);
    EXPECT_EQ(w.x(), 0);
    EXPECT_EQ(w.y(), 0);
}

constexpr LockedAxes kNoTranslation = LockedAxes::TranslationX | LockedAxes::TranslationY | LockedAxes::TranslationZ;
constexpr LockedAxes kOnRailAlongX = LockedAxes::TranslationY | LockedAxes::TranslationZ | LockedAxes::Rotation;

// Half in the floor, and held there: rows that counted on the locked translation gave their bodies spin in each
// substep.
TEST(LockedAxes, AnOverlapAlongALockedAxisDoesNotSpinABody) {
    for (const int substeps : {1, 4, 16})
        for (const double dt : {1.0 / 240, 1.0 / 60, 0.1})
            for (const double lean : {0.0, 0.3, 0.8, 1.2, 1.5})
                for (const double tilt : {0.0, 0.02, 0.1, 0.4, 0.8, 1.2}) {
                    SystemSettings settings = NoSleep();
                    settings.solver.substeps = substeps;
                    TestWorld world(settings);
                    world.Add({.shape = Plane::Create().Value(), .motion = MotionType::Static});
                    const BodyId id = world.Add(
                        {.shape = TaperedCapsule::Create(0.9f, 0.4f, 0.7f).Value(),
                         .position = {0, 0.25, 0},
                         .rotation = RotationAbout(Vector3::UnitX(), lean) * RotationAbout(Vector3::UnitZ(), tilt),
                         .angularVelocity = {-2, -2, 0},
                         .lockedAxes = LockedAxes::TranslationY | LockedAxes::TranslationZ | LockedAxes::RotationZ});
                    float fastest = 0;
                    for (int i = 0; i < 120; ++i) {
                        world.Step(dt);
                        fastest = std::max(fastest, Length(world.Bodies().GetAngularVelocity(id)));
                    }
                    EXPECT_LT(fastest, 8)
                        << substeps << " substeps of " << dt << " s, lean " << lean << ", tilt " << tilt;
                }
}

// As on a static shelf, although it has a tenth to a thousandth of the mass.
TEST(LockedAxes, AHeavyBoxRestsOnALightShelf) {
    for (const LockedAxes locks : {kNoTranslation | LockedAxes::Rotation, kOnRailAlongX})
        for (const int substeps : {1, 4, 16})
            for (const float mass : {1.0f, 100.0f, 10000.0f}) {
                SystemSettings settings = NoSleep();
                settings.solver.substeps = substeps;
                TestWorld world(settings);
                world.Add({.shape = BoxOf(1, 0.1f, 1), .position = {0, 0, 0}, .mass = 10.0f, .lockedAxes = locks});
                const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.6, 0}, .mass = mass});
                world.Run(5);
                EXPECT_NEAR(world.PositionOf(box).y(), 0.6, 0.001) << substeps << " substeps, " << mass << " kg";
                EXPECT_LT(Length(world.Bodies().GetLinearVelocity(box)), 1e-6f);
            }
}

// That it can move along y alone leaves it half of its mobility along the slope's normal.
TEST(LockedAxes, ABoxOnAVerticalRailStaysOnASlope) {
    for (const float mass : {1e-6f, 1.0f, 1e25f}) {
        TestWorld world(NoSleep());
        const Quaternion tilt = RotationAbout(Vector3::UnitZ(), 0.25 * kPi);
        world.Add({.shape = BoxOf(4, 1, 4), .motion = MotionType::Static, .rotation = tilt});
        const double height = (1 + 0.5) * std::sqrt(2.0);
        const BodyId box =
            world.Add({.shape = CubeOf(0.5f),
                       .position = {0, height + 0.1, 0},
                       .rotation = tilt,
                       .mass = mass,
                       .lockedAxes = LockedAxes::TranslationX | LockedAxes::TranslationZ | LockedAxes::Rotation});
        world.Run(3);
        EXPECT_NEAR(world.PositionOf(box).y(), height, 0.001) << mass << " kg";
        EXPECT_EQ(world.PositionOf(box).x(), 0) << mass << " kg";
        EXPECT_LT(Length(world.Bodies().GetLinearVelocity(box)), 1e-5f) << mass << " kg";
    }
}

// It stops after v^2 / (2 mu g), whatever the masses.
TEST(LockedAxes, ABoxThatSlidesOnALightShelfStops) {
    for (const LockedAxes locks : {kNoTranslation | LockedAxes::Rotation, kOnRailAlongX})
        for (const float mass : {1.0f, 10.0f, 1000.0f, 1e5f}) {
            TestWorld world(NoSleep());
            const Material material{.friction = 0.5f};
            world.Add({.shape = BoxOf(4, 0.1f, 4),
                       .position = {0, 0, 0},
                       .mass = 10.0f,
                       .material = material,
                       .lockedAxes = locks});
            const BodyId box = world.Add({.shape = BoxOf(0.5f, 0.2f, 0.5f),
                                          .position = {0, 0.3, 0},
                                          .linearVelocity = {0, 0, 1},
                                          .mass = mass,
                                          .material = material});
            world.Run(2);
            EXPECT_NEAR(world.PositionOf(box).z(), 1 / (2 * 0.5 * kGravity), 0.004) << mass << " kg";
            EXPECT_NEAR(world.PositionOf(box).y(), 0.3, 0.001) << mass << " kg";
            EXPECT_LT(Length(world.Bodies().GetLinearVelocity(box)), 1e-5f) << mass << " kg";
        }
}

// A ball of m kg swings from a cart of M kg, on a rail or held in place. On the rail both swing about their common
// center of mass along x.
TEST(LockedAxes, APendulumSwingsFromALightCart) {
    for (const LockedAxes locks : {kNoTranslation | LockedAxes::Rotation, kOnRailAlongX})
        for (const float mass : {10.0f, 100.0f, 1000.0f}) {
            SystemSettings settings = NoSleep();
            settings.solver.substeps = 16;
            TestWorld world(settings);
            const BodyId cart = world.Add(
                {.shape = BoxOf(0.3f, 0.1f, 0.3f), .position = {0, 0, 0}, .mass = 10.0f, .lockedAxes = locks});
            const BodyId ball = world.Add({.shape = SphereOf(0.2f), .position = {1, 0, 0}, .mass = mass});
            const JointId joint = Join(world, Of<PointJointSettings>(Between(cart, ball, {0, 0, 0})));
            const bool onRail = locks == kOnRailAlongX;
            const double center = onRail ? double{mass} / double{10 + mass} : 0;
            float gap = 0;
            double lowest = 0;
            for (int i = 0; i < 300; ++i) {
                world.Step();
                gap = std::max(gap, JointsOf(world).GetError(joint).distance);
                lowest = std::min(lowest, world.PositionOf(ball).y());
                if (onRail) {
                    EXPECT_NEAR((10 * world.PositionOf(cart).x() + double{mass} * world.PositionOf(ball).x()) /
                                    double{10 + mass},
                                center, 0.001);
                }
            }
            EXPECT_LT(gap, 0.002f) << mass << " kg";
            EXPECT_NEAR(lowest, -1, 0.01) << mass << " kg";
        }
}

TEST(Layers, OnlyCollidingLayersHaveContacts) {
    SystemSettings settings;
    settings.layerCollides[1] &= ~4u;  // 1 and 2 ignore each other
    settings.layerCollides[2] &= ~2u;
    TestWorld world(settings);
    world.Add({.shape = BoxOf(5, 1, 5), .motion = MotionType::Static, .position = {0, -1, 0}, .layer = 1});
    const BodyId meets = world.Add({.shape = SphereOf(0.5f), .position = {-2, 1, 0}, .layer = 1});
    const BodyId falls = world.Add({.shape = SphereOf(0.5f), .position = {2, 1, 0}, .layer = 2});
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(meets).y(), 0.5, 0.005);
    EXPECT_LT(world.PositionOf(falls).y(), -10);
}

TEST(Kinematic, ArrivesWhereItIsMoved) {
    TestWorld world;
    const BodyId lift = world.Add({.shape = BoxOf(2, 0.5f, 2), .motion = MotionType::Kinematic});
    const Quaternion turned = RotationAbout({0, 1, 0}, 0.1);
    ASSERT_TRUE(world.Bodies().MoveKinematic(lift, {0.5, 0.25, -0.125}, turned, static_cast<float>(kStep)));
    world.Step();
    // Half a meter in one step, in float.
    EXPECT_LT((world.PositionOf(lift) - Position(0.5, 0.25, -0.125)).norm(), 1e-6);
    EXPECT_NEAR(world.Bodies().GetPose(lift).rotation.y, turned.y, 1e-6);
    EXPECT_NEAR(world.Bodies().GetPose(lift).rotation.w, turned.w, 1e-6);
}

TEST(Kinematic, FeelsNoForces) {
    TestWorld world;
    const BodyId platform =
        world.Add({.shape = BoxOf(2, 0.5f, 2), .motion = MotionType::Kinematic, .linearVelocity = {1, 0, 0}});
    world.Add({.shape = CubeOf(0.5f), .position = {0, 3, 0}, .mass = 1e5f});
    world.Run(1);
    EXPECT_EQ(world.VelocityOf(platform), Vector3(1, 0, 0));
    EXPECT_NEAR(world.PositionOf(platform).x(), 1, 1e-5);
    EXPECT_EQ(world.PositionOf(platform).y(), 0);
}

TEST(Kinematic, CarriesABoxByFriction) {
    TestWorld world;
    const BodyId platform =
        world.Add({.shape = BoxOf(5, 0.5f, 5), .motion = MotionType::Kinematic, .position = {0, -0.5, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Run(2);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    // Speeding up at 2 m/s2, less than mu g: the box keeps up, and wakes to do so.
    double x = 0;
    for (int i = 1; i <= 60; ++i) {
        const double t = i * kStep;
        x = t * t;
        ASSERT_TRUE(world.Bodies().MoveKinematic(platform, {x, -0.5, 0}, {}, static_cast<float>(kStep)));
        world.Step();
    }
    EXPECT_TRUE(world.Bodies().IsAwake(box));
    EXPECT_NEAR(world.PositionOf(box).x(), x, 0.02);
    EXPECT_NEAR(world.VelocityOf(box).x(), world.VelocityOf(platform).x(), 0.05);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 0.005);
}

// A paddle turns by 1 to 10 rad within a step. A ball at rest before it leaves with the speed w r of the place that
// hits it, and not with what that place's acceleration would add to it until the end of the step.
TEST(Kinematic, ThrowsNothingFasterThanItTurns) {
    for (const double dt : {0.01, kStep, 0.05, 0.1}) {
        SystemSettings settings;
        settings.gravity.setZero();
        TestWorld world(settings);
        const double spin = 100, radius = 1.5;
        world.Add({.shape = BoxOf(2, 0.2f, 0.2f),
                   .motion = MotionType::Kinematic,
                   .angularVelocity = {0, static_cast<float>(spin), 0}});
        const BodyId ball = world.Add({.shape = SphereOf(0.2f), .position = {radius, 0, -0.4}});
        world.Step(dt);
        const double speed = double{Length(world.VelocityOf(ball))};
        EXPECT_GT(speed, 0.95 * spin * radius) << dt;
        EXPECT_LT(speed, spin * radius) << dt;
    }
}

// Friction holds what needs less than its limit for its circle, for as long as it lasts.
TEST(Kinematic, ABoxKeepsItsPlaceOnATurntable) {
    struct Case {
        int substeps;
        double dt;  // s
    };
    for (const Case& c :
         {Case{1, 1.0 / 60}, Case{2, 1.0 / 60}, Case{4, 1.0 / 60}, Case{16, 1.0 / 60}, Case{4, 1.0 / 30}})
        for (const float half : {0.05f, 0.2f}) {
            SystemSettings settings = NoSleep();
            settings.solver.substeps = c.substeps;
            TestWorld world(settings);
            const double radius = 2, friction = 0.5, turn = std::sqrt(0.9 * friction * kGravity / radius);
            const Material material{.friction = static_cast<float>(friction)};
            world.Add({.shape = Cylinder::Create(0.2f, 4).Value(),
                       .motion = MotionType::Kinematic,
                       .position = {0, -0.2, 0},
                       .angularVelocity = {0, static_cast<float>(turn), 0},
                       .material = material});
            const BodyId box = world.Add({.shape = CubeOf(half),
                                          .position = {radius, double{half}, 0},
                                          .linearVelocity = {0, 0, static_cast<float>(-turn * radius)},
                                          .angularVelocity = {0, static_cast<float>(turn), 0},
                                          .material = material});
            for (int i = 0; i < static_cast<int>(20 / c.dt); ++i) world.Step(c.dt);
            const Position at = world.PositionOf(box);
            EXPECT_NEAR(std::hypot(at.x(), at.z()), radius, 0.002) << c.substeps << " at " << c.dt << ", " << half;
        }
}

TEST(Kinematic, TurnsABoxWithATurntable) {
    TestWorld world(NoSleep());
    world.Add({.shape = BoxOf(5, 0.5f, 5),
               .motion = MotionType::Kinematic,
               .position = {0, -0.5, 0},
               .angularVelocity = {0, 1, 0}});
    const BodyId box = world.Add(
        {.shape = CubeOf(0.5f), .position = {2, 0.5, 0}, .linearVelocity = {0, 0, -2}, .angularVelocity = {0, 1, 0}});
    // Half a turn; w^2 r = 2 m/s2 is less than mu g.
    world.Run(kPi);
    const Position expected(2 * std::cos(std::round(kPi * 60) / 60), 0.5, -2 * std::sin(std::round(kPi * 60) / 60));
    EXPECT_LT((world.PositionOf(box) - expected).norm(), 0.01);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 0.005);
}

TEST(Bodies, IdsOfRemovedBodiesStayInvalid) {
    TestWorld world;
    world.AddFloor();
    const BodyId first = world.Add({.shape = SphereOf(0.5f), .position = {0, 0.5, 0}});
    world.Steps(10);
    ASSERT_TRUE(world.Bodies().Remove(first));
    EXPECT_FALSE(world.Bodies().Exists(first));
    EXPECT_FALSE(world.Bodies().Remove(first));
    world.Step();
    const BodyId second = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    EXPECT_EQ(second.index, first.index);
    EXPECT_NE(second.generation, first.generation);
    EXPECT_FALSE(world.Bodies().Exists(first));
    EXPECT_TRUE(world.Bodies().Exists(second));
    EXPECT_EQ(world.Bodies().GetMass(first), 0);
    const Status status = world.Bodies().SetVelocity(first, {1, 0, 0}, {0, 0, 0});
    ASSERT_FALSE(status);
    EXPECT_EQ(status.GetError().code, ErrorCode::UnknownId);
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(second).y(), 0.5, 0.005);
}

TEST(Bodies, ComeAndGoByTheHundred) {
    TestWorld world;
    world.AddFloor();
    std::vector<BodyId> ids;
    for (int round = 0; round < 20; ++round) {
        for (int i = 0; i < 30; ++i)
            ids.push_back(world.Add({.shape = i % 2 ? SphereOf(0.3f) : CubeOf(0.3f),
                                     .position = {i % 6 * 0.5, 1.0 + i / 6 * 0.5, 0.1 * i}}));
        world.Steps(5);
        for (size_t i = 0; i < ids.size(); i += 2) {
            ASSERT_TRUE(world.Bodies().Remove(ids[i]));
            ids[i] = ids.back();
            ids.pop_back();
        }
        world.Steps(3);
        EXPECT_EQ(world.Report().bodies, ids.size() + 1);
    }
    for (BodyId id : ids) EXPECT_TRUE(world.Bodies().Exists(id));
    EXPECT_TRUE(world.AllFinite());
}

TEST(Bodies, AnAddedAndRemovedBodyLeavesTheOthersBitsAlone) {
    const auto run = [](bool visitor) {
        TestWorld world;
        world.AddFloor();
        const BodyId box =
            world.Add({.shape = CubeOf(0.5f), .position = {0, 2, 0}, .rotation = RotationAbout({0, 0, 1}, 0.3)});
        world.Steps(20);
        if (visitor) {
            const BodyId far = world.Add({.shape = CubeOf(0.5f), .position = {50, 2, 0}});
            EXPECT_TRUE(world.Bodies().Remove(far));
        }
        world.Steps(100);
        return BitsOf(world, box);
    };
    EXPECT_EQ(run(false), run(true));
}

TEST(Bodies, AreReadAsTheyWereDescribed) {
    TestWorld world;
    // The center of mass of this hull is not its origin.
    const ShapePtr hull = HullOf({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}});
    const Quaternion turned = RotationAbout({0, 1, 0}, 0.5);
    const BodyId id =
        world.Add({.shape = hull, .position = {10, 20, 30}, .rotation = turned, .density = 2, .userData = 42});
    EXPECT_LT((world.PositionOf(id) - Position(10, 20, 30)).norm(), 1e-6);
    EXPECT_GT((world.Bodies().GetCenterOfMass(id) - Position(10, 20, 30)).norm(), 0.5);
    EXPECT_NEAR(world.Bodies().GetMass(id), 2 * 8.0 / 6, 1e-5);
    EXPECT_EQ(world.Bodies().GetUserData(id), 42u);
    EXPECT_EQ(world.Bodies().GetShape(id), hull);
    EXPECT_EQ(world.Bodies().GetMotionType(id), MotionType::Dynamic);
}

TEST(Bodies, EachSettingIsReadBackAndCanBeChanged) {
    TestWorld world;
    BodyInterface& bodies = world.Bodies();
    const BodySettings first{.shape = CubeOf(0.5f),
                             .position = {1, 2, 3},
                             .rotation = RotationAbout({0, 1, 0}, 0.5),
                             .linearVelocity = {1, 0, 0},
                             .angularVelocity = {0, 2, 0},
                             .mass = 5,
                             .inertia = {2, 3, 4},
                             .material = {.friction = 0.3f},
                             .linearDamping = 0.1f,
                             .angularDamping = 0.2f,
                             .gravityFactor = 0.5f,
                             .lockedAxes = LockedAxes::RotationZ,
                             .maxLinearSpeed = 20,
                             .maxAngularSpeed = 30,
                             .gyroscopicTorque = false,
                             .allowSleep = false,
                             .layer = 3,
                             .category = 4,
                             .mask = 6,
                             .group = {nullptr, 7, 8},
                             .continuous = ContinuousCollision::Linear,
                             .userData = 9,
                             .penetrationTarget = 0.01f,
                             .reportsContacts = false};
    const BodySettings second{.shape = SphereOf(0.5f),
                              .motion = MotionType::Kinematic,
                              .startAsleep = false,
                              .isSensor = true,
                              .sensorSees = SensorSees::Dynamic | SensorSees::Static,
                              .sensorReportsStay = false};
    const BodyId a = world.Add(first), b = world.Add(second);
    const BodyId ids[] = {a, b};
    const BodySettings* const settings[] = {&first, &second};
    std::set<std::string> read;
    for (const int k : {0, 1}) {
        const BodyId id = ids[k];
        const BodySettings& s = *settings[k];
        const auto expect = [&](const char* name, bool is) {
            EXPECT_TRUE(is) << name << " of body " << k;
            read.insert(name);
        };
        expect("shape", bodies.GetShape(id) == s.shape);
        expect("motion", bodies.GetMotionType(id) == s.motion);
        expect("position", (bodies.GetPose(id).position - s.position).norm() < 1e-6);
        expect("rotation", std::abs(bodies.GetPose(id).rotation.y - s.rotation.y) < 1e-6f);
        expect("linearVelocity", bodies.GetLinearVelocity(id) == s.linearVelocity);
        expect("angularVelocity", bodies.GetAngularVelocity(id) == s.angularVelocity);
        expect("mass", std::abs(bodies.GetMass(id) - s.mass) < 1e-5f);
        expect("inertia", std::abs(bodies.GetInertia(id).yy - s.inertia.y()) < 1e-5f);
        expect("material", bodies.GetMaterial(id).friction == s.material.friction);
        expect("linearDamping", bodies.GetLinearDamping(id) == s.linearDamping);
        expect("angularDamping", bodies.GetAngularDamping(id) == s.angularDamping);
        expect("gravityFactor", bodies.GetGravityFactor(id) == s.gravityFactor);
        expect("lockedAxes", bodies.GetLockedAxes(id) == s.lockedAxes);
        expect("maxLinearSpeed", bodies.GetMaxLinearSpeed(id) == s.maxLinearSpeed);
        expect("maxAngularSpeed", bodies.GetMaxAngularSpeed(id) == s.maxAngularSpeed);
        expect("gyroscopicTorque", bodies.HasGyroscopicTorque(id) == s.gyroscopicTorque);
        expect("allowSleep", bodies.AllowsSleep(id) == s.allowSleep);
        expect("layer", bodies.GetLayer(id) == s.layer);
        expect("category", bodies.GetCategory(id) == s.category);
        expect("mask", bodies.GetMask(id) == s.mask);
        expect("continuous", bodies.GetContinuous(id) == s.continuous);
        expect("userData", bodies.GetUserData(id) == s.userData);
        expect("penetrationTarget", bodies.GetPenetrationTarget(id) == s.penetrationTarget);
        expect("reportsContacts", bodies.ReportsContacts(id) == s.reportsContacts);
        expect("isSensor", bodies.IsSensor(id) == s.isSensor);
        expect("sensorSees", bodies.GetSensorSees(id) == (s.isSensor ? s.sensorSees : SensorSees::Nothing));
        expect("sensorReportsStay", bodies.SensorReportsStay(id) == (s.isSensor && s.sensorReportsStay));
        expect("startAsleep", bodies.IsAwake(id) == (!s.startAsleep && s.motion != MotionType::Static));
        EXPECT_EQ(bodies.GetGroup(id).group, s.group.group);
    }
    FieldNames all;
    BodySettings any;
    Describe(all, any);
    all.names.erase("density");  // read as mass
    EXPECT_EQ(read, all.names);
    // Those that have no test of their own.
    EXPECT_TRUE(bodies.SetGyroscopicTorque(a, true));
    EXPECT_TRUE(bodies.HasGyroscopicTorque(a));
    EXPECT_FALSE(bodies.SetGyroscopicTorque({77, 0}, true));
    EXPECT_TRUE(bodies.SetSensorSees(b, SensorSees::Kinematic));
    EXPECT_TRUE(bodies.SetSensorReportsStay(b, true));
    EXPECT_EQ(bodies.GetSensorSees(b), SensorSees::Kinematic);
    EXPECT_TRUE(bodies.SensorReportsStay(b));
    EXPECT_TRUE(bodies.SetSensor(b, false));
    EXPECT_EQ(bodies.GetSensorSees(b), SensorSees::Nothing);
}

// A spinning plate without gyroscopic torque keeps its angular velocity, with it its angular momentum.
TEST(Bodies, GyroscopicTorqueMayBeSwitched) {
    TestWorld world(NoGravity());
    const Vector3 spin(1, 5, 0.5f);
    const BodyId plate = world.Add(
        {.shape = BoxOf(1, 0.1f, 0.5f), .angularVelocity = spin, .gyroscopicTorque = false, .allowSleep = false});
    world.Steps(30);
    EXPECT_LT(Length(Vector3(world.Bodies().GetAngularVelocity(plate) - spin)), 1e-4f);
    ASSERT_TRUE(world.Bodies().SetGyroscopicTorque(plate, true));
    const Vector3 momentum = world.Bodies().GetAngularMomentum(plate);
    world.Steps(30);
    EXPECT_GT(Length(Vector3(world.Bodies().GetAngularVelocity(plate) - spin)), 0.1f);
    EXPECT_LT(Length(Vector3(world.Bodies().GetAngularMomentum(plate) - momentum)), 0.01f * Length(momentum));
}

TEST(Bodies, ASlightlyLongRotationIsNormalized) {
    TestWorld world;
    const BodyId id = world.Add({.shape = CubeOf(1), .rotation = {0, 0, 0, 1.0005f}});
    EXPECT_EQ(world.Bodies().GetPose(id).rotation.w, 1);
}

TEST(Bodies, ATeleportedBodyTouchesTheBodiesThere) {
    TestWorld world;
    world.AddFloor();
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .position = {0, 50, 0}});
    world.Step();
    ASSERT_TRUE(world.Bodies().SetPose(ball, {20, 0.5, 0}, {}));
    ASSERT_TRUE(world.Bodies().SetVelocity(ball, {0, 0, 0}, {0, 0, 0}));
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(ball).y(), 0.5, 0.005);
    EXPECT_NEAR(world.PositionOf(ball).x(), 20, 1e-6);
}

TEST(System, CountsItsBodiesAndHashesTheirPoses) {
    TestWorld a, b;
    EXPECT_EQ(a.System().HashPoses(), b.System().HashPoses());
    a.Add({.shape = CubeOf(1)});
    EXPECT_NE(a.System().HashPoses(), b.System().HashPoses());
    b.Add({.shape = SphereOf(1)});
    EXPECT_EQ(a.System().HashPoses(), b.System().HashPoses());  // of poses alone
    a.Step();
    EXPECT_EQ(a.Report().bodies, 1u);
    EXPECT_EQ(a.Report().step, 1u);
}

TEST(System, EnergyIsKineticPlusPotential) {
    TestWorld world;
    world.Add({.shape = SphereOf(0.5f), .position = {0, 3, 0}, .linearVelocity = {2, 0, 0}, .mass = 4});
    EXPECT_NEAR(world.System().GetEnergy(), 0.5 * 4 * 4 + 4 * kGravity * 3, 1e-4);
}

}  // namespace
}  // namespace fulcrum::testing
