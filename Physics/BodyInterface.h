// Creates, removes, moves and reads bodies. Poses are those of the shape's own frame, in which the user described it.
//
// Changes may be made by any thread at any time: each waits until no other thread steps, changes or reads the world,
// and is seen by all of them as a whole. Getters of PhysicsSystem::Bodies() do not lock, and are as fast as reading an
// array: call them only while no other thread changes or steps the world. Those of PhysicsSystem::LockingBodies() lock
// the world for the call. While another thread steps, they return the state of the last step: most without waiting for
// the step to end, those of velocities, energy, momentum, IsAwake and IsFrozen after it.
#pragma once

#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Math/Matrix.h>
#include <Fulcrum/Physics/BodyBatch.h>
#include <Fulcrum/Physics/QueryTypes.h>
#include <Fulcrum/Physics/Settings.h>

#include <optional>
#include <span>

namespace fulcrum {

struct WorldState;

// An axis-aligned box in the world, m.
struct BodyBounds {
    Position lower = Position::Zero(), upper = Position::Zero();
};

// An explosion: pushes bodies away from a point, once.
struct RadialImpulse {
    enum class Falloff : uint8_t {
        Constant,  // the same impulse everywhere within the radius
        Linear,    // decreases linearly to zero at the radius
    };
    Position center = Position::Zero();  // m
    float radius = 1;                    // m, > 0
    float impulse = 0;                   // N s, finite: of a body at the center; negative attracts
    Falloff falloff = Falloff::Linear;
};

class BodyInterface {
public:
    explicit BodyInterface(WorldState& world, bool locks = false) : world_(world), locks_(locks) {}

    // Errors name the field: NonFinite, NonPositive, Negative, OutOfRange, Unnormalized, Unsupported (no shape; a
    // dynamic body asleep that is not dynamic). Nothing is created then.
    Result<BodyId> Create(const BodySettings& settings);
    // Creates all bodies of a batch and then all its joints, in its order: the same as one by one, in less time, since
    // they have been checked and memory is reserved for all of them at once. Errors, of joints to bodies that are not
    // in the batch: UnknownId, Unsupported (no body of the joint is dynamic; `make` gave no joint type), named as
    // `joints[2]: ...`. Nothing is created then.
    Result<BatchIds> Commit(const BodyBatch& batch);
    // Wakes bodies that touched it. Error: UnknownId.
    Status Remove(BodyId id);
    bool Exists(BodyId id) const;

    // Teleports the body; wakes it, the bodies that touched it and those that it touches now. Unfreezes a frozen body,
    // at rest. Before the next step, what joints hold to it alone follows, if it was moved far (Docs/Joints.md); bodies
    // that are moved, too, do not. A pose returned by GetPose is restored bit-exactly. Errors: UnknownId, NonFinite,
    // OutOfRange (beyond 1e18 m), Unnormalized.
    Status SetPose(BodyId id, const Position& position, const Quaternion& rotation);
    // Several bodies at once, each to its pose: joints between bodies whose relative poses do not change are not
    // disturbed, as in a ragdoll or vehicle that is moved as a whole. Velocities are kept. Errors also: OutOfRange (not
    // as many poses as bodies), Unsupported (a body is named twice). No body has moved then.
    Status SetPoses(std::span<const BodyId> ids, std::span<const Pose> poses);
    // Gives a kinematic body the velocity with which it reaches the pose after `dt` seconds (> 0), within its maximum
    // speeds: for the next step only, after which it rests unless this is called again. To keep it moving, use
    // SetVelocity. Errors also: Unsupported.
    Status MoveKinematic(BodyId id, const Position& position, const Quaternion& rotation, float dt);
    // m/s, rad/s; wakes the body. Steps clamp it to the body's speed limits. Errors: UnknownId, NonFinite, Unsupported
    // (static, frozen).
    Status SetVelocity(BodyId id, const Vector3& linear, const Vector3& angular);
    // Acts during the next step only: N at a world point, N m; wakes. A force that is the same, within 1 %, in every
    // step does not keep a body awake: the body falls asleep under it, and wakes when it changes or is no longer
    // applied. Zero has no effect, and putting a body to sleep discards its forces. However large the force is, the
    // body stays within its maximum speeds; if the sum of several is not finite, it is frozen. Errors: UnknownId,
    // NonFinite, OutOfRange (point), Unsupported (not dynamic, frozen).
    Status AddForce(BodyId id, const Vector3& force);
    Status AddForceAt(BodyId id, const Vector3& force, const Position& point);
    Status AddTorque(BodyId id, const Vector3& torque);
    // Changes the velocity at once: N s at the center of mass or a world point, N m s; wakes the body, unless zero.
    Status AddImpulse(BodyId id, const Vector3& impulse);
    Status AddImpulseAt(BodyId id, const Vector3& impulse, const Position& point);
    Status AddAngularImpulse(BodyId id, const Vector3& impulse);
    // Acts at once on the dynamic bodies that the filter sees and that are within the radius, at their point that is
    // closest to the center; wakes them. A body that contains the center is pushed at its center of mass. Returns how
    // many were pushed. Errors: NonFinite, NonPositive, OutOfRange.
    Result<uint32_t> AddRadialImpulse(const RadialImpulse& settings, const QueryFilter& filter = {});
    // Contacts begin again, joints remain; wakes the body and its neighbors. A body that is no longer dynamic keeps its
    // mass for when it is dynamic again; one that never was uses the mass of its settings. Static bodies lose their
    // velocities. Errors: UnknownId, OutOfRange, Unsupported (frozen; a dynamic body of a shape without volume).
    Status SetMotionType(BodyId id, MotionType motion);
    // kg, > 0; moments of inertia change in proportion. If the body is not dynamic, it takes effect when it becomes
    // dynamic. Errors: UnknownId, NonFinite, NonPositive, OutOfRange (no inverse), Unsupported (no volume).
    Status SetMass(BodyId id, float mass);
    // With the inertia tensor, kg m2, about the center of mass along the axes of the body's own frame; positive
    // definite.
    Status SetMass(BodyId id, float mass, const SymmetricMatrix3& inertia);
    Status SetMaterial(BodyId id, const Material& material);
    // 0..31. As SetCategoryAndMask.
    Status SetLayer(BodyId id, uint8_t layer);
    // What it collides with, see BodySettings. Contacts that are no longer allowed end; the body and those it touched
    // wake.
    Status SetCategoryAndMask(BodyId id, uint64_t category, uint64_t mask);
    Status SetGroup(BodyId id, const CollisionGroup& group);
    Status SetGravityFactor(BodyId id, float factor);
    // m/s2, up to 1e6 along each axis, in place of the system's; none: the system's again. The gravity factor applies
    // to both. Wakes.
    Status SetGravity(BodyId id, const std::optional<Vector3>& gravity);
    // As in BodySettings. Axes wake; damping and speeds do if they change.
    Status SetDamping(BodyId id, float linear, float angular);
    Status SetLockedAxes(BodyId id, LockedAxes axes);
    Status SetMaxSpeeds(BodyId id, float linear, float angular);
    Status SetGyroscopicTorque(BodyId id, bool isOn);
    Status SetUserData(BodyId id, uint64_t userData);
    Status SetAllowSleep(BodyId id, bool allowSleep);  // false wakes the body
    Status SetContinuous(BodyId id,
                         ContinuousCollision continuous);  // Errors also: OutOfRange, Unsupported (a surface or plane)
    // How deep it may sink, see BodySettings; 0: as the system's, infinite: any. Errors also: NonFinite (NaN),
    // Negative.
    Status SetPenetrationTarget(BodyId id, float target);
    // Whether its contacts are reported as events, see EventSettings. If not, contacts reported so far get an end event
    // in the next step in which the body is awake.
    Status SetReportsContacts(BodyId id, bool reportsContacts);
    // Makes it a sensor with default settings, or a solid body again. Errors also: Unsupported (continuous collision).
    Status SetSensor(BodyId id, bool isSensor);
    // Errors also: Unsupported (no sensor), OutOfRange. Bodies that it no longer sees get an end event in the next
    // step.
    Status SetSensorSees(BodyId id, SensorSees sees);
    Status SetSensorReportsStay(BodyId id, bool reportsStay);
    Status Wake(BodyId id);
    // Puts the body and the bodies connected to it by contacts and joints to sleep.
    Status Sleep(BodyId id);

    // Replaces the shape; the body's own frame stays in place. Mass and inertia are computed with the body's density,
    // or kept; the center of mass becomes that of the shape. Wakes the body and those near it. Errors: UnknownId,
    // Unsupported (null, no volume for a dynamic body, a surface or plane for one with continuous collision),
    // OutOfRange (mass or inertia not invertible).
    Status SetShape(BodyId id, const ShapePtr& shape, MassUpdate mass = MassUpdate::Update);

    // Edit the children of a body created from a MutableCompound. Each such body has a copy of its own, so several
    // bodies may be created from one compound. Positions are in the body's own frame, which stays in place when the
    // center of mass moves; material points keep their velocities. The other children keep their masses. Wakes the
    // body, the bodies that touched the child and those that it touches now. Mass and center of mass of static and
    // kinematic bodies do not change. Errors: those of MutableCompound, UnknownId, Unsupported (the shape is no mutable
    // compound), OutOfRange (mass or inertia not invertible). On error nothing has changed.
    Result<ChildId> AddChild(BodyId id, const CompoundShape::ChildSettings& child,
                             MassUpdate mass = MassUpdate::Update);
    Status SetChild(BodyId id, ChildId child, const CompoundShape::ChildSettings& settings,
                    MassUpdate mass = MassUpdate::Update);
    Status MoveChild(BodyId id, ChildId child, const Vector3& position, const Quaternion& rotation,
                     MassUpdate mass = MassUpdate::Update);
    Status RemoveChild(BodyId id, ChildId child, MassUpdate mass = MassUpdate::Update);
    // The body's current compound; later edits change it. Null if it has none.
    const MutableCompound* GetChildren(BodyId id) const;

    // Getters return zeros for an unknown id.
    Pose GetPose(BodyId id) const;
    Position GetCenterOfMass(BodyId id) const;
    Vector3 GetLinearVelocity(BodyId id) const;   // m/s, of the center of mass
    Vector3 GetAngularVelocity(BodyId id) const;  // rad/s, world axes
    Vector3 GetVelocityAt(BodyId id, const Position& point) const;
    float GetMass(BodyId id) const;  // kg; 0 for a body that is not dynamic
    // kg m2 about the center of mass, along the axes of the body's own frame; zero if it is not dynamic.
    SymmetricMatrix3 GetInertia(BodyId id) const;
    // Of the whole shape, at most 1e-6 too large near the first body of the world.
    BodyBounds GetBounds(BodyId id) const;
    Vector3 GetAngularMomentum(BodyId id) const;  // kg m2/s, about the center of mass, world axes
    double GetKineticEnergy(BodyId id) const;     // J
    MotionType GetMotionType(BodyId id) const;
    ContinuousCollision GetContinuous(BodyId id) const;
    ShapePtr GetShape(BodyId id) const;
    Material GetMaterial(BodyId id) const;
    uint8_t GetLayer(BodyId id) const;
    float GetGravityFactor(BodyId id) const;
    Vector3 GetGravity(BodyId id) const;  // m/s2, its own or the system's, without the factor
    float GetLinearDamping(BodyId id) const;
    float GetAngularDamping(BodyId id) const;
    LockedAxes GetLockedAxes(BodyId id) const;
    float GetMaxLinearSpeed(BodyId id) const;
    float GetMaxAngularSpeed(BodyId id) const;
    bool HasGyroscopicTorque(BodyId id) const;
    bool AllowsSleep(BodyId id) const;
    uint64_t GetCategory(BodyId id) const;
    uint64_t GetMask(BodyId id) const;
    CollisionGroup GetGroup(BodyId id) const;
    uint64_t GetUserData(BodyId id) const;
    float GetPenetrationTarget(BodyId id) const;
    bool ReportsContacts(BodyId id) const;
    bool IsSensor(BodyId id) const;
    SensorSees GetSensorSees(BodyId id) const;  // Nothing if it is no sensor
    bool SensorReportsStay(BodyId id) const;
    bool IsAwake(BodyId id) const;
    // Whether the body is frozen because its state was not finite: it stays at its last valid pose like a static body,
    // without velocity. SetPose unfreezes it.
    bool IsFrozen(BodyId id) const;

private:
    WorldState& world_;
    const bool locks_;  // whether getters lock the world
};

}  // namespace fulcrum
