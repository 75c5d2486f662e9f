// The errors of joints: of every kind, axis and motor what is apart from what it should be, in m or rad, the same on
// demand and in the report of the next step. Bodies are put where an error is known in closed form.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <functional>
#include <string>

namespace fulcrum::testing {
namespace {

// Rounding of positions of about a meter and of sines in floats.
constexpr double kRounding = 2e-6;

constexpr SpringSettings kHard = {};

// A hook at the origin, A, and a weightless box there, B, which joints hold.
struct Held {
    TestWorld world{Weightless()};
    BodyId hook = AddHook(world);
    BodyId box = world.Add({.shape = BoxOf(0.2f, 0.1f, 0.3f)});

    JointSettings Between() { return UprightBetween(hook, box, {0, 0, 0}); }
    void Put(const Position& position, const Quaternion& rotation = {}) {
        ASSERT_TRUE(world.Bodies().SetPose(box, position, rotation));
    }
    void ExpectError(JointId joint, double distance, double angle, double tolerance = kRounding) {
        const uint64_t before = world.System().HashState();
        const JointError error = JointsOf(world).GetError(joint);
        EXPECT_NEAR(error.distance, distance, tolerance);
        EXPECT_NEAR(error.angle, angle, tolerance);
        EXPECT_EQ(world.System().HashState(), before) << "reading changes nothing";
        world.Step();
        EXPECT_NEAR(world.Report().largestJointError, error.distance, kRounding);
        EXPECT_NEAR(world.Report().largestJointAngle, error.angle, kRounding);
        EXPECT_TRUE(distance == 0 || world.Report().worstJoint == joint);
        EXPECT_TRUE(angle == 0 || world.Report().mostTurnedJoint == joint);
    }
};

Quaternion About(const Vector3& axis, double angle) { return RotationAbout(axis, angle); }

// One case of each kind. A kind without one does not compile.
void Put(Held& held, const PointJointSettings*) {
    const JointId joint = Join(held.world, PointJointSettings{held.Between()});
    held.Put({0.3, 0.4, 0}, About({0, 1, 0}, 1));
    held.ExpectError(joint, 0.5, 0);
}
void Put(Held& held, const FixedJointSettings*) {
    const JointId joint = Join(held.world, FixedJointSettings{held.Between()});
    held.Put({0, 0, -0.2}, About({0, 0, 1}, 0.3));
    held.ExpectError(joint, 0.2, 0.3);
}
void Put(Held& held, const DistanceJointSettings*) {
    const JointId joint = Join(held.world, DistanceJointSettings{held.Between(), 0.5f, 1.0f});
    held.Put({0, -0.75, 0});
    held.ExpectError(joint, 0, 0);
    held.Put({0, -1.25, 0});
    held.ExpectError(joint, 0.25, 0);
    held.Put({0.2, 0, 0});
    held.ExpectError(joint, 0.3, 0);
}
void Put(Held& held, const HingeJointSettings*) {
    const JointId joint = Join(held.world, HingeJointSettings{held.Between(), Limited(-0.5, 0.4)});
    held.Put({0, 0, 0}, About({1, 0, 0}, 0.3));
    held.ExpectError(joint, 0, 0);
    held.Put({0, 0, 0}, About({1, 0, 0}, 0.55));
    held.ExpectError(joint, 0, 0.15);
    held.Put({0, 0, 0}, About({1, 0, 0}, -0.7));
    held.ExpectError(joint, 0, 0.2);
}
void Put(Held& held, const SliderJointSettings*) {
    const JointId joint = Join(held.world, SliderJointSettings{held.Between(), Limited(-0.1, 0.3)});
    held.Put({0.5, 0, 0});
    held.ExpectError(joint, 0.2, 0);
    // The lock's error is the larger one.
    held.Put({-0.2, 0.15, 0});
    held.ExpectError(joint, 0.15, 0);
}
void Put(Held& held, const ConeJointSettings*) {
    ConeJointSettings cone{held.Between()};
    cone.halfAngle = 0.4f;
    const JointId joint = Join(held.world, cone);
    held.Put({0, 0, 0}, About({0, 0, 1}, 0.65));
    held.ExpectError(joint, 0, 0.25);
}
void Put(Held& held, const SwingTwistJointSettings*) {
    SwingTwistJointSettings shoulder{held.Between()};
    shoulder.twist = Limited(-0.2, 0.3);
    shoulder.swingY = shoulder.swingZ = Limited(-0.4, 0.4);
    const JointId joint = Join(held.world, shoulder);
    held.Put({0, 0, 0}, About({0, 0.6f, 0.8f}, 0.5));
    held.ExpectError(joint, 0, 0.1);
    held.Put({0, 0, 0}, About({1, 0, 0}, -0.45));
    held.ExpectError(joint, 0, 0.25);
}
void Put(Held& held, const SixDofJointSettings*) {
    SixDofJointSettings six{held.Between()};
    six[JointAxis::LinearX] = Limited(-0.1, 0.1);
    six[JointAxis::LinearY] = kLockedAxis;
    six[JointAxis::AngularX] = Limited(-0.2, 0.2);
    const JointId joint = Join(held.world, six);
    // The largest of each unit.
    held.Put({0.3, 0.05, 7}, About({1, 0, 0}, 0.5));
    held.ExpectError(joint, 0.2, 0.3);
    held.Put({0.12, 0.05, 7}, About({0, 1, 0}, 0.5));
    held.ExpectError(joint, 0.05, 0);
}
void Put(Held& held, const GearJointSettings*) {
    const JointId joint = Join(held.world, GearJointSettings{held.Between(), 2.0f});
    held.Put({0, 0, 0}, About({1, 0, 0}, 0.15));
    held.ExpectError(joint, 0, 2 * 0.15);
}
void Put(Held& held, const RackAndPinionJointSettings*) {
    const JointId joint = Join(held.world, RackAndPinionJointSettings{held.Between(), 5.0f});
    held.Put({0.06, 0, 0});
    held.ExpectError(joint, 0, 5 * 0.06);
}
void Put(Held& held, const PulleyJointSettings*) {
    // The hook's side is 1 m long, the other's 2 m and counts twice.
    PulleyJointSettings pulley{held.Between()};
    pulley.fixedPointA = {0, 1, 0};
    pulley.fixedPointB = {0, 2, 0};
    pulley.ratio = 2;
    const JointId joint = Join(held.world, pulley);
    held.Put({0, -0.1, 0});
    held.ExpectError(joint, 0.2, 0);
    held.Put({0, 0.1, 0});
    held.ExpectError(joint, 0, 0);  // slack
}
void Put(Held& held, const PathJointSettings*) {
    PathJointSettings path{held.Between()};
    path.path = Path::Straight(2);
    path.rotation = PathRotation::TangentAndNormal;
    const JointId joint = Join(held.world, path);
    // Beside it, along two axes.
    held.Put({0.5, 0.03, -0.04});
    held.ExpectError(joint, 0.05, 0);
    // Beyond its end, and turned.
    held.Put({1.2, 0, 0}, About({0, 0.6f, -0.8f}, 0.25));
    held.ExpectError(joint, 0.2, 0.25);
}
void Put(Held& held, const WheelJointSettings*) {
    auto wheel = Of<WheelJointSettings>(held.Between());
    wheel.isSteered = true;
    wheel.steering.motor = {};
    const JointId joint = Join(held.world, wheel);
    held.Put({0, 0.25, 0}, About({0, 1, 0}, -0.75));
    held.ExpectError(joint, 0.05, 0.15);
    // Its axle is tilted; spring and spin have no error.
    held.Put({0, 0.1, 0}, About({0, 0, 1}, 0.2) * About({1, 0, 0}, 2));
    held.ExpectError(joint, 0, 0.2);
}

// Keeps B at a height above A, by a row of the user's.
class AtHeight final : public JointType {
public:
    uint32_t MaxRows() const override { return 1; }
    void CollectRows(const JointPose& pose, JointRowList& rows) override {
        ++calls_[0];
        JointRow& row = rows.Add(0, JointRow::Kind::Equal);
        pose.SetAlong(row, {0, 1, 0});
        row.error = pose.offset.y() - 0.5f;
    }
    std::span<double> State() override { return calls_; }

private:
    std::array<double, 1> calls_{};
};

void Put(Held& held, const CustomJointSettings*) {
    auto custom = Of<CustomJointSettings>(held.Between());
    custom.make = [] { return std::make_unique<AtHeight>(); };
    const JointId joint = Join(held.world, custom);
    held.Put({3, 0.7, 0});
    held.ExpectError(joint, 0.2, 0);
}

TEST(ErrorOfAJoint, OfEveryKindAreWhatItIsApart){
#define FULCRUM_PUT(name)                                      \
    {                                                          \
        SCOPED_TRACE(#name);                                   \
        Held held;                                             \
        Put(held, static_cast<name##JointSettings*>(nullptr)); \
    }
    FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_PUT)
#undef FULCRUM_PUT
}

TEST(ErrorOfAJoint, OfEachAxisAreBeyondItsLimits) {
    for (int axis = 0; axis < 6; ++axis)
        for (const double side : {-1.0, 1.0}) {
            SCOPED_TRACE(axis);
            Held held;
            SixDofJointSettings six{held.Between()};
            six.axes[static_cast<size_t>(axis)] = Limited(-0.3, 0.3);
            const JointId joint = Join(held.world, six);
            Vector3 way = Vector3::Zero();
            way[axis % 3] = 1;
            if (axis < 3) held.Put((way * static_cast<float>(0.4 * side)).cast<double>());
            else held.Put({0, 0, 0}, About(way, 0.4 * side));
            held.ExpectError(joint, axis < 3 ? 0.1 : 0, axis < 3 ? 0 : 0.1);
        }
}

TEST(ErrorOfAJoint, OfALockAwayFromZeroAreWhatIsMissing) {
    for (int axis = 0; axis < 6; ++axis) {
        SCOPED_TRACE(axis);
        Held held;
        SixDofJointSettings six{held.Between()};
        six.axes[static_cast<size_t>(axis)] = Limited(axis < 4 ? 0.2 : 0, axis < 4 ? 0.2 : 0);
        if (axis >= 4) six.axes[static_cast<size_t>(axis)].limits = {0, 0, {}};
        const JointId joint = Join(held.world, six);
        Vector3 way = Vector3::Zero();
        way[axis % 3] = 1;
        if (axis < 3) held.Put((way * 0.5f).cast<double>());
        else held.Put({0, 0, 0}, About(way, 0.5));
        const double error = axis < 4 ? 0.3 : 0.5;
        held.ExpectError(joint, axis < 3 ? error : 0, axis < 3 ? 0 : error);
    }
}

// Springs and soft limits yield, motors to a speed and friction hold no place.
TEST(ErrorOfAJoint, OfWhatIsSoftAreNone) {
    const std::vector<std::function<void(AxisControl&)>> soft = {
        [](AxisControl& x) { x = Limited(-0.1, 0.1, FrequencySpring(2, 1)); },
        [](AxisControl& x) { x = Limited(0.1, 0.1, StiffnessSpring(100, 1)); },
        [](AxisControl& x) { x.motor = PositionMotor(0.1, FrequencySpring(5, 1)); },
        [](AxisControl& x) { x.motor = SpeedMotor(1); },
        [](AxisControl& x) { x.friction = 100; },
    };
    for (size_t i = 0; i < soft.size(); ++i)
        for (const int axis : {0, 3}) {
            SCOPED_TRACE(i);
            Held held;
            SixDofJointSettings six{held.Between()};
            soft[i](six.axes[static_cast<size_t>(axis)]);
            const JointId joint = Join(held.world, six);
            held.Put({0.5, 0, 0}, About({1, 0, 0}, 0.5));
            held.ExpectError(joint, 0, 0);
        }
}

TEST(ErrorOfAJoint, OfAHardMotorAreTheWayToItsPosition) {
    for (int axis = 0; axis < 6; ++axis) {
        SCOPED_TRACE(axis);
        Held held;
        SixDofJointSettings six{held.Between()};
        six.axes[static_cast<size_t>(axis)].motor = PositionMotor(0.4, kHard);
        const JointId joint = Join(held.world, six);
        held.ExpectError(joint, axis < 3 ? 0.4 : 0, axis < 3 ? 0 : 0.4);
        held.world.Run(2);
        held.ExpectError(joint, 0, 0, 1e-3);
    }
}

// A motor that is to hold a weight of m g = 19.62 N at 0.5 m. With less force than that it is at its limit, which is no
// error; with more, what is missing is one.
TEST(ErrorOfAJoint, OfAMotorAtItsForceLimitAreNone) {
    for (const double force : {15.0, 40.0}) {
        SCOPED_TRACE(force);
        TestWorld world(NoSleep());
        const BodyId box = world.Add({.shape = CubeOf(0.1f), .mass = 2});
        SliderJointSettings slider{Between(AddHook(world), box, {0, 0, 0}, {0, 1, 0}), Limited(0, 1)};
        slider.slide.motor = PositionMotor(0.5, kHard);
        slider.slide.motor.minForce = static_cast<float>(-force);
        slider.slide.motor.maxForce = static_cast<float>(force);
        const JointId joint = Join(world, slider);
        const auto missing = [&] { return 0.5 - JointsOf(world).GetCoordinate(joint, JointAxis::LinearX); };
        for (int i = 0; i < 120; ++i) {
            const double before = missing();
            world.Step();
            const double pull = std::fabs(JointsOf(world).GetAxisForces(joint, JointAxis::LinearX).motor);
            // Of the steps in which it is at its limit for a while only, either.
            if (pull > 0.999 * force) {
                ASSERT_NEAR(world.Report().largestJointError, 0, kRounding) << i;
                ASSERT_NEAR(JointsOf(world).GetError(joint).distance, 0, kRounding) << i;
            } else if (world.Report().largestJointError > 0) {
                ASSERT_NEAR(world.Report().largestJointError, before, kRounding) << i;
                ASSERT_NEAR(JointsOf(world).GetError(joint).distance, missing(), kRounding) << i;
            }
            if (force < 2 * kGravity) {
                ASSERT_GT(pull, 0.999 * force) << i;
            }
        }
        // With (40 - 2 g) / 2 m/s2 the way of half a meter takes a third of a second.
        if (force > 2 * kGravity) {
            EXPECT_NEAR(missing(), 0, 1e-4);
        }
    }
}

// Gears count the revolutions that they are out of phase by.
TEST(ErrorOfAJoint, AreReadAsOftenAsOneLikes) {
    Held held;
    const JointId joint = Join(held.world, GearJointSettings{held.Between(), 2.0f});
    for (int i = 0; i < 10; ++i) {
        ASSERT_TRUE(held.world.Bodies().SetVelocity(held.box, {0, 0, 0}, {9, 0, 0}));
        held.world.Step();
    }
    const JointError error = JointsOf(held.world).GetError(joint);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(JointsOf(held.world).GetError(joint).angle, error.angle);
}

}  // namespace
}  // namespace fulcrum::testing
