// The public calls that random programs are made of. Each file has a table with a line per call: its name, its weight,
// and a function that makes it in one world. A call draws all its arguments from its values, the same in each world.
#pragma once

#include <Fulcrum/UnitTests/Random/Twin.h>

#include <span>

namespace fulcrum::testing {

// The objects that a call uses, by slots, which may be empty.
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
