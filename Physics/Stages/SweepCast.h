// The first hit of a swept body. Called by the Continuous stage, for different bodies from any number of threads at
// once.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// m: a body that moves farther than this in a step is cast; also the speculative distance of such bodies.
float FreeMotion(float innerRadius, float outerRadius);

// Whether casts include rotation. Compounds always do: their children away from the center of mass could change sides
// of a wall by rotation.
bool IsCastTurning(const BodyStore& bodies, uint32_t body);

// The current sweep of a body in this step. Zero motion if it rests.
Sweep SweepOf(const StepContext& step, const BodyStore& bodies, const SweepStore& sweeps, uint32_t body);

// The first hit of the rest of the sweep that counts: with an overlap of more than a fraction of its thickness. Sliding
// and light touches are left to the solver. Returns false if there is none.
bool CastSweep(const CollisionView& view, const SweepStore& sweeps, const Sweep& sweep, WorkerFindings& findings,
               SweepHit& hit);
// The same against only the other collider of a pair, for a body with one collider that is cast without rotation.
bool CastPair(const CollisionView& view, const SweepStore& sweeps, uint32_t collider, uint32_t other,
              WorkerFindings& findings, SweepHit& hit);

}  // namespace fulcrum
