// A ragdoll in a world: the ids of its bodies and joints, and calls that concern all of them. A plain value: copies
// name the same bodies, which live until Remove. Call it between steps, from one thread at a time, as BodyInterface.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/Ragdoll/RagdollSettings.h>

namespace fulcrum {

class Ragdoll {
public:
    // In the reference pose, its frame at `origin`. With `motion` all parts move so, whatever their settings say:
    // kinematic for hard keying. Parts that are joined do not collide, all others do (JointSettings::collideConnected).
    // Two joined parts of which none is dynamic get no joint. The system must outlive the ragdoll's use. Errors: those
    // of Check; of `origin` NonFinite, Unnormalized. Nothing is created then.
    static Result<Ragdoll> Create(PhysicsSystem& system, const RagdollSettings& settings, const Pose& origin = {},
                                  std::optional<MotionType> motion = {});

    // Removes the bodies and joints; those that were removed already are skipped.
    void Remove();

    // One a part, in the order of the settings.
    std::span<const BodyId> Bodies() const;
    // The joint of each part to its parent; an invalid id for the first part and where no joint was created.
    std::span<const JointId> Joints() const;

    // Spans of poses have one element per part, the pose of the body's own frame. Errors of all that follow: UnknownId
    // (a body was removed), OutOfRange (another number of poses), NonFinite, Unnormalized: nothing has changed then.
    Status GetPose(std::span<Pose> pose) const;
    // Teleports; velocities stay as they are.
    Status SetPose(std::span<const Pose> pose);

    // Sets the targets of all position motors to the pose: orientations, and of a SixDof the places along its axes.
    // Where the whole ragdoll stands is not asked for. Motors that are off, or drive a speed, stay so; removed joints
    // are passed over.
    Status DriveByMotors(std::span<const Pose> pose);
    // Soft keying: gives all parts the velocity with which they reach the pose after `dt` seconds (> 0), gravity
    // counted in, unless contacts and joints stop them on the way. Errors also: NonPositive, Unsupported (a body is
    // frozen).
    Status DriveByVelocities(std::span<const Pose> pose, float dt);
    // Hard keying: moves the kinematic parts so that they are in the pose after `dt` seconds (> 0); dynamic parts
    // follow as their joints say. Errors as for soft keying.
    Status DriveKinematically(std::span<const Pose> pose, float dt);

    // Gives every angular axis of the ragdoll's joints that can have one this motor, but for its target position, which
    // stays. Errors: those of JointInterface::SetMotor.
    Status SetMotors(const JointMotor& motor);

    // Where the ragdoll's frame is for the first part to be in its reference pose there.
    Pose Origin() const;

private:
    explicit Ragdoll(PhysicsSystem& system);
    struct Placed;
    static Placed Place(const RagdollSettings& settings, const Pose& origin, std::optional<MotionType> motion);
    static MaybeError CheckPlaced(const Placed& placed);
    MaybeError Build(const RagdollSettings& settings, const Placed& placed);
    MaybeError CheckExists() const;
    MaybeError CheckPose(std::span<const Pose> pose) const;
    MaybeError CheckDrive(std::span<const Pose> pose, float dt) const;
    Status Drive(std::span<const Pose> pose, float dt, bool dynamicToo);
    // Linear and angular.
    std::pair<Vector3, Vector3> VelocityTo(size_t part, const Pose& pose, float dt) const;
    void SetTarget(JointId joint, const RelativePose& target);

    PhysicsSystem* system_;
    std::vector<BodyId> bodies_;
    std::vector<JointId> joints_;
    std::vector<int> parents_;
    std::vector<RagdollJointFrames> frames_;  // of the joints; the first part's is not used
    std::vector<float> gravityFactors_;
    RelativePose originInRoot_;
};

}  // namespace fulcrum
