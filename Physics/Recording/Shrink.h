// Finds a smaller program that still fails in a recording of calls (CallRecorder.h): fewer bodies, steps and calls.
// Delta debugging (Zeller and Hildebrandt, "Simplifying and isolating failure-inducing input", IEEE Transactions on
// Software Engineering 28 (2), 2002): parts are left out, first halves, then quarters and so on, as long as what is
// left fails. Any thread.
#pragma once

#include <Fulcrum/Math/Function.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Physics/Recording/CallRecorder.h>
#include <Fulcrum/Physics/Recording/CallRecording.h>
#include <Fulcrum/Physics/Recording/ReplaySources.h>

#include <span>
#include <vector>

namespace fulcrum {

// Whether a program has failed, asked after each step. The program is played in one world per job system, in parallel
// as it were: all have made the same calls.
using FailureCheck = Function<bool(std::span<PhysicsSystem* const> worlds)>;

// A body has been frozen, since its state was not finite.
FailureCheck FailureOfFrozenBody();
// A body is faster than this, m/s.
FailureCheck FailureOfSpeed(float speed);
// A body's center of mass is below this height, m along y.
FailureCheck FailureOfHeight(double height);
// The worlds' states differ: give several numbers of threads.
FailureCheck FailureOfDifference();

// Calls play(send) in a process of its own. Returns whether that died, and the bytes that it sent until then.
struct IsolatedRun {
    bool hasDied = false;
    std::vector<std::byte> sent{};
};
using Isolation = Function<IsolatedRun(const Function<void(const CallRecorder::Sink& send)>& play)>;

struct ShrinkSettings {
    std::vector<JobSystem*> jobs{nullptr};  // of each world; null: no threads
    ReplaySources sources{};
    size_t mostReplays = 3000;  // of programs that are tried
    // For programs that crash: each is played so, and fails if its process dies. The check of the failure may be empty
    // then. Threads of the job systems do not exist in a forked process: without `jobs`.
    Isolation isolation{};
    // Called for each program that is tried; null: nobody is told.
    Function<void(size_t replays, size_t calls)> progress{};
};

struct ProgramSize {
    size_t bodies = 0, calls = 0, steps = 0;  // bodies: created
};
struct ShrinkReport {
    std::vector<std::byte> recording{};  // of the smaller program, which ends with the step that fails
    ProgramSize before{}, after{};
    size_t replays = 0;
};

// Calls that name a body or joint whose creation is left out are left out, too; batches become bodies created one by
// one. Children of mutable compounds are named as they were: calls about them may be refused then.
// Errors: Unsupported (it does not fail; something in it is neither in it nor in the sources), Degenerate (damaged).
Result<ShrinkReport> Shrink(const CallRecording& recording, const FailureCheck& failure,
                            const ShrinkSettings& settings = {});

}  // namespace fulcrum
