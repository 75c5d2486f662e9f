// The stages of a step. Each function says in its signature what it reads, const, and what it writes; its file has its
// name, but for those that belong to another one. Step.cpp has the list, in order, and what each is given. All run on
// the thread that steps, and schedule their ranges on StepWorkers::jobs.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/Waking.h>

namespace fulcrum {

// Reads poses, velocities, shapes. Writes world inertia and accelerations; fat bounds and trees where a collider left
// its own. Bodies that disperse (Crowd.h) get their velocities, by contacts of pairs; what is not finite is frozen.
// SettleStopped is to follow.
void UpdateBounds(const StepContext& step, const PairStore& pairs, const SensorStore& sensors, BodyStore& bodies,
                  ColliderStore& colliders, std::vector<DispersingBody>& dispersing, const StepWorkers& workers);
// Where workers froze or stopped bodies, in UpdateBounds or MoveBodies: what pushed these is forgotten, and joints see
// who can move. In BodyLimits.cpp.
void SettleStopped(std::span<const WorkerFindings> findings, const ColliderStore& colliders, BodyStore& bodies,
                   PairStore& pairs, JointStore& joints, ConstraintColoring& coloring);

// Reads trees and the colliders that moved. Adds pairs, sorted by id, and activates resting ones, which it lists in
// `updates`. Bodies that overlap many others deeply start to disperse, others have dispersed: these lose pairs, collide
// again, and are searched for. ForgetMoved is to follow.
void FindPairs(const StepContext& step, const JointStore& joints, BodyStore& bodies, ColliderStore& colliders,
               PairStore& pairs, ConstraintColoring& coloring, PairUpdates& updates, CrowdState& crowd,
               const StepWorkers& workers);
// The searches are over: no collider counts as moved. Sensors are to look at those that did.
void ForgetMoved(ColliderStore& colliders, SensorStore& sensors, JobSystem& jobs);

// Reads active pairs, poses, velocities, shapes, what is touched and jointed. Writes manifolds into the records, which
// pairs changed, and into the workers' findings which bodies overlap deeply.
void Collide(const StepContext& step, const BodyStore& bodies, const ColliderStore& colliders, const JointStore& joints,
             const ConstraintColoring& coloring, PairStore& pairs, PairUpdates& updates, const StepWorkers& workers,
             StepReport& report);
// The same for the pairs alone that FindPairs activated.
void CollideActivated(const StepContext& step, const BodyStore& bodies, const ColliderStore& colliders,
                      const JointStore& joints, const ConstraintColoring& coloring, PairStore& pairs,
                      PairUpdates& updates, const StepWorkers& workers, StepReport& report);
// Wakes the sleeping bodies that are hit; their pairs began. Returns whether there are any. In Collide.cpp.
bool WakeHit(const PairStore& pairs, std::span<PairChange> changes, const SleepStores& stores);

// Applies the changes, which are None afterwards: colors contacts that began, and lists them in `began`; uncolors those
// that ended, removes dead pairs.
void Color(uint32_t bodyCount, std::span<PairChange> changes, PairStore& pairs, ConstraintColoring& coloring,
           std::vector<uint32_t>& began);

// Takes the points from the records of contacts that only a seam between two immovable bodies makes, and notes their
// pairs in `seams`; first gives those of the last step theirs back.
void RemoveSeamContacts(const BodyStore& bodies, const ColliderStore& colliders, const ConstraintColoring& coloring,
                        PairStore& pairs, std::vector<uint32_t>& seams, ScratchArena& scratch);

// Sorts the colored constraints into the solver's groups and batches, where they changed. Islands under load get more
// effort (ContactLoads.h); for that it notes the weights that lie on contacts which began; where islands lose effort,
// impulses in records are limited. Of the joints it writes what their types say of locks and rows. Efforts that a
// snapshot restored are taken, and no longer `saved` afterwards.
void BuildIslands(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
                  std::span<const uint32_t> began, PairStore& pairs, JointStore& joints, SolverLayout& layout,
                  SavedEfforts& saved, ScratchArena& scratch);

// Reads records, poses, masses, who is crowded. Writes the rows of the batches; what types of joints carry from step to
// step; contacts whose numbers are not finite lose their points.
void Prepare(const StepContext& step, const BodyStore& bodies, const ConstraintColoring& coloring,
             const CrowdState& crowd, PairStore& pairs, JointStore& joints, SolverLayout& layout,
             const StepWorkers& workers, StepReport& report);

// Substeps: integrates velocities, warm starts, iterates, integrates poses, position passes. Writes velocities,
// displacements and the batches. Colliders and pairs are read where bodies disperse.
void Solve(const StepContext& step, const ColliderStore& colliders, const PairStore& pairs, const JointStore& joints,
           const ConstraintColoring& coloring, BodyStore& bodies, SolverLayout& layout, const StepWorkers& workers);

// The Store stage is these three, and SettleStopped.
// Writes the batches' impulses to the records of contacts and joints, and what contacts carried to their loads.
void StoreImpulses(const StepContext& step, const BodyStore& bodies, const SolverLayout& layout, PairStore& pairs,
                   JointStore& joints, const StepWorkers& workers);
// Writes displacements to the poses, moves bodies without contacts and joints, measures slowness. Where SweepStore is
// kept, notes where bodies started. Returns how many bodies have been slow for long enough.
uint32_t MoveBodies(const StepContext& step, const ColliderStore& colliders, const JointStore& joints,
                    const ConstraintColoring& coloring, const CrowdState& crowd, BodyStore& bodies, SweepStore& sweeps,
                    const StepWorkers& workers, StepReport& report);
// Disables joints that did more than they stand, and lists them.
void BreakJoints(const BodyStore& bodies, ColliderStore& colliders, JointStore& joints, ConstraintColoring& coloring,
                 std::vector<BrokenJoint>& broken);

// Reads where bodies were when the step began. Casts those with continuous collision that moved far along their path:
// what hits something bounces there, and gets another pose and velocity; what is hit wakes. Writes the sweeps of the
// step, and bounds that hold them.
void Continuous(const StepContext& step, const PairStore& pairs, const SleepStores& stores, SweepStore& sweeps,
                const StepWorkers& workers, StepReport& report);

// Finds what is inside the sensors, and what came in or left, along the paths of the step. Writes the sensors, and the
// bounds of their colliders.
void Sense(const StepContext& step, const BodyStore& bodies, const JointStore& joints, const SweepStore& sweeps,
           SensorStore& sensors, ColliderStore& colliders, SensorSearch& sensing, const StepWorkers& workers,
           StepReport& report);

// The Events stage, in Events.cpp.
// Contacts that began, went on or ended in the step, and hits of continuous collision, if somebody asks for them. Pairs
// note what was said of them.
void ListContactEvents(const StepContext& step, const BodyStore& bodies, const ColliderStore& colliders,
                       const SolverLayout& solver, const SweepStore& sweeps, PairStore& pairs, EventBuffers& buffers,
                       const StepWorkers& workers);

// The Sleep stage is these two.
// Puts islands that have been slow for long enough to sleep; their pairs rest. candidates: how many bodies have been.
void Sleep(const StepContext& step, uint32_t candidates, const SleepStores& stores, PairStore& pairs,
           CollidersOutsideFatBounds& outsideFatBounds, ScratchArena& scratch);
// Which bodies are awake, moved, woke and fell asleep, if somebody asks for them. In BodyEvents.cpp.
void ListBodyEvents(const StepContext& step, BodyStore& bodies, EventBuffers& buffers, const StepWorkers& workers);
// Where somebody asks for them from now on: bodies are as they are.
void BeginBodyEvents(const BodyStore& bodies, EventBuffers& buffers);

}  // namespace fulcrum
