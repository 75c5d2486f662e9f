// Six-degrees-of-freedom joints against the special ones, paths, wheels, joints of a user's own.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

SixDofJointSettings SixDof(const JointSettings& between, std::initializer_list<JointAxis> free) {
    SixDofJointSettings settings{between};
    for (AxisControl& axis : settings.axes) axis = kLockedAxis;
    for (const JointAxis axis : free) settings[axis] = {};
    return settings;
}

// A box hung up at its corner from a hook, thrown, by two settings in two worlds: after two seconds both are at the
// same place.
template <class First, class Second>
void ExpectTheSameMotion(const First& first, const Second& second) {
    std::vector<BodyBits> bits;
    const auto run = [&](const auto& settings) {
        TestWorld world(NoSleep());
        const BodyId hook = AddHook(world);
        const BodyId box = world.Add({.shape = BoxOf(0.4f, 0.2f, 0.3f),
                                      .position = {0.4, -0.2, 0.3},
                                      .linearVelocity = {1, 2, -1},
                                      .angularVelocity = {3, -2, 1}});
        auto placed = settings;
        placed.bodyA = hook;
        placed.bodyB = box;
        Join(world, placed);
        world.Run(2);
        bits.push_back(BitsOf(world, box));
    };
    run(first);
    run(second);
    EXPECT_EQ(bits[0], bits[1]);
}

const JointSettings kAtTheOrigin = Between({}, {}, {0, 0, 0}, {0, 1, 0});

TEST(SixDof, AllLockedIsAFixedJoint) {
    ExpectTheSameMotion(FixedJointSettings{kAtTheOrigin}, SixDof(kAtTheOrigin, {}));
}
TEST(SixDof, FreeToTurnIsABallJoint) {
    ExpectTheSameMotion(PointJointSettings{kAtTheOrigin},
                        SixDof(kAtTheOrigin, {JointAxis::AngularX, JointAxis::AngularY, JointAxis::AngularZ}));
}
TEST(SixDof, FreeToTurnAboutXIsAHinge) {
    ExpectTheSameMotion(HingeJointSettings{kAtTheOrigin}, SixDof(kAtTheOrigin, {JointAxis::AngularX}));
}
TEST(SixDof, FreeToMoveAlongXIsASlider) {
    ExpectTheSameMotion(SliderJointSettings{kAtTheOrigin}, SixDof(kAtTheOrigin, {JointAxis::LinearX}));
}
TEST(SixDof, WithLimitsAndMotorOnXIsADrivenHinge) {
    HingeJointSettings hinge{kAtTheOrigin, Limited(-0.5, 0.3)};
    hinge.angle.motor = SpeedMotor(2, 50);
    hinge.angle.friction = 3;
    SixDofJointSettings six = SixDof(kAtTheOrigin, {JointAxis::AngularX});
    six[JointAxis::AngularX] = hinge.angle;
    ExpectTheSameMotion(hinge, six);
}
TEST(SixDof, WithLimitsAndMotorOnXIsADrivenSlider) {
    SliderJointSettings slider{kAtTheOrigin, Limited(-0.5, 0.3)};
    slider.slide.motor = PositionMotor(1, FrequencySpring(2, 0.5));
    SixDofJointSettings six = SixDof(kAtTheOrigin, {JointAxis::LinearX});
    six[JointAxis::LinearX] = slider.slide;
    ExpectTheSameMotion(slider, six);
}
TEST(SixDof, WithSwingAndTwistIsASwingTwistJoint) {
    SwingTwistJointSettings shoulder{kAtTheOrigin};
    shoulder.twist = Limited(-0.3, 0.4);
    shoulder.swingY = Limited(-0.6, 0.6);
    shoulder.swingZ = Limited(-0.2, 0.2);
    shoulder.twist.motor = PositionMotor(0.2, FrequencySpring(3, 1));
    SixDofJointSettings six = SixDof(kAtTheOrigin, {});
    six.shape = SwingShape::Ellipse;
    six[JointAxis::AngularX] = shoulder.twist;
    six[JointAxis::AngularY] = shoulder.swingY;
    six[JointAxis::AngularZ] = shoulder.swingZ;
    ExpectTheSameMotion(shoulder, six);
}
TEST(SixDof, AllFreeIsNoJoint) {
    TestWorld world;
    const BodyId box = world.Add({.shape = CubeOf(0.2f), .linearVelocity = {1, 0, 0}, .angularVelocity = {0, 2, 0}});
    Join(world, SixDofJointSettings{Between(AddHook(world), box, {0, 0, 0})});
    world.Run(1);
    EXPECT_NEAR(world.VelocityOf(box).y(), -kGravity, 1e-4);
    EXPECT_NEAR(world.VelocityOf(box).x(), 1, 1e-6);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(box).y(), 2, 1e-5);
}

TEST(SixDof, EachLinearAxisKeepsToItsOwnLimits) {
    TestWorld world(Weightless());
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .mass = 1});
    SixDofJointSettings settings = SixDof(Between(AddHook(world), ball, {0, 0, 0}), {});
    const double limits[][2] = {{-0.1, 0.3}, {-0.2, 0.5}, {0, 0.7}};
    for (size_t k = 0; k < 3; ++k) {
        settings.axes[k] = Limited(limits[k][0], limits[k][1]);
        settings.axes[k].motor = SpeedMotor(k == 1 ? -2 : 2, 30);
    }
    const JointId joint = Join(world, settings);
    for (int i = 0; i < 120; ++i) {
        world.Step();
        for (size_t k = 0; k < 3; ++k) {
            const double place = JointsOf(world).GetCoordinate(joint, static_cast<JointAxis>(k));
            ASSERT_GE(place, limits[k][0] - 1e-3);
            ASSERT_LE(place, limits[k][1] + 1e-3);
        }
    }
    EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::LinearX), 0.3, 1e-3);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::LinearY), -0.2, 1e-3);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::LinearZ), 0.7, 1e-3);
}

// A circle of eight points in the x-y plane, by Hermite pieces: within 1e-3 of the radius.
std::shared_ptr<const Path> Circle(float radius) {
    std::vector<PathPoint> points;
    for (int i = 0; i < 8; ++i) {
        const double angle = i * kPi / 4;
        const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
        PathPoint point;
        point.position = Vector3(c, s, 0) * radius;
        point.tangent = Vector3(-s, c, 0) * (radius * static_cast<float>(kPi / 4));
        point.normal = Vector3(0, 0, 1);
        points.push_back(point);
    }
    auto path = Path::Hermite(points, true);
    if (path) return path.Value();
    ADD_FAILURE() << path.GetError().message;
    return nullptr;
}

PathJointSettings OnTheCircle(TestWorld& world, BodyId body, float radius, PathRotation rotation) {
    PathJointSettings settings{Between(AddHook(world), body, {0, 0, 0})};
    settings.anchorA.normal = Vector3(0, 1, 0);
    settings.anchorB = settings.anchorA;
    settings.anchorB->point = world.PositionOf(body);
    settings.path = Circle(radius);
    settings.rotation = rotation;
    return settings;
}

TEST(PathJoint, ABeadSwingsOnACircleAndStaysThere) {
    TestWorld world(NoSleep());
    const BodyId bead = world.Add({.shape = SphereOf(0.05f), .position = {2, 0, 0}, .mass = 1});
    Join(world, OnTheCircle(world, bead, 2, PathRotation::Free));
    for (int i = 0; i < 300; ++i) {
        world.Step();
        const Position p = world.PositionOf(bead);
        ASSERT_NEAR(p.norm(), 2, 0.02) << "step " << i;
        ASSERT_NEAR(p.z(), 0, 1e-3);
    }
}

TEST(PathJoint, AMotorDrivesAroundAndAround) {
    TestWorld world(Weightless());
    const BodyId cart = world.Add({.shape = BoxOf(0.2f, 0.1f, 0.1f),
                                   .position = {2, 0, 0},
                                   .rotation = RotationAbout({0, 0, 1}, kPi / 2),
                                   .mass = 2});
    PathJointSettings settings = OnTheCircle(world, cart, 2, PathRotation::TangentAndNormal);
    settings.anchorB = AnchorAt({2, 0, 0}, {0, 1, 0});
    settings.anchorB->normal = Vector3(0, 0, 1);
    settings.along.motor = SpeedMotor(3);
    const JointId joint = Join(world, settings);
    world.Run(20);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::LinearX), 60, 0.3);
    EXPECT_NEAR(Length(world.VelocityOf(cart)), 3, 0.03);
    const Position p = world.PositionOf(cart);
    EXPECT_NEAR(p.norm(), 2, 0.01);
    // Its x axis is along the circle.
    const Vector3 x = Rotate(world.Bodies().GetPose(cart).rotation, Vector3(1, 0, 0));
    EXPECT_NEAR(double(x.x()) * -p.y() / 2 + double(x.y()) * p.x() / 2, 1, 1e-3);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(cart).z(), 1.5, 0.05);
}

TEST(PathJoint, APositionMotorGoesToAPlaceOnThePath) {
    TestWorld world(NoSleep());
    const BodyId bead = world.Add({.shape = SphereOf(0.05f), .position = {2, 0, 0}, .mass = 1});
    PathJointSettings settings = OnTheCircle(world, bead, 2, PathRotation::Free);
    settings.along.motor = PositionMotor(2 * kPi, FrequencySpring(3, 1));  // half way round: at the left
    Join(world, settings);
    world.Run(5);
    // It carries m g there: g / w^2 too low.
    EXPECT_LT((world.PositionOf(bead) - Position(-2, -kGravity / std::pow(6 * kPi, 2), 0)).norm(), 0.005);
}

TEST(PathJoint, AnOpenPathEnds) {
    TestWorld world(Weightless());
    const BodyId bead = world.Add({.shape = SphereOf(0.05f), .linearVelocity = {5, 0, 0}});
    PathJointSettings settings{Between(AddHook(world), bead, {0, 0, 0})};
    settings.path = Path::Straight(3);
    const JointId joint = Join(world, settings);
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(bead).x(), 1.5, 1e-3);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::LinearX), 3, 1e-3);
}

WheelJointSettings UprightWheel(const JointSettings& between) {
    auto settings = Of<WheelJointSettings>(between);
    settings.anchorA.normal = Vector3(0, 1, 0);
    return settings;
}

TEST(WheelJoint, ASuspensionCarriesAWeightAtForceOverStiffness) {
    TestWorld world(NoSleep());
    const BodyId chassis = world.Add(
        {.shape = BoxOf(1, 0.2f, 0.5f), .position = {0, 1, 0}, .mass = 400, .lockedAxes = LockedAxes::Rotation});
    const BodyId wheel = AddHook(world, {0, 1, 0});
    const JointId joint = Join(world, UprightWheel(Between(chassis, wheel, {0, 1, 0}, {0, 0, 1})));
    world.Run(4);
    // Seen from the chassis the wheel goes up.
    EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::LinearY), 400 * kGravity / 4.0e4, 1e-4);
}

TEST(WheelJoint, BouncesAtTheFrequencyOfItsSpring) {
    TestWorld world(Weightless());
    const BodyId chassis = world.Add(
        {.shape = BoxOf(1, 0.2f, 0.5f), .position = {0, 1.1, 0}, .mass = 400, .lockedAxes = LockedAxes::Rotation});
    const BodyId wheel = AddHook(world, {0, 1, 0});
    auto settings = UprightWheel(Between(chassis, wheel, {0, 1.1, 0}, {0, 0, 1}));
    settings.anchorB = settings.anchorA;
    settings.anchorB->point = {0, 1, 0};
    settings.suspension.motor.spring = FrequencySpring(1.5, 0.2);
    const JointId joint = Join(world, settings);
    std::vector<double> x;
    for (int i = 0; i < 300; ++i) {
        x.push_back(JointsOf(world).GetCoordinate(joint, JointAxis::LinearY));
        world.Step();
    }
    EXPECT_NEAR(x.front(), -0.1, 1e-6);
    const Oscillator found = FitOscillator(x, kStep, 6);
    EXPECT_NEAR(found.frequency, 1.5, 0.015);
    EXPECT_NEAR(found.dampingRatio, 0.2, 0.002);
}

TEST(WheelJoint, SteersAndSpinsAndDrives) {
    TestWorld world(NoSleep());
    const BodyId chassis =
        world.Add({.shape = BoxOf(1, 0.2f, 0.5f), .motion = MotionType::Static, .position = {0, 1, 0}});
    const BodyId wheel = world.Add({.shape = SphereOf(0.3f), .position = {0, 1, 1}, .mass = 20});
    auto settings = UprightWheel(Between(chassis, wheel, {0, 1, 1}, {0, 0, 1}));
    settings.isSteered = true;
    settings.spin.motor = SpeedMotor(10, 50);
    const JointId joint = Join(world, settings);
    ASSERT_TRUE(JointsOf(world).SetMotor(joint, JointAxis::AngularY, PositionMotor(0.4, FrequencySpring(4, 1))));
    world.Run(3);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::AngularY), 0.4, 2e-3);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::LinearY), -20 * kGravity / 4.0e4, 2e-3);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(joint, JointAxis::AngularZ), 0, 2e-3);
    EXPECT_NEAR(Length(world.Bodies().GetAngularVelocity(wheel)), 10, 0.05);
    // The axle, +z turned by 0.4 about +y.
    const Vector3 axle = Rotate(JointsOf(world).GetFrameB(joint).rotation, Vector3(1, 0, 0));
    EXPECT_NEAR(axle.x(), std::sin(0.4), 3e-3);
    EXPECT_NEAR(axle.z(), std::cos(0.4), 3e-3);
}

// A nut on a thread: it turns about x by `lead` rad a meter. Made of public parts alone, as a user would.
class Screw final : public JointType {
public:
    explicit Screw(float lead) : lead_(lead) {}
    JointLocks Locks() const override { return {LinearLock::Line, AngularLock::Axis, 0, 0}; }
    uint32_t MaxRows() const override { return 1; }
    void CollectRows(const JointPose& pose, JointRowList& rows) override {
        const Vector3 axis = Rotate(pose.frameA, Vector3(1, 0, 0));
        JointRow& row = rows.Add(0, JointRow::Kind::Speed);
        pose.SetAlong(row, axis * -lead_);
        row.jacobian.a.angular += axis;
        row.jacobian.b.angular += axis;
    }

private:
    float lead_;
};

TEST(CustomJoint, AScrewFallsAsItsThreadLetsIt) {
    // a = m g / (m + I lead^2).
    TestWorld world(NoSleep());
    const double lead = 20, mass = 2, inertia = 0.4 * 2 * 0.01;
    const BodyId nut = world.Add({.shape = SphereOf(0.1f), .mass = static_cast<float>(mass)});
    auto settings = Of<CustomJointSettings>(Between(AddHook(world), nut, {0, 0, 0}, {0, 1, 0}));
    settings.make = [&] { return std::make_unique<Screw>(static_cast<float>(lead)); };
    Join(world, settings);
    world.Run(1);
    const double acceleration = mass * kGravity / (mass + inertia * lead * lead);
    EXPECT_NEAR(world.VelocityOf(nut).y(), -acceleration, 1e-3 * acceleration);
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(nut).y(), -acceleration * lead, 1e-3 * acceleration * lead);
}

TEST(CustomJoint, ARowOfItsOwnIsReadBack) {
    TestWorld world(NoSleep());
    const BodyId nut = world.Add({.shape = SphereOf(0.1f), .mass = 2});
    auto settings = Of<CustomJointSettings>(Between(AddHook(world), nut, {0, 0, 0}, {0, 1, 0}));
    settings.make = [] { return std::make_unique<Screw>(20.0f); };
    const JointId joint = Join(world, settings);
    world.Run(0.5);
    // What holds it up: m (g - a).
    const double acceleration = 2 * kGravity / (2 + 0.008 * 400);
    EXPECT_NEAR(JointsOf(world).GetForce(joint).y(), 2 * (kGravity - acceleration), 0.01);
}

}  // namespace
}  // namespace fulcrum::testing
