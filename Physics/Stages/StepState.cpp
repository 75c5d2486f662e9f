#include <Fulcrum/Physics/Stages/StepState.h>

#include <Fulcrum/Physics/World/HeapBytes.h>

namespace fulcrum {

size_t HeapBytes(const WorkerFindings& findings) {
    const auto& [colliders, outsideFatBounds, pairs, deepPairs, putInto, deepOverlaps, crowdedOverlaps, surface,
                 surfacePlaces, surfaceLeft, surfaceTouched, more, newContacts, turnedNormals, deflections, sweepHits,
                 sensorCandidates, sensorVisits, sensorTests, eventPairs, libccd, contacts, points, kept, deepest,
                 deepestPair, clamped, frozen, firstFrozen, sleepCandidates, loadsChanged, strainsBegan, joints] =
        findings;
    return HeapBytes(colliders, outsideFatBounds, pairs, deepPairs, putInto, deepOverlaps, crowdedOverlaps, surface,
                     surfacePlaces, surfaceLeft, surfaceTouched, more, newContacts, turnedNormals, deflections,
                     sweepHits, sensorCandidates, sensorVisits, sensorTests, eventPairs, libccd, contacts, points, kept,
                     deepest, deepestPair, clamped, frozen, firstFrozen, sleepCandidates, loadsChanged, strainsBegan,
                     joints);
}

size_t HeapBytes(const PairUpdates& updates) {
    const auto& [found, activated, changes, moreManifolds, deflections, deflectedPairs, changesBefore,
                 hadManyNewContacts] = updates;
    return HeapBytes(found, activated, changes, moreManifolds, deflections, deflectedPairs, changesBefore,
                     hadManyNewContacts);
}

size_t HeapBytes(const CrowdState& crowd) {
    const auto& [deepOverlaps, dispersing, crowded, settling, settled] = crowd;
    return HeapBytes(deepOverlaps, dispersing, crowded, settling, settled);
}

size_t HeapBytes(const StepState& step) {
    const auto& [lastSubstepDt, stiffnessDt, report, findings, scratch, ofWorkers, pairs, crowd, began, seams, solver,
                 savedEfforts, sleepCandidates, sweeps, sensing, events, errors] = step;
    return HeapBytes(lastSubstepDt, stiffnessDt, report, findings, scratch, ofWorkers, pairs, crowd, began, seams,
                     solver, savedEfforts, sleepCandidates, sweeps, sensing, events, errors);
}

}  // namespace fulcrum
