// Solver state of a body: one cache line of 64 bytes, two rows of eight floats that are gathered into lanes. Masses are
// in a row of their own. Filled by Physics before the solve, read back after it.
#pragma once

#include <Fulcrum/Constraints/Parts/RowPlaces.h>
#include <Fulcrum/Math/Wide.h>

#include <cstdint>
#include <limits>

namespace fulcrum {

struct alignas(64) BodyState {
    // First row: the velocity.
    float linearVelocity[3] = {0, 0, 0};   // m/s, of the center of mass
    float angularVelocity[3] = {0, 0, 0};  // rad/s, world axes
    float spare = 0;
    float marks = 0;  // flags of the stages, not used by constraints
    // Second row: change of pose since the start of the step.
    float deltaPosition[3] = {0, 0, 0};  // m
    float deltaRotation[3] = {0, 0, 0};  // rad, rotation vector in world axes
    // sin(a / 2) / a and cos(a / 2) of the angle a = |deltaRotation|: the quaternion of the rotation is (deltaRotation
    // times the first, the second). Kept up to date for bodies with ball joints.
    float halfTurn[2] = {0.5f, 1};

    float* VelocityRow() { return linearVelocity; }
    float* PoseRow() { return deltaPosition; }
    const float* VelocityRow() const { return linearVelocity; }
    const float* PoseRow() const { return deltaPosition; }
    // Indices in both rows, in the first, and in the second.
    enum Places { kLinear = 0, kAngular = 3, kMarks = 7, kHalfTurn = 6 };
};
static_assert(sizeof(BodyState) == 64);
FULCRUM_CHECK_PLACE(BodyState, linearVelocity, 0, BodyState::kLinear);
FULCRUM_CHECK_PLACE(BodyState, angularVelocity, 0, BodyState::kAngular);
FULCRUM_CHECK_PLACE(BodyState, marks, 0, BodyState::kMarks);
FULCRUM_CHECK_PLACE(BodyState, deltaPosition, 1, BodyState::kLinear);
FULCRUM_CHECK_PLACE(BodyState, deltaRotation, 1, BodyState::kAngular);
FULCRUM_CHECK_PLACE(BodyState, halfTurn, 1, BodyState::kHalfTurn);

// Zero for static and kinematic bodies.
struct alignas(32) BodyMass {
    float inverseInertia[6] = {0, 0, 0, 0, 0, 0};  // xx yy zz xy xz yz, world axes, 1/(kg m2)
    float inverseMass = 0;                         // 1/kg
    float flags = 0;                               // the sum of these

    enum Flags {
        kTurns = 1,  // the inertia rotates with the body from substep to substep
        // Translation along x, y or z is locked: there is no mobility along it, whatever the inverse mass.
        kLockedX = 2,
        kLockedY = 4,
        kLockedZ = 8
    };

    const float* Row() const { return inverseInertia; }
    enum Places { kInverseInertia = 0, kInverseMass = 6, kFlags = 7 };
    SymmetricMatrix3 InverseInertia() const {
        const float* i = inverseInertia;
        return {i[0], i[1], i[2], i[3], i[4], i[5]};
    }
};
static_assert(sizeof(BodyMass) == 32);
FULCRUM_CHECK_PLACE(BodyMass, inverseInertia, 0, BodyMass::kInverseInertia);
FULCRUM_CHECK_PLACE(BodyMass, inverseMass, 0, BodyMass::kInverseMass);
FULCRUM_CHECK_PLACE(BodyMass, flags, 0, BodyMass::kFlags);

// Pose of the center frame at the start of the step, acceleration by gravity and forces, and the body's size.
struct alignas(64) BodyPose {
    float rotation[4] = {0, 0, 0, 1};   // x y z w
    float acceleration[3] = {0, 0, 0};  // m/s2
    uint32_t boundsChangedIn = 0;       // the last step in which its fat bounds changed: its pairs must be checked
    double position[3] = {0, 0, 0};     // m, of the center of mass
    // m, Shape::InnerRadius; infinite if it has none (surfaces, planes).
    float innerRadius = std::numeric_limits<float>::infinity();
    float spare = 0;

    const float* Row() const { return rotation; }
    enum Places { kRotation = 0, kAcceleration = 4, kNoFloat = 7 };
};
static_assert(sizeof(BodyPose) == 64);
FULCRUM_CHECK_PLACE(BodyPose, rotation, 0, BodyPose::kRotation);
FULCRUM_CHECK_PLACE(BodyPose, acceleration, 0, BodyPose::kAcceleration);
FULCRUM_CHECK_PLACE(BodyPose, boundsChangedIn, 0, BodyPose::kNoFloat);

// Linear and angular velocity, or linear and angular displacement; Real is float or lanes.
template <class Real>
struct Twist {
    Vec3<Real> linear = Vec3<Real>(Real(0.0f), Real(0.0f), Real(0.0f));
    Vec3<Real> angular = Vec3<Real>(Real(0.0f), Real(0.0f), Real(0.0f));
};

// Inverse mass and world inverse inertia.
template <class Real>
struct UniformInverseMass {
    Real mass = Real(0.0f);
    Sym3<Real> inertia;
};

// The same, with an inverse mass for each world axis: zero along locked translations.
template <class Real>
struct InverseMass {
    Vec3<Real> mass = Vec3<Real>(Real(0.0f), Real(0.0f), Real(0.0f));
    Sym3<Real> inertia;

    InverseMass() = default;
    InverseMass(const Real& uniform, const Sym3<Real>& itsInertia)
        : mass(uniform, uniform, uniform), inertia(itsInertia) {}
};

// Constraints refer to bodies by index into these arrays.
struct ConstSolverBodies {
    const BodyState* states;
    const BodyMass* masses;
    const BodyPose* poses;
};
struct SolverBodies {
    BodyState* states;
    const BodyMass* masses;
    const BodyPose* poses;
    operator ConstSolverBodies() const { return {states, masses, poses}; }
};

}  // namespace fulcrum
