// Joints to the world itself, and the spring that drags a body to a target.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

BodyId HangBob(TestWorld& world, const Position& at = Position::Zero()) {
    const BodyId bob = world.Add({.shape = SphereOf(0.1f), .position = at + Position(0, -1, 0)});
    PointJointSettings joint;
    joint.bodyA = kWorldBody;
    joint.bodyB = bob;
    joint.anchorA.point = at;
    EXPECT_TRUE(world.System().Joints().Create(joint));
    return bob;
}

// A compound pendulum: T = 2 pi sqrt(I / (m g l)) for small angles.
TEST(WorldBody, APendulumSwingsWithItsPeriod) {
    TestWorld world(NoSleep());
    const BodyId bob = HangBob(world);
    ASSERT_TRUE(world.Bodies().SetVelocity(bob, {0.1f, 0, 0}, {0, 0, 0.1f}));
    int crossings = 0, first = 0, last = 0;
    double before = 0;
    for (int i = 1; i <= 1200; ++i) {
        world.Step();
        const double x = world.PositionOf(bob).x();
        if (before < 0 && x >= 0) {
            if (crossings++ == 0) first = i;
            last = i;
        }
        before = x;
    }
    ASSERT_GT(crossings, 3);
    const double inertia = 1 + 0.4 * 0.1 * 0.1;  // per kg
    const double period = 2 * kPi * std::sqrt(inertia / kGravity);
    EXPECT_NEAR((last - first) * kStep / (crossings - 1), period, 0.01 * period);
}

TEST(WorldBody, IsNoBodyOfAnyOtherCall) {
    TestWorld world;
    const BodyId bob = HangBob(world);
    int bodies = 0;
    world.System().VisitBodies([&](BodyId) { ++bodies; });
    EXPECT_EQ(bodies, 1);
    world.Step();
    EXPECT_EQ(world.Report().bodies, 1u);
    EXPECT_FALSE(world.Bodies().Exists(kWorldBody));
    EXPECT_FALSE(world.Bodies().Remove(kWorldBody));
    JointId joint;
    world.System().Joints().VisitOf(bob, [&](JointId id) { joint = id; });
    EXPECT_EQ(world.System().Joints().GetBodyA(joint), kWorldBody);
    EXPECT_EQ(world.System().Joints().GetBodyB(joint), bob);
    int ofWorld = 0;
    world.System().Joints().VisitOf(kWorldBody, [&](JointId) { ++ofWorld; });
    EXPECT_EQ(ofWorld, 1);
    PointJointSettings twice;
    twice.bodyA = twice.bodyB = kWorldBody;
    EXPECT_EQ(world.System().Joints().Create(twice).GetError().code, ErrorCode::Unsupported);
}

// Far out, where floats from the world's origin are a meter apart, joints hold as near it.
TEST(WorldBody, HoldsFarOutToo) {
    TestWorld world;
    const Position far(1e7, 0, -3e6);
    const BodyId bob = HangBob(world, far);
    world.Run(2);
    EXPECT_LT((world.PositionOf(bob) - far - Position(0, -1, 0)).norm(), 0.002);
}

TEST(WorldBody, IsThereAgainInASnapshotOfAnEmptyWorld) {
    TestWorld a, b;
    const BodyId bob = HangBob(a);
    a.Steps(3);
    std::vector<std::byte> empty, hung;
    ASSERT_TRUE(b.System().SaveSnapshot(empty));
    ASSERT_TRUE(a.System().SaveSnapshot(hung));
    const ShapePtr shapes[1] = {a.Bodies().GetShape(bob)};
    ASSERT_TRUE(b.System().RestoreSnapshot(hung, {.shapes = shapes}));
    EXPECT_EQ(a.System().HashState(), b.System().HashState());
    // The world is one body in both, also for joints to come.
    for (TestWorld* world : {&a, &b}) {
        HangBob(*world, {5, 0, 0});
        world->Steps(30);
    }
    EXPECT_EQ(a.System().HashState(), b.System().HashState());
    ASSERT_TRUE(b.System().RestoreSnapshot(empty));
    HangBob(b);
    b.Steps(3);
    int joints = 0;
    b.System().Joints().VisitOf(kWorldBody, [&](JointId) { ++joints; });
    EXPECT_EQ(joints, 1);
}

// At rest the spring of k = m (2 pi f)^2 carries the weight: it hangs g / (2 pi f)^2 below its target.
TEST(TargetJoint, ABodyHangsBelowItsTargetByItsWeight) {
    TestWorld world;
    const BodyId ball = world.Add({.shape = SphereOf(0.2f)});
    const Result<JointId> joint = world.System().Joints().CreateTarget(
        {.body = ball, .target = {1, 2, 3}, .spring = {.frequency = 3, .dampingRatio = 1}});
    ASSERT_TRUE(joint);
    world.Run(4);
    const double sag = kGravity / std::pow(2 * kPi * 3, 2);
    EXPECT_LT((world.PositionOf(ball) - Position(1, 2 - sag, 3)).norm(), 0.02 * sag);
    EXPECT_NEAR(world.System().Joints().GetForce(joint.Value()).y(), world.Bodies().GetMass(ball) * kGravity,
                0.01 * world.Bodies().GetMass(ball) * kGravity);
    // And sleeps there, until the target moves.
    EXPECT_FALSE(world.Bodies().IsAwake(ball));
    ASSERT_TRUE(world.System().Joints().SetTarget(joint.Value(), {1, 2, 3}));
    EXPECT_FALSE(world.Bodies().IsAwake(ball));
    ASSERT_TRUE(world.System().Joints().SetTarget(joint.Value(), {-4, 2, 3}));
    EXPECT_TRUE(world.Bodies().IsAwake(ball));
    world.Run(4);
    EXPECT_LT((world.PositionOf(ball) - Position(-4, 2 - sag, 3)).norm(), 0.02 * sag);
}

// A force of at most 5 N along each axis gives 1 kg at most 5 m/s2 along each.
TEST(TargetJoint, PullsNoHarderThanItsForce) {
    TestWorld world(NoGravity());
    const BodyId ball = world.Add({.shape = SphereOf(0.2f), .mass = 1});
    ASSERT_TRUE(world.System().Joints().CreateTarget({.body = ball, .target = {100, 0, 0}, .maxForce = 5}));
    world.Steps(60);
    EXPECT_NEAR(world.VelocityOf(ball).x(), 5, 0.01);
    EXPECT_NEAR(world.PositionOf(ball).x(), 2.5, 0.05);
}

TEST(TargetJoint, RefusesWhatMakesNoSense) {
    TestWorld world;
    const BodyId ball = world.Add({.shape = SphereOf(0.2f)}), other = world.Add({.shape = SphereOf(0.2f)});
    JointInterface& joints = world.System().Joints();
    EXPECT_EQ(joints.CreateTarget({.body = {}}).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(joints.CreateTarget({.body = ball, .target = {NAN, 0, 0}}).GetError().code, ErrorCode::NonFinite);
    EXPECT_EQ(joints.CreateTarget({.body = ball, .maxForce = 0}).GetError().code, ErrorCode::NonPositive);
    EXPECT_EQ(joints.CreateTarget({.body = ball, .spring = {.frequency = -1}}).GetError().code, ErrorCode::Negative);
    PointJointSettings between;
    between.bodyA = ball;
    between.bodyB = other;
    const JointId id = joints.Create(between).Value();
    EXPECT_EQ(joints.SetTarget(id, {0, 0, 0}).GetError().code, ErrorCode::Unsupported);
    EXPECT_EQ(joints.SetTarget({}, {0, 0, 0}).GetError().code, ErrorCode::UnknownId);
}

}  // namespace
}  // namespace fulcrum::testing
