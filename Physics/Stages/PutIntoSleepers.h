// Bodies that do not move, put by the user into sleeping ones: created there, or made solid. Nothing is awake that
// would find their contact, so FindPairs looks at them once, when they are new where they are. What only touches a
// sleeping body, or lies as deep in it as bodies do at rest, does not wake it: a level may be built around sleepers in
// any order.
#pragma once

#include <Fulcrum/Physics/Stages/CollisionView.h>
#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/Waking.h>

namespace fulcrum {

// Notes the sleeping body of two colliders, one of which is of such a body, if that must wake it. By any worker.
void NoteIfPutIntoSleeper(const CollisionView& view, uint32_t colliderA, uint32_t colliderB, WorkerFindings& findings);

// Wakes the noted bodies; returns whether there are any.
bool WakePutInto(std::span<WorkerFindings> workers, const SleepStores& stores);

}  // namespace fulcrum
