// Arguments of all stages of a step: constants and workers. Created by each step.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Physics/Settings.h>

#include <span>

namespace fulcrum {

class ContactListener;
struct WorkerFindings;

// Constants of the whole step. No stage changes them.
struct StepContext {
    const SystemSettings& settings;
    const ContactListener* listener;  // null: none
    uint64_t number;                  // of the step, 1 for the first
    float dt;                         // s, > 0
    float substepDt;                  // s, of the settings' substeps
    float impulseScale;               // dt of its substeps / dt of the last step's, at most 2: scales the warm start
    float stiffnessDt;                // s: maximum over the last substeps; limits the stiffness of contacts and joints
    float softness;                   // s^2, of contacts in the settings' substeps: see SinkScale
};

// The workers and scratch memory of a stage.
struct StepWorkers {
    JobSystem& jobs;
    std::span<WorkerFindings> findings;  // by worker
    ScratchArena& scratch;               // of the step
};

}  // namespace fulcrum
