#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>

#include <Fulcrum/Constraints/Joints/JointAngles.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/BodyBatch.h>
#include <Fulcrum/Physics/Joints/JointChecks.h>
#include <Fulcrum/Physics/Misuse.h>

namespace fulcrum {

namespace {

constexpr JointAxis kLinearAxes[] = {JointAxis::LinearX, JointAxis::LinearY, JointAxis::LinearZ};
constexpr JointAxis kAngularAxes[] = {JointAxis::AngularX, JointAxis::AngularY, JointAxis::AngularZ};

BodySettings PlacedBody(const BodySettings& settings, const Pose& pose, const Pose& origin,
                        std::optional<MotionType> motion) {
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
    return {frame.position.cast<double>(), Rotate(frame.rotation, Vector3(1, 0, 0)),
            Rotate(frame.rotation, Vector3(0, 1, 0))};
}

MaybeError NamedPart(size_t part, const char* field, const MaybeError& error) {
    if (!error) return error;
    return Error{error->code, "parts[" + std::to_string(part) + "]." + field + ": " + error->message};
}

bool CanHaveMotor(const AxisControl* control) {
    return control && !(control->limited && control->limits.min >= control->limits.max);
}

}  // namespace

// Bodies and joints to be created, in world space.
struct Ragdoll::Placed {
    std::vector<BodySettings> bodies;
    std::vector<RagdollJointFrames> frames;  // that of the first part is unused
    std::vector<std::optional<RagdollJoint>>
        joints;  // without their bodies; none for the first part and between two parts of which none is dynamic
};

Ragdoll::Placed Ragdoll::Place(const RagdollSettings& settings, const Pose& origin, std::optional<MotionType> motion) {
    const size_t count = settings.parts.size();
    std::vector<Pose> pose(count);
    ReferencePose(settings, origin, pose);
    Placed placed{std::vector<BodySettings>(count), std::vector<RagdollJointFrames>(count),
                  std::vector<std::optional<RagdollJoint>>(count)};
    for (size_t i = 0; i < count; ++i) {
        const RagdollPart& part = settings.parts[i];
        placed.bodies[i] = PlacedBody(part.body, pose[i], origin, motion);
        if (i == 0) continue;
        placed.frames[i] = JointFramesOf(settings, i);
        const auto isDynamic = [&](size_t of) { return placed.bodies[of].motion == MotionType::Dynamic; };
        if (!isDynamic(static_cast<size_t>(part.parent)) && !isDynamic(i)) continue;
        JointSettings& common = CommonOf(placed.joints[i].emplace(part.joint));
        common.space = JointSpace::Body;
        common.anchorA = AnchorAt(placed.frames[i].inParent);
        common.anchorB = AnchorAt(placed.frames[i].inPart);
    }
    return placed;
}

// Valid settings may become invalid when placed: beyond the largest position, or with another motion type.
MaybeError Ragdoll::CheckPlaced(const Placed& placed) {
    for (size_t i = 0; i < placed.bodies.size(); ++i) {
        if (MaybeError e = NamedPart(i, "body", Check(placed.bodies[i]))) return e;
        if (!placed.joints[i]) continue;
        if (MaybeError e =
                NamedPart(i, "joint", std::visit([](const auto& joint) { return Check(joint); }, *placed.joints[i])))
            return e;
    }
    return std::nullopt;
}

Ragdoll::Ragdoll(PhysicsSystem& system) : system_(&system) {}

std::span<const BodyId> Ragdoll::Bodies() const { return bodies_; }
std::span<const JointId> Ragdoll::Joints() const { return joints_; }

Result<Ragdoll> Ragdoll::Create(PhysicsSystem& system, const RagdollSettings& settings, const Pose& origin,
                                std::optional<MotionType> motion) {
    const DefaultFloats floats;
    if (MaybeError e = FirstOf(Check(settings), CheckPosition("origin.position", origin.position),
                               CheckRotation("origin.rotation", origin.rotation)))
        return *e;
    const Placed placed = Place(settings, {origin.position, Normalized(origin.rotation)}, motion);
    if (MaybeError e = CheckPlaced(placed)) return *e;
    Ragdoll ragdoll(system);
    if (MaybeError e = ragdoll.Build(settings, placed)) return *e;
    return ragdoll;
}

MaybeError Ragdoll::Build(const RagdollSettings& settings, const Placed& placed) {
    const BodySettings& root = settings.parts[0].body;
    originInRoot_ = Inverse({root.position.cast<float>(), Normalized(root.rotation)});
    std::vector<BodyBatch::Joint> joints;
    for (size_t i = 0; i < settings.parts.size(); ++i) {
        parents_.push_back(settings.parts[i].parent);
        frames_.push_back(placed.frames[i]);
        gravityFactors_.push_back(settings.parts[i].body.gravityFactor);
        if (!placed.joints[i]) continue;
        std::visit([&](const auto& ofKind) { joints.emplace_back(ofKind); }, *placed.joints[i]);
        CommonOf(joints.back()).bodyA = BodyBatch::Body(static_cast<uint32_t>(parents_[i]));
        CommonOf(joints.back()).bodyB = BodyBatch::Body(static_cast<uint32_t>(i));
    }
    joints_.resize(settings.parts.size());
    const Result<BodyBatch> batch = BodyBatch::Prepare(placed.bodies, std::move(joints));
    if (!batch) return batch.GetError();
    // The settings are checked, so this fails only if changes are not allowed now.
    Result<BatchIds> made = system_->Bodies().Commit(batch.Value());
    if (!made) return made.GetError();
    bodies_ = std::move(made.Value().bodies);
    for (size_t i = 0, next = 0; i < joints_.size(); ++i)
        if (placed.joints[i]) joints_[i] = made.Value().joints[next++];
    return std::nullopt;
}

void Ragdoll::Remove() {
    // This removes their joints, too.
    for (BodyId id : bodies_) {
        if (!system_->Bodies().Exists(id)) continue;
        if (Status removed = system_->Bodies().Remove(id); !removed) return ReportMisuse(removed.GetError());
    }
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
        const MaybeError e =
            FirstOf(CheckPosition("position", pose[i].position), CheckRotation("rotation", pose[i].rotation));
        if (e) return Error{e->code, "pose[" + std::to_string(i) + "]." + e->message};
    }
    return std::nullopt;
}

MaybeError Ragdoll::CheckDrive(std::span<const Pose> pose, float dt) const {
    if (MaybeError e = FirstOf(CheckPose(pose), CheckPositive("dt", dt))) return e;
    for (size_t i = 0; i < bodies_.size(); ++i)
        if (system_->Bodies().IsFrozen(bodies_[i]))
            return Error{ErrorCode::Unsupported,
                         "the body of part " + std::to_string(i) + " is frozen; SetPose revives it"};
    return std::nullopt;
}

Status Ragdoll::GetPose(std::span<Pose> pose) const {
    const DefaultFloats floats;
    if (MaybeError e = CheckExists()) return *e;
    if (pose.size() != bodies_.size())
        return Error{ErrorCode::OutOfRange, "pose has " + std::to_string(pose.size()) + " elements; it must have " +
                                                std::to_string(bodies_.size()) + ", one a part"};
    for (size_t i = 0; i < pose.size(); ++i) pose[i] = system_->Bodies().GetPose(bodies_[i]);
    return Done{};
}

Status Ragdoll::SetPose(std::span<const Pose> pose) {
    const DefaultFloats floats;
    if (MaybeError e = CheckPose(pose)) return *e;
    for (size_t i = 0; i < pose.size(); ++i)
        if (Status set = system_->Bodies().SetPose(bodies_[i], pose[i].position, pose[i].rotation); !set) return set;
    return Done{};
}

Status Ragdoll::DriveByMotors(std::span<const Pose> pose) {
    const DefaultFloats floats;
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

// `target` is the joint's frame on the part relative to that on the parent.
void Ragdoll::SetTarget(JointId joint, const RelativePose& target) {
    JointInterface& joints = system_->Joints();
    const auto motorOf = [&](JointAxis axis) -> std::optional<JointMotor> {
        const AxisControl* control = joints.GetControl(joint, axis);
        if (!control || control->motor.mode != MotorMode::ToPosition) return std::nullopt;
        return control->motor;
    };
    const auto setPosition = [&](JointAxis axis, JointMotor motor, double position) {
        motor.targetPosition = static_cast<float>(position);
        static_cast<void>(
            joints.SetMotor(joint, axis, motor));  // cannot fail: the motor was valid, and the position is finite
    };
    for (int k = 0; k < 3; ++k)
        if (const auto motor = motorOf(kLinearAxes[k])) setPosition(kLinearAxes[k], *motor, target.position[k]);
    if (joints.GetControl(joint, JointAxis::AngularY)) {
        static_cast<void>(joints.SetTargetOrientation(joint, target.rotation));
    } else if (const auto motor = motorOf(JointAxis::AngularX)) {
        // A hinge counts revolutions: the target is the equivalent angle within its limits, or, without limits, the
        // nearest.
        const AxisControl& control = *joints.GetControl(joint, JointAxis::AngularX);
        TurnCount turns;
        turns.Start(NearestTurn(TwistAngle(target.rotation), joints.GetCoordinate(joint, JointAxis::AngularX)),
                    control);
        setPosition(JointAxis::AngularX, *motor, turns.Angle());
    }
}

Status Ragdoll::DriveByVelocities(std::span<const Pose> pose, float dt) {
    const DefaultFloats floats;
    return Drive(pose, dt, true);
}
Status Ragdoll::DriveKinematically(std::span<const Pose> pose, float dt) {
    const DefaultFloats floats;
    return Drive(pose, dt, false);
}

Status Ragdoll::Drive(std::span<const Pose> pose, float dt, bool dynamicToo) {
    if (MaybeError e = CheckDrive(pose, dt)) return *e;
    BodyInterface& bodies = system_->Bodies();
    const auto drives = [&](size_t i) {
        const MotionType motion = bodies.GetMotionType(bodies_[i]);
        return motion == MotionType::Kinematic || (motion == MotionType::Dynamic && dynamicToo);
    };
    // All poses are checked before any is set: on error no part has moved.
    for (size_t i = 0; i < pose.size(); ++i) {
        if (!drives(i)) continue;
        const auto [linear, angular] = VelocityTo(i, pose[i], dt);
        const MaybeError e = FirstOf(CheckFinite("the linear velocity that it asks for", linear),
                                     CheckFinite("the angular velocity that it asks for", angular));
        if (e) return Error{e->code, "pose[" + std::to_string(i) + "]: " + e->message};
    }
    for (size_t i = 0; i < pose.size(); ++i) {
        if (!drives(i)) continue;
        const auto [linear, angular] = VelocityTo(i, pose[i], dt);
        if (Status set = bodies.SetVelocity(bodies_[i], linear, angular); !set) return set;
    }
    return Done{};
}

std::pair<Vector3, Vector3> Ragdoll::VelocityTo(size_t part, const Pose& pose, float dt) const {
    const BodyInterface& bodies = system_->Bodies();
    const BodyId id = bodies_[part];
    const Quaternion goal = Normalized(pose.rotation), now = bodies.GetPose(id).rotation;
    const Position center = pose.position + Rotate(goal, bodies.GetShape(id)->Mass().centerOfMass).cast<double>();
    const Vector3 way = (center - bodies.GetCenterOfMass(id)).cast<float>();
    const bool falls = bodies.GetMotionType(id) == MotionType::Dynamic;
    const Vector3 fall =
        falls ? Vector3(system_->Settings().gravity * (gravityFactors_[part] * 0.5f * dt)) : Vector3(Vector3::Zero());
    return {way * (1.0f / dt) - fall, RotationVectorOf(goal * now.Conjugate()) * (1.0f / dt)};
}

Status Ragdoll::SetMotors(const JointMotor& motor) {
    const DefaultFloats floats;
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

Pose Ragdoll::Origin() const {
    const DefaultFloats floats;
    return system_->Bodies().GetPose(bodies_[0]) * originInRoot_;
}

}  // namespace fulcrum
