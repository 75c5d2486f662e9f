// The bodies and joints of the scene.
#include <Fulcrum/UnitTests/Support/JointScene.h>

#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

namespace fulcrum::testing {

namespace {

template <class Settings>
Settings BetweenTwo(BodyId a, BodyId b, const Position& pointA, const Position& pointB,
                    const Vector3& axis = Vector3(1, 0, 0)) {
    auto settings = Of<Settings>(Between(a, b, pointA, axis));
    settings.anchorB = AnchorAt(pointB, axis);
    return settings;
}

// A body of a mechanism; these do not collide with each other.
BodyId AddPart(TestWorld& world, const ShapePtr& shape, const Position& place, float mass = 0) {
    return world.Add({.shape = shape, .position = place, .mass = mass, .layer = 1});
}

// A row of a user's own: a screw.
class Screw final : public JointType {
public:
    JointLocks Locks() const override { return {LinearLock::Line, AngularLock::Axis, 0, 0}; }
    uint32_t MaxRows() const override { return 1; }
    void CollectRows(const JointPose& pose, JointRowList& rows) override {
        const Vector3 axis = ToMatrix(pose.frameA).x;
        JointRow& row = rows.Add(0, JointRow::Kind::Speed);
        pose.SetAlong(row, axis * 5.0f);
        row.jacobian.a.angular += axis;
        row.jacobian.b.angular += axis;
    }
};

}  // namespace

std::unique_ptr<JointType> MakeScrew() { return std::make_unique<Screw>(); }

// A rope on a kinematic swing, and a chain of 1 kg links with 100 kg at its end.
void JointScene::AddChains() {
    swing_ = world_.Add({.shape = BoxOf(0.3f, 0.1f, 0.3f), .motion = MotionType::Kinematic, .position = {0, 8, 0}});
    BodyId last = swing_;
    for (int i = 0; i < 6; ++i) {
        const BodyId link =
            world_.Add({.shape = CapsuleOf(0.2f, 0.08f), .position = {0.1 * i, 7.6 - 0.5 * i, 0.03 * i}});
        const JointId joint =
            Join(world_, Of<PointJointSettings>(Between(last, link, {0.1 * i, 7.85 - 0.5 * i, 0.03 * i})));
        if (i == 4) removed_ = joint;
        if (i == 2) removedBody_ = link;
        last = link;
    }
    last = AddHook(world_, {4, 9, 0.01});
    for (int i = 0; i <= 6; ++i) {
        const BodyId link = AddPart(world_, i == 6 ? SphereOf(0.4f) : BoxOf(0.23f, 0.05f, 0.05f),
                                    {4.25 + 0.5 * i, 9, 0}, i == 6 ? 100.0f : 1.0f);
        Join(world_, Of<PointJointSettings>(Between(last, link, {4 + 0.5 * i, 9, 0.01})));
        last = link;
    }
}

// Pendulums that keep to a plane, where much is exactly zero; those with and without rows are solved side by side.
void JointScene::AddPlane() {
    for (int i = 0; i < 8; ++i) {
        const double x = -3.0 * i;
        const BodyId hook = AddHook(world_, {x, 6, 12});
        const BodyId arm = AddPart(world_, BoxOf(0.5f, 0.1f, 0.1f), {x + 0.5, 6, 12}),
                     tip = AddPart(world_, SphereOf(0.2f), {x + 1.2, 6, 12});
        auto hinge = Of<HingeJointSettings>(Between(hook, arm, {x, 6, 12}, {0, 0, 1}));
        if (i % 4 == 1) hinge.angle = Limited(-0.5, 0.4);
        if (i % 4 == 2) hinge.angle.motor = SpeedMotor(3, 200);
        if (i % 4 == 3) hinge.angle.friction = 8;
        const JointId joint = Join(world_, hinge);
        if (i == 2) driven_ = joint;
        if (i == 6) switched_ = joint;
        Join(world_, Of<PointJointSettings>(Between(arm, tip, {x + 1, 6, 12})));
    }
}

void JointScene::AddSprings() {
    const BodyId hook = AddHook(world_, {-6, 8, 0});
    for (int i = 0; i < 4; ++i) {
        const Position place(-6 + 0.7 * i, 6.5, 0.4 * i);
        auto distance = BetweenTwo<DistanceJointSettings>(hook, AddPart(world_, CubeOf(0.2f), place), {-6, 8, 0},
                                                          place + Position(0.2, 0.2, 0));
        if (i == 1) distance.maxDistance = 1.2f;
        if (i == 2) distance.minDistance = 1.0f, distance.maxDistance = 1.5f, distance.spring = FrequencySpring(3, 0.1);
        if (i == 3) distance.spring = StiffnessSpring(800, 5);
        Join(world_, distance);
    }
    auto slider = Of<SliderJointSettings>(
        Between(hook, AddPart(world_, CubeOf(0.25f), {-6, 5, 2}), {-6, 5, 2}, Normalized(Vector3(1, -1, 0.2f))));
    slider.slide = Limited(-0.5, 0.6, FrequencySpring(4, 0.3));
    slider.slide.friction = 5;
    Join(world_, slider);
    auto piston =
        Of<SliderJointSettings>(Between(hook, AddPart(world_, CubeOf(0.25f), {-6, 5, 4}), {-6, 5, 4}, {0, 1, 0}));
    piston.slide = Limited(-0.8, 0.8);
    piston.slide.motor = SpeedMotor(-1.5, 4000);
    gate_ = Join(world_, piston);
    auto screw = Of<CustomJointSettings>(
        Between(hook, AddPart(world_, BoxOf(0.3f, 0.1f, 0.2f), {-6, 5, 6}), {-6, 5, 6}, {0, 1, 0}));
    screw.make = MakeScrew;
    Join(world_, screw);
}

void JointScene::AddShoulders() {
    for (int i = 0; i < 6; ++i) {
        const Position place(-12, 6, 1.5 * i);
        const BodyId hook = AddHook(world_, place),
                     arm = AddPart(world_, BoxOf(0.6f, 0.1f, 0.15f), place + Position(0.6, 0, 0));
        if (i < 2) {
            auto cone = Of<ConeJointSettings>(Between(hook, arm, place, {0.6f, -0.8f, 0}));
            cone.halfAngle = 0.5f;
            if (i == 1) cone.spring = FrequencySpring(3, 0.4);
            Join(world_, cone);
            continue;
        }
        if (i < 4) {
            auto ball = Of<SwingTwistJointSettings>(UprightBetween(hook, arm, place));
            ball.shape = i == 2 ? SwingShape::Ellipse : SwingShape::Pyramid;
            ball.twist = Limited(-0.4, 0.3);
            ball.swingY = Limited(-0.6, 0.6);
            ball.swingZ = Limited(-0.9, 0.9);
            ball.twist.friction = 1;
            if (i == 3)
                ball.twist.motor = ball.swingY.motor = ball.swingZ.motor = PositionMotor(0.2, FrequencySpring(2, 0.5));
            const JointId joint = Join(world_, ball);
            if (i == 3) shoulder_ = joint;
            continue;
        }
        auto six = Of<SixDofJointSettings>(UprightBetween(hook, arm, place));
        six[JointAxis::LinearX] = i == 4 ? kLockedAxis : Limited(-0.1, 0.2);
        six[JointAxis::LinearY] = i == 4 ? kLockedAxis : Limited(0, 0, FrequencySpring(3, 0.2));
        six[JointAxis::LinearZ] = kLockedAxis;
        six[JointAxis::AngularX].motor = SpeedMotor(4, 30);
        six[JointAxis::AngularY] = kLockedAxis;
        six[JointAxis::AngularZ] = Limited(-0.7, 0.7);
        six[JointAxis::AngularZ].friction = 3;
        Join(world_, six);
    }
}

void JointScene::AddGears() {
    const BodyId frame = AddHook(world_, {8, 5, 6});
    const BodyId first = AddPart(world_, CapsuleOf(0.1f, 0.4f), {8, 5, 6}),
                 second = AddPart(world_, CapsuleOf(0.1f, 0.7f), {9.2, 5, 6});
    const BodyId rack = AddPart(world_, BoxOf(1.5f, 0.1f, 0.1f), {9.2, 4.2, 6});
    auto bearing = Of<HingeJointSettings>(Between(frame, first, {8, 5, 6}, {0, 0, 1}));
    bearing.angle.motor = SpeedMotor(5, 2000);
    wheel_ = Join(world_, bearing);
    Join(world_, Of<HingeJointSettings>(Between(frame, second, {9.2, 5, 6}, {0, 0, 1})));
    auto gear = BetweenTwo<GearJointSettings>(first, second, {8, 5, 6}, {9.2, 5, 6}, {0, 0, 1});
    gear.ratio = 1.75f;
    Join(world_, gear);
    auto guide = Of<SliderJointSettings>(Between(frame, rack, {9.2, 4.2, 6}));
    guide.slide = Limited(-1.2, 1.2);
    Join(world_, guide);
    auto teeth = BetweenTwo<RackAndPinionJointSettings>(second, rack, {9.2, 5, 6}, {9.2, 4.2, 6}, {0, 0, 1});
    teeth.anchorB->axis = Vector3(1, 0, 0);
    teeth.ratio = 1.25f;
    Join(world_, teeth);
}

void JointScene::AddPathsAndRopes() {
    std::vector<Vector3> places;
    for (int i = 0; i < 8; ++i) {
        const double angle = 2 * kPi * i / 8;
        places.push_back(Position(3 * Cos(angle), 0.5 * Sin(2 * angle), 2 * Sin(angle)).cast<float>());
    }
    const Vector3 up(0, 1, 0);
    const std::shared_ptr<const Path> track = Path::CatmullRom(places, {&up, 1}, true).Value();
    const BodyId hook = AddHook(world_, {16, 5, 0});
    const PathRotation rotations[] = {PathRotation::Free, PathRotation::Tangent, PathRotation::TangentAndNormal,
                                      PathRotation::Constant};
    for (int i = 0; i < 4; ++i) {
        const PathSample at = track->Sample(2.0 * i + 0.3);
        const Position place = Position(16, 5, 0) + at.position.cast<double>();
        auto settings =
            BetweenTwo<PathJointSettings>(hook, AddPart(world_, BoxOf(0.3f, 0.1f, 0.2f), place), {16, 5, 0}, place);
        settings.anchorA.normal = up;
        settings.anchorB->axis = at.tangent;
        settings.anchorB->normal = at.normal;
        settings.path = track;
        settings.rotation = rotations[i];
        if (i > 1) settings.along.motor = SpeedMotor(3, 500);
        if (i == 1) settings.along.friction = 20;
        Join(world_, settings);
    }
    const BodyId light = AddPart(world_, SphereOf(0.3f), {12, 2, -4}, 10),
                 heavy = AddPart(world_, CubeOf(0.3f), {14, 4, -4}, 25);
    auto pulley = BetweenTwo<PulleyJointSettings>(light, heavy, {12, 2.3, -4}, {14, 4.3, -4.1});
    pulley.fixedPointA = {12, 7, -4};
    pulley.fixedPointB = {14, 7, -4};
    pulley.ratio = 0.5f;
    winch_ = Join(world_, pulley);
}

void JointScene::AddCar() {
    const BodyId chassis = world_.Add({.shape = BoxOf(1.2f, 0.2f, 0.6f), .position = {-4, 0.8, -8}, .mass = 300});
    for (int i = 0; i < 4; ++i) {
        const Position axle(-4 + (i < 2 ? 1.0 : -1.0), 0.35, -8 + (i % 2 ? 0.8 : -0.8));
        const BodyId body = world_.Add({.shape = SphereOf(0.35f), .position = axle, .mass = 15});
        auto wheel = Of<WheelJointSettings>(Between(chassis, body, axle, {0, 0, -1}));
        wheel.anchorA.normal = Vector3(0, 1, 0);
        wheel.isSteered = i < 2;
        wheel.steering.motor = PositionMotor(0.2, FrequencySpring(6, 1));
        if (i >= 2) wheel.spin.motor = SpeedMotor(10, 200);
        Join(world_, wheel);
    }
    // A kerb to drive over, and boxes that are fixed to each other, in the way.
    world_.Add({.shape = BoxOf(0.3f, 0.06f, 2), .motion = MotionType::Static, .position = {-1.5, 0.05, -8}});
    const BodyId low = world_.Add({.shape = CubeOf(0.3f), .position = {0.5, 0.3, -8}}),
                 high = world_.Add({.shape = CubeOf(0.3f), .position = {0.6, 0.95, -8.1}});
    Join(world_, Of<FixedJointSettings>(Between(low, high, {0.5, 0.6, -8})));
}

// 20 x 21 balls and 799 joints: a large island.
void JointScene::AddCurtain() {
    const ShapePtr ball = SphereOf(0.15f);
    BodyId above[21], now[21];
    for (int row = 0; row < 20; ++row) {
        for (int i = 0; i < 21; ++i) {
            const bool isHung = row == 0 && i % 5 == 0;
            now[i] = world_.Add({.shape = ball,
                                 .motion = isHung ? MotionType::Static : MotionType::Dynamic,
                                 .position = {20 + 0.4 * i, 9 - 0.4 * row, 8},
                                 .layer = 1});
            if (i > 0)
                Join(world_, Of<PointJointSettings>(Between(now[i - 1], now[i], {19.8 + 0.4 * i, 9 - 0.4 * row, 8})));
            if (row > 0)
                Join(world_, Of<PointJointSettings>(Between(above[i], now[i], {20 + 0.4 * i, 9.2 - 0.4 * row, 8})));
        }
        std::copy(now, now + 21, above);
    }
    world_.Add({.shape = SphereOf(0.5f), .position = {24, 5, 2}, .linearVelocity = {0, 3, 9}, .density = 300});
}

// More springs than colors.
void JointScene::AddHub() {
    hub_ = AddPart(world_, SphereOf(0.5f), {-16, 5, -8}, 50);
    for (int i = 0; i < 68; ++i) {
        const double angle = 2 * kPi * i / 68, height = 5 + 0.3 * (i % 3);
        const Position place(-16 + 1.5 * Cos(angle), height, -8 + 1.5 * Sin(angle));
        auto spring =
            BetweenTwo<DistanceJointSettings>(hub_, AddPart(world_, SphereOf(0.1f), place), {-16, 5, -8}, place);
        if (i % 4) spring.spring = FrequencySpring(4, 0.2);
        Join(world_, spring);
    }
}

// Three hinged boxes that lie on the floor until a ball hits them.
void JointScene::AddSleepers() {
    BodyId last;
    for (int i = 0; i < 3; ++i) {
        const BodyId box = world_.Add({.shape = BoxOf(0.4f, 0.2f, 0.4f), .position = {0.9 * i, 0.2, 20}});
        if (i > 0) Join(world_, Of<HingeJointSettings>(Between(last, box, {0.9 * i - 0.45, 0.2, 20}, {0, 0, 1})));
        last = box;
    }
    sleeper_ = last;
}

// A shelf that a ball tears off.
void JointScene::AddWhatBreaks() {
    const BodyId hook = AddHook(world_, {8, 3, -8}),
                 shelf = world_.Add({.shape = BoxOf(0.6f, 0.05f, 0.4f), .position = {8.7, 3, -8}, .mass = 5});
    auto bracket = Of<FixedJointSettings>(Between(hook, shelf, {8.1, 3, -8}));
    bracket.breakTorque = 150;
    breaking_ = Join(world_, bracket);
    world_.Add({.shape = SphereOf(0.2f), .position = {9.1, 4.5, -8}, .mass = 30});
}

void JointScene::AddRagdolls() {
    const RagdollSettings kinds[] = {Humanoid(), HumanoidWithMotors(300, 20, 200)};
    for (int i = 0; i < 2; ++i) {
        const Pose origin{Position(-20, 1.6 + 0.5 * i, 3.0 * i), RotationAbout({0, 0.6f, 0.8f}, 0.5 + i)};
        EXPECT_TRUE(Ragdoll::Create(world_.System(), kinds[i], origin));
    }
}

}  // namespace fulcrum::testing
