// What all stages of a step are given: what holds for it, and who works on it. Made anew by each step.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Physics/Settings.h>

#include <span>

namespace fulcrum {

class ContactListener;
struct WorkerFindings;

// What holds for the whole step. No stage changes it.
struct StepContext {
    const SystemSettings& settings;
    const ContactListener* listener;  // null: none
    uint64_t number;                  // of the step, 1 for the first
    float dt;                         // s, > 0
    float substepDt;                  // s, of the settings' substeps
    float impulseScale;               // dt of its substeps / dt of the last step's, at most 2: scales the warm start
    float stiffnessDt;  // s: the longest of the last substeps, for which contacts and joints are not too stiff
    float softness;     // s^2, of contacts in the settings' substeps: see SinkScale
};

// Who does the work of a stage, and in what memory.
struct StepWorkers {
    JobSystem& jobs;
    std::span<WorkerFindings> findings;  // by worker
    ScratchArena& scratch;               // of the step
};

}  // namespace fulcrum
