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
    float lastSubstepDt;              // s, of the last step; 0: there was none
    float impulseScale;               // substepDt / lastSubstepDt, at most 2: scales the warm start of joints
    float contactImpulseScale;        // likewise of contacts, at most 8
    float stiffnessDt;                // s: maximum over the last substeps; limits the stiffness of contacts and joints
    float softness;  // s^2, of contacts in the settings' substeps, as stiff as stiffnessDt allows: see SinkScale

    // Whether springs that suffice in the last step are too soft in this one.
    bool Lengthens() const { return substepDt > 1.5f * lastSubstepDt && lastSubstepDt > 0; }
};

// The workers and scratch memory of a stage.
struct StepWorkers {
    JobSystem& jobs;
    std::span<WorkerFindings> findings;  // by worker
    ScratchArena& scratch;               // of the step
    std::span<ScratchArena> ofWorkers;   // by worker: reset by each user
};

}  // namespace fulcrum
