// The stages of a step; each is a file of its name beside this one.
// Step.cpp has the list of them, in order, and what each is given. All run on the thread that steps and schedule their
// ranges on the world's job system.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// Reads poses, velocities, shapes. Writes world inertia and accelerations; fat bounds and trees where a collider left
// its own. Bodies that disperse (Crowd.h) get their velocities; what is not finite is frozen.
void UpdateBounds(WorldState& world, float dt, std::vector<DispersingBody>& dispersing,
                  std::span<WorkerFindings> workers);

// Reads trees and the colliders that moved. Adds pairs, sorted by id, and activates resting ones, which it lists in
// `updates`. Bodies that overlap many others deeply start to disperse, others have dispersed: these lose pairs, collide
// again.
void FindPairs(WorldState& world, PairUpdates& updates, CrowdState& crowd, std::span<WorkerFindings> workers,
               ScratchArena& scratch);

// Reads active pairs, poses, shapes. Writes manifolds into the records, which pairs changed, and which bodies overlap
// deeply. Wakes what is hit, and finds its pairs.
void Collide(WorldState& world, float dt, PairUpdates& updates, CrowdState& crowd, std::span<WorkerFindings> workers,
             ScratchArena& scratch, StepReport& report);

// Applies the changes, which are None afterwards: colors contacts that began, and lists them in `began`; uncolors those
// that ended, removes dead pairs.
void Color(uint32_t bodyCount, std::span<PairChange> changes, PairStore& pairs, ConstraintColoring& coloring,
           std::vector<uint32_t>& began);

// Takes the points from the records of contacts that only a seam between two immovable bodies makes, and notes their
// pairs in `seams`; first gives those of the last step theirs back.
void RemoveSeamContacts(const BodyStore& bodies, const ColliderStore& colliders, const ConstraintColoring& coloring,
                        PairStore& pairs, std::vector<uint32_t>& seams, ScratchArena& scratch);

// Sorts the colored constraints into the solver's groups and batches, where they changed. Islands under
// load get more effort (ContactLoads.h); where they lose it, impulses in records are limited. Of the joints it writes
// what their types say of locks and rows. softness: s^2, SoftnessOf the system's substeps.
void BuildIslands(const BodyStore& bodies, const ConstraintColoring& coloring, PairStore& pairs,
                  const SystemSettings& settings, float softness, JointStore& joints, SolverLayout& layout,
                  ScratchArena& scratch);

// Reads records, poses, masses. Writes the rows of the batches; what types of joints carry from step to step; contacts
// whose numbers are not finite lose their points.
void Prepare(WorldState& world, const StepState& step, SolverLayout& layout, std::span<WorkerFindings> workers,
             ScratchArena& scratch, StepReport& report);

// Substeps: integrates velocities, warm starts, iterates, integrates poses, position passes.
void Solve(WorldState& world, StepState& step);

// Writes impulses to the records, displacements to the poses; moves bodies without contacts and joints; measures
// slowness; breaks joints, which it lists. Where continuous collision or sensors ask for it, notes where bodies
// started. Returns how many bodies have been slow for long enough.
uint32_t Store(WorldState& world, const StepState& step, SweepStore& sweeps, std::vector<JointId>& broken,
               std::span<WorkerFindings> workers, StepReport& report);

// Reads where bodies were when the step began. Casts those with continuous collision that moved far along their path:
// what hits something bounces there, and gets another pose and velocity. Writes the sweeps of the step.
void Continuous(WorldState& world, SweepStore& sweeps, std::span<WorkerFindings> workers, ScratchArena& scratch,
                StepReport& report);

// Finds what is inside the sensors, and what came in or left, along the paths of the step. Writes the sensors, and the
// bounds of their colliders, which are the world's.
void Sense(const WorldState& world, SensorStore& sensors, ColliderStore& colliders, const SweepStore& sweeps,
           SensorSearch& sensing, std::span<WorkerFindings> workers, StepReport& report);

// Puts islands that have been slow for long enough to sleep. candidates: how many bodies have been.
void Sleep(WorldState& world, uint32_t candidates, ScratchArena& scratch);

}  // namespace fulcrum
