// Applies the hits of a round of casts to the sweeps of the bodies. Called by the Continuous stage; serial except for
// the impacts.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/Waking.h>

namespace fulcrum {

// The index of a body's sweep in `swept`; added at the first call, as `known` unless that is null. kNone for bodies
// that are neither cast nor movable.
uint32_t PlaceOf(const StepContext& step, const BodyStore& bodies, SweepStore& sweeps, uint32_t body,
                 const Sweep* known = nullptr);

// Resolves SweepStore::hits, and lists in `next` the sweeps to cast again. isLast: in the last round bodies with a hit
// stay there until the next step. Wakes bodies that are hit.
void ResolveHits(const StepContext& step, const SleepStores& stores, SweepStore& sweeps, bool isLast,
                 const StepWorkers& workers, StepReport& report);

}  // namespace fulcrum
