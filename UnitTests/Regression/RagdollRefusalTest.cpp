// Calls of a ragdoll that failed half-way had moved, woken or created some parts: failing calls must change nothing.
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

// Bodies with all their state that can be read, and the ids that come next.
struct Snapshot {
    std::vector<BodyBits> bodies;
    std::vector<bool> awake;
    uint32_t joints = 0;
    friend bool operator==(const Snapshot&, const Snapshot&) = default;
};

Snapshot Of(TestWorld& world) {
    Snapshot snapshot;
    world.System().VisitBodies([&](BodyId id) {
        snapshot.bodies.push_back(BitsOf(world, id));
        snapshot.awake.push_back(world.Bodies().IsAwake(id));
    });
    world.System().Joints().Visit([&](JointId) { ++snapshot.joints; });
    return snapshot;
}

BodyId NextId(TestWorld& world) { return world.Add({.shape = SphereOf(0.1f), .position = {0, 100, 0}}); }

std::vector<Pose> PoseOf(const Ragdoll& ragdoll) {
    std::vector<Pose> pose(ragdoll.Bodies().size());
    EXPECT_TRUE(ragdoll.GetPose(pose));
    return pose;
}

TEST(RagdollRefusal, DrivingMovesAllPartsOrNone) {
    TestWorld world(NoGravity());
    Result<Ragdoll> made = Ragdoll::Create(world.System(), Humanoid(), {}, MotionType::Kinematic);
    ASSERT_TRUE(made);
    Ragdoll& ragdoll = made.Value();
    world.Steps(3);
    const Snapshot before = Of(world);
    std::vector<Pose> pose = PoseOf(ragdoll);
    for (Pose& each : pose) each.position.x() += 0.1;
    // The last part is asked for a speed that no float holds.
    pose.back().position.y() = 1e18;
    for (const float dt : {1e-30f, 1e-38f}) {
        const Status driven = ragdoll.DriveKinematically(pose, dt);
        ASSERT_FALSE(driven);
        EXPECT_EQ(driven.GetError().code, ErrorCode::NonFinite);
        EXPECT_NE(driven.GetError().message.find("pose[" + std::to_string(pose.size() - 1) + "]"), std::string::npos)
            << driven.GetError().message;
        EXPECT_FALSE(ragdoll.DriveByVelocities(pose, dt));
        EXPECT_TRUE(Of(world) == before);
    }
    pose.back().position.y() = 1e19;
    EXPECT_FALSE(ragdoll.SetPose(pose));
    EXPECT_FALSE(ragdoll.DriveByMotors(pose));
    EXPECT_TRUE(Of(world) == before);
    world.Step();
    EXPECT_TRUE(Of(world) == before);
}

// Each way in which the last part, or its joint, is wrong only where it is put.
TEST(RagdollRefusal, CreatingMakesAllOrNothing) {
    const auto expect = [](const RagdollSettings& settings, const Pose& origin, std::optional<MotionType> motion,
                           const char* message) {
        TestWorld world, twin;
        for (TestWorld* each : {&world, &twin}) {
            each->AddFloor();
            each->Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
            each->Steps(120);
        }
        const Snapshot before = Of(world);
        const Result<Ragdoll> made = Ragdoll::Create(world.System(), settings, origin, motion);
        ASSERT_FALSE(made);
        EXPECT_NE(made.GetError().message.find(message), std::string::npos) << made.GetError().message;
        EXPECT_TRUE(Of(world) == before);
        EXPECT_EQ(NextId(world), NextId(twin));
        world.Steps(10);
        twin.Steps(10);
        EXPECT_TRUE(Of(world) == Of(twin));
    };
    RagdollSettings settings = Humanoid();
    expect(settings, {}, static_cast<MotionType>(77), "motion");
    expect(settings, {Position(2e18, 0, 0), {}}, {}, "origin.position");
    // A part that may be static alone.
    settings.parts.back().body.motion = MotionType::Static;
    settings.parts.back().body.shape = Plane::Create(Vector3(0, 1, 0), 0).Value();
    expect(settings, {}, MotionType::Dynamic,
           ("parts[" + std::to_string(settings.parts.size() - 1) + "].body: shape").c_str());
    // A part whose place is near enough only as long as the origin is.
    settings = Humanoid();
    settings.parts.back().body.position = Position(0, 9e17, 0);
    expect(settings, {Position(0, 9e17, 0), {}}, {}, "position");
}

TEST(RagdollRefusal, UnderHoldNothingIsMade) {
    TestWorld world;
    world.AddFloor();
    const Snapshot before = Of(world);
    {
        const auto held = world.System().Queries().Hold();
        const Result<Ragdoll> made = Ragdoll::Create(world.System(), Humanoid());
        ASSERT_FALSE(made);
        EXPECT_EQ(made.GetError().code, ErrorCode::NotAllowedHere);
    }
    EXPECT_TRUE(Of(world) == before);
    EXPECT_TRUE(Ragdoll::Create(world.System(), Humanoid()));
}

}  // namespace
}  // namespace fulcrum::testing
