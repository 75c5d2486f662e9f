// The first hit of a swept body. Called by the Continuous stage, for different bodies from any number of threads at
// once.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// A body that moved farther than this in a step, in m, is cast; also how far ahead the solver sees contacts of such
// bodies.
float FreeMotion(float innerRadius, float outerRadius);

// Pieces beside the center of mass change sides of a wall where the body turns, so that compounds are always cast with
// their turn.
bool IsCastTurning(const BodyStore& bodies, uint32_t body);

// How a body moves in this step, as far as is decided. Zero motion for one that rests.
Sweep SweepOf(const StepContext& step, const BodyStore& bodies, const SweepStore& sweeps, uint32_t body);

// The first hit of the sweep's rest that counts: of what it would overlap by more than a part of its thickness. What it
// only slides along, or touches and leaves, is left to the solver. False: none.
bool CastSweep(const CollisionView& view, const SweepStore& sweeps, const Sweep& sweep, WorkerFindings& findings,
               SweepHit& hit);
// The same against the other collider of a pair alone, for a body of one piece that is cast without its turn.
bool CastPair(const CollisionView& view, const SweepStore& sweeps, uint32_t collider, uint32_t other,
              WorkerFindings& findings, SweepHit& hit);

}  // namespace fulcrum
