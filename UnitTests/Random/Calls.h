// The public calls that random programs are made of. One line a call in a table of each file: its name, how often it
// comes, and what it does in one world. A call draws all its arguments from its values, the same in each world.
#pragma once

#include <Fulcrum/UnitTests/Random/Twin.h>

#include <span>

namespace fulcrum::testing {

// Which things a call names, by slots that were filled before it or not.
struct CallTargets {
    uint32_t bodyA = 0, bodyB = 0, joint = 0, ragdoll = 0;
};

struct CallKind {
    const char* name;
    float weight;
    void (*play)(Twin& twin, Values& values, const CallTargets& targets, Outcome& outcome);
};

std::span<const CallKind> BodyCalls();
std::span<const CallKind> WorldCalls();  // steps, settings, listeners
std::span<const CallKind> JointCalls();
std::span<const CallKind> RagdollCalls();
std::span<const CallKind> QueryCalls();  // change nothing
std::span<const CallKind> ShapeCalls();  // of no world: files, distances, casts

template <class T>
bool Note(const Result<T>& result, Outcome& outcome) {
    outcome.isRefused = !result;
    outcome.answer.Add(outcome.isRefused);
    if (!result) outcome.answer.Add(result.GetError().code);
    return !outcome.isRefused;
}

}  // namespace fulcrum::testing
