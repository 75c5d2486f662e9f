// The stages of a step. Each function states in its signature what it reads (const) and what it writes; it is in the
// file of its name unless stated otherwise. Step.cpp has the list, in order, with the arguments. All run on the thread
// that steps, and schedule parallel ranges on StepWorkers::jobs.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/Waking.h>

namespace fulcrum {

// Reads poses, velocities, shapes. Writes world inertia and accelerations; fat bounds and trees for colliders that left
// theirs. Sets the velocities of dispersing bodies (Crowd.h), for which it reads contacts; freezes bodies that are not
// finite. Must be followed by SettleStopped.
void UpdateBounds(const StepContext& step, const PairStore& pairs, const SensorStore& sensors, BodyStore& bodies,
                  ColliderStore& colliders, Array<DispersingBody>& dispersing, const StepWorkers& workers);
// Handles bodies that workers froze or stopped in UpdateBounds or MoveBodies: clears the impulses of their contacts and
// joints, and updates which bodies joints can move. In BodyLimits.cpp.
void SettleStopped(std::span<const WorkerFindings> findings, const ColliderStore& colliders, BodyStore& bodies,
                   PairStore& pairs, JointStore& joints, ConstraintColoring& coloring);

// Reads trees and the colliders that moved. Adds pairs, sorted by id, and activates resting ones, which it lists in
// `updates`. Starts and ends the dispersing of bodies that overlap many others deeply, and removes or searches their
// pairs. Must be followed by ForgetMoved.
void FindPairs(const StepContext& step, const JointStore& joints, BodyStore& bodies, ColliderStore& colliders,
               PairStore& pairs, ConstraintColoring& coloring, PairUpdates& updates, CrowdState& crowd,
               const StepWorkers& workers);
// Clears the list of moved colliders after the searches, and passes it on to sensors.
void ForgetMoved(ColliderStore& colliders, SensorStore& sensors, JobSystem& jobs);

// Reads active pairs, poses, velocities, shapes, and which bodies have contacts and joints. Writes manifolds to the
// records, the changes of pairs, and deeply overlapping bodies to the workers' findings.
void Collide(const StepContext& step, const BodyStore& bodies, const ColliderStore& colliders, const JointStore& joints,
             const ConstraintColoring& coloring, PairStore& pairs, PairUpdates& updates, const StepWorkers& workers,
             StepReport& report);
// The same for only those pairs that FindPairs activated.
void CollideActivated(const StepContext& step, const BodyStore& bodies, const ColliderStore& colliders,
                      const JointStore& joints, const ConstraintColoring& coloring, PairStore& pairs,
                      PairUpdates& updates, const StepWorkers& workers, StepReport& report);
// Wakes sleeping bodies that are hit, whose pairs then begin. Returns whether there are any. In Collide.cpp.
bool WakeHit(const PairStore& pairs, std::span<PairChange> changes, const SleepStores& stores);

// Applies the changes and resets them to None: colors contacts that began, and lists them in `began`; uncolors those
// that ended, and removes those without points; removes dead pairs.
void Color(uint32_t bodyCount, std::span<PairChange> changes, PairStore& pairs, ConstraintColoring& coloring,
           Array<uint32_t>& began);

// Removes the points from records of contacts caused by a seam between two immovable bodies, and lists their pairs in
// `seams`; first restores those of the last step.
void RemoveSeamContacts(const BodyStore& bodies, const ColliderStore& colliders, const ConstraintColoring& coloring,
                        PairStore& pairs, Array<uint32_t>& seams, ScratchArena& scratch);

// Sorts the colored constraints into the solver's groups and batches, if they changed. Islands under load are solved
// directly (ContactLoads.h): initializes the loads of contacts that began. Updates the locks and row counts of joints
// from their types. Takes and clears efforts restored by a snapshot (`saved`).
void BuildIslands(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
                  std::span<const uint32_t> began, PairStore& pairs, JointStore& joints, SolverLayout& layout,
                  SavedEfforts& saved, ScratchArena& scratch);

// Reads records, poses, masses, crowded bodies. Writes the rows of the batches and the state of joint types; contacts
// whose numbers are not finite lose their points.
void Prepare(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
             const CrowdState& crowd, PairStore& pairs, JointStore& joints, SolverLayout& layout,
             const StepWorkers& workers, StepReport& report);

// Substeps: integrates velocities, warm starts, iterates, integrates poses, relax or position iterations. Writes
// velocities, displacements and the batches. Colliders and pairs are read for dispersing bodies. pushes: by body,
// filled for ErrorMeter.h; empty if not requested.
void Solve(const StepContext& step, const ColliderStore& colliders, PairStore& pairs, const JointStore& joints,
           const ConstraintColoring& coloring, BodyStore& bodies, SolverLayout& layout, std::span<PushNote> pushes,
           const StepWorkers& workers);

// The Store stage consists of the following three and SettleStopped.
// Writes the batches' impulses to the records of contacts and joints, updates the load levels, and reports the largest
// errors of joints.
void StoreImpulses(const StepContext& step, const BodyStore& bodies, const SolverLayout& layout, PairStore& pairs,
                   JointStore& joints, const StepWorkers& workers, StepReport& report);
// Applies displacements to the poses, moves bodies without contacts and joints, updates sleep timers. Records start
// poses if SweepStore is kept. Returns how many bodies have been slow for long enough to sleep.
uint32_t MoveBodies(const StepContext& step, const ColliderStore& colliders, const JointStore& joints,
                    const ConstraintColoring& coloring, const CrowdState& crowd, BodyStore& bodies, SweepStore& sweeps,
                    const StepWorkers& workers, StepReport& report);
// Disables joints whose break force or torque was exceeded, and lists them.
void BreakJoints(const BodyStore& bodies, ColliderStore& colliders, JointStore& joints, ConstraintColoring& coloring,
                 Array<BrokenJoint>& broken);

// Reads the poses at the start of the step. Casts bodies with continuous collision that moved far along their paths,
// and resolves hits: changes velocities, wakes bodies. Writes the sweeps of the step, and fat bounds that contain them.
// Poses and trees, which queries read meanwhile, are changed by EndContinuous, which must follow.
void Continuous(const StepContext& step, const PairStore& pairs, const SleepStores& stores, SweepStore& sweeps,
                const StepWorkers& workers, StepReport& report);

void EndContinuous(BodyStore& bodies, ColliderStore& colliders, const SweepStore& sweeps);

// Finds the bodies that are inside sensors, entered or left them along the paths of the step. Writes the sensors, and
// the bounds of their colliders.
void Sense(const StepContext& step, const BodyStore& bodies, const JointStore& joints, const SweepStore& sweeps,
           SensorStore& sensors, ColliderStore& colliders, SensorSearch& sensing, const StepWorkers& workers,
           StepReport& report);

// The Events stage, in Events.cpp.
// Lists contacts that began, persisted or ended in the step, and hits of continuous collision, if enabled. Pairs store
// their reported state.
void ListContactEvents(const StepContext& step, const BodyStore& bodies, const ColliderStore& colliders,
                       const SolverLayout& solver, const SweepStore& sweeps, PairStore& pairs, EventBuffers& buffers,
                       const StepWorkers& workers);

// The Sleep stage consists of the following two.
// Puts islands that have been slow for long enough to sleep; their pairs rest. candidates: number of bodies that have
// been slow for long enough.
void Sleep(const StepContext& step, uint32_t candidates, const SleepStores& stores, PairStore& pairs,
           CollidersOutsideFatBounds& outsideFatBounds, ScratchArena& scratch);
// Lists the bodies that are awake, moved, woke and fell asleep, if enabled. In BodyEvents.cpp.
void ListBodyEvents(const StepContext& step, BodyStore& bodies, EventBuffers& buffers, const StepWorkers& workers);
// Called when body events are enabled: initializes the reported state of bodies.
void BeginBodyEvents(const BodyStore& bodies, EventBuffers& buffers);

}  // namespace fulcrum
