// Creates, removes, drives and reads joints. From PhysicsSystem::Joints(); call it between steps, from one thread at a
// time (concurrent reads are allowed). Bodies connected by joints sleep and wake together; every change of a joint
// wakes them.
#pragma once

#include <Fulcrum/Constraints/Joints/JointError.h>
#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Physics/Joints/JointKinds.h>
#include <Fulcrum/Physics/World/WorldLock.h>

#include <memory>

namespace fulcrum {

struct WorldState;

// Average force of the rows along one axis over the last step, N or N m on body B; 0 if there was no row.
struct JointAxisForces {
    float limit = 0, motor = 0, friction = 0;
};

// A spring from a place in the world to a point of a body, as a mouse drags it. Made of the translations of a six-dof
// joint, whose motors may be changed as such.
struct TargetJointSettings {
    BodyId body{};                       // dynamic
    Position anchor = Position::Zero();  // m, world: the point of the body at its present pose
    Position target = Position::Zero();  // m, world
    SpringSettings spring = {.frequency = 5.0f, .dampingRatio = 1.0f};
    float maxForce = std::numeric_limits<float>::infinity();  // N, > 0, along each axis of the world
    bool collideConnected = true;
    uint64_t userData = 0;
};

class JointInterface {
public:
    explicit JointInterface(WorldState& world) : world_(world) {}

    // Settings: those of any kind in Joints/JointKinds.h. The bodies may be in any pose: joints with errors come
    // together. Errors name the field: UnknownId (a body), Unsupported (the same body twice, no dynamic one),
    // NonFinite, NonPositive, Negative, OutOfRange, Unnormalized. On error nothing is created.
    template <SettingsOfAKindOfJoint Settings>
    Result<JointId> Create(const Settings& settings);
    Result<JointId> CreateTarget(const TargetJointSettings& settings);
    // Moves A's anchor of a joint whose body A is the world to a position, m; wakes the bodies, unless it is there
    // already. Errors also: Unsupported (body A is another), NonFinite, OutOfRange.
    Status SetTarget(JointId id, const Position& target);
    // Removing a body removes its joints. Error: UnknownId, as for all that follow.
    Status Remove(JointId id);
    bool Exists(JointId id) const;

    // A disabled joint has no effect, and its bodies collide. Also enables broken joints again.
    Status SetEnabled(JointId id, bool enabled);
    bool IsEnabled(JointId id) const;
    // Limits, motor and friction of an axis. Errors also: Unsupported (the joint has no such axis), and those of
    // Create. Changing the target of an active motor is cheap and allocates nothing.
    Status SetLimits(JointId id, JointAxis axis, const std::optional<JointLimits>& limits);
    Status SetMotor(JointId id, JointAxis axis, const JointMotor& motor);
    Status SetFriction(JointId id, JointAxis axis, float friction);
    // Target orientation of frame B relative to frame A for position motors. Errors also: NonFinite, Unnormalized.
    Status SetTargetOrientation(JointId id, const Quaternion& target);
    // Minimum solver effort of the joint's island, see JointSettings; 0: the system's. Of the effort only the substeps
    // and iterations count. Errors also: OutOfRange.
    Status SetEffort(JointId id, const SolverSettings& effort);
    // How far apart its anchors may be, m, see JointSettings; 0: as the system's, infinite: anyhow. Errors also:
    // NonFinite (NaN), Negative.
    Status SetErrorTarget(JointId id, float target);
    // Mass scales of the bodies for this joint, see JointSettings. Errors also: NonFinite, OutOfRange.
    Status SetMassOverride(JointId id, const MassOverride& massOverride);

    // Getters return zeros for an unknown id.
    const AxisControl* GetControl(JointId id, JointAxis axis) const;  // null if it has no such axis
    double GetCoordinate(JointId id, JointAxis axis) const;           // m or rad, see the joint's settings
    // The largest of its locks, limits, lengths, ratios and hard motors at the bodies' present poses.
    JointError GetError(JointId id) const;
    // Average force and torque of the joint (locks and rows) on body B over the last step: N, and N m about B's anchor,
    // world axes. For sleeping joints those of the last active step; zero if disabled.
    Vector3 GetForce(JointId id) const;
    Vector3 GetTorque(JointId id) const;
    // The locks' share of it.
    Vector3 GetLockForce(JointId id) const;
    Vector3 GetLockTorque(JointId id) const;
    JointAxisForces GetAxisForces(JointId id, JointAxis axis) const;
    // The joint's frame fixed in body A and that fixed in body B, world space.
    Pose GetFrameA(JointId id) const;
    Pose GetFrameB(JointId id) const;
    BodyId GetBodyA(JointId id) const;
    BodyId GetBodyB(JointId id) const;
    float GetErrorTarget(JointId id) const;
    uint64_t GetUserData(JointId id) const;
    MassOverride GetMassOverride(JointId id) const;  // none for an unknown id
    // The joint's type, for data that only this type has; null for an unknown id. Valid until the joint is removed.
    const JointType* GetType(JointId id) const;

    // Visits all joints, by index; all joints of a body, the newest first.
    void Visit(FunctionRef<void(JointId)> visit) const;
    void VisitOf(BodyId body, FunctionRef<void(JointId)> visit) const;

private:
    friend class BodyInterface;  // creates the joints of a batch

    JointId Add(const JointSettings& settings, std::unique_ptr<JointType> type);
    AxisControl* ControlOf(JointId id, JointAxis axis) const;
    template <class Change>
    Status ChangeControl(const WorldLock::Exclusive& alone, JointId id, JointAxis axis, Change&& change);

    WorldState& world_;
};

}  // namespace fulcrum
