// A world in one line for tests of the physics, and the shapes to fill it with. One thread at a time.
#pragma once

#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/PhysicsSystem.h>

#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <span>
#include <vector>

namespace fulcrum::testing {

inline constexpr double kGravity = 9.81;     // m/s2, the default
inline constexpr double kStep = 1.0 / 60.0;  // s
inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kDegree = kPi / 180;

ShapePtr SphereOf(float radius);
ShapePtr BoxOf(float halfX, float halfY, float halfZ);
inline ShapePtr CubeOf(float half) { return BoxOf(half, half, half); }
ShapePtr CapsuleOf(float halfHeight, float radius);
ShapePtr HullOf(std::initializer_list<Vector3> points);
ShapePtr CompoundOf(std::initializer_list<Compound::ChildSettings> children);

class TestWorld {
public:
    explicit TestWorld(const SystemSettings& settings = {}, uint32_t threads = 1);

    PhysicsSystem& System() { return *system_; }
    BodyInterface& Bodies() { return system_->Bodies(); }
    const StepReport& Report() const { return system_->Report(); }

    // Fails the test where the settings are wrong.
    BodyId Add(const BodySettings& settings);
    // Static box of 200 m x 200 m, its top at y = 0 above `origin`.
    BodyId AddFloor(const Material& material = {}, const Position& origin = Position::Zero());

    // Fails the test where Update does.
    void Step(double dt = kStep);
    void Steps(int count, double dt = kStep);
    void Run(double seconds, double dt = kStep);  // rounded to whole steps

    Position PositionOf(BodyId id) { return Bodies().GetPose(id).position; }
    Vector3 VelocityOf(BodyId id) { return Bodies().GetLinearVelocity(id); }

    // Sum over the points of all contacts between two bodies, N s of the last substep, and that as a force.
    double ImpulseBetween(BodyId a, BodyId b);
    double ForceBetween(BodyId a, BodyId b, double dt = kStep);
    // Whether all poses and velocities are finite and no body is frozen.
    bool AllFinite();

private:
    std::unique_ptr<ThreadPool> jobs_;
    std::unique_ptr<PhysicsSystem> system_;
};

// Settings in which nothing falls, and in which nothing sleeps.
SystemSettings NoGravity();
SystemSettings NoSleep();

// Position, rotation and velocities of a body as bits: equal only where nothing at all changed.
struct BodyBits {
    double position[3];
    float rotation[4], linear[3], angular[3];
    friend bool operator==(const BodyBits&, const BodyBits&) = default;
};
BodyBits BitsOf(TestWorld& world, BodyId id);

}  // namespace fulcrum::testing
