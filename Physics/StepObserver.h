// Callbacks for profilers: derive from StepObserver and pass it to PhysicsSystem::SetStepObserver. Without one a step
// only tests a pointer per stage. Called by the thread that steps; to observe the workers, use a JobSystem of the
// program.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

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
