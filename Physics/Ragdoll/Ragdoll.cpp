#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>

#include <Fulcrum/Constraints/Joints/JointAngles.h>

namespace fulcrum {

namespace {

constexpr JointAxis kLinearAxes[] = {JointAxis::LinearX, JointAxis::LinearY, JointAxis::LinearZ};
constexpr JointAxis kAngularAxes[] = {JointAxis::AngularX, JointAxis::AngularY, JointAxis::AngularZ};

BodySettings PlacedBody(const BodySettings& settings, const Pose& pose, const Pose& origin, std::optional<MotionType> motion) {
    BodySettings body = settings;
    body.position = pose.position;
    body.rotation = pose.rotation;
    body.linearVelocity = Rotate(origin.rotation, settings.linearVelocity);
    body.angularVelocity = Rotate(origin.rotation, settings.angularVelocity);
    if (!motion) return body;
    body.motion = *motion;
    if (*motion != MotionType::Dynamic) body.startAsleep = false;
    if (*motion == MotionType::Static) body.linearVelocity = body.angularVelocity = Vector3::Zero();
    return body;
}

JointAnchor AnchorAt(const RelativePose& frame) {
    return {frame.position.cast<double>(), Rotate(frame.rotation, Vector3(1, 0, 0)), Rotate(frame.rotation, Vector3(0, 1, 0))};
}

bool CanHaveMotor(const AxisControl* control) {
    return control && !(control->limited && control->limits.min >= control->limits.max);
}

}  // namespace

Result<Ragdoll> Ragdoll::Create(PhysicsSystem& system, const RagdollSettings& settings, const Pose& origin,
                                std::optional<MotionType> motion) {
    if (MaybeError e = FirstOf(Check(settings), CheckFinite("origin.position", origin.position), CheckRotation("origin.rotation", origin.rotation)))
        return *e;
    Ragdoll ragdoll(system);
    if (MaybeError e = ragdoll.Build(settings, {origin.position, Normalized(origin.rotation)}, motion)) {
        ragdoll.Remove();
        return *e;
    }
    return ragdoll;
}

MaybeError Ragdoll::Build(const RagdollSettings& settings, const Pose& origin, std::optional<MotionType> motion) {
    std::vector<Pose> pose(settings.parts.size());
    ReferencePose(settings, origin, pose);
    const BodySettings& root = settings.parts[0].body;
    originInRoot_ = Inverse({root.position.cast<float>(), Normalized(root.rotation)});
    for (size_t i = 0; i < settings.parts.size(); ++i) {
        const RagdollPart& part = settings.parts[i];
        Result<BodyId> body = system_->Bodies().Create(PlacedBody(part.body, pose[i], origin, motion));
        if (!body) return Error{body.GetError().code, "parts[" + std::to_string(i) + "].body: " + body.GetError().message};
        bodies_.push_back(body.Value());
        joints_.emplace_back();
        parents_.push_back(part.parent);
        frames_.push_back(i == 0 ? RagdollJointFrames{} : JointFramesOf(settings, i));
        gravityFactors_.push_back(part.body.gravityFactor);
    }
    const auto isDynamic = [&](size_t i) { return system_->Bodies().GetMotionType(bodies_[i]) == MotionType::Dynamic; };
    for (size_t i = 1; i < settings.parts.size(); ++i) {
        const auto parent = static_cast<size_t>(parents_[i]);
        if (!isDynamic(parent) && !isDynamic(i)) continue;
        RagdollJoint joint = settings.parts[i].joint;
        JointSettings& common = CommonOf(joint);
        common.bodyA = bodies_[parent];
        common.bodyB = bodies_[i];
        common.space = JointSpace::Body;
        common.anchorA = AnchorAt(frames_[i].inParent);
        common.anchorB = AnchorAt(frames_[i].inPart);
        Result<JointId> id = std::visit([&](const auto& ofKind) { return system_->Joints().Create(ofKind); }, joint);
        if (!id) return Error{id.GetError().code, "parts[" + std::to_string(i) + "].joint: " + id.GetError().message};
        joints_[i] = id.Value();
    }
    return std::nullopt;
}

void Ragdoll::Remove() {
    // Their joints go with them.
    for (BodyId id : bodies_)
        if (system_->Bodies().Exists(id)) static_cast<void>(system_->Bodies().Remove(id));
}

MaybeError Ragdoll::CheckExists() const {
    for (size_t i = 0; i < bodies_.size(); ++i)
        if (!system_->Bodies().Exists(bodies_[i]))
            return Error{ErrorCode::UnknownId, "the body of part " + std::to_string(i) + " of the ragdoll was removed"};
    return std::nullopt;
}

MaybeError Ragdoll::CheckPose(std::span<const Pose> pose) const {
    if (MaybeError e = CheckExists()) return e;
    if (pose.size() != bodies_.size())
        return Error{ErrorCode::OutOfRange, "pose has " + std::to_string(pose.size()) + " elements; it must have " +
                                                std::to_string(bodies_.size()) + ", one a part"};
    for (size_t i = 0; i < pose.size(); ++i) {
        const MaybeError e = FirstOf(CheckFinite("position", pose[i].position), CheckRotation("rotation", pose[i].rotation));
        if (e) return Error{e->code, "pose[" + std::to_string(i) + "]." + e->message};
    }
    return std::nullopt;
}

MaybeError Ragdoll::CheckDrive(std::span<const Pose> pose, float dt) const {
    if (MaybeError e = FirstOf(CheckPose(pose), CheckPositive("dt", dt))) return e;
    for (size_t i = 0; i < bodies_.size(); ++i)
        if (system_->Bodies().IsFrozen(bodies_[i]))
            return Error{ErrorCode::Unsupported, "the body of part " + std::to_string(i) + " is frozen; SetPose revives it"};
    return std::nullopt;
}

Status Ragdoll::GetPose(std::span<Pose> pose) const {
    if (MaybeError e = CheckExists()) return *e;
    if (pose.size() != bodies_.size())
        return Error{ErrorCode::OutOfRange, "pose has " + std::to_string(pose.size()) + " elements; it must have " +
                                                std::to_string(bodies_.size()) + ", one a part"};
    for (size_t i = 0; i < pose.size(); ++i) pose[i] = system_->Bodies().GetPose(bodies_[i]);
    return Done{};
}

Status Ragdoll::SetPose(std::span<const Pose> pose) {
    if (MaybeError e = CheckPose(pose)) return *e;
    for (size_t i = 0; i < pose.size(); ++i)
        if (Status set = system_->Bodies().SetPose(bodies_[i], pose[i].position, pose[i].rotation); !set) return set;
    return Done{};
}

Status Ragdoll::DriveByMotors(std::span<const Pose> pose) {
    if (MaybeError e = CheckPose(pose)) return *e;
    for (size_t i = 1; i < pose.size(); ++i) {
        if (!system_->Joints().Exists(joints_[i])) continue;
        const Pose onParent = pose[static_cast<size_t>(parents_[i])] * frames_[i].inParent;
        RelativePose target = Relative(onParent, pose[i] * frames_[i].inPart);
        target.rotation = Normalized(target.rotation);
        SetTarget(joints_[i], target);
    }
    return Done{};
}

// `target` is the joint's frame on the part, seen from that on the parent.
void Ragdoll::SetTarget(JointId joint, const RelativePose& target) {
    JointInterface& joints = system_->Joints();
    const auto motorOf = [&](JointAxis axis) -> std::optional<JointMotor> {
        const AxisControl* control = joints.GetControl(joint, axis);
        if (!control || control->motor.mode != MotorMode::ToPosition) return std::nullopt;
        return control->motor;
    };
    const auto setPosition = [&](JointAxis axis, JointMotor motor, double position) {
        motor.targetPosition = static_cast<float>(position);
        static_cast<void>(joints.SetMotor(joint, axis, motor));  // it was valid, and the position is finite
    };
    for (int k = 0; k < 3; ++k)
        if (const auto motor = motorOf(kLinearAxes[k])) setPosition(kLinearAxes[k], *motor, target.position[k]);
    if (joints.GetControl(joint, JointAxis::AngularY)) {
        static_cast<void>(joints.SetTargetOrientation(joint, target.rotation));
    } else if (const auto motor = motorOf(JointAxis::AngularX)) {
        // A hinge counts turns: the target is the one within its limits, or, without any, the nearest.
        const AxisControl& control = *joints.GetControl(joint, JointAxis::AngularX);
        TurnCount turns;
        turns.Start(NearestTurn(TwistAngle(target.rotation), joints.GetCoordinate(joint, JointAxis::AngularX)), control);
        setPosition(JointAxis::AngularX, *motor, turns.Angle());
    }
}

Status Ragdoll::DriveByVelocities(std::span<const Pose> pose, float dt) { return Drive(pose, dt, true); }
Status Ragdoll::DriveKinematically(std::span<const Pose> pose, float dt) { return Drive(pose, dt, false); }

Status Ragdoll::Drive(std::span<const Pose> pose, float dt, bool dynamicToo) {
    if (MaybeError e = CheckDrive(pose, dt)) return *e;
    BodyInterface& bodies = system_->Bodies();
    for (size_t i = 0; i < pose.size(); ++i) {
        const BodyId id = bodies_[i];
        const MotionType motion = bodies.GetMotionType(id);
        if (motion == MotionType::Kinematic) {
            if (Status moved = bodies.MoveKinematic(id, pose[i].position, pose[i].rotation, dt); !moved) return moved;
        } else if (motion == MotionType::Dynamic && dynamicToo) {
            const Quaternion goal = Normalized(pose[i].rotation), now = bodies.GetPose(id).rotation;
            const Position centre = pose[i].position + Rotate(goal, bodies.GetShape(id)->Mass().centreOfMass).cast<double>();
            const Vector3 way = (centre - bodies.GetCentreOfMass(id)).cast<float>();
            const Vector3 fall = system_->Settings().gravity * (gravityFactors_[i] * 0.5f * dt);
            const Vector3 turn = RotationVectorOf(goal * now.Conjugate()) * (1.0f / dt);
            if (Status set = bodies.SetVelocity(id, way * (1.0f / dt) - fall, turn); !set) return set;
        }
    }
    return Done{};
}

Status Ragdoll::SetMotors(const JointMotor& motor) {
    JointInterface& joints = system_->Joints();
    for (JointId joint : joints_) {
        for (JointAxis axis : kAngularAxes) {
            const AxisControl* control = joints.GetControl(joint, axis);
            if (!CanHaveMotor(control)) continue;
            JointMotor changed = motor;
            changed.targetPosition = control->motor.targetPosition;
            if (Status set = joints.SetMotor(joint, axis, changed); !set) return set;
        }
    }
    return Done{};
}

Pose Ragdoll::Origin() const { return system_->Bodies().GetPose(bodies_[0]) * originInRoot_; }

}  // namespace fulcrum
