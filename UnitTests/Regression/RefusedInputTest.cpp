// Invalid enumerators, positions beyond the range of float, and shapes that a body's settings do not allow were
// accepted; poses lost bits in a round trip.
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cstring>
#include <random>

namespace fulcrum::testing {
namespace {

template <class E>
E OutOf(int value) {
    return static_cast<E>(value);
}

void ExpectRefused(const char* field, ErrorCode code, const Result<BodyId>& result) {
    ASSERT_FALSE(result) << field;
    EXPECT_EQ(result.GetError().code, code) << field;
    EXPECT_NE(result.GetError().message.find(field), std::string::npos) << result.GetError().message;
}
void ExpectRefused(const char* field, const Status& status) {
    ASSERT_FALSE(status) << field;
    EXPECT_EQ(status.GetError().code, ErrorCode::OutOfRange) << field;
    EXPECT_NE(status.GetError().message.find(field), std::string::npos) << status.GetError().message;
}

TEST(RefusedInput, EnumeratorsOfBodies) {
    TestWorld world;
    const auto expect = [&](const char* field, const auto& spoil) {
        for (int value : {77, 255}) {
            BodySettings settings{.shape = SphereOf(1)};
            spoil(settings, value);
            ExpectRefused(field, ErrorCode::OutOfRange, world.Bodies().Create(settings));
        }
    };
    expect("motion", [](BodySettings& s, int x) { s.motion = OutOf<MotionType>(x); });
    expect("lockedAxes", [](BodySettings& s, int x) { s.lockedAxes = OutOf<LockedAxes>(x); });
    expect("continuous", [](BodySettings& s, int x) { s.continuous = OutOf<ContinuousCollision>(x); });
    expect("sensorSees", [](BodySettings& s, int x) { s.sensorSees = OutOf<SensorSees>(x); });
    expect("frictionRule", [](BodySettings& s, int x) { s.material.frictionRule = OutOf<CombineRule>(x); });
    expect("restitutionRule", [](BodySettings& s, int x) { s.material.restitutionRule = OutOf<CombineRule>(x); });
    const BodyId id = world.Add({.shape = SphereOf(1)});
    BodyInterface& bodies = world.Bodies();
    ExpectRefused("frictionRule", bodies.SetMaterial(id, {.frictionRule = OutOf<CombineRule>(5)}));
    ExpectRefused("continuous", bodies.SetContinuous(id, OutOf<ContinuousCollision>(3)));
    ExpectRefused("mass", bodies.SetShape(id, SphereOf(2), OutOf<MassUpdate>(2)));
    ASSERT_TRUE(bodies.SetSensor(id, true));
    ExpectRefused("sensorSees", bodies.SetSensorSees(id, OutOf<SensorSees>(32)));
    EXPECT_EQ(id.index, 0u);
}

TEST(RefusedInput, EnumeratorsOfTheSystem) {
    SystemSettings settings;
    settings.narrowPhase = OutOf<NarrowPhaseMethod>(2);
    const auto created = PhysicsSystem::Create(settings);
    ASSERT_FALSE(created);
    EXPECT_NE(created.GetError().message.find("narrowPhase"), std::string::npos);
    TestWorld world;
    ExpectRefused("narrowPhase", world.System().SetSettings(settings));
    EXPECT_EQ(world.System().Settings().narrowPhase, NarrowPhaseMethod::Automatic);
}

class JointEnumerators : public ::testing::Test {
protected:
    TestWorld world_;
    BodyId a_ = world_.Add({.shape = SphereOf(0.1f)}),
           b_ = world_.Add({.shape = SphereOf(0.1f), .position = {1, 0, 0}});

    template <class Settings, class Spoil>
    void Expect(const char* field, const Spoil& spoil) {
        Settings settings = Of<Settings>(Between(a_, b_, {0, 0, 0}));
        spoil(settings);
        const Result<JointId> made = JointsOf(world_).Create(settings);
        ASSERT_FALSE(made) << field;
        EXPECT_EQ(made.GetError().code, ErrorCode::OutOfRange);
        EXPECT_NE(made.GetError().message.find(field), std::string::npos) << made.GetError().message;
    }
};

TEST_F(JointEnumerators, AreChecked) {
    Expect<PointJointSettings>("space", [](auto& s) { s.space = OutOf<JointSpace>(2); });
    Expect<PointJointSettings>("priority", [](auto& s) { s.priority = OutOf<JointPriority>(2); });
    Expect<DistanceJointSettings>("spring.mode", [](auto& s) { s.spring.mode = OutOf<SpringMode>(2); });
    Expect<DistanceJointSettings>("spring.form", [](auto& s) { s.spring.form = OutOf<SpringForm>(3); });
    Expect<ConeJointSettings>("spring.mode", [](auto& s) { s.spring.mode = OutOf<SpringMode>(200); });
    Expect<HingeJointSettings>("angle.limits.spring.mode",
                               [](auto& s) { s.angle.limits.spring.mode = OutOf<SpringMode>(2); });
    Expect<HingeJointSettings>("angle.motor.spring.form",
                               [](auto& s) { s.angle.motor.spring.form = OutOf<SpringForm>(9); });
    Expect<HingeJointSettings>("angle.motor.mode", [](auto& s) { s.angle.motor.mode = OutOf<MotorMode>(3); });
    Expect<SwingTwistJointSettings>("shape", [](auto& s) { s.shape = OutOf<SwingShape>(2); });
    Expect<SixDofJointSettings>("shape", [](auto& s) { s.shape = OutOf<SwingShape>(2); });
    Expect<PathJointSettings>("rotation", [](auto& s) { s.rotation = OutOf<PathRotation>(100); });
}

TEST_F(JointEnumerators, AnAxisThatIsNoneHasNothing) {
    auto settings = Of<SixDofJointSettings>(Between(a_, b_, {0, 0, 0}));
    const JointId joint = Join(world_, settings);
    JointInterface& joints = JointsOf(world_);
    for (int value : {6, 77, 255}) {
        const JointAxis axis = OutOf<JointAxis>(value);
        ExpectRefused("axis", joints.SetMotor(joint, axis, {}));
        ExpectRefused("axis", joints.SetLimits(joint, axis, JointLimits{}));
        ExpectRefused("axis", joints.SetFriction(joint, axis, 1));
        EXPECT_EQ(joints.GetControl(joint, axis), nullptr);
        EXPECT_EQ(joints.GetCoordinate(joint, axis), 0);
        EXPECT_EQ(joints.GetAxisForces(joint, axis).motor, 0);
    }
}

TEST(RefusedInputDeathTest, SettingsHaveNoAxisThatIsNone) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    SixDofJointSettings settings;
    EXPECT_DEATH(settings[OutOf<JointAxis>(6)].friction = 1, "no axis");
}

TEST(RefusedInput, PositionsThatNoFloatHolds) {
    TestWorld world;
    const BodyId id = world.Add({.shape = SphereOf(1)});
    for (double far : {3.5e38, 1e39, 1e300, -1e39, 1.1e18}) {
        ExpectRefused("position", ErrorCode::OutOfRange,
                      world.Bodies().Create({.shape = SphereOf(1), .position = {0, far, 0}}));
        ExpectRefused("position", world.Bodies().SetPose(id, {far, 0, 0}, {}));
        ExpectRefused("point", world.Bodies().AddForceAt(id, {1, 0, 0}, {far, 0, 0}));
        ExpectRefused("point", world.Bodies().AddImpulseAt(id, {1, 0, 0}, {far, 0, 0}));
    }
    EXPECT_EQ(world.PositionOf(id), Position(0, 0, 0));
    ASSERT_TRUE(world.Bodies().SetPose(id, {1e18, 0, 0}, {}));
    world.Steps(3);
    EXPECT_TRUE(world.AllFinite());
}

TEST(RefusedInput, AMeshForABodyWithContinuousCollision) {
    const Vector3 vertices[] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
    const uint32_t indices[] = {0, 1, 2};
    const ShapePtr mesh = TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value();
    TestWorld world;
    const BodyId id =
        world.Add({.shape = SphereOf(1), .motion = MotionType::Kinematic, .continuous = ContinuousCollision::Linear});
    const ShapePtr before = world.Bodies().GetShape(id);
    const Status status = world.Bodies().SetShape(id, mesh);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.GetError().code, ErrorCode::Unsupported);
    EXPECT_NE(status.GetError().message.find("continuous"), std::string::npos);
    EXPECT_EQ(world.Bodies().GetShape(id), before);
    ASSERT_TRUE(world.Bodies().SetContinuous(id, ContinuousCollision::Off));
    EXPECT_TRUE(world.Bodies().SetShape(id, mesh));
    world.Step();
}

// Of bodies that tumble and of rotations as a user has them.
TEST(PoseRoundTrip, KeepsEveryBit) {
    TestWorld world(NoGravity());
    TestWorld other(NoGravity());
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        const Quaternion q = Normalized(Quaternion{unit(random), unit(random), unit(random), unit(random)});
        const ShapePtr shape = i % 2 ? BoxOf(0.1f, 0.2f, 0.3f) : HullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
        const BodySettings settings{.shape = shape,
                                    .position = {10.0 * i, unit(random), unit(random)},
                                    .rotation = q,
                                    .angularVelocity = {unit(random), 3 * unit(random), unit(random)}};
        world.Add(settings);
        other.Add(settings);
    }
    world.Steps(5);
    world.System().VisitBodies([&](BodyId id) {
        const BodyBits before = BitsOf(world, id);
        const Pose pose = world.Bodies().GetPose(id);
        ASSERT_TRUE(world.Bodies().SetPose(id, pose.position, pose.rotation));
        EXPECT_TRUE(BitsOf(world, id) == before) << id.index;
        ASSERT_TRUE(other.Bodies().SetPose(id, pose.position, pose.rotation));
        const Pose there = other.Bodies().GetPose(id);
        EXPECT_EQ(std::memcmp(&there.rotation, &pose.rotation, sizeof pose.rotation), 0);
    });
}

}  // namespace
}  // namespace fulcrum::testing
