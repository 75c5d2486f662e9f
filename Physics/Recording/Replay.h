// Plays a recording of calls (CallRecorder.h) again, bit for bit, and finds the first step that differs. Any thread.
#pragma once

#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/Recording/CallRecording.h>
#include <Fulcrum/Physics/Recording/ReplaySources.h>

#include <optional>
#include <string>
#include <vector>

namespace fulcrum {

struct ReplaySettings {
    JobSystem* jobs = nullptr;  // null: no threads
    ReplaySources sources{};
    // Called after each step, e.g. to draw it or to stop in a debugger; false ends the replay.
    Function<bool(PhysicsSystem& system)> afterStep{};
};

// Where a replay differs from what was recorded. Steps count from 1.
struct Divergence {
    uint64_t step = 0;      // the first step whose state differs, or before which calls had another effect
    bool isInStep = false;  // whether the step made the difference, or a call before it
    // The bodies whose poses, velocities or sleep differ first, at step `bodiesStep`, by index: none if none does
    // within 600 steps.
    std::vector<BodyId> bodies{};
    uint64_t bodiesStep = 0;
    std::string what{};  // a sentence
};

struct ReplayReport {
    uint64_t calls = 0, steps = 0;  // played
    std::optional<Divergence> divergence;
    uint64_t stateHash = 0;  // of the world at the end
};

// Stops after the first step that differs, as soon as a body does. Errors: Unsupported (something in the recording is
// neither in it nor in the sources), Degenerate (damaged), and those of RestoreSnapshot.
Result<ReplayReport> Replay(const CallRecording& recording, const ReplaySettings& settings = {});

}  // namespace fulcrum
