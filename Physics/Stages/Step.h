// One step: the stages, one after the other.
#pragma once

#include <Fulcrum/Physics/Stages/StepState.h>

namespace fulcrum {

// Advances the world by dt seconds, and fills the report. Less than a nanosecond has no effect.
void RunStep(WorldState& world, StepState& state, double dt);

// The islands of the step that were solved with more than the settings' effort, in a deterministic order.
void VisitEfforts(const SolverSettings& settings, const BodyStore& bodies, const SolverLayout& layout,
                  FunctionRef<void(const IslandEffortReport&)> visit);

}  // namespace fulcrum
