// All bodies, as arrays by index: data used by the same stages are adjacent. Indices of removed bodies are reused with
// another generation. Written by BodyInterface between steps and by the stages during one.
#pragma once

#include <Fulcrum/Constraints/Parts/BodyState.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Physics/World/IndexSet.h>

#include <cmath>
#include <memory>
#include <span>
#include <utility>

namespace fulcrum {

// Warm: read once per body and step. Principal inertia, damping, limits.
struct alignas(64) BodyDynamics {
    float inverseInertia[3] = {0, 0, 0};    // 1/(kg m2), principal axes
    float inverseMass = 0;                  // 1/kg
    float principalAxes[4] = {0, 0, 0, 1};  // x y z w: from the principal frame to the center frame
    float gravityFactor = 1;
    float linearDamping = 0, angularDamping = 0;    // 1/s
    float maxLinearSpeed = 0, maxAngularSpeed = 0;  // m/s, rad/s
    float slowSeconds = 0;                          // how long it has been slow enough to sleep
    float outerRadius = 0;                          // m
    MotionType motion = MotionType::Static;
    LockedAxes lockedAxes = LockedAxes::None;
    // Bits that steps write, and, in another byte, those that queries read meanwhile.
    bool awake : 1 = false;
    bool hasForce : 1 = false;  // BodyCold::force or torque is not zero
    bool frozen : 1 = false;
    bool dispersing : 1 = false;  // see Crowd.h
    uint8_t crowded : 2 = 0;      // level, see CrowdContacts.h; 0: it is not
    bool spherical : 1 = false;   // all principal moments are equal
    bool continuous : 1 = false;  // BodyCold::continuous is not Off
    bool : 0;
    bool gyroscopic : 1 = false;
    bool allowSleep : 1 = true;
    bool special : 1 = false;  // it has a BodyFilter, ask FiltersAllow; or gravity of its own, ask GravityOf
    uint8_t layer : 5 = 0;

    // Eight numbers each, for lanes.
    const float* InertiaRow() const { return inverseInertia; }
    const float* LimitsRow() const { return &gravityFactor; }
    // Places in the first row, and in the second.
    enum Places {
        kInverseInertia = 0,
        kInverseMass = 3,
        kPrincipalAxes = 4,
        kGravityFactor = 0,
        kLinearDamping = 1,
        kAngularDamping = 2,
        kMaxLinearSpeed = 3,
        kMaxAngularSpeed = 4,
        kOuterRadius = 6,
        kNoFloat = 7
    };

    // Sets the components of a velocity or displacement along locked axes to zero.
    void Lock(Vector3& linear, Vector3& angular) const {
        const unsigned locked = static_cast<unsigned>(lockedAxes);
        for (unsigned k = 0; k < 3; ++k) {
            if (locked >> k & 1) linear[k] = 0;
            if (locked >> (3 + k) & 1) angular[k] = 0;
        }
    }
    // Whether gyroscopic torque is significant at the angular velocity in rad/s.
    bool HasGyroscopicTorqueAt(const Vector3& w) const {
        return HasGyroscopicTorque() && LengthSquared(w) > kLeastGyroscopicSpeed * kLeastGyroscopicSpeed;
    }
    static constexpr float kLeastGyroscopicSpeed = 0.1f;  // rad/s
    bool HasGyroscopicTorque() const { return gyroscopic && !spherical && !LocksRotation(); }
    // Whether it rotates about two world axes, in which its inertia changes as it does (FreeRotation.h).
    bool RotatesAboutTwoAxes() const {
        const unsigned locked = LockedRotations();
        return gyroscopic && !spherical && (locked == 1 || locked == 2 || locked == 4);
    }
    unsigned LockedTranslations() const { return static_cast<unsigned>(lockedAxes) & 7u; }  // bits: x, y, z
    Vector3 AlongFreeTranslations(Vector3 v) const {
        Vector3 none = Vector3::Zero();
        Lock(v, none);
        return v;
    }
    unsigned LockedRotations() const { return static_cast<unsigned>(lockedAxes) >> 3; }  // bits: x, y, z
    bool LocksRotation() const { return LockedRotations() != 0; }
    Quaternion PrincipalAxes() const {
        return {principalAxes[0], principalAxes[1], principalAxes[2], principalAxes[3]};
    }
};
static_assert(sizeof(BodyDynamics) == 64);
FULCRUM_CHECK_PLACE(BodyDynamics, inverseInertia, 0, BodyDynamics::kInverseInertia);
FULCRUM_CHECK_PLACE(BodyDynamics, inverseMass, 0, BodyDynamics::kInverseMass);
FULCRUM_CHECK_PLACE(BodyDynamics, principalAxes, 0, BodyDynamics::kPrincipalAxes);
FULCRUM_CHECK_PLACE(BodyDynamics, gravityFactor, 1, BodyDynamics::kGravityFactor);
FULCRUM_CHECK_PLACE(BodyDynamics, linearDamping, 1, BodyDynamics::kLinearDamping);
FULCRUM_CHECK_PLACE(BodyDynamics, angularDamping, 1, BodyDynamics::kAngularDamping);
FULCRUM_CHECK_PLACE(BodyDynamics, maxLinearSpeed, 1, BodyDynamics::kMaxLinearSpeed);
FULCRUM_CHECK_PLACE(BodyDynamics, maxAngularSpeed, 1, BodyDynamics::kMaxAngularSpeed);
FULCRUM_CHECK_PLACE(BodyDynamics, outerRadius, 1, BodyDynamics::kOuterRadius);
FULCRUM_CHECK_PLACE(BodyDynamics, motion, 1, BodyDynamics::kNoFloat);

// kg m2/s about the center of mass, world axes, at the rotation and angular velocity (rad/s).
Vector3 AngularMomentum(const BodyDynamics& body, const Quaternion& rotation, const Vector3& angularVelocity);
// J, in double: for extreme bodies it overflows a float.
double RotationalEnergy(const BodyDynamics& body, const Quaternion& rotation, const Vector3& angularVelocity);
// Twice the kinetic energy, J, of a body that rotates at this angular velocity (rad/s, along the principal axes),
// summed in Real.
template <class Real>
Real TwiceRotationalEnergy(const BodyDynamics& body, const Vector3& w) {
    Real sum = 0;
    for (int k = 0; k < 3; ++k)
        sum += body.inverseInertia[k] > 0 ? Real{w[k]} * Real{w[k]} / Real{body.inverseInertia[k]} : Real{0};
    return sum;
}
// Sets the inverses of mass, kg, and principal moments of inertia, kg m2; principalAxes: rotation of the principal
// frame in the center frame.
void SetMass(BodyDynamics& body, const Quaternion& principalAxes, float mass, const Vector3& inertia);
// World inverse inertia of a body that locks rotations: the inverse of the block of the free axes. axes: the principal
// ones in world space.
SymmetricMatrix3 InverseOfFreeAxes(const BodyDynamics& body, const Matrix3& axes);
// The principal axes in world space.
inline Matrix3 AxesOf(const BodyDynamics& body, const Quaternion& rotation) {
    return ToMatrix(rotation * body.PrincipalAxes());
}
class MutableCompound;

// Data of bodies with editable children.
struct BodyChildren {
    FULCRUM_WORLD_MEMORY
    MutableCompound* compound = nullptr;  // the body's own: BodyCold::shape
    Vector3 origin = Vector3::Zero();     // origin of the children's frame in the center frame, m
    double massUnit = 0;                  // kg, mass per unit of the compound's RelativeMass
    uint32_t moreColliders = ~0u;         // index into ColliderStore::runs
};

// Collision filter of a body, if not the default.
struct BodyFilter {
    FULCRUM_WORLD_MEMORY
    uint64_t category = 1, mask = ~uint64_t(0);
    CollisionGroup group;
    bool IsDefault() const { return category == 1 && mask == ~uint64_t(0) && !group.filter; }
};

// The mass that a body gets when it becomes dynamic.
struct KeptMass {
    FULCRUM_WORLD_MEMORY
    float mass = 0;                     // kg
    Vector3 inertia = Vector3::Zero();  // kg m2, principal
    Quaternion principalAxes;           // from the principal frame to the center frame
};

// Force, N, and torque, N m, applied by the user in a step.
struct BodyPush {
    Vector3 force = Vector3::Zero(), torque = Vector3::Zero();
    bool IsZero() const { return force.isZero(0) && torque.isZero(0); }
};

// State of a kinematic body that moves for one step only.
enum class SingleMove : uint8_t {
    None,
    Next,  // in the next step
    Last,  // in the last one: it stops unless MoveKinematic is called again
};

// Cold: for the interface.
struct BodyCold {
    ShapePtr shape;
    uint64_t userData = 0;
    Material material;
    Vector3 force = Vector3::Zero(), torque = Vector3::Zero();  // of the next step
    float penetrationTarget = 0;                                // see BodySettings
    std::unique_ptr<BodyFilter> filter;                         // null: the default
    uint32_t firstCollider = 0, colliderCount = 0;
    std::unique_ptr<BodyChildren> children;  // if `shape` is a mutable compound
    uint32_t generation = 0;
    uint32_t awakePlace = 0;        // index into BodyStore::awake
    uint32_t sleepingIsland = ~0u;  // index into SleepingIslands
    ContinuousCollision continuous = ContinuousCollision::Off;
    SingleMove singleMove = SingleMove::None;
    uint8_t directMisses = 0;  // steps in which direct solutions of its island took long; see Stages/DirectIsland.h
    bool wasDirect = false;    // solved directly with its contacts since it woke
    std::unique_ptr<KeptMass> keptMass;  // null: that of a density of 1000 kg/m3
    BodyPush lastPush;                   // of the last step in which it was awake; see World/SteadyPushes.h
    Vector3 gravity = Vector3::Zero();   // m/s2, where hasGravity
    // As in BodyDynamics.
    bool placed : 1 = false;    // see BodyStore::MarkPlaced
    bool isSteady : 1 = false;  // lastPush was the same in the step before
    bool : 0;
    bool exists : 1 = false;
    bool removed : 1 = false;  // removed by the interface, its index not yet free
    bool isSensor : 1 = false;
    bool isWorld : 1 = false;     // it is BodyStore::worldBody
    bool hasGravity : 1 = false;  // of its own, in place of the system's

    uint32_t MoreColliders() const {
        return children ? children->moreColliders : ~0u;
    }  // index into ColliderStore::runs
};

size_t HeapBytes(const BodyCold& body);

// Unconstrained velocity, from which the next substep's warm start is computed.
struct alignas(32) UnconstrainedVelocity {
    float row[kRowFloats];  // same layout as the first row of BodyState
};

// The step reads positions rounded to multiples of this and keeps the remainder: relative positions are then
// bit-identical wherever the bodies are, up to 2^30 m, where the spacing of doubles exceeds it.
inline constexpr double kPositionGrid = 0x1p-23;  // m, 0.12 micrometers

// The nearest point of the grid. Beyond 2^29 m all doubles are on the grid.
inline Position OnGrid(const Position& position) {
    Position rounded;
    for (int k = 0; k < 3; ++k)
        rounded[k] = std::fabs(position[k]) < 0x1p29
                         ? std::floor(position[k] * (1 / kPositionGrid) + 0.5) * kPositionGrid
                         : position[k];
    return rounded;
}

// The exact position minus the one on the grid.
struct Remainder {
    Position value = Position::Zero();  // m
    bool isGiven = true;  // set by the user, whose positions are coarser far out: dropped when the body moves
};

// Mean velocities, m/s and rad/s, of a body that has been slow: of its last moments and of somewhat longer, from which
// follows whether it still accelerates (Stages/Stillness.h). Of bodies with BodyDynamics::slowSeconds alone.
struct SlowMotion {
    struct Mean {
        Vector3 linear = Vector3::Zero(), angular = Vector3::Zero();
    };
    Mean lately, before;
};

class BodyStore {
public:
    static constexpr uint32_t kNone = ~0u;
    // By index; all of the same size.
    Array<BodyState> states;
    Array<BodyMass> masses;
    Array<BodyPose> poses;
    Array<UnconstrainedVelocity> unconstrained;
    Array<BodyDynamics> dynamics;
    Array<BodyCold> cold;
    Array<Remainder> remainders;
    Array<SlowMotion> slowMotions;

    Array<uint32_t> placed;        // see MarkPlaced, in no order
    Array<uint32_t> awake;         // dynamic bodies awake and kinematic ones that move, in no order
    uint32_t worldBody = kNone;    // the static one that stands for the world in joints, see JointInterface.cpp
    uint32_t continuousCount = 0;  // bodies with continuous collision
    uint32_t targetCount = 0;      // bodies with a penetrationTarget
    IndexSet reportsContacts;      // bodies of BodySettings::reportsContacts
    IndexSet pushed;               // bodies that have a force or torque, or had one in the last step
    IndexSet singleMoves;          // bodies with a SingleMove
    IndexSet editable;             // bodies whose shape may be edited in place, see ShapeEdits.h
    // For events, if enabled: bodies created, woken or fallen asleep since the last step; with duplicates, unordered.
    Array<uint32_t> sleepChanges;
    bool notesSleepChanges = false;

    uint32_t Size() const { return static_cast<uint32_t>(cold.size()); }  // of the arrays
    uint32_t Count() const { return count_; }                             // of the bodies
    // For so many more bodies, and for the lists of those that wake or fall asleep, once each, and of `placed` that are
    // placed: until then none of these asks for memory.
    void Reserve(size_t more, size_t placed);
    uint32_t Allocate();        // an index with default values; exists is set
    void Free(uint32_t index);  // after Remove: the index may be reused
    // Whether the id is that of an existing body; then id.index is its index. The body of the world has none: its index
    // and generation may be those of an id that was given out before a snapshot was restored.
    bool Find(BodyId id) const {
        return id.index < cold.size() && cold[id.index].exists && cold[id.index].generation == id.generation &&
               !cold[id.index].isWorld;
    }
    BodyId IdOf(uint32_t index) const { return {index, cold[index].generation}; }
    void SetPenetrationTarget(uint32_t index, float target) {
        targetCount += (target > 0) - (cold[index].penetrationTarget > 0);
        cold[index].penetrationTarget = target;
    }
    const BodyFilter& FilterOf(uint32_t index) const {
        static const BodyFilter kDefault;
        return cold[index].filter ? *cold[index].filter : kDefault;
    }
    static std::unique_ptr<BodyFilter> MakeFilter(const BodyFilter& filter) {
        return filter.IsDefault() ? nullptr : std::make_unique<BodyFilter>(filter);
    }
    void SetFilter(uint32_t index, std::unique_ptr<BodyFilter> filter) {
        cold[index].filter = std::move(filter);
        UpdateSpecial(index);
    }

    void UpdateSpecial(uint32_t index) { dynamics[index].special = cold[index].filter || cold[index].hasGravity; }

    // Whether constraints move it.
    bool CanMove(uint32_t index) const {
        return dynamics[index].motion == MotionType::Dynamic && !dynamics[index].frozen;
    }
    void MarkAwake(uint32_t index);
    // Called for a body that was created, or got another pose, shape or filter: its overlaps in the next step, or in
    // the one in which it wakes, count as placed by the user (Stages/CrowdContacts.h).
    void MarkPlaced(uint32_t index);
    void ForgetPlaced();
    void UnmarkPlaced(uint32_t index);  // the body is not dynamic any more
    void CountPlacedAsleep();           // after a snapshot was read
    void MarkAsleep(uint32_t index);

    // Sets them from its shape.
    void SetRadii(uint32_t index, const Shape& shape) {
        dynamics[index].outerRadius = shape.OuterRadius();
        const float inner = shape.InnerRadius();
        poses[index].innerRadius = inner > 0 ? inner : std::numeric_limits<float>::infinity();
    }

    Quaternion RotationOf(uint32_t index) const {
        const float* r = poses[index].rotation;
        return {r[0], r[1], r[2], r[3]};
    }
    // On the grid.
    Position CenterOf(uint32_t index) const {
        const double* p = poses[index].position;
        return Position(p[0], p[1], p[2]);
    }
    Pose CenterPoseOf(uint32_t index) const { return {CenterOf(index), RotationOf(index)}; }
    Pose ExactCenterPoseOf(uint32_t index) const { return {ExactCenterOf(index), RotationOf(index)}; }
    Position ExactCenterOf(uint32_t index) const { return CenterOf(index) + remainders[index].value; }
    void SetCenterPose(uint32_t index, const Pose& pose);
    // Moves the center by a displacement, m, and sets the rotation.
    void MoveCenter(uint32_t index, const Vector3& displacement, const Quaternion& rotation);
    Vector3 LinearVelocityOf(uint32_t index) const {
        const float* v = states[index].linearVelocity;
        return Vector3(v[0], v[1], v[2]);
    }
    Vector3 AngularVelocityOf(uint32_t index) const {
        const float* w = states[index].angularVelocity;
        return Vector3(w[0], w[1], w[2]);
    }
    void SetVelocity(uint32_t index, const Vector3& linear, const Vector3& angular) {
        BodyState& s = states[index];
        for (int k = 0; k < 3; ++k) {
            s.linearVelocity[k] = linear[k];
            s.angularVelocity[k] = angular[k];
        }
    }
    // m/s2, without the body's factor; `gravity`: the system's.
    Vector3 GravityOf(uint32_t index, const Vector3& gravity) const {
        return dynamics[index].special && cold[index].hasGravity ? cold[index].gravity : gravity;
    }
    void ForgetForces(uint32_t index) {
        if (!dynamics[index].hasForce) return;
        cold[index].force = cold[index].torque = Vector3::Zero();
        dynamics[index].hasForce = false;
    }
    // Updates the world inverse inertia of `masses` from the rotation.
    void UpdateInertia(uint32_t index) { masses[index] = MassAlong(index, AxesOf(dynamics[index], RotationOf(index))); }
    // Mass and world inertia for the given principal axes in world space.
    BodyMass MassAlong(uint32_t index, const Matrix3& axes) const;
    SolverBodies ForSolver() { return {states.data(), masses.data(), poses.data()}; }
    ConstSolverBodies ForSolver() const { return {states.data(), masses.data(), poses.data()}; }
    friend size_t HeapBytes(const BodyStore& store);

private:
    friend struct SnapshotAccess;
    Array<uint32_t> free_;
    uint32_t count_ = 0;
    uint32_t placedAsleep_ = 0;  // bodies that will be in `placed` again when they wake
};

}  // namespace fulcrum
