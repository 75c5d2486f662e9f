// Snapshots of some bodies: these go back, all others go on.
#include <Fulcrum/UnitTests/Physics/Snapshots/SnapshotTesting.h>

namespace fulcrum::testing {
namespace {

Bytes SnapshotOfBodies(const PhysicsSystem& system, std::initializer_list<BodyId> bodies) {
    Bytes bytes;
    const Status saved = system.SaveBodies(std::span(bodies.begin(), bodies.size()), bytes);
    if (!saved) ADD_FAILURE() << saved.GetError().message;
    return bytes;
}

TEST(BodySnapshot, TakesTheseBodiesBackAndNoOthers) {
    TestWorld world;
    world.AddFloor();
    const ShapePtr lopsided =
        CompoundOf({{.shape = CubeOf(0.2f)}, {.shape = SphereOf(0.3f), .position = {0.5f, 0, 0}}});
    BodyId ids[3];
    for (int i = 0; i < 3; ++i)
        ids[i] = world.Add({.shape = lopsided,
                            .position = {3.0 * i, 9 + 0.1 * i, 0.01},
                            .linearVelocity = {0.3f, 5, 0},
                            .angularVelocity = {1, 2, 3}});
    world.Steps(5);
    EXPECT_TRUE(world.Bodies().AddForce(ids[0], {100, 0, 0}));
    const Bytes bytes = SnapshotOfBodies(world.System(), {ids[0], ids[2]});
    BodyBits start[3];
    for (int i = 0; i < 3; ++i) start[i] = BitsOf(world, ids[i]);
    // Nothing touches them: what follows is the same to the last bit, too.
    std::vector<BodyBits> first;
    for (int step = 0; step < 40; ++step) {
        world.Step();
        first.push_back(BitsOf(world, ids[0]));
    }
    const BodyBits stays = BitsOf(world, ids[1]);
    ASSERT_TRUE(world.System().RestoreBodies(bytes));
    EXPECT_EQ(BitsOf(world, ids[0]), start[0]);
    EXPECT_EQ(BitsOf(world, ids[1]), stays);
    EXPECT_EQ(BitsOf(world, ids[2]), start[2]);
    for (int step = 0; step < 40; ++step) {
        world.Step();
        ASSERT_EQ(BitsOf(world, ids[0]), first[static_cast<size_t>(step)]) << step;
    }
}

TEST(BodySnapshot, TakesTurnsAndMotorsOfJointsBack) {
    TestWorld world(NoGravity());
    const BodyId base = world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Static});
    const BodyId wheel = world.Add({.shape = SphereOf(0.5f)});
    HingeJointSettings hinge;
    hinge.bodyA = base;
    hinge.bodyB = wheel;
    hinge.angle.motor = {.mode = MotorMode::ToVelocity, .targetSpeed = 10};
    JointInterface& joints = world.System().Joints();
    const JointId joint = joints.Create(hinge).Value();
    world.Run(2);
    const double angle = joints.GetCoordinate(joint, JointAxis::AngularX);
    EXPECT_NEAR(angle, 20, 0.5);  // more than three turns
    const Bytes bytes = SnapshotOfBodies(world.System(), {wheel, base});
    EXPECT_TRUE(joints.SetMotor(joint, JointAxis::AngularX, {.mode = MotorMode::ToVelocity, .targetSpeed = -25}));
    world.Run(3);
    EXPECT_LT(joints.GetCoordinate(joint, JointAxis::AngularX), -40);
    ASSERT_TRUE(world.System().RestoreBodies(bytes));
    EXPECT_NEAR(joints.GetCoordinate(joint, JointAxis::AngularX), angle, 1e-5);
    world.Run(1);
    EXPECT_NEAR(joints.GetCoordinate(joint, JointAxis::AngularX), angle + 10, 0.1);
}

TEST(BodySnapshot, PutsAStackBackThatStands) {
    TestWorld world;
    world.AddFloor();
    std::vector<BodyId> stack;
    for (int i = 0; i < 5; ++i) stack.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}}));
    world.Run(3);
    EXPECT_FALSE(world.Bodies().IsAwake(stack[4]));
    Bytes bytes;
    ASSERT_TRUE(world.System().SaveBodies(stack, bytes));
    EXPECT_TRUE(world.Bodies().SetVelocity(stack[0], {20, 0, 0}, {}));
    world.Run(2);
    ASSERT_TRUE(world.System().RestoreBodies(bytes));
    world.Run(2);
    for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(world.PositionOf(stack[static_cast<size_t>(i)]).x(), 0, 2e-3) << i;
        EXPECT_NEAR(world.PositionOf(stack[static_cast<size_t>(i)]).y(), 0.5 + i, 0.01) << i;
    }
    EXPECT_FALSE(world.Bodies().IsAwake(stack[4]));
}

TEST(BodySnapshot, IsRefusedWhereBodiesOrJointsAreOthers) {
    TestWorld world;
    const BodyId a = world.Add({.shape = CubeOf(0.5f)}), b = world.Add({.shape = CubeOf(0.5f), .position = {2, 0, 0}});
    HingeJointSettings hinge;
    hinge.bodyA = a;
    hinge.bodyB = b;
    const JointId joint = world.System().Joints().Create(hinge).Value();
    world.Step();
    Bytes bytes = SnapshotOfBodies(world.System(), {a, b});
    const Bytes whole = SnapshotOf(world.System());
    const auto expectRefused = [&](const Bytes& snapshot, ErrorCode code) {
        const uint64_t before = world.System().HashState();
        const Status restored = world.System().RestoreBodies(snapshot);
        ASSERT_FALSE(restored);
        EXPECT_EQ(restored.GetError().code, code) << restored.GetError().message;
        EXPECT_EQ(world.System().HashState(), before);
    };
    expectRefused(whole, ErrorCode::Unsupported);
    EXPECT_FALSE(world.System().RestoreSnapshot(bytes));
    for (size_t at = 8; at < bytes.size(); at += 5) {
        bytes[at] ^= std::byte{4};
        EXPECT_FALSE(world.System().RestoreBodies(bytes)) << at;
        bytes[at] ^= std::byte{4};
    }
    EXPECT_TRUE(world.Bodies().SetShape(b, SphereOf(0.5f), MassUpdate::Update));
    expectRefused(bytes, ErrorCode::Unsupported);
    ASSERT_TRUE(world.System().RestoreSnapshot(whole));
    EXPECT_TRUE(world.System().Joints().Remove(joint));
    expectRefused(bytes, ErrorCode::UnknownId);
    ASSERT_TRUE(world.System().RestoreSnapshot(whole));
    EXPECT_TRUE(world.Bodies().Remove(b));
    expectRefused(bytes, ErrorCode::UnknownId);
    const BodyId gone[] = {b};
    EXPECT_FALSE(world.System().SaveBodies(gone, bytes));
}

}  // namespace
}  // namespace fulcrum::testing
