// What steps make of energy and momentum (StepErrors), where somebody asks for it. Called by Step.cpp and Solve; serial
// but for the notes of pushes, which Solve takes on the worker that moves the body.
#pragma once

#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/Stages/StepContext.h>
#include <Fulcrum/Physics/Stages/SweepStore.h>
#include <Fulcrum/Physics/StepReport.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/JointStore.h>

#include <span>

namespace fulcrum {

// How an island has changed in the step beyond what gravity and applied forces explain.
struct ErrorSums {
    Position momentum = Position::Zero(), angularMomentum = Position::Zero();  // N s, N m s
    double energy = 0;                                                         // J
};

// A body as the step found it.
struct ErrorStart {
    uint64_t step = 0;                                             // the one that this is of
    Position center = Position::Zero();                            // m
    Position momentum = Position::Zero(), own = Position::Zero();  // N s; N m s about its center
    double kinetic = 0;                                            // J
    Position force = Position::Zero(), torque = Position::Zero();  // N, N m that the user applies
    Position angularVelocity = Position::Zero();                   // rad/s
};

// A body as the last substep moved it: with these velocities (rad/s, m/s) to this place, and the most energy of a push.
struct PushNote {
    Vector3 linear = Vector3::Zero(), angular = Vector3::Zero();
    Vector3 displacement = Vector3::Zero(), turn = Vector3::Zero();  // m, rad, since the start of the step
    double energy = 0;                                               // J
};

struct ErrorMeter {
    struct Island {
        uint32_t mostGaining = ~0u, momentumBody = ~0u, angularMomentumBody = ~0u;
        double gain = 0, momentumChange = 0, angularMomentumChange = 0;  // of these bodies
        double mass = 0;                                                 // kg
        Position before = Position::Zero(), after = Position::Zero();    // center of mass times mass
        ErrorSums sums;
        bool isHeld = false, isDriven = false;
    };
    // By body; empty where nobody asks.
    Array<ErrorStart> starts;
    Array<PushNote> pushes;
    Array<uint32_t> parents;
    Array<Island> islands;  // by root
};

inline size_t HeapBytes(const ErrorMeter& meter) {
    const auto& [starts, pushes, parents, islands] = meter;
    return HeapBytes(starts, pushes, parents, islands);
}

// Before Solve: notes the awake bodies.
void BeginErrors(const StepContext& step, const BodyStore& bodies, ErrorMeter& meter);
// Once poses are integrated: how bodies were moved.
void NoteMoved(const BodyStore& bodies, std::span<const uint32_t> moved, std::span<PushNote> pushes);
// When a substep of h seconds has ended, before the next one changes velocities: the energy of pushes.
void NotePushes(const BodyStore& bodies, std::span<const uint32_t> moved, float h, std::span<PushNote> pushes);
// After all that moves bodies.
void EndErrors(const StepContext& step, const BodyStore& bodies, const JointStore& joints,
               const ConstraintColoring& coloring, const SweepStore& sweeps, ErrorMeter& meter, StepErrors& errors);

}  // namespace fulcrum
