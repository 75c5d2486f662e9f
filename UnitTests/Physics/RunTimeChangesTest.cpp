// What of a body may be changed while the world runs: each setter with what follows from it for its motion.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/Plane.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

TEST(SetMotionType, ADynamicBodyStopsAndFallsAgainWithTheMassThatItHad) {
    TestWorld world;
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 10, 0}, .mass = 3});
    world.Run(0.5);
    ASSERT_TRUE(world.Bodies().SetMotionType(box, MotionType::Static));
    EXPECT_EQ(world.Bodies().GetMotionType(box), MotionType::Static);
    EXPECT_EQ(world.VelocityOf(box), Vector3(0, 0, 0));
    EXPECT_EQ(world.Bodies().GetMass(box), 0);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    const Position held = world.PositionOf(box);
    world.Run(0.5);
    EXPECT_EQ(world.PositionOf(box), held);
    ASSERT_TRUE(world.Bodies().SetMotionType(box, MotionType::Dynamic));
    EXPECT_FLOAT_EQ(world.Bodies().GetMass(box), 3);
    const double time = 30 * kStep;
    world.Steps(30);
    // Flight is exact but for the floats of velocities.
    EXPECT_NEAR(world.PositionOf(box).y(), held.y() - 0.5 * kGravity * time * time, 1e-5);
}

TEST(SetMotionType, WhatRestsOnABodyGoesOnRestingAsItBecomesStaticAndFallsWithIt) {
    TestWorld world;
    world.AddFloor({}, {0, -10, 0});
    const BodyId shelf =
        world.Add({.shape = BoxOf(2, 0.5f, 2), .motion = MotionType::Static, .position = {0, -0.5, 0}, .mass = 100});
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    ASSERT_TRUE(world.Bodies().SetMotionType(shelf, MotionType::Kinematic));
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 0.005);
    ASSERT_TRUE(world.Bodies().SetMotionType(shelf, MotionType::Dynamic));
    EXPECT_FLOAT_EQ(world.Bodies().GetMass(shelf), 100);
    EXPECT_TRUE(world.Bodies().IsAwake(box));
    world.Run(4);
    EXPECT_NEAR(world.PositionOf(shelf).y(), -9.5, 0.01);
    EXPECT_NEAR(world.PositionOf(box).y(), -8.5, 0.02);
    // And where it lies it carries on.
    ASSERT_TRUE(world.Bodies().SetMotionType(shelf, MotionType::Static));
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(box).y(), -8.5, 0.02);
}

TEST(SetMotionType, WhatNeverHadAMassGetsThatOfWater) {
    TestWorld world;
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static});
    ASSERT_TRUE(world.Bodies().SetMotionType(box, MotionType::Dynamic));
    EXPECT_FLOAT_EQ(world.Bodies().GetMass(box), 1000);
    const BodyId given = world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Kinematic, .position = {5, 0, 0}});
    ASSERT_TRUE(world.Bodies().SetMass(given, 7));
    EXPECT_EQ(world.Bodies().GetMass(given), 0);
    ASSERT_TRUE(world.Bodies().SetMotionType(given, MotionType::Dynamic));
    EXPECT_FLOAT_EQ(world.Bodies().GetMass(given), 7);
}

TEST(SetMotionType, AKinematicBodyKeepsItsVelocityAndAJointHoldsOn) {
    TestWorld world;
    const BodyId anchor = world.Add({.shape = CubeOf(0.5f), .position = {0, 5, 0}});
    const BodyId bob = world.Add({.shape = SphereOf(0.25f), .position = {0, 3, 0}});
    PointJointSettings joint;
    joint.bodyA = anchor;
    joint.bodyB = bob;
    joint.anchorA.point = {0, 5, 0};
    ASSERT_TRUE(world.System().Joints().Create(joint));
    ASSERT_TRUE(world.Bodies().SetMotionType(anchor, MotionType::Kinematic));
    ASSERT_TRUE(world.Bodies().SetVelocity(anchor, {1, 0, 0}, {0, 0, 0}));
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(anchor).x(), 2, 1e-5);
    EXPECT_EQ(world.PositionOf(anchor).y(), 5);
    EXPECT_NEAR((world.PositionOf(bob) - world.PositionOf(anchor)).norm(), 2, 0.02);
    ASSERT_TRUE(world.Bodies().SetMotionType(anchor, MotionType::Dynamic));
    EXPECT_EQ(world.VelocityOf(anchor), Vector3(1, 0, 0));
    world.Steps(30);
    EXPECT_LT(world.PositionOf(anchor).y(), 4.9);
}

TEST(SetMotionType, RefusesWhatCannotMove) {
    TestWorld world;
    const BodyId plane = world.Add({.shape = ShapePtr(Plane::Create().Value()), .motion = MotionType::Static});
    EXPECT_EQ(world.Bodies().SetMotionType(plane, MotionType::Dynamic).GetError().code, ErrorCode::Unsupported);
    EXPECT_EQ(world.Bodies().SetMotionType(plane, static_cast<MotionType>(7)).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(world.Bodies().SetMotionType({}, MotionType::Static).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(world.Bodies().GetMotionType(plane), MotionType::Static);
}

TEST(SetMass, AnImpulseGivesTheVelocityOfTheNewMassAndInertia) {
    TestWorld world(NoGravity());
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .mass = 2});
    ASSERT_TRUE(world.Bodies().SetMass(box, 5));
    EXPECT_FLOAT_EQ(world.Bodies().GetMass(box), 5);
    EXPECT_NEAR(world.Bodies().GetInertia(box).xx, 5.0f / 6, 1e-5);  // m a^2 / 6
    ASSERT_TRUE(world.Bodies().AddImpulse(box, {10, 0, 0}));
    EXPECT_NEAR(world.VelocityOf(box).x(), 2, 1e-6);
    ASSERT_TRUE(world.Bodies().AddAngularImpulse(box, {0, 5, 0}));
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(box).y(), 6, 1e-5);
}

// L = I w for a full tensor, positive definite, in the body's frame, which is turned.
TEST(SetMass, AFullTensorTurnsAngularImpulsesIntoVelocities) {
    TestWorld world(NoGravity());
    const Quaternion turned = RotationAbout({0.6f, 0, 0.8f}, 0.7);
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .rotation = turned});
    SymmetricMatrix3 inertia;
    inertia.xx = 3, inertia.yy = 4, inertia.zz = 5, inertia.xy = 0.5f, inertia.xz = -0.7f, inertia.yz = 0.9f;
    ASSERT_TRUE(world.Bodies().SetMass(box, 8, inertia));
    const SymmetricMatrix3 got = world.Bodies().GetInertia(box);
    EXPECT_NEAR(got.xx, 3, 1e-5);
    EXPECT_NEAR(got.yy, 4, 1e-5);
    EXPECT_NEAR(got.zz, 5, 1e-5);
    EXPECT_NEAR(got.xy, 0.5, 1e-5);
    EXPECT_NEAR(got.xz, -0.7, 1e-5);
    EXPECT_NEAR(got.yz, 0.9, 1e-5);
    const Vector3 impulse(1, -2, 3);
    ASSERT_TRUE(world.Bodies().AddAngularImpulse(box, impulse));
    const Vector3 w = InverseRotate(turned, world.Bodies().GetAngularVelocity(box));
    EXPECT_NEAR(Length(Vector3(Rotate(turned, Vector3(inertia * w)) - impulse)), 0, 1e-4);
    inertia.xy = 10;  // no longer positive definite
    EXPECT_EQ(world.Bodies().SetMass(box, 8, inertia).GetError().code, ErrorCode::NonPositive);
    EXPECT_EQ(world.Bodies().SetMass(box, 0).GetError().code, ErrorCode::NonPositive);
    EXPECT_EQ(world.Bodies().SetMass(box, NAN).GetError().code, ErrorCode::NonFinite);
    EXPECT_FLOAT_EQ(world.Bodies().GetMass(box), 8);
}

TEST(SetGravity, ABodyFallsAlongItsOwn) {
    TestWorld world;
    const BodyId own = world.Add({.shape = SphereOf(0.5f)});
    const BodyId usual = world.Add({.shape = SphereOf(0.5f), .position = {10, 0, 0}});
    ASSERT_TRUE(world.Bodies().SetGravity(own, Vector3(3, 0, 4)));
    EXPECT_EQ(world.Bodies().GetGravity(own), Vector3(3, 0, 4));
    EXPECT_EQ(world.Bodies().GetGravity(usual), Vector3(0, -9.81f, 0));
    world.Steps(60);
    EXPECT_NEAR(world.PositionOf(own).x(), 1.5, 1e-5);
    EXPECT_NEAR(world.PositionOf(own).z(), 2, 1e-5);
    EXPECT_NEAR(world.PositionOf(own).y(), 0, 1e-12);
    EXPECT_NEAR(world.PositionOf(usual).y(), -kGravity / 2, 1e-5);
    ASSERT_TRUE(world.Bodies().SetGravity(own, std::nullopt));
    const Vector3 before = world.VelocityOf(own);
    world.Step();
    EXPECT_NEAR(world.VelocityOf(own).y(), before.y() - kGravity * kStep, 1e-5);
    EXPECT_EQ(world.Bodies().SetGravity(own, Vector3(0, 2e6f, 0)).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(world.Bodies().SetGravity(own, Vector3(0, NAN, 0)).GetError().code, ErrorCode::NonFinite);
}

// On a wall: gravity of its own presses it there, and it sleeps.
TEST(SetGravity, ABodyRestsOnAWall) {
    TestWorld world;
    world.Add({.shape = BoxOf(0.5f, 5, 5), .motion = MotionType::Static, .position = {2.5, 0, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {1.4, 0, 0}});
    ASSERT_TRUE(world.Bodies().SetGravity(box, Vector3(5, 0, 0)));
    world.Run(3);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    EXPECT_NEAR(world.PositionOf(box).x(), 1.5, 0.005);
    EXPECT_NEAR(world.PositionOf(box).y(), 0, 0.005);
    // It wakes as gravity is the system's again.
    ASSERT_TRUE(world.Bodies().SetGravity(box, std::nullopt));
    world.Steps(30);
    EXPECT_LT(world.PositionOf(box).y(), -1);
}

TEST(SetGravityFactor, HasItsGetter) {
    TestWorld world;
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .gravityFactor = 0.5f});
    EXPECT_EQ(world.Bodies().GetGravityFactor(box), 0.5f);
    ASSERT_TRUE(world.Bodies().SetGravityFactor(box, -1));
    EXPECT_EQ(world.Bodies().GetGravityFactor(box), -1);
    world.Steps(60);
    EXPECT_NEAR(world.PositionOf(box).y(), kGravity / 2, 1e-5);
}

TEST(SetDamping, VelocitiesDecayAtTheRate) {
    TestWorld world(NoGravity());
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .linearVelocity = {4, 0, 0}, .angularVelocity = {0, 2, 0}});
    ASSERT_TRUE(world.Bodies().SetDamping(ball, 0.5f, 1.5f));
    EXPECT_EQ(world.Bodies().GetLinearDamping(ball), 0.5f);
    EXPECT_EQ(world.Bodies().GetAngularDamping(ball), 1.5f);
    world.Steps(60);
    EXPECT_NEAR(world.VelocityOf(ball).x(), 4 * std::exp(-0.5), 1e-4);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(ball).y(), 2 * std::exp(-1.5), 1e-4);
    EXPECT_EQ(world.Bodies().SetDamping(ball, -1, 0).GetError().code, ErrorCode::Negative);
}

TEST(SetLockedAxes, LockAndUnlock) {
    TestWorld world;
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .linearVelocity = {1, 0, 0}, .angularVelocity = {0, 0, 1}});
    ASSERT_TRUE(world.Bodies().SetLockedAxes(box, LockedAxes::TranslationY | LockedAxes::RotationZ));
    EXPECT_EQ(world.Bodies().GetLockedAxes(box), LockedAxes::TranslationY | LockedAxes::RotationZ);
    world.Steps(60);
    EXPECT_EQ(world.PositionOf(box).y(), 0);
    EXPECT_NEAR(world.PositionOf(box).x(), 1, 1e-5);
    EXPECT_EQ(world.Bodies().GetAngularVelocity(box).z(), 0);
    ASSERT_TRUE(world.Bodies().SetLockedAxes(box, LockedAxes::None));
    world.Steps(60);
    EXPECT_NEAR(world.PositionOf(box).y(), -kGravity / 2, 1e-4);
    EXPECT_EQ(world.Bodies().SetLockedAxes(box, static_cast<LockedAxes>(64)).GetError().code, ErrorCode::OutOfRange);
}

TEST(SetMaxSpeeds, HoldFromTheNextStepOn) {
    TestWorld world(NoGravity());
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .linearVelocity = {10, 0, 0}, .angularVelocity = {0, 10, 0}});
    ASSERT_TRUE(world.Bodies().SetMaxSpeeds(box, 2, 3));
    EXPECT_EQ(world.Bodies().GetMaxLinearSpeed(box), 2);
    EXPECT_EQ(world.Bodies().GetMaxAngularSpeed(box), 3);
    world.Step();
    EXPECT_NEAR(world.VelocityOf(box).x(), 2, 1e-5);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(box).y(), 3, 1e-5);
    EXPECT_EQ(world.Bodies().SetMaxSpeeds(box, 0, 1).GetError().code, ErrorCode::NonPositive);
}

TEST(SetLayer, WhatItNoLongerMeetsLetsItFall) {
    SystemSettings settings;
    settings.layerCollides[1] &= ~(1u << 2);
    settings.layerCollides[2] &= ~(1u << 1);
    TestWorld world(settings);
    world.Add({.shape = BoxOf(5, 1, 5), .motion = MotionType::Static, .position = {0, -1, 0}, .layer = 1});
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .layer = 1});
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    EXPECT_EQ(world.Bodies().GetLayer(box), 1);
    ASSERT_TRUE(world.Bodies().SetLayer(box, 2));
    EXPECT_EQ(world.Bodies().GetLayer(box), 2);
    world.Run(0.2);
    ASSERT_LT(world.PositionOf(box).y(), 0.4);
    // Back in its layer it is pushed out again.
    ASSERT_TRUE(world.Bodies().SetLayer(box, 1));
    world.Run(3);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 0.01);
    EXPECT_EQ(world.Bodies().SetLayer(box, 32).GetError().code, ErrorCode::OutOfRange);
}

TEST(SetLayer, QueriesSeeTheNewOne) {
    TestWorld world;
    const BodyId box = world.Add({.shape = CubeOf(0.5f)});
    ASSERT_TRUE(world.Bodies().SetLayer(box, 5));
    const Ray down{{0, 2, 0}, {0, -4, 0}};
    EXPECT_TRUE(world.System().Queries().IsHit(down, {}, {.layers = 1u << 5}));
    EXPECT_FALSE(world.System().Queries().IsHit(down, {}, {.layers = 1u << 0}));
}

TEST(SetUserData, AndTheOtherGetters) {
    TestWorld world;
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .material = {.friction = 0.3f}, .userData = 1});
    ASSERT_TRUE(world.Bodies().SetUserData(box, 42));
    EXPECT_EQ(world.Bodies().GetUserData(box), 42u);
    EXPECT_EQ(world.Bodies().GetMaterial(box).friction, 0.3f);
    EXPECT_EQ(world.Bodies().GetMaterial({}).friction, 0);
    EXPECT_EQ(world.Bodies().SetUserData({}, 1).GetError().code, ErrorCode::UnknownId);
}

TEST(SetAllowSleep, KeepsAwakeAndLetsSleep) {
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    EXPECT_TRUE(world.Bodies().AllowsSleep(box));
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    ASSERT_TRUE(world.Bodies().SetAllowSleep(box, false));
    EXPECT_FALSE(world.Bodies().AllowsSleep(box));
    world.Run(2);
    EXPECT_TRUE(world.Bodies().IsAwake(box));
    ASSERT_TRUE(world.Bodies().SetAllowSleep(box, true));
    world.Run(1);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
}

TEST(GetBounds, AreThoseOfTheTurnedShape) {
    TestWorld world(NoGravity());
    const double angle = 0.3;
    const BodyId box =
        world.Add({.shape = BoxOf(1, 2, 3), .position = {10, 20, 30}, .rotation = RotationAbout({0, 0, 1}, angle)});
    const BodyBounds bounds = world.Bodies().GetBounds(box);
    const Position half(std::cos(angle) + 2 * std::sin(angle), std::sin(angle) + 2 * std::cos(angle), 3);
    EXPECT_LT((bounds.upper - Position(10, 20, 30) - half).norm(), 1e-4);
    EXPECT_LT((bounds.lower - Position(10, 20, 30) + half).norm(), 1e-4);
    const BodyId empty = world.Add({.shape = EmptyShape::Create(), .position = {1, 2, 3}, .mass = 1});
    EXPECT_EQ(world.Bodies().GetBounds(empty).lower, Position(1, 2, 3));
    EXPECT_EQ(world.Bodies().GetBounds(empty).upper, Position(1, 2, 3));
    EXPECT_EQ(world.Bodies().GetBounds({}).upper, Position(0, 0, 0));
}

TEST(VisitContactsOf, GivesThoseOfOneBodyInTheOrderOfAll) {
    TestWorld world;
    const BodyId floor = world.AddFloor();
    std::vector<BodyId> boxes;
    for (int i = 0; i < 3; ++i)
        boxes.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}, .allowSleep = false}));
    world.Steps(30);
    const auto contactsOf = [&](BodyId id) {
        std::vector<std::pair<BodyId, BodyId>> found;
        world.System().VisitContactsOf(id, [&](const ContactView& c) { found.emplace_back(c.bodyA, c.bodyB); });
        return found;
    };
    std::vector<std::pair<BodyId, BodyId>> expected;
    world.System().VisitContacts([&](const ContactView& c) {
        if (c.bodyA == boxes[1] || c.bodyB == boxes[1]) expected.emplace_back(c.bodyA, c.bodyB);
    });
    ASSERT_EQ(expected.size(), 2u);
    EXPECT_EQ(contactsOf(boxes[1]), expected);
    EXPECT_EQ(contactsOf(floor).size(), 1u);
    EXPECT_TRUE(contactsOf({}).empty());
}

}  // namespace
}  // namespace fulcrum::testing
