// Water, wind and fields of force in regions of the world. A program creates a Fields, fills its lists, and calls Apply
// before each step. Uses only the public interfaces; one thread. Forces are computed at the bodies' present poses. For
// a body at rest they are the same in every step, so that it falls asleep and stays asleep while they are applied
// (BodyInterface::AddForce).
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>

#include <limits>
#include <vector>

namespace fulcrum {

// A box along the world's axes, by default everywhere. A body is inside where its center of mass is.
struct FieldRegion {
    Position lower = Position::Constant(-1e9), upper = Position::Constant(1e9);  // m
};

// Buoyancy: the weight of the displaced water; and drag.
struct Water {
    FieldRegion region{};  // high enough for bodies that float with their center above the surface
    // The surface is where up . x = level, below is water. The system's gravity counts along `up`.
    Vector3 up = Vector3(0, 1, 0);       // unit
    double level = 0;                    // m
    float density = 1000;                // kg/m3, >= 0
    Vector3 velocity = Vector3::Zero();  // m/s, of a current
    // 1/s, >= 0: the decay rate of a body's velocity relative to the water, and of its angular velocity, times the mass
    // of the displaced water over its own: v' = -drag v for a submerged body with the density of water.
    float drag = 1, angularDrag = 1;
};

// Moving air: a force of density / 2 c A |u| u at the center of each convex piece, u the wind relative to the piece, A
// its frontal area.
struct Wind {
    FieldRegion region{};
    Vector3 velocity = Vector3::Zero();  // m/s
    float density = 1.2f;                // kg/m3, >= 0
    float dragCoefficient = 1;           // c, >= 0: 0.5 of a ball, 1 of a cube, 2 of a long plate
};

struct ForceField {
    FieldRegion region{};
    Vector3 acceleration = Vector3::Zero();  // m/s2, the same everywhere
    // m/s2 at a place, on top of that; for planets, vortices and the like. A pure function of the position.
    Function<Vector3(const Position&)> accelerationAt{};
};

struct Fields {
    std::vector<Water> waters{};
    std::vector<Wind> winds{};
    std::vector<ForceField> forces{};
    std::vector<OverlapHit> found{};  // room for Apply

    // Adds the forces of a step of dt s, > 0, at most 1, to the dynamic bodies that the filter accepts. Drag never
    // reverses a velocity, however large it is. Errors, after which no force was added: NonFinite, NonPositive,
    // OutOfRange, Negative, Unnormalized, naming the field and its number. Allocates nothing once its lists have grown.
    Status Apply(PhysicsSystem& system, double dt, const QueryFilter& filter = {});
};

// The part of a body below a plane, for games with waves: pass the plane of the water surface at each body. The lift is
// the density of the water times the volume times gravity, at the center. Zero for an unknown id.
struct Lift {
    double volume = 0;                   // m3, submerged
    Position center = Position::Zero();  // m, world
};
Lift SubmergedVolume(const BodyInterface& bodies, BodyId id, const Vector3& up, double level);

}  // namespace fulcrum
