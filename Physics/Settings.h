// What a user sets: the system, the solver, a body. Every default works; every field says its unit and range.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Math/Pose.h>
#include <Fulcrum/Physics/GroupFilter.h>

#include <array>
#include <cstdint>
#include <limits>

namespace fulcrum {

// Names a body. Ids of removed bodies are never valid again: an index is reused with another generation.
struct BodyId {
    uint32_t index = 0xFFFFFFFFu;
    uint32_t generation = 0;
    friend auto operator<=>(const BodyId&, const BodyId&) = default;
};

enum class MotionType : uint8_t {
    Static,     // never moves
    Kinematic,  // moves with the velocity that it is given, pushed by nothing
    Dynamic,    // moved by forces, contacts and joints
};

// How the coefficients of two touching bodies make one. Where their rules differ the later one in this list wins.
enum class CombineRule : uint8_t { GeometricMean, Average, Minimum, Multiply, Maximum };

struct Material {
    float friction = 0.5f;     // Coulomb coefficient, >= 0
    float restitution = 0.0f;  // 0 (no bounce) .. 1 (no loss)
    CombineRule frictionRule = CombineRule::GeometricMean;
    CombineRule restitutionRule = CombineRule::Maximum;
};

// Whether a body is cast along its path in steps in which it moves or turns by more than half its thickness, so that it
// passes through nothing however fast it is. It bounces where it hits, in the middle of the step.
enum class ContinuousCollision : uint8_t {
    Off,
    Linear,            // small turns within a step are left out of the cast; not of compounds
    LinearAndAngular,  // all are part of it
};

// Which bodies a sensor reports; combine with |.
enum class SensorSees : uint8_t {
    Nothing = 0,
    Dynamic = 1,
    Kinematic = 2,
    Static = 4,
    Sleeping = 8,  // dynamic ones that sleep, too; else they leave as they fall asleep
    Sensors = 16,  // other sensors, too, of the kinds of motion chosen
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
    Plane2D = 4 | 8 | 16,  // moves in the x-y plane, turns about z
};
constexpr LockedAxes operator|(LockedAxes a, LockedAxes b) {
    return static_cast<LockedAxes>(static_cast<uint8_t>(a) | static_cast<uint8_t>(b));
}

// How overlaps and gaps of joints are corrected. Docs/Accuracy.md says which suits which effort.
enum class PositionCorrection : uint8_t {
    SoftRelax,  // soft rows push in the velocity iterations; relaxing passes take the speed of the pushes out again
    Baumgarte,  // hard rows; position passes move the bodies and add no speed. Small gaps of joints
};

// The trade of speed for accuracy.
struct SolverSettings {
    int substeps = 4;            // 1..64; each integrates dt / substeps
    int velocityIterations = 1;  // 1..255 per substep
    int positionIterations = 1;  // 0..255 per substep: relaxing passes, or position passes
    PositionCorrection positionCorrection = PositionCorrection::SoftRelax;
    // Of Baumgarte: the part of an error that a position pass corrects, > 0, at most 1; and the overlap that it leaves,
    // m, 0..1000, so that what rests keeps its contacts: without any, walls creep sideways.
    float baumgarte = 0.2f;
    float baumgarteSlop = 0.001f;

    // Presets; errors fall with the square of the substeps. Docs/Accuracy.md says which structures stand with which.
    static constexpr SolverSettings Fast() { return {.substeps = 2}; }
    static constexpr SolverSettings Balanced() { return {}; }  // the default
    static constexpr SolverSettings Accurate() { return {.substeps = 16}; }
    static constexpr SolverSettings Reference() {  // structures obey statics within 3 %
        return {.substeps = 64, .velocityIterations = 4, .positionIterations = 4};
    }
    friend bool operator==(const SolverSettings&, const SolverSettings&) = default;
};

struct BodySettings {
    ShapePtr shape;
    MotionType motion = MotionType::Dynamic;
    Position position = Position::Zero();       // m, of the shape's own origin; 1e18 along an axis at most
    Quaternion rotation{};                      // unit within 1e-3; normalized exactly
    Vector3 linearVelocity = Vector3::Zero();   // m/s, of the center of mass; beyond 3e8 counts as that
    Vector3 angularVelocity = Vector3::Zero();  // rad/s, world axes; beyond 1e6 counts as that
    float density = 1000.0f;                    // kg/m3, > 0; used where mass is 0
    float mass = 0.0f;                          // kg, >= 0; 0: density times volume
    Vector3 inertia = Vector3::Zero();          // kg m2 about the shape's principal axes; zero: the shape's own
    Material material{};
    float linearDamping = 0.0f;   // 1/s, >= 0: v' = -damping v
    float angularDamping = 0.0f;  // 1/s, >= 0
    float gravityFactor = 1.0f;   // finite
    LockedAxes lockedAxes = LockedAxes::None;
    // Upper limits, which hold for dynamic and kinematic bodies whatever pushes them: of the velocity after a step, and
    // of the motion within one.
    float maxLinearSpeed = 1000.0f;  // m/s, > 0; more than 3e8 counts as that
    float maxAngularSpeed = 300.0f;  // rad/s, > 0; more than 1e6 counts as that
    bool gyroscopicTorque = true;    // conserve angular momentum of bodies whose inertia is not spherical
    bool allowSleep = true;
    bool startAsleep = false;  // dynamic bodies only
    uint8_t layer = 0;         // 0..31, see SystemSettings::layerCollides
    // Two bodies collide only if each has a bit of its category in the other's mask,
    uint64_t category = 1, mask = ~uint64_t(0);
    CollisionGroup group{};  // and only if the filter of a group that both are in lets them
    ContinuousCollision continuous = ContinuousCollision::Off;  // not for meshes, height fields and planes
    uint64_t userData = 0;
    bool reportsContacts = true;  // see EventSettings
    bool isSensor = false;        // touches nothing, and reports what is inside: PhysicsSystem::SensorEvents
    SensorSees sensorSees = SensorSees::Default;  // of those that layers, masks and groups let it meet
    bool sensorReportsStay = true;                // an event in each step for each body that stays inside
};

struct SleepSettings {
    bool enabled = true;
    float seconds = 0.5f;  // >= 0: an island whose bodies have all been slow for so long falls asleep
    // m/s, >= 0: slow is below this, at the farthest point of the body; of small bodies below one radius a second.
    float linearSpeed = 0.05f;
};

// Accuracy of resting contacts and of joints: islands get more substeps than the system's where these are too few
// (Docs/Step.md). Other islands do not cost more.
struct AccuracyTarget {
    // How deep bodies sink into each other at a contact, as a part of the smaller one's size (half an edge of a cube),
    // > 0; infinite: no island has more substeps. Slender islands, as columns are, get as many as keep them upright by
    // a margin of four at 0.004, in inverse proportion to this.
    float penetration = 0.004f;
    // m, > 0: how far apart the anchors of a joint may be along what it locks; infinite: no island has more substeps
    // for that. It follows what is measured, within some tenths of a second.
    float jointError = std::numeric_limits<float>::infinity();
    int mostSubsteps = 64;  // 1..64
    // Whether islands of 768 constraints and more get as many, too. If not, they get only what the weight of small
    // bodies in them asks for: few contacts of a large pile carry much, but all of it is solved with the same effort.
    bool largeIslands = false;
};

// What PhysicsSystem::Events lists. What is off costs nothing.
struct EventSettings {
    // Contacts that begin and end, and hits of continuous collision: of bodies of which one has
    // BodySettings::reportsContacts.
    bool contacts = false;
    bool stays = true;    // with them an event in each step for each contact that goes on
    bool bodies = false;  // which bodies are awake, moved, woke, fell asleep
};

struct SystemSettings {
    Vector3 gravity = Vector3(0, -9.81f, 0);  // m/s2, up to 1e6 along each axis
    SolverSettings solver{};
    AccuracyTarget accuracy{};
    SleepSettings sleep{};
    EventSettings events{};
    NarrowPhaseMethod narrowPhase = NarrowPhaseMethod::Automatic;
    // m, > 0, at most 1000: contact points are created at this separation, before bodies touch; of small shapes, at a
    // quarter of the smaller one's outer radius.
    float speculativeDistance = 0.02f;
    float penetrationSlop = 0.0f;  // m, >= 0: overlap that is left alone
    // Hz, > 0, of the spring that pushes overlaps apart. It is never stiffer than substeps resolve: at most
    // sqrt((velocityIterations + positionIterations) / 45) of their rate, by default a fifth. Infinite: as stiff as
    // that.
    float contactFrequency = std::numeric_limits<float>::infinity();
    float contactDampingRatio = 1.0f;  // 0..1e6
    float contactPushSpeed = 3.0f;     // m/s, > 0, at most 1e6: the fastest push
    // m/s, > 0, at most 1e6: the fastest that bodies which were created, placed or grown in each other are pushed
    // apart. They keep none of that velocity.
    float depenetrationSpeed = 0.5f;
    float jointFrequency =
        std::numeric_limits<float>::infinity();  // Hz, likewise, of the spring that pulls joints together
    float jointDampingRatio = 1.0f;              // 0..1e6
    // Joints that carry more than this times the mass of their own bodies are solved exactly, as trees, where they form
    // such; twice this where all masses are alike, as in a rope that carries nothing (Docs/Joints.md). > 0, infinite:
    // never.
    float exactJointLoad = 10.0f;
    // m/s and rad/s, > 0, at most 1e6: the fastest pull; from afar up to three times that (Docs/Joints.md).
    float jointPushSpeed = 20.0f;
    // m/s, >= 0: slower impacts do not bounce; between bodies that gravity does not press together, only those slower
    // than four substeps of gravity do not.
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
