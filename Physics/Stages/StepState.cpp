#include <Fulcrum/Physics/Stages/StepState.h>

#include <Fulcrum/Physics/World/HeapBytes.h>

namespace fulcrum {

size_t HeapBytes(const WorkerFindings& findings) {
    const auto& [colliders, outsideFatBounds, pairs, deepPairs, deepOverlaps, crowdedOverlaps, surface, surfacePlaces,
                 surfaceLeft, surfaceTouched, more, sweepHits, sensorCandidates, sensorVisits, sensorTests, libccd,
                 contacts, points, kept, deepest, deepestPair, clamped, frozen, firstFrozen, sleepCandidates, bounces,
                 joints] = findings;
    return HeapBytes(colliders, outsideFatBounds, pairs, deepPairs, deepOverlaps, crowdedOverlaps, surface,
                     surfacePlaces, surfaceLeft, surfaceTouched, more, sweepHits, sensorCandidates, sensorVisits,
                     sensorTests, libccd, contacts, points, kept, deepest, deepestPair, clamped, frozen, firstFrozen,
                     sleepCandidates, bounces, joints);
}

size_t HeapBytes(const StepState& step) {
    const auto& [dt, substepDt, impulseScale, lastSubstepDt, report, findings, scratch, newPairs, activated, changes,
                 moreManifolds, deepOverlaps, dispersing, crowded, began, seams, solver, bounces, broken,
                 sleepCandidates, sweeps, sensing] = step;
    return HeapBytes(dt, substepDt, impulseScale, lastSubstepDt, report, findings, scratch, newPairs, activated,
                     changes, moreManifolds, deepOverlaps, dispersing, crowded, began, seams, solver, bounces, broken,
                     sleepCandidates, sweeps, sensing);
}

}  // namespace fulcrum
