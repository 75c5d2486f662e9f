#include <Fulcrum/UnitTests/Random/Calls.h>
#include <Fulcrum/UnitTests/Random/RandomShapes.h>

#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>

namespace fulcrum::testing {

namespace {

Material RandomMaterial(Values& values) {
    Material material;
    material.friction = values.Setting(0, 1);
    material.restitution = values.Chance(0.5f) ? 0 : values.Setting(0, 1);
    material.frictionRule = values.One<CombineRule>(5);
    material.restitutionRule = values.One<CombineRule>(5);
    return material;
}

BodySettings RandomBody(Values& values) {
    BodySettings settings;
    settings.motion = values.Chance(0.75f) ? MotionType::Dynamic : values.One<MotionType>(3);
    settings.shape = settings.motion == MotionType::Dynamic ? RandomSolid(values) : RandomShape(values);
    settings.position = values.Place(3);
    settings.rotation = values.Rotation();
    settings.linearVelocity = values.Speeds(values.Chance(0.2f) ? 100.0f : 3.0f);
    settings.angularVelocity = values.Speeds(values.Chance(0.2f) ? 50.0f : 3.0f);
    settings.density = values.Chance(0.8f) ? 1000.0f : values.Mass() * 100;
    if (values.Chance(0.2f)) settings.mass = values.Mass();
    if (values.Chance(0.1f)) {
        const float z = values.Mass(), y = values.Mass();
        settings.inertia = Vector3(values.Mass(), y, z);
    }
    settings.material = RandomMaterial(values);
    if (values.Chance(0.2f))
        settings.linearDamping = values.Setting(0, 1), settings.angularDamping = values.Setting(0, 1);
    if (values.Chance(0.1f)) settings.gravityFactor = values.Setting(-1, 2);
    if (values.Chance(0.1f)) settings.lockedAxes = static_cast<LockedAxes>(values.Below(64));
    if (values.Chance(0.1f)) settings.maxLinearSpeed = values.Setting(0.1f, 100);
    if (values.Chance(0.1f)) settings.maxAngularSpeed = values.Setting(0.1f, 100);
    settings.gyroscopicTorque = values.Chance(0.8f);
    settings.allowSleep = values.Chance(0.9f);
    settings.startAsleep = values.Chance(0.1f);
    settings.layer = static_cast<uint8_t>(values.IsOdd() ? 32 + values.Below(200) : values.Below(3));
    if (values.Chance(0.2f)) settings.category = 1u + values.Below(7), settings.mask = values.Below(8);
    settings.userData = values.Below(1000);
    settings.reportsContacts = settings.userData % 4 != 0;
    if (settings.userData % 16 == 3) settings.penetrationTarget = 0.002f;
    if (values.Style().continuous && values.Chance(0.2f)) settings.continuous = values.One<ContinuousCollision>(3);
    if (values.Style().sensors && values.Chance(0.15f)) {
        settings.isSensor = true;
        settings.sensorSees =
            values.IsOdd() ? static_cast<SensorSees>(values.Below(256)) : static_cast<SensorSees>(values.Below(32));
        settings.sensorReportsStay = values.Chance(0.5f);
    }
    return settings;
}

void Create(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const BodySettings settings = RandomBody(values);
    const Result<BodyId> id = twin.system->Bodies().Create(settings);
    if (!Note(id, outcome)) return;
    if (settings.lockedAxes != LockedAxes::None) twin.guided.push_back(id.Value());
    outcome.answer.Add(id.Value());
    twin.bodies[targets.bodyA] = id.Value();
}

void CreateFloor(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    BodySettings settings;
    const Vector3 half(20, 0.5f, 20);
    settings.shape = values.Chance(0.3f) ? ShapePtr(Plane::Create().Value()) : ShapePtr(Box::Create(half).Value());
    settings.motion = MotionType::Static;
    settings.position = Position(0, settings.shape->Type() == ShapeType::Box ? -0.5 : 0, 0);
    const Result<BodyId> id = twin.system->Bodies().Create(settings);
    if (Note(id, outcome)) twin.bodies[targets.bodyA] = id.Value();
}

// Of a body named by the call.
template <class Change>
void Play(Twin& twin, const CallTargets& targets, Outcome& outcome, const Change& change) {
    Note(change(twin.system->Bodies(), twin.bodies[targets.bodyA]), outcome);
}

// Statements, the last of which returns the call's status. Each draws at most one argument: compilers differ in the
// order in which they evaluate the arguments of a call.
#define FULCRUM_BODY_CALL(name, ...)                                                                           \
    void name(Twin& twin, [[maybe_unused]] Values& values, const CallTargets& targets, Outcome& outcome) {     \
        Play(twin, targets, outcome, [&](BodyInterface& bodies, [[maybe_unused]] BodyId id) { __VA_ARGS__; }); \
    }

FULCRUM_BODY_CALL(Remove, return bodies.Remove(id))
FULCRUM_BODY_CALL(SetPose, const Quaternion rotation = values.Rotation();
                  return bodies.SetPose(id, values.Place(3), rotation))
FULCRUM_BODY_CALL(MoveKinematic, const float dt = values.Setting(0.01f, 1);
                  const Quaternion rotation = values.Rotation();
                  return bodies.MoveKinematic(id, values.Place(2), rotation, dt))
FULCRUM_BODY_CALL(SetVelocity, const Vector3 angular = values.Speeds(10);
                  return bodies.SetVelocity(id, values.Speeds(10), angular))
FULCRUM_BODY_CALL(AddForce, return bodies.AddForce(id, values.Forces(3000)))
FULCRUM_BODY_CALL(AddForceAt, const Position point = values.Place(2);
                  return bodies.AddForceAt(id, values.Forces(3000), point))
FULCRUM_BODY_CALL(AddTorque, return bodies.AddTorque(id, values.Forces(500)))
FULCRUM_BODY_CALL(AddImpulse, return bodies.AddImpulse(id, values.Forces(300)))
FULCRUM_BODY_CALL(AddImpulseAt, const Position point = values.Place(2);
                  return bodies.AddImpulseAt(id, values.Forces(100), point))
FULCRUM_BODY_CALL(AddAngularImpulse, return bodies.AddAngularImpulse(id, values.Forces(30)))
FULCRUM_BODY_CALL(SetMaterial, return bodies.SetMaterial(id, RandomMaterial(values)))
FULCRUM_BODY_CALL(SetCategoryAndMask, const uint32_t mask = values.Below(4);
                  return bodies.SetCategoryAndMask(id, values.Below(4), mask))
FULCRUM_BODY_CALL(SetGravityFactor, return bodies.SetGravityFactor(id, values.Setting(-1, 2)))
FULCRUM_BODY_CALL(SetGravity, std::optional<Vector3> gravity; if (values.Chance(0.6f)) gravity = values.Speeds(10);
                  return bodies.SetGravity(id, gravity))
FULCRUM_BODY_CALL(SetMotionType, return bodies.SetMotionType(id, values.One<MotionType>(3)))
FULCRUM_BODY_CALL(SetMass, return bodies.SetMass(id, values.Mass()))
FULCRUM_BODY_CALL(SetInertia, SymmetricMatrix3 inertia; inertia.xx = values.Mass(); inertia.yy = values.Mass();
                  inertia.zz = values.Mass(); inertia.xy = values.Setting(-1, 1);
                  return bodies.SetMass(id, values.Mass(), inertia))
FULCRUM_BODY_CALL(SetLayer, return bodies.SetLayer(id, static_cast<uint8_t>(values.Below(values.IsOdd() ? 256 : 3))))
FULCRUM_BODY_CALL(SetDamping, const float linear = values.Setting(0, 2);
                  return bodies.SetDamping(id, linear, values.Setting(0, 2)))
FULCRUM_BODY_CALL(SetLockedAxes, twin.guided.push_back(id);
                  return bodies.SetLockedAxes(id, static_cast<LockedAxes>(values.Below(values.IsOdd() ? 256 : 64))))
FULCRUM_BODY_CALL(SetMaxSpeeds, const float linear = values.Setting(0.1f, 100);
                  return bodies.SetMaxSpeeds(id, linear, values.Setting(0.1f, 100)))
FULCRUM_BODY_CALL(SetAllowSleep, return bodies.SetAllowSleep(id, values.Chance(0.7f)))
FULCRUM_BODY_CALL(SetUserData, return bodies.SetUserData(id, values.Below(1000)))
FULCRUM_BODY_CALL(AddSteadyForce, return bodies.AddForce(id, Vector3(0, 100, 0)))
FULCRUM_BODY_CALL(AddRadialImpulse, RadialImpulse blast; blast.center = values.Place(2);
                  blast.radius = values.Setting(0.1f, 5); blast.impulse = values.Setting(-50, 50);
                  blast.falloff = values.One<RadialImpulse::Falloff>(2); return bodies.AddRadialImpulse(blast))
FULCRUM_BODY_CALL(SetContinuous, return bodies.SetContinuous(id, values.One<ContinuousCollision>(3)))
FULCRUM_BODY_CALL(SetReportsContacts, return bodies.SetReportsContacts(id, values.Chance(0.7f)))
FULCRUM_BODY_CALL(SetSensor, return bodies.SetSensor(id, values.Chance(0.4f)))
FULCRUM_BODY_CALL(SetSensorSees,
                  return bodies.SetSensorSees(id, static_cast<SensorSees>(values.Below(values.IsOdd() ? 256 : 32))))
FULCRUM_BODY_CALL(SetSensorReportsStay, return bodies.SetSensorReportsStay(id, values.Chance(0.5f)))
FULCRUM_BODY_CALL(Wake, return bodies.Wake(id))
FULCRUM_BODY_CALL(Sleep, return bodies.Sleep(id))
FULCRUM_BODY_CALL(SetShape, const MassUpdate update = values.One<MassUpdate>(2);
                  return bodies.SetShape(id, values.Chance(0.8f) ? RandomSolid(values) : RandomShape(values), update))
FULCRUM_BODY_CALL(SetShapeOfAnother, return bodies.SetShape(id, bodies.GetShape(twin.bodies[targets.bodyB])))
FULCRUM_BODY_CALL(AddChild, return bodies.AddChild(id, {RandomConvex(values), values.Offset(0.5f), values.Rotation(),
                                                        values.Setting(0.1f, 3)}))
FULCRUM_BODY_CALL(SetChild, const CompoundShape::ChildSettings child{RandomConvex(values), values.Offset(0.5f),
                                                                     values.Rotation()};
                  return bodies.SetChild(id, {values.Below(4), values.Below(2)}, child))
FULCRUM_BODY_CALL(MoveChild, const MassUpdate update = values.One<MassUpdate>(2);
                  const Quaternion rotation = values.Rotation(); const Vector3 place = values.Offset(0.5f);
                  return bodies.MoveChild(id, {values.Below(4), values.Below(2)}, place, rotation, update))
FULCRUM_BODY_CALL(RemoveChild, const MassUpdate update = values.One<MassUpdate>(2);
                  return bodies.RemoveChild(id, {values.Below(4), values.Below(2)}, update))

#undef FULCRUM_BODY_CALL

void SetPoses(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const BodyId ids[2] = {twin.bodies[targets.bodyA], twin.bodies[targets.bodyB]};
    Pose poses[2];
    for (Pose& pose : poses) {
        pose.rotation = values.Rotation();
        pose.position = values.Place(3);
    }
    Note(twin.system->Bodies().SetPoses(ids, poses), outcome);
}

// Two members of a group, which pass through each other or not.
void SetGroup(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome) {
    const auto filter = GroupFilterTable::Create({{0, 1}, {values.Below(3), 2}}).Value();
    BodyInterface& bodies = twin.system->Bodies();
    const Status first = bodies.SetGroup(twin.bodies[targets.bodyA], {filter, 0, values.Below(3)});
    if (Note(first, outcome)) (void)bodies.SetGroup(twin.bodies[targets.bodyB], {filter, 0, values.Below(3)});
}

constexpr CallKind kCalls[] = {
    {"Create", 12, Create},
    {"CreateFloor", 0.2f, CreateFloor},
    {"Remove", 1, Remove},
    {"SetPose", 2, SetPose},
    {"MoveKinematic", 2, MoveKinematic},
    {"SetVelocity", 2, SetVelocity},
    {"AddForce", 1, AddForce},
    {"AddForceAt", 1, AddForceAt},
    {"AddTorque", 1, AddTorque},
    {"AddImpulse", 1, AddImpulse},
    {"AddImpulseAt", 1, AddImpulseAt},
    {"AddAngularImpulse", 1, AddAngularImpulse},
    {"SetMaterial", 0.5f, SetMaterial},
    {"SetCategoryAndMask", 0.5f, SetCategoryAndMask},
    {"SetGroup", 0.5f, SetGroup},
    {"SetGravityFactor", 0.5f, SetGravityFactor},
    {"SetPoses", 1, SetPoses},
    {"SetGravity", 0.5f, SetGravity},
    {"SetMotionType", 1.5f, SetMotionType},
    {"SetMass", 0.5f, SetMass},
    {"SetInertia", 0.5f, SetInertia},
    {"SetLayer", 0.5f, SetLayer},
    {"SetDamping", 0.3f, SetDamping},
    {"SetLockedAxes", 0.3f, SetLockedAxes},
    {"SetMaxSpeeds", 0.3f, SetMaxSpeeds},
    {"SetAllowSleep", 0.5f, SetAllowSleep},
    {"SetUserData", 0.3f, SetUserData},
    {"AddSteadyForce", 3, AddSteadyForce},
    {"AddRadialImpulse", 0.5f, AddRadialImpulse},
    {"SetContinuous", 1, SetContinuous},
    {"SetReportsContacts", 0.5f, SetReportsContacts},
    {"SetSensor", 1, SetSensor},
    {"SetSensorSees", 0.5f, SetSensorSees},
    {"SetSensorReportsStay", 0.5f, SetSensorReportsStay},
    {"Wake", 0.5f, Wake},
    {"Sleep", 1, Sleep},
    {"SetShape", 2, SetShape},
    {"SetShapeOfAnother", 0.5f, SetShapeOfAnother},
    {"AddChild", 1, AddChild},
    {"SetChild", 1, SetChild},
    {"MoveChild", 1, MoveChild},
    {"RemoveChild", 1, RemoveChild},
};

}  // namespace

std::span<const CallKind> BodyCalls() { return kCalls; }

}  // namespace fulcrum::testing
