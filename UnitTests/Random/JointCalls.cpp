#include <Fulcrum/UnitTests/Random/Calls.h>

namespace fulcrum::testing {

namespace {

SpringSettings RandomSpring(Values& values) {
    SpringSettings spring;
    spring.mode = values.One<SpringMode>(2);
    if (values.Chance(0.5f)) {
        spring.frequency = values.Setting(0.5f, 20);
        spring.dampingRatio = values.Setting(0, 1);
        spring.stiffness = values.Setting(0, 1e4f);
        spring.damping = values.Setting(0, 1e3f);
    }
    spring.form = values.One<SpringForm>(3);
    return spring;
}

JointLimits RandomLimits(Values& values) {
    JointLimits limits;
    limits.min = values.Setting(-1, 0);
    limits.max = values.Chance(0.4f) ? -limits.min : values.Setting(0, 1);
    if (values.Chance(0.3f)) limits.spring = RandomSpring(values);
    return limits;
}

JointMotor RandomMotor(Values& values) {
    JointMotor motor;
    motor.mode = values.One<MotorMode>(3);
    motor.targetSpeed = values.Setting(-5, 5);
    motor.targetPosition = values.Setting(-1, 1);
    if (values.Chance(0.5f)) motor.spring = RandomSpring(values);
    if (values.Chance(0.5f)) motor.minForce = values.Setting(-1000, 0), motor.maxForce = values.Setting(0, 1000);
    return motor;
}

AxisControl RandomControl(Values& values) {
    AxisControl control;
    control.limited = values.Chance(0.5f);
    control.limits = RandomLimits(values);
    if (values.Chance(0.4f)) control.motor = RandomMotor(values);
    if (values.Chance(0.3f)) control.friction = values.Setting(0, 100);
    return control;
}

JointAnchor RandomAnchor(Values& values, bool inBody) {
    JointAnchor anchor;
    anchor.point = inBody ? Position(values.Offset(0.5f).cast<double>()) : values.Place(2);
    anchor.axis = values.IsOdd() ? values.Offset(1) : values.Random().Direction();
    if (values.IsOdd()) anchor.normal = values.Offset(1);
    return anchor;
}

MassOverride RandomMassOverride(Values& values) {
    MassOverride o;
    for (float* scale : {&o.inverseMassScaleA, &o.inverseInertiaScaleA, &o.inverseMassScaleB, &o.inverseInertiaScaleB})
        if (values.Chance(0.5f)) *scale = values.Chance(0.2f) ? 0.0f : values.Setting(0, 2);
    return o;
}

void FillCommon(JointSettings& settings, const Twin& twin, Values& values, const CallTargets& targets) {
    settings.bodyA = twin.bodies[targets.bodyA];
    settings.bodyB = twin.bodies[targets.bodyB];
    if (values.Chance(0.15f)) settings.bodyA = kWorldBody;
    const bool inBody = values.Chance(0.5f);
    settings.space = inBody ? JointSpace::Body : JointSpace::World;
    if (values.IsOdd()) settings.space = values.One<JointSpace>(2);
    settings.anchorA = RandomAnchor(values, inBody);
    if (inBody || values.Chance(0.2f)) settings.anchorB = RandomAnchor(values, inBody);
    settings.enabled = values.Chance(0.9f);
    settings.collideConnected = values.Chance(0.3f);
    if (values.Chance(0.2f)) settings.priority = values.One<JointPriority>(2);
    if (values.Chance(0.1f)) settings.breakForce = values.Setting(10, 1e5f);
    if (values.Chance(0.1f)) settings.breakTorque = values.Setting(10, 1e5f);
    if (values.Chance(0.1f)) settings.substeps = static_cast<int>(values.Below(20));
    if (values.Chance(0.1f)) settings.velocityIterations = static_cast<int>(values.Below(10));
    if (values.Chance(0.1f)) settings.massOverride = RandomMassOverride(values);
    if (settings.bodyA.index % 8 == 3) settings.errorTarget = 0.002f;
}

void FillKind(PointJointSettings&, Values&) {}
void FillKind(FixedJointSettings&, Values&) {}
void FillKind(DistanceJointSettings& settings, Values& values) {
    if (values.Chance(0.5f)) settings.minDistance = values.Setting(0, 1);
    if (values.Chance(0.5f)) settings.maxDistance = values.Setting(1, 3);
    if (values.Chance(0.5f)) settings.spring = RandomSpring(values);
}
void FillKind(HingeJointSettings& settings, Values& values) { settings.angle = RandomControl(values); }
void FillKind(SliderJointSettings& settings, Values& values) { settings.slide = RandomControl(values); }
void FillKind(ConeJointSettings& settings, Values& values) {
    settings.halfAngle = values.Setting(0, 3);
    if (values.Chance(0.3f)) settings.spring = RandomSpring(values);
}
void FillKind(SwingTwistJointSettings& settings, Values& values) {
    settings.shape = values.One<SwingShape>(2);
    settings.twist = RandomControl(values);
    settings.swingY = RandomControl(values);
    settings.swingZ = RandomControl(values);
    if (settings.shape == SwingShape::Ellipse) {
        settings.swingY.limits.max = -settings.swingY.limits.min;
        settings.swingZ.limits.max = -settings.swingZ.limits.min;
    }
}
void FillKind(SixDofJointSettings& settings, Values& values) {
    for (AxisControl& axis : settings.axes) axis = values.Chance(0.4f) ? kLockedAxis : RandomControl(values);
    settings.shape = values.One<SwingShape>(2);
}
void FillKind(GearJointSettings& settings, Values& values) { settings.ratio = values.Setting(-3, 3); }
void FillKind(RackAndPinionJointSettings& settings, Values& values) { settings.ratio = values.Setting(-3, 3); }
void FillKind(PulleyJointSettings& settings, Values& values) {
    settings.fixedPointA = values.Place(4);
    settings.fixedPointB = values.Place(4);
    settings.ratio = values.Setting(0.2f, 4);
    settings.minLength = values.Setting(0, 1);
    if (values.Chance(0.5f)) settings.maxLength = values.Setting(1, 6);
}
void FillKind(PathJointSettings& settings, Values& values) {
    if (values.Chance(0.7f)) {
        std::vector<Vector3> places;
        for (uint32_t i = 0; i < 4; ++i) places.push_back(values.Offset(2));
        const Vector3 normal(0, 1, 0);
        Result<std::shared_ptr<const Path>> path = Path::CatmullRom(places, {&normal, 1}, values.Chance(0.5f));
        if (path) settings.path = path.Value();
    } else if (values.IsOdd()) {
        settings.path = nullptr;
    }
    settings.along = RandomControl(values);
    settings.rotation = values.One<PathRotation>(4);
}
void FillKind(WheelJointSettings& settings, Values& values) {
    settings.anchorA.axis = Vector3(0, 0, 1);
    settings.anchorA.normal = Vector3(0, 1, 0);
    if (values.Chance(0.5f)) settings.suspension.limits = RandomLimits(values);
    settings.isSteered = values.Chance(0.5f);
    if (values.Chance(0.5f)) settings.steering = RandomControl(values);
    settings.spin = RandomControl(values);
}

void FillKind(CustomJointSettings&, Values&) {}

template <class Settings>
constexpr float kWeight = 1;
template <>
constexpr float kWeight<ConeJointSettings> = 0.5f;
template <>
constexpr float kWeight<GearJointSettings> = 0.5f;
template <>
constexpr float kWeight<RackAndPinionJointSettings> = 0.5f;
template <>
constexpr float kWeight<PulleyJointSettings> = 0.5f;
template <>
constexpr float kWeight<PathJointSettings> = 0.5f;
template <>
constexpr float kWeight<CustomJointSettings> = 0;  // what a user's class does is not in question

template <class Settings>
void Create(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    Settings settings;
    FillCommon(settings, twin, values, targets);
    FillKind(settings, values);
    const Result<JointId> id = twin.system->Joints().Create(settings);
    if (!Note(id, outcome)) return;
    outcome.answer.Add(id.Value());
    twin.joints[targets.joint] = id.Value();
}

void CreateTarget(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    TargetJointSettings settings;
    settings.body = twin.bodies[targets.bodyA];
    settings.anchor = values.Place(2);
    settings.target = values.Place(3);
    if (values.Chance(0.5f)) settings.spring = RandomSpring(values);
    if (values.Chance(0.5f)) settings.maxForce = values.Setting(0, 1e4f);
    const Result<JointId> id = twin.system->Joints().CreateTarget(settings);
    if (Note(id, outcome)) twin.joints[targets.joint] = id.Value();
}

// Statements, the last of which returns what the call returned.
#define FULCRUM_JOINT_CALL(name, ...)                                                                      \
    void name(Twin& twin, [[maybe_unused]] Values& values, const CallTargets& targets, Outcome& outcome) { \
        JointInterface& joints = twin.system->Joints();                                                    \
        const JointId id = twin.joints[targets.joint];                                                     \
        Note([&] { __VA_ARGS__; }(), outcome);                                                             \
    }

FULCRUM_JOINT_CALL(RemoveJoint, return joints.Remove(id))
FULCRUM_JOINT_CALL(SetEnabled, return joints.SetEnabled(id, values.Chance(0.6f)))
FULCRUM_JOINT_CALL(SetLimits, std::optional<JointLimits> limits;
                   if (!values.Chance(0.3f)) limits = RandomLimits(values);
                   return joints.SetLimits(id, values.One<JointAxis>(6), limits))
FULCRUM_JOINT_CALL(SetMotor, const JointMotor motor = RandomMotor(values);
                   return joints.SetMotor(id, values.One<JointAxis>(6), motor))
FULCRUM_JOINT_CALL(SetFriction, const float most = values.Setting(0, 100);
                   return joints.SetFriction(id, values.One<JointAxis>(6), most))
FULCRUM_JOINT_CALL(SetTargetOrientation, return joints.SetTargetOrientation(id, values.Rotation()))
FULCRUM_JOINT_CALL(SetEffort, return joints.SetEffort(id, {static_cast<int>(values.Below(70)),
                                                           static_cast<int>(values.Below(5)), 1}))

FULCRUM_JOINT_CALL(SetTarget, return joints.SetTarget(id, values.Place(3)))
FULCRUM_JOINT_CALL(SetMassOverride, return joints.SetMassOverride(id, RandomMassOverride(values)))

#undef FULCRUM_JOINT_CALL

constexpr CallKind kCalls[] = {
#define FULCRUM_CREATE(kind) {"Create" #kind "Joint", kWeight<kind##JointSettings>, Create<kind##JointSettings>},
    FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_CREATE)
#undef FULCRUM_CREATE
        {"RemoveJoint", 0.5f, RemoveJoint},
    {"SetEnabled", 0.5f, SetEnabled},
    {"SetLimits", 1, SetLimits},
    {"SetMotor", 1, SetMotor},
    {"SetFriction", 0.5f, SetFriction},
    {"SetTargetOrientation", 0.5f, SetTargetOrientation},
    {"SetEffort", 0.5f, SetEffort},
    {"SetMassOverride", 0.5f, SetMassOverride},
    {"CreateTarget", 1, CreateTarget},
    {"SetTarget", 2, SetTarget},
};

}  // namespace

std::span<const CallKind> JointCalls() { return kCalls; }

}  // namespace fulcrum::testing
