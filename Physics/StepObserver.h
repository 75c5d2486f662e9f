// What a profiler is told of a step: derive from StepObserver and pass it to PhysicsSystem::SetStepObserver. Without
// one a step looks at a null pointer per stage. Called by the thread that steps; what workers do is seen by the
// program's own JobSystem.
#pragma once

#include <cstdint>

namespace fulcrum {

class StepObserver {
public:
    virtual ~StepObserver() = default;

    virtual void BeginStep(uint64_t step) { (void)step; }  // 1 for the first
    virtual void EndStep(uint64_t step) { (void)step; }
    // `name` lives as long as the program: StageName(stage), stage 0 .. kStageCount - 1.
    virtual void BeginStage(int stage, const char* name) { (void)stage, (void)name; }
    virtual void EndStage(int stage, const char* name) { (void)stage, (void)name; }
};

}  // namespace fulcrum
