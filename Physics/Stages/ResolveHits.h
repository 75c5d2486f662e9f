// What the hits of a round of casts make of the sweeps of the bodies. Called by the Continuous stage; serial but for
// the impacts.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/Waking.h>

namespace fulcrum {

// The place of a body's sweep in `swept`, where it comes to be when it is first asked for: as `known`, unless that is
// null. kNone for what neither is cast nor can move.
uint32_t PlaceOf(const StepContext& step, const BodyStore& bodies, SweepStore& sweeps, uint32_t body,
                 const Sweep* known = nullptr);

// Resolves SweepStore::hits, and notes in `next` whose sweep is to be cast again. isLast: in the last round whatever
// hits something stays there until the next step. What is hit wakes.
void ResolveHits(const StepContext& step, const SleepStores& stores, SweepStore& sweeps, bool isLast,
                 const StepWorkers& workers, StepReport& report);

}  // namespace fulcrum
