// Water, wind and fields of force in regions of the world. A program has a Fields of its own, fills its lists, and
// calls Apply before each step. Uses the public interfaces alone; one thread. Forces are those of where bodies are
// then, and what they do to a body that rests stays the same: it falls asleep, and sleeps on while they are applied
// (BodyInterface::AddForce).
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>

#include <functional>
#include <limits>
#include <vector>

namespace fulcrum {

// A box along the world's axes, by default everywhere. A body is inside where its center of mass is.
struct FieldRegion {
    Position lower = Position::Constant(-1e9), upper = Position::Constant(1e9);  // m
};

// Lifts what is below its surface by the weight of the water that it displaces, and slows it down.
struct Water {
    FieldRegion region{};  // high enough for what swims with its center above the surface
    // The surface is where up . x = level, below is water. The system's gravity counts along `up`.
    Vector3 up = Vector3(0, 1, 0);       // unit
    double level = 0;                    // m
    float density = 1000;                // kg/m3, >= 0
    Vector3 velocity = Vector3::Zero();  // m/s, of a current
    // 1/s, >= 0: a body loses its velocity against the water, and its angular velocity, at this rate times the mass of
    // the water that it displaces over its own. v' = -drag v where it has the density of water and is all below.
    float drag = 1, angularDrag = 1;
};

// Air that moves: a force of density / 2 c A |u| u at the center of each convex piece, u the wind seen from the piece,
// A the area that it shows to the wind.
struct Wind {
    FieldRegion region{};
    Vector3 velocity = Vector3::Zero();  // m/s
    float density = 1.2f;                // kg/m3, >= 0
    float dragCoefficient = 1;           // c, >= 0: 0.5 of a ball, 1 of a cube, 2 of a long plate
};

struct ForceField {
    FieldRegion region{};
    Vector3 acceleration = Vector3::Zero();  // m/s2, the same everywhere
    // m/s2 at a place, on top of that; for planets, whirls and the like. A pure function of the place.
    std::function<Vector3(const Position&)> accelerationAt{};
};

struct Fields {
    std::vector<Water> waters{};
    std::vector<Wind> winds{};
    std::vector<ForceField> forces{};
    std::vector<OverlapHit> found{};  // room for Apply

    // Adds what acts on the dynamic bodies that the filter sees for a step of dt s, > 0, at most 1. Drag never turns a
    // velocity round, however large it is. Errors, after which no force was added: NonFinite, NonPositive, OutOfRange,
    // Negative, Unnormalized, naming the field and its number. Allocates nothing once its lists have grown.
    Status Apply(PhysicsSystem& system, double dt, const QueryFilter& filter = {});
};

// What of a body is below a plane, for games that have waves of their own: of each body, with the plane that its piece
// of water is. The lift is the density of the water times the volume times gravity, at the center. Zero for an unknown
// id.
struct Lift {
    double volume = 0;                   // m3, submerged
    Position center = Position::Zero();  // m, world
};
Lift SubmergedVolume(const BodyInterface& bodies, BodyId id, const Vector3& up, double level);

}  // namespace fulcrum
