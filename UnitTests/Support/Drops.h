// Random rods, plates, boxes and hulls that fall onto something or onto each other, and their energy, which only falls,
// since nothing drives them. Of the public interface alone. One thread.
#pragma once

#include <Fulcrum/Physics/PhysicsSystem.h>

#include <string>

namespace fulcrum::testing {

enum class DropGround { Floor, Mesh, Hills, Air };

// One kind of drops.
struct DropSettings {
    DropGround ground = DropGround::Floor;
    int together = 1;  // bodies that are dropped onto each other
    ContinuousCollision kind = ContinuousCollision::Off;
    float restitution = 0, friction = 0.6f;
    int substeps = 4;
    double dt = 1.0 / 60;  // s
};

// A mesh of 80 m by 80 m about the origin, its cells 2 m; of its corners every fifth or so stands up by `height`
// meters.
ShapePtr HillyGround(float height);

// "Floor, 1 of Linear, restitution 0.5, ...".
std::string NameOf(const DropSettings& settings);

// The largest energy of the dropped groups, relative to each one's initial energy; potential energy counts from the
// ground.
struct DropEnergy {
    double most = 0;           // at any time
    double gain = 0;           // above the least before
    uint32_t drop = 0;         // which of them has the most,
    uint32_t step = 0;         // and when
    uint32_t gainingDrop = 0;  // which gains the most
    bool finite = true;
};

// Drops as many groups as `drops`, each of its own random numbers `first`, `first` + 1, ...; for `seconds` each.
DropEnergy EnergyOfDrops(const DropSettings& settings, uint32_t first, uint32_t drops, double seconds = 3);

}  // namespace fulcrum::testing
