// Several bodies put elsewhere at once, and pushes away from a point.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/Plane.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// A chain of rods from body to body.
struct Chain {
    explicit Chain(TestWorld& world, int count) {
        for (int i = 0; i < count; ++i) {
            links.push_back(world.Add({.shape = BoxOf(0.25f, 0.05f, 0.05f), .position = {0.5 * i, 5, 0}}));
            if (i == 0) continue;
            PointJointSettings joint;
            joint.bodyA = links[static_cast<size_t>(i) - 1];
            joint.bodyB = links[static_cast<size_t>(i)];
            joint.anchorA.point = {0.5 * i - 0.25, 5, 0};
            joints.push_back(world.System().Joints().Create(joint).Value());
        }
    }
    std::vector<Pose> Poses(TestWorld& world) const {
        std::vector<Pose> poses;
        for (const BodyId link : links) poses.push_back(world.Bodies().GetPose(link));
        return poses;
    }
    std::vector<BodyId> links;
    std::vector<JointId> joints;
};

// A chain that is moved and turned as a whole goes on as one that was not, turned likewise.
TEST(SetPoses, AMechanismDoesNotNoticeThatItIsMovedAsAWhole) {
    TestWorld moved(NoGravity()), stays(NoGravity());
    const Chain a(moved, 5), b(stays, 5);
    for (TestWorld* world : {&moved, &stays})
        ASSERT_TRUE(world->Bodies().SetVelocity((world == &moved ? a : b).links[2], {0, 1, 0}, {0, 0, 0}));
    moved.Steps(20);
    stays.Steps(20);
    const Position by(1024, 16, -512);
    std::vector<Pose> poses = a.Poses(moved);
    for (Pose& pose : poses) pose.position += by;
    ASSERT_TRUE(moved.Bodies().SetPoses(a.links, poses));
    for (int i = 0; i < 60; ++i) {
        moved.Step();
        stays.Step();
        // What is out of joint is pulled back at up to 20 m/s; a teleport of one link alone has gaps of meters.
        EXPECT_LT(moved.Report().largestJointError, stays.Report().largestJointError + 1e-4f) << i;
    }
    for (size_t i = 0; i < a.links.size(); ++i) {
        const Position apart = moved.PositionOf(a.links[i]) - stays.PositionOf(b.links[i]) - by;
        EXPECT_LT(apart.norm(), 1e-4) << i;
    }
}

TEST(SetPoses, WakesWhatRestedThereAndWhatItNowTouches) {
    TestWorld world;
    world.AddFloor();
    const BodyId lower = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    const BodyId upper = world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}});
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(upper));
    const BodyId ids[1] = {lower};
    const Pose there[1] = {{{10, 0.5, 0}, {}}};
    ASSERT_TRUE(world.Bodies().SetPoses(ids, there));
    EXPECT_TRUE(world.Bodies().IsAwake(upper));
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(upper).y(), 0.5, 0.01);
}

TEST(SetPoses, ChangesNothingWhereOnePoseIsWrong) {
    TestWorld world;
    const BodyId a = world.Add({.shape = CubeOf(0.5f)}), b = world.Add({.shape = CubeOf(0.5f), .position = {5, 0, 0}});
    const uint64_t before = world.System().HashState();
    const BodyId both[2] = {a, b}, twice[2] = {a, a}, unknown[2] = {a, {}};
    const Pose good[2] = {{{1, 2, 3}, {}}, {{7, 2, 3}, {}}}, bad[2] = {{{1, 2, 3}, {}}, {{NAN, 2, 3}, {}}};
    EXPECT_EQ(world.Bodies().SetPoses(both, bad).GetError().code, ErrorCode::NonFinite);
    EXPECT_EQ(world.Bodies().SetPoses(both, {good, 1}).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(world.Bodies().SetPoses(twice, good).GetError().code, ErrorCode::Unsupported);
    EXPECT_EQ(world.Bodies().SetPoses(unknown, good).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(world.System().HashState(), before);
    ASSERT_TRUE(world.Bodies().SetPoses(both, good));
    EXPECT_EQ(world.PositionOf(b), Position(7, 2, 3));
}

// ---- What follows a body that is moved

Pose Moved(const Pose& pose, const Position& by, const Quaternion& turn) {
    return {Position(Rotate(turn, Vector3(pose.position.cast<float>())).cast<double>() + by),
            Normalized(turn * pose.rotation)};
}

void ExpectPoses(TestWorld& world, std::span<const BodyId> bodies, std::span<const Pose> poses) {
    for (size_t i = 0; i < bodies.size(); ++i) {
        const Pose now = world.Bodies().GetPose(bodies[i]);
        EXPECT_LT((now.position - poses[i].position).norm(), 1e-4) << i;
        EXPECT_LT(Length(RotationVectorOf<float>(now.rotation * poses[i].rotation.Conjugate())), 1e-3f) << i;
    }
}

// As one rigid body, at the next step and not before.
TEST(AMovedBody, TakesAlongWhatHangsOnIt) {
    const Quaternion turn = RotationAbout(Vector3(0.6f, 0, 0.8f), 2.5);
    const Position by(100, -3, 20);
    for (const size_t moved : {size_t{0}, size_t{2}}) {
        TestWorld world(NoGravity());
        const Chain chain(world, 5);
        std::vector<Pose> there = chain.Poses(world);
        const std::vector<Pose> before = there;
        for (Pose& pose : there) pose = Moved(pose, by, turn);
        ASSERT_TRUE(world.Bodies().SetPose(chain.links[moved], there[moved].position, there[moved].rotation));
        for (size_t i = 0; i < 5; ++i) {
            if (i == moved) continue;
            EXPECT_EQ(world.PositionOf(chain.links[i]), before[i].position);
        }
        world.Step();
        ExpectPoses(world, chain.links, there);
        EXPECT_LT(world.Report().largestJointError, 1e-4f);
        for (const BodyId link : chain.links) EXPECT_LT(Length(world.VelocityOf(link)), 1e-3f);
    }
}

TEST(AMovedBody, LeavesThoseThatAreMovedToo) {
    TestWorld world(NoGravity());
    const Chain chain(world, 5);
    std::vector<Pose> there = chain.Poses(world);
    const Quaternion turn = RotationAbout(Vector3(0, 1, 0), 1.5);
    for (size_t i = 0; i < 5; ++i) {
        there[i] = Moved(there[i], Position(0, 30, 0), turn);
        ASSERT_TRUE(world.Bodies().SetPose(chain.links[i], there[i].position, there[i].rotation));
    }
    world.Step();
    ExpectPoses(world, chain.links, there);
    // The two halves of a chain that is cut in two places keep to the ends that were moved.
    for (const size_t end : {size_t{0}, size_t{4}})
        ASSERT_TRUE(world.Bodies().SetPose(chain.links[end], there[end].position + Position(0, end == 0 ? 50 : -50, 0),
                                           there[end].rotation));
    for (size_t i = 0; i < 5; ++i) there[i].position.y() += i < 2 ? 50 : -50;
    world.Step();
    for (const size_t i : {size_t{0}, size_t{1}, size_t{3}, size_t{4}})
        EXPECT_NEAR(world.PositionOf(chain.links[i]).y(), there[i].position.y(), 0.5) << i;
}

// What holds a body elsewhere keeps it; a small move is left to the step.
TEST(AMovedBody, TakesNothingFromElsewhere) {
    TestWorld world(NoGravity());
    const Chain chain(world, 3);
    PointJointSettings hook;
    hook.bodyA = kWorldBody;
    hook.bodyB = chain.links[0];
    hook.anchorA.point = {-0.25, 5, 0};
    ASSERT_TRUE(world.System().Joints().Create(hook));
    ASSERT_TRUE(world.Bodies().SetPose(chain.links[2], {50, 5, 0}, {}));
    world.Step();
    EXPECT_LT(world.PositionOf(chain.links[1]).x(), 2);

    TestWorld other(NoGravity());
    const Chain free(other, 3);
    ASSERT_TRUE(other.Bodies().SetPose(free.links[2], {1.0, 5.1, 0}, {}));
    other.Step();
    EXPECT_LT(other.PositionOf(free.links[0]).y(), 5.05);
}

TEST(AMovedBody, IsFollowedAfterASnapshotToo) {
    TestWorld world(NoGravity()), other(NoGravity());
    const Chain chain(world, 5), same(other, 5);
    world.Step();
    other.Step();
    ASSERT_TRUE(world.Bodies().SetPose(chain.links[1], {40, 5, 7}, {}));
    std::vector<std::byte> snapshot;
    ASSERT_TRUE(world.System().SaveSnapshot(snapshot));
    ASSERT_TRUE(other.System().RestoreSnapshot(snapshot));
    world.Steps(3);
    other.Steps(3);
    EXPECT_EQ(world.System().HashState(), other.System().HashState());
    EXPECT_NEAR(other.PositionOf(same.links[4]).x(), 41.5, 1e-3);
}

// ---- AddRadialImpulse

// A ball of 1 kg with its surface 1.5 m from the center of a blast of radius 2 gets a quarter of the impulse.
TEST(AddRadialImpulse, FallsOffWithTheDistanceOfTheSurface) {
    TestWorld world(NoGravity());
    const BodyId near = world.Add({.shape = SphereOf(0.5f), .position = {2, 0, 0}, .mass = 1});
    const BodyId far = world.Add({.shape = SphereOf(0.5f), .position = {0, 0, 2.6}, .mass = 1});
    const BodyId wall = world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static, .position = {-1.2, 0, 0}});
    const Result<uint32_t> pushed =
        world.Bodies().AddRadialImpulse({.radius = 2, .impulse = 8, .falloff = RadialImpulse::Falloff::Linear});
    ASSERT_TRUE(pushed);
    EXPECT_EQ(pushed.Value(), 1u);
    EXPECT_NEAR(world.VelocityOf(near).x(), 2, 1e-4);
    EXPECT_EQ(world.VelocityOf(far), Vector3(0, 0, 0));
    EXPECT_EQ(world.VelocityOf(wall), Vector3(0, 0, 0));
    ASSERT_TRUE(world.Bodies().AddRadialImpulse(
        {.radius = 3, .impulse = -1, .falloff = RadialImpulse::Falloff::Constant}, {.ignore = {&near, 1}}));
    EXPECT_NEAR(world.VelocityOf(near).x(), 2, 1e-4);
    EXPECT_NEAR(world.VelocityOf(far).z(), -1, 1e-4);
}

// At the end of a plank: it turns as an impulse there turns it.
TEST(AddRadialImpulse, PushesAtTheClosestPointAndTurns) {
    TestWorld world(NoGravity());
    const BodyId plank = world.Add({.shape = BoxOf(2, 0.1f, 0.1f), .mass = 3});
    ASSERT_TRUE(world.Bodies().Sleep(plank));
    ASSERT_TRUE(world.Bodies().AddRadialImpulse(
        {.center = {1.5, -1.1, 0}, .radius = 5, .impulse = 6, .falloff = RadialImpulse::Falloff::Constant}));
    EXPECT_TRUE(world.Bodies().IsAwake(plank));
    EXPECT_NEAR(world.VelocityOf(plank).y(), 2, 1e-4);
    const double inertia = 3.0 / 12 * (4 * 4 + 0.2 * 0.2);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(plank).z(), 6 * 1.5 / inertia, 1e-3);
    EXPECT_EQ(world.Bodies().AddRadialImpulse({.radius = 0}).GetError().code, ErrorCode::NonPositive);
    EXPECT_EQ(world.Bodies().AddRadialImpulse({.impulse = INFINITY}).GetError().code, ErrorCode::NonFinite);
}

TEST(AddRadialImpulse, WhatTheCenterIsInsideOfIsPushedWhole) {
    TestWorld world(NoGravity());
    const BodyId box = world.Add({.shape = CubeOf(1), .mass = 2});
    ASSERT_TRUE(world.Bodies().AddRadialImpulse({.center = {-0.5, 0, 0}, .radius = 3, .impulse = 4}));
    EXPECT_NEAR(world.VelocityOf(box).x(), 2, 1e-5);
    EXPECT_LT(Length(world.Bodies().GetAngularVelocity(box)), 1e-5f);
}

}  // namespace
}  // namespace fulcrum::testing
