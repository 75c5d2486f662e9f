// Settings of the system, the solver and bodies. All defaults work; every field states its unit and range.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Math/Pose.h>
#include <Fulcrum/Physics/GroupFilter.h>

#include <array>
#include <cstdint>
#include <limits>

namespace fulcrum {

// Identifies a body. Ids of removed bodies never become valid again: an index is reused with another generation.
struct BodyId {
    uint32_t index = 0xFFFFFFFFu;
    uint32_t generation = 0;
    friend auto operator<=>(const BodyId&, const BodyId&) = default;
};

enum class MotionType : uint8_t {
    Static,     // never moves
    Kinematic,  // moves with the velocity set by the user, not affected by forces or contacts
    Dynamic,    // moved by forces, contacts and joints
};

// How the coefficients of two touching bodies are combined. If their rules differ, the later one in this list is used.
enum class CombineRule : uint8_t { GeometricMean, Average, Minimum, Multiply, Maximum };

struct Material {
    float friction = 0.5f;     // Coulomb coefficient, >= 0, at most 1e6
    float restitution = 0.0f;  // 0 (no bounce) .. 1 (no loss)
    CombineRule frictionRule = CombineRule::GeometricMean;
    CombineRule restitutionRule = CombineRule::Maximum;
};

// Continuous collision: whether a body is cast along its path in steps in which it moves or rotates by more than half
// its thickness, so that it cannot tunnel at any speed. A hit is resolved at its time within the step.
enum class ContinuousCollision : uint8_t {
    Off,
    Linear,            // small rotations within a step are ignored by the cast; not for compounds
    LinearAndAngular,  // all rotations are part of the cast
};

// Which bodies a sensor reports; combine with |.
enum class SensorSees : uint8_t {
    Nothing = 0,
    Dynamic = 1,
    Kinematic = 2,
    Static = 4,
    Sleeping = 8,  // sleeping dynamic bodies, too; else they leave when they fall asleep
    Sensors = 16,  // other sensors, too, of the selected motion types
    Default = Dynamic | Kinematic | Sleeping,
    All = 31,
};
constexpr SensorSees operator|(SensorSees a, SensorSees b) {
    return static_cast<SensorSees>(static_cast<uint8_t>(a) | static_cast<uint8_t>(b));
}
constexpr bool operator&(SensorSees a, SensorSees b) {
    return (static_cast<uint8_t>(a) & static_cast<uint8_t>(b)) != 0;
}

// Degrees of freedom in world axes; combine with |.
enum class LockedAxes : uint8_t {
    None = 0,
    TranslationX = 1,
    TranslationY = 2,
    TranslationZ = 4,
    RotationX = 8,
    RotationY = 16,
    RotationZ = 32,
    Rotation = 8 | 16 | 32,
    Plane2D = 4 | 8 | 16,  // moves in the x-y plane, rotates about z
};
constexpr LockedAxes operator|(LockedAxes a, LockedAxes b) {
    return static_cast<LockedAxes>(static_cast<uint8_t>(a) | static_cast<uint8_t>(b));
}

// How contact overlaps are corrected where there are no joints. With joints, their errors and the overlaps of what they
// connect are always corrected in the poses. Docs/Accuracy.md says which suits which effort.
enum class PositionCorrection : uint8_t {
    SoftRelax,  // soft rows in the velocity iterations; relax iterations remove the correction velocity
    Baumgarte,  // hard rows; position iterations correct poses and add no velocity
};

// Solver effort: trades speed for accuracy.
struct SolverSettings {
    int substeps = 4;  // 1..255; each integrates dt / substeps
    // 1..255 per substep. Of several the first half solves impacts with friction, and the second separates overlaps.
    int velocityIterations = 1;
    int positionIterations = 1;  // 0..255 per substep: relax iterations (SoftRelax) or position iterations (Baumgarte)
    PositionCorrection positionCorrection = PositionCorrection::SoftRelax;
    // For Baumgarte, and for all with joints: fraction of the error that a position iteration corrects, > 0, at most 1;
    // and the overlap that it leaves, m, 0..1000, so that resting contacts persist: without any, walls creep sideways.
    float baumgarte = 0.2f;
    float baumgarteSlop = 0.001f;

    // Presets; errors decrease with the square of the substeps. Docs/Accuracy.md says which structures are stable with
    // which.
    static constexpr SolverSettings Fast() { return {.substeps = 2}; }
    static constexpr SolverSettings Balanced() { return {}; }  // the default
    static constexpr SolverSettings Accurate() { return {.substeps = 16}; }
    static constexpr SolverSettings Reference() {  // contact forces of structures match statics within 3 %
        return {.substeps = 128};
    }
    friend bool operator==(const SolverSettings&, const SolverSettings&) = default;
};

struct BodySettings {
    static constexpr float kUsualDensity = 1000.0f;  // kg/m3, of water
    ShapePtr shape;
    MotionType motion = MotionType::Dynamic;
    Position position = Position::Zero();       // m, of the shape's own origin; at most 1e18 per axis
    Quaternion rotation{};                      // unit within 1e-3; normalized exactly
    Vector3 linearVelocity = Vector3::Zero();   // m/s, of the center of mass; clamped to 3e8
    Vector3 angularVelocity = Vector3::Zero();  // rad/s, world axes; clamped to 1e6
    float density = kUsualDensity;              // kg/m3, > 0; used if mass is 0
    float mass = 0.0f;                          // kg, >= 0; 0: density times volume
    Vector3 inertia = Vector3::Zero();          // kg m2 about the shape's principal axes; zero: the shape's own
    Material material{};
    float linearDamping = 0.0f;   // 1/s, >= 0: v' = -damping v
    float angularDamping = 0.0f;  // 1/s, >= 0
    float gravityFactor = 1.0f;   // finite
    LockedAxes lockedAxes = LockedAxes::None;
    // Speed limits of dynamic and kinematic bodies: for the velocity after a step, and for the motion within it.
    float maxLinearSpeed = 1000.0f;  // m/s, > 0; clamped to 3e8
    float maxAngularSpeed = 300.0f;  // rad/s, > 0; clamped to 1e6
    bool gyroscopicTorque = true;    // conserves angular momentum of bodies with non-spherical inertia
    bool allowSleep = true;
    bool startAsleep = false;  // dynamic bodies only
    uint8_t layer = 0;         // 0..31, see SystemSettings::layerCollides
    // Two bodies collide only if each has a bit of its category in the other's mask,
    uint64_t category = 1, mask = ~uint64_t(0);
    CollisionGroup group{};  // and only if the filter of their common group, if any, allows it
    ContinuousCollision continuous = ContinuousCollision::Off;  // not for meshes, height fields and planes
    uint64_t userData = 0;
    // In place of AccuracyTarget::penetration for the contacts of this body, > 0; 0: as that, infinite: any
    // penetration. Of two bodies that have one the lesser counts.
    float penetrationTarget = 0;
    bool reportsContacts = true;                  // see EventSettings
    bool isSensor = false;                        // no contacts; reports bodies inside: PhysicsSystem::SensorEvents
    SensorSees sensorSees = SensorSees::Default;  // among those that layers, masks and groups allow
    bool sensorReportsStay = true;                // an event in each step for each body that stays inside
};

struct SleepSettings {
    bool enabled = true;
    // >= 0: an island whose bodies have all been slow for this long falls asleep, unless one of them accelerates,
    // drifts or is driven, however slowly (Docs/Architecture.md, Sleep).
    float seconds = 0.5f;
    // m/s, >= 0: a body is slow if its fastest point is below this; small bodies below one radius per second. In
    // uniform motion it must be below a fifth of it, among bodies that touch below two fifths.
    float linearSpeed = 0.05f;
};

// Target accuracy of resting contacts and of joints: islands that would miss it are solved directly, where that costs
// little (Docs/Step.md). Other islands do not cost more. Bodies and joints may have targets of their own
// (BodySettings::penetrationTarget, JointSettings::errorTarget).
struct AccuracyTarget {
    // Allowed penetration at a contact with the settings' effort, as a fraction of the smaller body's size (half an
    // edge of a cube), > 0; infinite: no island is solved directly for that. Slender islands, such as columns, count as
    // if they sank by more, so that they stand with a safety factor of four at 0.004, in inverse proportion to this;
    // walls of 768 constraints and more get more substeps.
    float penetration = 0.004f;
    // m, > 0: allowed distance of a joint's anchors along locked directions; infinite: any. By the measured error: a
    // mechanism with a joint beyond it for eight steps is solved directly from then on, until it sleeps.
    float jointError = std::numeric_limits<float>::infinity();
};

// Selects the events of PhysicsSystem::Events. Events that are off cost nothing.
struct EventSettings {
    // Contacts that begin and end, and hits of continuous collision, if one of the bodies has
    // BodySettings::reportsContacts.
    bool contacts = false;
    bool stays = true;    // additionally an event per step for each persisting contact
    bool bodies = false;  // bodies that are awake, moved, woke up, fell asleep
};

struct SystemSettings {
    Vector3 gravity = Vector3(0, -9.81f, 0);  // m/s2, up to 1e6 along each axis
    SolverSettings solver{};
    AccuracyTarget accuracy{};
    SleepSettings sleep{};
    EventSettings events{};
    bool measuresErrors = false;  // StepReport::errors; costs nothing where it is off, and changes no result
    NarrowPhaseMethod narrowPhase = NarrowPhaseMethod::Automatic;
    // m, > 0, at most 1000: separation below which contact points are created before bodies touch; for small shapes a
    // quarter of the smaller outer radius.
    float speculativeDistance = 0.02f;
    float penetrationSlop = 0.0f;  // m, >= 0: overlap that is not corrected
    // Hz, > 0: frequency of the soft contact. Limited to what substeps can resolve: sqrt((velocityIterations +
    // positionIterations) / 45) of the substep rate, by default a fifth. Infinite: that limit.
    float contactFrequency = std::numeric_limits<float>::infinity();
    float contactDampingRatio = 1.0f;  // 0..1e6
    float contactPushSpeed = 3.0f;     // m/s, > 0, at most 1e6: largest recovery speed of overlaps
    // m/s, > 0, at most 1e6: largest speed at which bodies that were created, placed or grown inside each other are
    // separated. They keep none of that velocity.
    float depenetrationSpeed = 0.5f;
    // The joints of islands that carry more than this multiple of their own bodies' mass are solved directly; twice
    // this if all masses are alike, as in an unloaded rope; so are closed loops where nothing touches, joints of which
    // a motor drives one at its stops, and long levers of which a joint has been torn a little (Docs/Joints.md). > 0,
    // infinite: never.
    float exactJointLoad = 10.0f;
    // m/s and rad/s, > 0, at most 1e6: largest correction speed of joints, in the poses.
    float jointPushSpeed = 20.0f;
    // m/s, >= 0: restitution threshold, slower impacts do not bounce. Between bodies that gravity does not press
    // together the threshold is at most the speed gained in four substeps of gravity.
    float restitutionSpeed = 0.5f;
    float boundsMargin = 0.05f;  // m, > 0: fat bounds exceed the shape's by this, or a quarter of its outer radius
    // Bit j of layerCollides[i]: bodies of layer i and j collide. Must be symmetric.
    std::array<uint32_t, 32> layerCollides = AllLayers();

    static constexpr std::array<uint32_t, 32> AllLayers() {
        std::array<uint32_t, 32> all{};
        for (uint32_t& mask : all) mask = 0xFFFFFFFFu;
        return all;
    }
};

}  // namespace fulcrum
