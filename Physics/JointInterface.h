// Adds, removes, drives and reads joints. From PhysicsSystem::Joints(); call it between steps, from one thread at a
// time (reading from many is fine). Jointed bodies sleep and wake together; every change of a joint wakes them.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Physics/Joints/JointKinds.h>

#include <memory>

namespace fulcrum {

struct WorldState;

// Position error of a joint's locks, now.
struct JointError {
    float distance = 0;  // m, between the anchors, along what is locked
    float angle = 0;     // rad, of what is locked
};

// What the rows along one axis did on average over the last step, N or N m on body B; 0 where there was no row.
struct JointAxisForces {
    float limit = 0, motor = 0, friction = 0;
};

// A spring from a place in the world to a point of a body, as a mouse drags it. Made of the translations of a six-dof
// joint, whose motors may be changed as such.
struct TargetJointSettings {
    BodyId body{};                       // dynamic
    Position anchor = Position::Zero();  // m, world: the point of the body, as it stands now
    Position target = Position::Zero();  // m, world
    SpringSettings spring = {.frequency = 5.0f, .dampingRatio = 1.0f};
    float maxForce = std::numeric_limits<float>::infinity();  // N, > 0, along each axis of the world
    bool collideConnected = true;
    uint64_t userData = 0;
};

class JointInterface {
public:
    explicit JointInterface(WorldState& world) : world_(world) {}

    // Settings: those of any kind in Joints/JointKinds.h. The bodies may be in any pose: what is out of place is pulled
    // together. Errors name the field: UnknownId (a body), Unsupported (the same body twice, no dynamic one),
    // NonFinite, NonPositive, Negative, OutOfRange, Unnormalized. Nothing is created then.
    template <class Settings>
    Result<JointId> Create(const Settings& settings);
    Result<JointId> CreateTarget(const TargetJointSettings& settings);
    // Moves A's anchor, of a joint whose body A is the world, to a place, m; the bodies wake, unless it is there
    // already. Errors also: Unsupported (body A is another), NonFinite, OutOfRange.
    Status SetTarget(JointId id, const Position& target);
    // Removing a body removes its joints. Error: UnknownId, as for all that follow.
    Status Remove(JointId id);
    bool Exists(JointId id) const;

    // A joint that is not enabled does nothing, and its bodies collide. Enables one that broke, too.
    Status SetEnabled(JointId id, bool enabled);
    bool IsEnabled(JointId id) const;
    // Limits, motor and friction of an axis. Errors also: Unsupported (the joint has nothing there), and those of
    // Create. Another target of a motor that runs already changes no row and allocates nothing.
    Status SetLimits(JointId id, JointAxis axis, const std::optional<JointLimits>& limits);
    Status SetMotor(JointId id, JointAxis axis, const JointMotor& motor);
    Status SetFriction(JointId id, JointAxis axis, float friction);
    // The orientation of frame B against frame A that position motors turn to. Errors also: NonFinite, Unnormalized.
    Status SetTargetOrientation(JointId id, const Quaternion& target);
    // More effort for the joint's island, see JointSettings; 0: the system's. Errors also: OutOfRange.
    Status SetEffort(JointId id, const SolverSettings& effort);
    // Other masses of the bodies for this joint, see JointSettings. Errors also: NonFinite, OutOfRange.
    Status SetMassOverride(JointId id, const MassOverride& massOverride);

    // Readers return zeros for an unknown id.
    const AxisControl* GetControl(JointId id, JointAxis axis) const;  // null: nothing there
    double GetCoordinate(JointId id, JointAxis axis) const;           // m or rad, see the joint's settings
    JointError GetError(JointId id) const;
    // What the joint, locks and rows together, did to body B on average over the last step: N and N m about B's anchor,
    // world axes. While it sleeps, what it carried when it fell asleep; disabled, nothing.
    Vector3 GetForce(JointId id) const;
    Vector3 GetTorque(JointId id) const;
    // The locks' part of it.
    Vector3 GetLockForce(JointId id) const;
    Vector3 GetLockTorque(JointId id) const;
    JointAxisForces GetAxisForces(JointId id, JointAxis axis) const;
    // The joint's frame as it moves with body A and with body B, world space.
    Pose GetFrameA(JointId id) const;
    Pose GetFrameB(JointId id) const;
    BodyId GetBodyA(JointId id) const;
    BodyId GetBodyB(JointId id) const;
    uint64_t GetUserData(JointId id) const;
    MassOverride GetMassOverride(JointId id) const;  // none for an unknown id
    // The kind of the joint, and what only its kind has; null for an unknown id. Valid until the joint is removed.
    const JointType* GetType(JointId id) const;

    // All joints, in the order of their indices; all joints of a body, the newest first.
    void Visit(FunctionRef<void(JointId)> visit) const;
    void VisitOf(BodyId body, FunctionRef<void(JointId)> visit) const;

private:
    Result<JointId> Add(const JointSettings& settings, std::unique_ptr<JointType> type);
    AxisControl* ControlOf(JointId id, JointAxis axis) const;
    template <class Change>
    Status ChangeControl(JointId id, JointAxis axis, Change&& change);

    WorldState& world_;
};

}  // namespace fulcrum
