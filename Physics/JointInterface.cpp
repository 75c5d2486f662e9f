#include <Fulcrum/Physics/JointInterface.h>

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>
#include <Fulcrum/Physics/World/BodyColliders.h>
#include <Fulcrum/Physics/World/BodyReading.h>
#include <Fulcrum/Physics/World/JointChanges.h>
#include <Fulcrum/Physics/World/JointErrors.h>
#include <Fulcrum/Physics/World/TargetChanges.h>
#include <Fulcrum/Physics/World/WorldChange.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

Error Unknown(JointId id) {
    return {ErrorCode::UnknownId, "no joint has the id (index " + std::to_string(id.index) + ", generation " +
                                      std::to_string(id.generation) + ")"};
}

// A point and a rotation, in the world or in a body's center frame.
struct Frame {
    Vector3 point;  // m, in the center frame
    Quaternion rotation;
};

Frame FrameOf(const WorldState& world, uint32_t body, const JointAnchor& anchor, JointSpace space) {
    const Pose center = world.bodies.CenterPoseOf(body);
    const Quaternion rotation = RotationOf(anchor);
    if (space == JointSpace::World || body == world.bodies.worldBody)
        return {center.InverseTransform(OnGrid(anchor.point)), center.rotation.Conjugate() * rotation};
    const Vector3 offset = world.bodies.cold[body].shape->Mass().centerOfMass;
    return {Vector3(anchor.point.cast<float>()) - offset, rotation};
}

Pose WorldFrameOf(const WorldState& world, uint32_t body, const Frame& frame) {
    const Pose center = world.bodies.CenterPoseOf(body);
    return {center.Transform(frame.point), center.rotation * frame.rotation};
}

// The frames of a joint. If B's is not given, it coincides with A's in the world; if only its normal is missing, it is
// derived from A's.
std::pair<Frame, Frame> FramesOf(const WorldState& world, const JointSettings& s) {
    const Frame a = FrameOf(world, s.bodyA.index, s.anchorA, s.space);
    const Pose pose = WorldFrameOf(world, s.bodyA.index, a);
    JointAnchor b;
    if (s.anchorB) {
        b = *s.anchorB;
        if (!b.normal) {
            Vector3 normal = Rotate(pose.rotation, Vector3(0, 1, 0));
            if (s.space == JointSpace::Body) normal = InverseRotate(world.bodies.RotationOf(s.bodyB.index), normal);
            SetNormalNear(b, normal);
        }
        return {a, FrameOf(world, s.bodyB.index, b, s.space)};
    }
    const RelativePose bInA =
        Relative(world.bodies.CenterPoseOf(s.bodyA.index), world.bodies.CenterPoseOf(s.bodyB.index));
    return {a, {bInA.InverseTransform(a.point), InitialFrame2(bInA.rotation, a.rotation)}};
}

void Write(float (&to)[4], const Quaternion& q) {
    to[0] = q.x;
    to[1] = q.y;
    to[2] = q.z;
    to[3] = q.w;
}

// Static, without a shape, near the first body, where floats are precise.
void AddWorldBody(WorldState& world) {
    BodyStore& bodies = world.bodies;
    const uint32_t body = bodies.worldBody = bodies.Allocate();
    bodies.cold[body].isWorld = true;
    SetShapeOf(world, body, OwnShape(ShapeOfWorldBody()));
    bodies.SetRadii(body, *bodies.cold[body].shape);
    bodies.SetCenterPose(body, {world.colliders.boundsOrigin, {}});
    bodies.UpdateInertia(body);
    MakeColliders(world, body);
}

// The index of a body in valid settings. The body of the world is created when it is first needed.
uint32_t IndexOf(WorldState& world, BodyId id) {
    if (id != kWorldBody) return id.index;
    if (world.bodies.worldBody == BodyStore::kNone) AddWorldBody(world);
    return world.bodies.worldBody;
}

BodyId IdOf(const WorldState& world, uint32_t body) {
    return body == world.bodies.worldBody ? kWorldBody : world.bodies.IdOf(body);
}

}  // namespace

JointId JointInterface::Add(const JointSettings& settings, std::unique_ptr<JointType> type) {
    JointSettings s = settings;
    for (BodyId* body : {&s.bodyA, &s.bodyB}) body->index = IndexOf(world_, *body);
    const uint32_t index = world_.joints.Allocate();
    Joint& joint = world_.joints.joints[index];
    joint.body[0] = s.bodyA.index;
    joint.body[1] = s.bodyB.index;
    for (int side = 0; side < 2; ++side) joint.fixed[side] = !world_.bodies.CanMove(joint.body[side]);
    joint.collideConnected = s.collideConnected;
    joint.priority = s.priority;
    joint.breakForce = s.breakForce;
    joint.breakTorque = s.breakTorque;
    joint.effort = ToLeastEffort({s.substeps, s.velocityIterations, s.positionIterations});
    world_.joints.SetErrorTarget(index, s.errorTarget);
    joint.SetMassOverride(s.massOverride);
    joint.userData = s.userData;
    if (std::isfinite(s.breakForce) || std::isfinite(s.breakTorque)) world_.joints.breakable.Insert(index);
    JointRecord& record = world_.joints.records[index];
    const auto [a, b] = FramesOf(world_, s);
    for (int k = 0; k < 3; ++k) {
        record.anchorA[k] = a.point[k];
        record.anchorB[k] = b.point[k];
    }
    Write(record.frameA, a.rotation);
    Write(record.frameB, b.rotation);
    type->Start(PoseOf(world_, index));
    joint.type = std::move(type);
    world_.joints.types[index] = joint.type.get();
    world_.joints.Link(index);
    joint.enabled = s.enabled;
    if (s.enabled) EnableJoint(world_, index, true);
    return world_.joints.IdOf(index);
}

template <SettingsOfAKindOfJoint Settings>
Result<JointId> JointInterface::Create(const Settings& settings) {
    const WorldChange<&JointInterface::Create<Settings>> change(world_, settings);
    if (change.Refusal()) return *change.Refusal();
    const auto motionOf = [&](BodyId id) { return MotionOf(world_, id); };
    if (MaybeError error = Check(settings)) return *error;
    Result<std::unique_ptr<JointType>> type = MakeCheckedType(settings, motionOf);
    if (!type) return type.GetError();
    Additions more;
    IncludeJoint(world_, settings, more);
    ReserveForChange(world_, more);
    change.Begin();
    return change.template Created<JointId>(Add(settings, std::move(type.Value())));
}

#define FULCRUM_INSTANTIATE(kind) template Result<JointId> JointInterface::Create(const kind##JointSettings&);
FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_INSTANTIATE)
#undef FULCRUM_INSTANTIATE

Result<JointId> JointInterface::CreateTarget(const TargetJointSettings& s) {
    const DefaultFloats floats;
    if (MaybeError error = FirstOf(CheckPosition("anchor", s.anchor), CheckPosition("target", s.target),
                                   CheckSpring("spring", s.spring)))
        return *error;
    if (!(s.maxForce > 0)) return Error{ErrorCode::NonPositive, "maxForce must be larger than 0"};
    SixDofJointSettings joint;
    joint.bodyA = kWorldBody;
    joint.bodyB = s.body;
    joint.anchorA.point = s.target;
    joint.anchorB = JointAnchor{.point = s.anchor};
    joint.collideConnected = s.collideConnected;
    joint.userData = s.userData;
    for (size_t k = 0; k < 3; ++k)
        joint.axes[k].motor = {
            .mode = MotorMode::ToPosition, .spring = s.spring, .minForce = -s.maxForce, .maxForce = s.maxForce};
    return Create(joint);
}

Status JointInterface::SetTarget(JointId id, const Position& target) {
    const WorldChange<&JointInterface::SetTarget> change(world_, id, target);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError error = CheckPosition("target", target)) return *error;
    const Joint& joint = world_.joints.joints[id.index];
    if (joint.body[0] != world_.bodies.worldBody)
        return Error{ErrorCode::Unsupported, "the joint's body A is not the world; its anchor there cannot be moved"};
    float(&anchor)[3] = world_.joints.records[id.index].anchorA;
    const Vector3 point = world_.bodies.CenterPoseOf(joint.body[0]).InverseTransform(OnGrid(target));
    const bool isSame = point == Vector3(anchor[0], anchor[1], anchor[2]);
    ReserveToWake(world_, joint);
    change.Begin();
    for (int k = 0; k < 3; ++k) anchor[k] = point[k];
    if (joint.enabled && !isSame) WakeBodiesOf(world_, joint);
    return Done{};
}

Status JointInterface::Remove(JointId id) {
    const WorldChange<&JointInterface::Remove> change(world_, id);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    ReserveForChange(world_);
    change.Begin();
    RemoveJoint(world_, id.index);
    return Done{};
}

bool JointInterface::Exists(JointId id) const { return IsReadable(world_) && world_.joints.Find(id); }

Status JointInterface::SetEnabled(JointId id, bool enabled) {
    const WorldChange<&JointInterface::SetEnabled> change(world_, id, enabled);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    const Joint& joint = world_.joints.joints[id.index];
    if (joint.enabled == enabled) return Done{};
    ReserveForChange(world_, {.removedPairs = enabled ? PairsEndedBy(world_, joint) : 0});
    change.Begin();
    EnableJoint(world_, id.index, enabled);
    return Done{};
}

bool JointInterface::IsEnabled(JointId id) const { return Exists(id) && world_.joints.joints[id.index].enabled; }

AxisControl* JointInterface::ControlOf(JointId id, JointAxis axis) const {
    return Exists(id) && axis <= JointAxis::AngularZ ? world_.joints.types[id.index]->Control(axis) : nullptr;
}

namespace {

// Clears the stored row impulses, for a type that may have no rows anymore: the Store stage skips it.
void ForgetRows(JointType& type) {
    type.impulses.fill(0.0f);
    type.forces.fill(0.0f);
    type.turnedA = type.turnedB = Vector3::Zero();
}

}  // namespace

template <class Change>
Status JointInterface::ChangeControl(const WorldLock::Exclusive& alone, JointId id, JointAxis axis, Change&& change) {
    if (!Exists(id)) return Unknown(id);
    if (MaybeError error = CheckEnum("axis", axis, JointAxis::AngularZ)) return *error;
    AxisControl* control = ControlOf(id, axis);
    if (!control)
        return Error{ErrorCode::Unsupported, "axis: the joint has neither limits nor motor nor friction there"};
    AxisControl changed = *control;
    change(changed);
    if (MaybeError error = CheckControl("axis", changed, world_.joints.types[id.index]->BoundsOf(axis))) return *error;
    Joint& joint = world_.joints.joints[id.index];
    ReserveToWake(world_, joint);
    alone.Begin();
    const bool wasDriven = IsDrivenAtStops(*control);
    *control = changed;
    if (joint.type->MaxRows() != joint.maxRows || !(joint.type->Locks() == joint.locks) ||
        IsDrivenAtStops(changed) != wasDriven)  // HardMechanisms
        world_.coloring.Invalidate();
    if (joint.type->MaxRows() == 0) ForgetRows(*joint.type);
    if (joint.enabled) WakeBodiesOf(world_, joint);
    return Done{};
}

Status JointInterface::SetLimits(JointId id, JointAxis axis, const std::optional<JointLimits>& limits) {
    const WorldChange<&JointInterface::SetLimits> change(world_, id, axis, limits);
    if (change.Refusal()) return *change.Refusal();
    return ChangeControl(change, id, axis, [&](AxisControl& control) {
        control.limited = limits.has_value();
        if (limits) control.limits = *limits;
    });
}
Status JointInterface::SetMotor(JointId id, JointAxis axis, const JointMotor& motor) {
    const WorldChange<&JointInterface::SetMotor> change(world_, id, axis, motor);
    if (change.Refusal()) return *change.Refusal();
    return ChangeControl(change, id, axis, [&](AxisControl& control) { control.motor = motor; });
}
Status JointInterface::SetFriction(JointId id, JointAxis axis, float friction) {
    const WorldChange<&JointInterface::SetFriction> change(world_, id, axis, friction);
    if (change.Refusal()) return *change.Refusal();
    return ChangeControl(change, id, axis, [&](AxisControl& control) { control.friction = friction; });
}

Status JointInterface::SetTargetOrientation(JointId id, const Quaternion& target) {
    const WorldChange<&JointInterface::SetTargetOrientation> change(world_, id, target);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError error = CheckRotation("target", target)) return *error;
    const Joint& joint = world_.joints.joints[id.index];
    ReserveToWake(world_, joint);
    change.Begin();
    joint.type->SetTargetOrientation(Normalized(target));
    if (joint.enabled) WakeBodiesOf(world_, joint);
    return Done{};
}

Status JointInterface::SetErrorTarget(JointId id, float target) {
    const DefaultFloats floats;
    if (MaybeError error = CheckTarget("errorTarget", target)) return *error;
    const WorldChange<&JointInterface::SetErrorTarget> change(world_, id, target);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    ChangeErrorTarget(world_, id.index, target);
    return Done{};
}

Status JointInterface::SetEffort(JointId id, const SolverSettings& effort) {
    const WorldChange<&JointInterface::SetEffort> change(world_, id, effort);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError error = FirstOf(CheckRange("substeps", effort.substeps, 0, 64),
                                   CheckRange("velocityIterations", effort.velocityIterations, 0, 255),
                                   CheckRange("positionIterations", effort.positionIterations, 0, 255)))
        return *error;
    Joint& joint = world_.joints.joints[id.index];
    ReserveToWake(world_, joint);
    change.Begin();
    joint.effort = ToLeastEffort(effort);
    world_.coloring.Invalidate();
    if (joint.enabled) WakeBodiesOf(world_, joint);
    return Done{};
}

Status JointInterface::SetMassOverride(JointId id, const MassOverride& massOverride) {
    const WorldChange<&JointInterface::SetMassOverride> change(world_, id, massOverride);
    if (change.Refusal()) return *change.Refusal();
    if (!Exists(id)) return Unknown(id);
    if (MaybeError error = CheckMassOverride("massOverride", massOverride)) return *error;
    Joint& joint = world_.joints.joints[id.index];
    ReserveToWake(world_, joint);
    change.Begin();
    if (!(joint.massOverride == massOverride)) world_.coloring.Invalidate();
    joint.SetMassOverride(massOverride);
    if (joint.enabled) WakeBodiesOf(world_, joint);
    return Done{};
}

const AxisControl* JointInterface::GetControl(JointId id, JointAxis axis) const { return ControlOf(id, axis); }

double JointInterface::GetCoordinate(JointId id, JointAxis axis) const {
    const DefaultFloats floats;
    return Exists(id) && axis <= JointAxis::AngularZ
               ? world_.joints.types[id.index]->Coordinate(axis, PoseOf(world_, id.index))
               : 0.0;
}

JointError JointInterface::GetError(JointId id) const {
    const DefaultFloats floats;
    return Exists(id) ? ErrorOfJoint(world_, id.index) : JointError{};
}

namespace {

Vector3 Read(const WorldState& world, JointId id, float (JointRecord::*force)[3]) {
    if (!IsReadable(world) || !world.joints.Find(id)) return Vector3::Zero();
    const float(&v)[3] = world.joints.records[id.index].*force;
    return Vector3(v[0], v[1], v[2]);
}

}  // namespace

Vector3 JointInterface::GetForce(JointId id) const { return Read(world_, id, &JointRecord::totalForce); }
Vector3 JointInterface::GetTorque(JointId id) const { return Read(world_, id, &JointRecord::totalTorque); }
Vector3 JointInterface::GetLockForce(JointId id) const { return Read(world_, id, &JointRecord::lockForce); }
Vector3 JointInterface::GetLockTorque(JointId id) const { return Read(world_, id, &JointRecord::lockTorque); }

JointAxisForces JointInterface::GetAxisForces(JointId id, JointAxis axis) const {
    const DefaultFloats floats;
    if (!ControlOf(id, axis)) return {};
    const JointType& type = *world_.joints.types[id.index];
    const auto forceOf = [&](uint32_t slot) { return type.forces[type.FirstSlot(axis) + slot]; };
    return {forceOf(ControlSlots::kLowLimit) - forceOf(ControlSlots::kHighLimit), forceOf(ControlSlots::kMotor),
            forceOf(ControlSlots::kFriction)};
}

Pose JointInterface::GetFrameA(JointId id) const {
    const DefaultFloats floats;
    if (!Exists(id)) return {};
    return AnchorFrameOf(world_, id.index, 0);
}
Pose JointInterface::GetFrameB(JointId id) const {
    const DefaultFloats floats;
    if (!Exists(id)) return {};
    return AnchorFrameOf(world_, id.index, 1);
}
BodyId JointInterface::GetBodyA(JointId id) const {
    return Exists(id) ? IdOf(world_, world_.joints.joints[id.index].body[0]) : BodyId{};
}
BodyId JointInterface::GetBodyB(JointId id) const {
    return Exists(id) ? IdOf(world_, world_.joints.joints[id.index].body[1]) : BodyId{};
}
float JointInterface::GetErrorTarget(JointId id) const {
    return Exists(id) ? world_.joints.joints[id.index].errorTarget : 0;
}
uint64_t JointInterface::GetUserData(JointId id) const {
    return Exists(id) ? world_.joints.joints[id.index].userData : 0;
}

MassOverride JointInterface::GetMassOverride(JointId id) const {
    return Exists(id) ? world_.joints.joints[id.index].massOverride : MassOverride{};
}

const JointType* JointInterface::GetType(JointId id) const {
    return Exists(id) ? world_.joints.types[id.index] : nullptr;
}

void JointInterface::Visit(FunctionRef<void(JointId)> visit) const {
    if (!IsReadable(world_)) return;
    for (uint32_t i = 0; i < world_.joints.joints.size(); ++i)
        if (world_.joints.joints[i].exists) visit(world_.joints.IdOf(i));
}

void JointInterface::VisitOf(BodyId body, FunctionRef<void(JointId)> visit) const {
    if (!IsReadable(world_)) return;
    const uint32_t index = body == kWorldBody ? world_.bodies.worldBody : body.index;
    if (body == kWorldBody || world_.bodies.Find(body))
        world_.joints.VisitOf(index, [&](uint32_t joint) { visit(world_.joints.IdOf(joint)); });
}

}  // namespace fulcrum
