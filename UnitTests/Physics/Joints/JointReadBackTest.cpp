// What joints report: forces, torques, errors, frames; and what is refused, with nothing changed.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <functional>

namespace fulcrum::testing {
namespace {

TEST(ReadBack, AJointCarriesTheWeightOfWhatHangsThere) {
    TestWorld world(NoSleep());
    const BodyId hook = AddHook(world), upper = world.Add({.shape = CubeOf(0.1f), .position = {0, -1, 0}, .mass = 10});
    const BodyId lower = world.Add({.shape = CubeOf(0.1f), .position = {0, -2, 0}, .mass = 5});
    const JointId first = Join(world, PointJointSettings{Between(hook, upper, {0, 0, 0})});
    const JointId second = Join(world, PointJointSettings{Between(upper, lower, {0, -1, 0})});
    // A and B swapped: the force is that on B, which now is the hook.
    const BodyId other = world.Add({.shape = CubeOf(0.1f), .position = {5, -1, 0}, .mass = 10});
    const JointId third = Join(world, PointJointSettings{Between(other, hook, {5, 0, 0})});
    world.Run(2);
    EXPECT_LT(Length(Vector3(JointsOf(world).GetForce(first) - Vector3(0, static_cast<float>(15 * kGravity), 0))),
              0.002 * 15 * kGravity);
    EXPECT_LT(Length(Vector3(JointsOf(world).GetForce(second) - Vector3(0, static_cast<float>(5 * kGravity), 0))),
              0.002 * 5 * kGravity);
    EXPECT_LT(Length(Vector3(JointsOf(world).GetForce(third) + Vector3(0, static_cast<float>(10 * kGravity), 0))),
              0.002 * 10 * kGravity);
    EXPECT_LT(Length(JointsOf(world).GetTorque(first)), 1e-2f);
    EXPECT_EQ(JointsOf(world).GetForce(first), JointsOf(world).GetLockForce(first));
}

TEST(ReadBack, ACantileverCarriesForceTimesArm) {
    TestWorld world(NoSleep());
    const BodyId arm = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0.5, 0, 0}, .mass = 10});
    const JointId joint = Join(world, FixedJointSettings{Between(AddHook(world), arm, {0, 0, 0})});
    world.Run(2);
    EXPECT_NEAR(JointsOf(world).GetForce(joint).y(), 10 * kGravity, 0.01 * 98.1);
    EXPECT_NEAR(JointsOf(world).GetTorque(joint).z(), 10 * kGravity * 0.5, 0.01 * 49);
    EXPECT_NEAR(JointsOf(world).GetTorque(joint).x(), 0, 0.1);
}

TEST(ReadBack, EachRowOfAnAxisHasItsForce) {
    TestWorld world(NoSleep());
    const BodyId hook = AddHook(world);
    const auto slider = [&](double x, const AxisControl& slide) {
        const BodyId box = world.Add({.shape = CubeOf(0.1f), .position = {x, 0, 0}, .mass = 10});
        return Join(world, SliderJointSettings{Between(hook, box, {x, 0, 0}, {0, 1, 0}), slide});
    };
    const double weight = 10 * kGravity;
    AxisControl driven, rubbed{.friction = 200};
    driven.motor = SpeedMotor(0);
    const JointId low = slider(1, Limited(0, 1)), high = slider(2, Limited(-1, 1)), motor = slider(3, driven),
                  friction = slider(4, rubbed);
    ASSERT_TRUE(JointsOf(world).SetLimits(high, JointAxis::LinearX, JointLimits{-1, 1, {}}));
    for (int i = 0; i < 120; ++i) {
        ASSERT_TRUE(world.Bodies().AddForce(JointsOf(world).GetBodyB(high), {0, static_cast<float>(3 * weight), 0}));
        world.Step();
    }
    const auto forces = [&](JointId id) { return JointsOf(world).GetAxisForces(id, JointAxis::LinearX); };
    const double tolerance = 0.005 * weight;
    EXPECT_NEAR(forces(low).limit, weight, tolerance);
    EXPECT_NEAR(forces(high).limit, -2 * weight, tolerance);
    EXPECT_NEAR(forces(motor).motor, weight, tolerance);
    EXPECT_NEAR(forces(friction).friction, weight, tolerance);
    EXPECT_EQ(forces(motor).limit, 0);
    EXPECT_EQ(forces(low).motor, 0);
    for (const JointId id : {low, motor, friction}) {
        EXPECT_NEAR(JointsOf(world).GetForce(id).y(), weight, tolerance);
        EXPECT_NEAR(JointsOf(world).GetLockForce(id).y(), 0, tolerance);
    }
}

TEST(ReadBack, ADisabledJointDoesNothing) {
    TestWorld world(NoSleep());
    const BodyId box = world.Add({.shape = CubeOf(0.1f), .mass = 10});
    SliderJointSettings settings{Between(AddHook(world), box, {0, 0, 0}, {0, 1, 0})};
    settings.slide.motor = SpeedMotor(0);
    const JointId joint = Join(world, settings);
    world.Run(1);
    EXPECT_NEAR(JointsOf(world).GetAxisForces(joint, JointAxis::LinearX).motor, 10 * kGravity, 1);
    ASSERT_TRUE(JointsOf(world).SetEnabled(joint, false));
    for (int i = 0; i < 2; ++i) {
        EXPECT_EQ(JointsOf(world).GetAxisForces(joint, JointAxis::LinearX).motor, 0);
        EXPECT_EQ(JointsOf(world).GetForce(joint), Vector3(0, 0, 0));
        world.Step();
    }
}

TEST(ReadBack, ASleepingJointCarriesWhatItDid) {
    TestWorld world;
    const BodyId hook = AddHook(world), box = world.Add({.shape = CubeOf(0.1f), .position = {0.4, 0, 0}, .mass = 10});
    const BodyId weight = world.Add({.shape = CubeOf(0.1f), .position = {0, -2, 0}, .mass = 10});
    const JointId arm = Join(world, FixedJointSettings{Between(hook, box, {0, 0, 0})});
    SliderJointSettings settings{Between(hook, weight, {0, -2, 0}, {0, 1, 0})};
    settings.slide.motor = SpeedMotor(0);
    const JointId slider = Join(world, settings);
    world.Run(3);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    ASSERT_FALSE(world.Bodies().IsAwake(weight));
    // Steps of another length, in which they sleep on, change nothing.
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(JointsOf(world).GetForce(arm).y(), 10 * kGravity, 1);
        EXPECT_NEAR(JointsOf(world).GetTorque(arm).z(), 10 * kGravity * 0.4, 0.4);
        EXPECT_NEAR(JointsOf(world).GetAxisForces(slider, JointAxis::LinearX).motor, 10 * kGravity, 1);
        world.Step(0.004);
    }
    EXPECT_FALSE(world.Bodies().IsAwake(box));
}

TEST(ReadBack, AHingeReadsTheRightTurnAtAnySpeed) {
    // Five radians a step and more: the turn follows from the way of the step. Whoever sets the speed in between, or
    // takes steps of other lengths, loses none.
    for (const double speed : {220.0, -500.0, 1000.0}) {
        TestWorld world(Weightless());
        const BodyId ball = world.Add({.shape = SphereOf(0.2f), .mass = 1, .maxAngularSpeed = 1e4f});
        HingeJointSettings settings{Between(AddHook(world), ball, {0, 0, 0}, {0, 0, 1})};
        settings.angle.friction = 1e-6f;  // so that it counts
        const JointId hinge = Join(world, settings);
        double angle = 0;
        for (int i = 0; i < 30; ++i) {
            const double dt = i % 3 ? kStep : 0.02, now = i % 10 == 7 ? -0.3 * speed : speed;
            ASSERT_TRUE(world.Bodies().SetVelocity(ball, {0, 0, 0}, {0, 0, static_cast<float>(now)}));
            EXPECT_NEAR(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX), angle, 0.01)
                << speed << " step " << i;
            world.Step(dt);
            angle += now * dt;
            EXPECT_NEAR(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX), angle, 0.01)
                << speed << " step " << i;
        }
    }
}

TEST(ReadBack, UnknownJointsReadAsZero) {
    TestWorld world;
    const JointId nobody{3, 1};
    EXPECT_FALSE(JointsOf(world).Exists(nobody));
    EXPECT_EQ(JointsOf(world).GetControl(nobody, JointAxis::LinearX), nullptr);
    EXPECT_EQ(JointsOf(world).GetForce(nobody), Vector3(0, 0, 0));
    EXPECT_EQ(JointsOf(world).GetCoordinate(nobody, JointAxis::AngularX), 0);
    EXPECT_EQ(JointsOf(world).GetAxisForces(nobody, JointAxis::LinearX).motor, 0);
    EXPECT_EQ(JointsOf(world).GetError(nobody).distance, 0);
    EXPECT_EQ(JointsOf(world).GetUserData(nobody), 0u);
}

TEST(ReadBack, FramesErrorsAndUserDataAreThoseOfTheJoint) {
    TestWorld world(NoGravity());
    const BodyId hook = AddHook(world),
                 box = world.Add(
                     {.shape = CubeOf(0.5f), .position = {2, 0, 0}, .rotation = RotationAbout({0, 1, 0}, 0.4)});
    HingeJointSettings settings{Between(hook, box, {1, 2, 3}, {0, 0, 1})};
    settings.anchorB = AnchorAt({1, 2.25, 3}, {0, 1, 0});
    settings.userData = 77;
    const JointId joint = Join(world, settings);
    EXPECT_LT((JointsOf(world).GetFrameA(joint).position - Position(1, 2, 3)).norm(), 1e-6);
    EXPECT_LT((JointsOf(world).GetFrameB(joint).position - Position(1, 2.25, 3)).norm(), 1e-6);
    EXPECT_NEAR(JointsOf(world).GetError(joint).distance, 0.25, 1e-6);
    EXPECT_NEAR(JointsOf(world).GetError(joint).angle, kPi / 2, 1e-5);
    EXPECT_EQ(JointsOf(world).GetUserData(joint), 77u);
    EXPECT_EQ(JointsOf(world).GetBodyA(joint), hook);
    EXPECT_EQ(JointsOf(world).GetBodyB(joint), box);
    const Vector3 axis = Rotate(JointsOf(world).GetFrameB(joint).rotation, Vector3(1, 0, 0));
    EXPECT_NEAR(axis.y(), 1, 1e-6);
    world.Step();
    EXPECT_EQ(world.Report().worstJoint, joint);
    EXPECT_NEAR(world.Report().largestJointError, 0.25, 1e-5);
    EXPECT_EQ(world.Report().mostTurnedJoint, joint);
    EXPECT_NEAR(world.Report().largestJointAngle, kPi / 2, 1e-4);
}

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

class JointErrors : public ::testing::Test {
protected:
    void SetUp() override {
        hook_ = AddHook(world_);
        floor_ = world_.AddFloor();
        box_ = world_.Add({.shape = CubeOf(0.5f), .position = {0, 2, 0}});
    }
    template <class Settings>
    void Expect(ErrorCode code, const std::string& field, const std::function<void(Settings&)>& spoil) {
        Settings settings;
        settings.bodyA = hook_;
        settings.bodyB = box_;
        spoil(settings);
        const Result<JointId> result = JointsOf(world_).Create(settings);
        ASSERT_FALSE(result) << field;
        EXPECT_EQ(result.GetError().code, code) << result.GetError().message;
        EXPECT_NE(result.GetError().message.find(field), std::string::npos) << result.GetError().message;
        int count = 0;
        JointsOf(world_).Visit([&](JointId) { ++count; });
        EXPECT_EQ(count, 0);
    }

    TestWorld world_;
    BodyId hook_, floor_, box_;
};

TEST_F(JointErrors, OfTheBodies) {
    using S = PointJointSettings;
    Expect<S>(ErrorCode::UnknownId, "bodyA", [](S& s) { s.bodyA = BodyId{77, 0}; });
    Expect<S>(ErrorCode::UnknownId, "bodyB", [](S& s) { s.bodyB = {}; });
    Expect<S>(ErrorCode::Unsupported, "the same", [this](S& s) { s.bodyA = box_; });
    Expect<S>(ErrorCode::Unsupported, "not dynamic", [this](S& s) { s.bodyB = floor_; });
    const BodyId gone = world_.Add({.shape = CubeOf(0.1f), .position = {5, 5, 5}});
    ASSERT_TRUE(world_.Bodies().Remove(gone));
    Expect<S>(ErrorCode::UnknownId, "bodyB", [&](S& s) { s.bodyB = gone; });
}

TEST_F(JointErrors, OfEveryKind) {
    Expect<PointJointSettings>(ErrorCode::NonFinite, "anchorA.point",
                               [](auto& s) { s.anchorA.point.x() = std::numeric_limits<double>::quiet_NaN(); });
    Expect<FixedJointSettings>(ErrorCode::Unnormalized, "anchorA.axis",
                               [](auto& s) { s.anchorA.axis = Vector3::Zero(); });
    Expect<FixedJointSettings>(ErrorCode::NonPositive, "breakForce", [](auto& s) { s.breakForce = 0; });
    Expect<DistanceJointSettings>(ErrorCode::OutOfRange, "minDistance",
                                  [](auto& s) { s.minDistance = 2.0f, s.maxDistance = 1.0f; });
    Expect<DistanceJointSettings>(ErrorCode::Negative, "spring.stiffness", [](auto& s) { s.spring.stiffness = -1; });
    Expect<HingeJointSettings>(ErrorCode::OutOfRange, "angle.limits.min", [](auto& s) { s.angle = Limited(1, -1); });
    Expect<SliderJointSettings>(ErrorCode::Negative, "slide.friction", [](auto& s) { s.slide.friction = -1; });
    Expect<ConeJointSettings>(ErrorCode::OutOfRange, "halfAngle", [](auto& s) { s.halfAngle = 4; });
    Expect<SwingTwistJointSettings>(ErrorCode::OutOfRange, "swingY.limits.min",
                                    [](auto& s) { s.swingY = Limited(0.1, 1); });
    Expect<SixDofJointSettings>(ErrorCode::NonFinite, "axes[LinearX].motor.targetSpeed",
                                [](auto& s) { s.axes[0].motor.targetSpeed = kNaN; });
    Expect<GearJointSettings>(ErrorCode::OutOfRange, "ratio", [](auto& s) { s.ratio = 0; });
    Expect<RackAndPinionJointSettings>(ErrorCode::NonFinite, "ratio", [](auto& s) { s.ratio = kNaN; });
    Expect<PulleyJointSettings>(ErrorCode::NonPositive, "ratio", [](auto& s) { s.ratio = -1; });
    Expect<PathJointSettings>(ErrorCode::Unsupported, "path", [](auto& s) { s.path = nullptr; });
    Expect<WheelJointSettings>(ErrorCode::Negative, "suspension.motor.spring.damping",
                               [](auto& s) { s.suspension.motor.spring.damping = -1; });
    Expect<CustomJointSettings>(ErrorCode::Unsupported, "make", [](auto& s) { s.make = nullptr; });
}

TEST_F(JointErrors, OfChangesLeaveTheJointAsItWas) {
    HingeJointSettings settings{Between(hook_, box_, {0, 2, 0}, {0, 0, 1}), Limited(-1, 1)};
    settings.angle.motor = SpeedMotor(2);
    const JointId joint = Join(world_, settings);
    JointInterface& joints = JointsOf(world_);
    EXPECT_EQ(joints.SetLimits(joint, JointAxis::AngularX, JointLimits{2, 1, {}}).GetError().code,
              ErrorCode::OutOfRange);
    EXPECT_EQ(joints.SetMotor(joint, JointAxis::AngularX, SpeedMotor(double(kNaN))).GetError().code,
              ErrorCode::NonFinite);
    EXPECT_EQ(joints.SetFriction(joint, JointAxis::AngularX, -1).GetError().code, ErrorCode::Negative);
    EXPECT_EQ(joints.SetMotor(joint, JointAxis::LinearY, {}).GetError().code, ErrorCode::Unsupported);
    EXPECT_EQ(joints.SetEffort(joint, {65, 1, 1}).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(joints.SetTargetOrientation(joint, {0, 0, 0, 2}).GetError().code, ErrorCode::Unnormalized);
    const JointId nobody{9, 9};
    EXPECT_EQ(joints.SetLimits(nobody, JointAxis::AngularX, std::nullopt).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(joints.SetEffort(nobody, {}).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(joints.Remove(nobody).GetError().code, ErrorCode::UnknownId);
    const AxisControl* control = joints.GetControl(joint, JointAxis::AngularX);
    ASSERT_NE(control, nullptr);
    EXPECT_EQ(control->limits.min, -1);
    EXPECT_EQ(control->motor.targetSpeed, 2);
    EXPECT_EQ(control->friction, 0);
}

TEST_F(JointErrors, OfLimitsAreThoseOfCreate) {
    SwingTwistJointSettings shoulder{Between(hook_, box_, {0, 0, 0})};
    shoulder.swingY = Limited(-1, 1);
    SixDofJointSettings six{Between(hook_, box_, {0, 0, 0})};
    DistanceJointSettings rope{Between(hook_, box_, {0, 0, 0})};
    PulleyJointSettings pulley{Between(hook_, box_, {0, 0, 0})};
    struct Case {
        JointId joint;
        JointAxis axis;
        float min, max;
        const char* field;
    };
    const JointId ofShoulder = Join(world_, shoulder), ofSix = Join(world_, six), ofRope = Join(world_, rope),
                  ofPulley = Join(world_, pulley);
    const Case cases[] = {
        {ofShoulder, JointAxis::AngularY, 0.1f, 1, "axis.limits.min"},    // not around 0
        {ofShoulder, JointAxis::AngularZ, -1, -0.1f, "axis.limits.max"},  // not around 0
        {ofShoulder, JointAxis::AngularY, -0.5f, 1, "axis.limits"},       // an ellipse has two equal sides
        {ofShoulder, JointAxis::AngularX, -4, 0, "axis.limits.min"},      // beyond pi
        {ofShoulder, JointAxis::AngularX, 0, 4, "axis.limits.max"},
        {ofSix, JointAxis::AngularZ, -1, -0.5f, "axis.limits.max"},
        {ofSix, JointAxis::AngularX, -4, 0, "axis.limits.min"},
        {ofRope, JointAxis::LinearX, -2, -1, "axis.limits.min"},
        {ofPulley, JointAxis::LinearX, -2, 1, "axis.limits.min"},
    };
    for (const Case& c : cases) {
        const JointLimits before = JointsOf(world_).GetControl(c.joint, c.axis)->limits;
        const Status status = JointsOf(world_).SetLimits(c.joint, c.axis, JointLimits{c.min, c.max, {}});
        ASSERT_FALSE(status) << c.field;
        EXPECT_EQ(status.GetError().code, ErrorCode::OutOfRange) << status.GetError().message;
        EXPECT_TRUE(status.GetError().message.starts_with(std::string(c.field) + " ")) << status.GetError().message;
        const JointLimits& after = JointsOf(world_).GetControl(c.joint, c.axis)->limits;
        EXPECT_EQ(after.min, before.min);
        EXPECT_EQ(after.max, before.max);
    }
    // What Create takes is taken: a pyramid need not be even, lengths may be endless.
    EXPECT_TRUE(JointsOf(world_).SetLimits(ofSix, JointAxis::AngularY, JointLimits{-0.2f, 1, {}}));
    EXPECT_TRUE(JointsOf(world_).SetLimits(ofRope, JointAxis::LinearX,
                                           JointLimits{0, std::numeric_limits<float>::infinity(), {}}));
    EXPECT_TRUE(JointsOf(world_).SetLimits(ofSix, JointAxis::LinearX, JointLimits{-2, -1, {}}));
}

TEST_F(JointErrors, LeaveTheWorldsBitsAsTheyAre) {
    TestWorld clean, tried;
    for (TestWorld* world : {&clean, &tried}) {
        const BodyId hook = AddHook(*world), box = world->Add({.shape = CubeOf(0.5f), .position = {0.3, -0.7, 0}});
        Join(*world, PointJointSettings{Between(hook, box, {0, 0, 0})});
        for (int i = 0; i < 60; ++i) {
            if (world == &tried) {
                HingeJointSettings bad{Between(hook, box, {0, 0, 0}), Limited(1, -1)};
                EXPECT_FALSE(JointsOf(*world).Create(bad));
                EXPECT_FALSE(JointsOf(*world).Create(PointJointSettings{Between(box, box, {0, 0, 0})}));
            }
            world->Step();
        }
    }
    EXPECT_EQ(clean.System().HashPoses(), tried.System().HashPoses());
}

}  // namespace
}  // namespace fulcrum::testing
