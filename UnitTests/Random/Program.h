// A random program: calls of the public interface, generated from a seed, played in several worlds side by side and
// checked after each call; failing programs are shortened. The same seed gives the same program with one compiler.
//
// The worlds: with one, two and four threads, one in which calls that were refused are left out, and one in which each
// call is taken back by a snapshot and made again. All must return the same and have the same bits, after every call:
// neither threads nor refused calls nor snapshots may have an effect.
#pragma once

#include <Fulcrum/UnitTests/Random/Calls.h>

#include <optional>
#include <string>
#include <vector>

namespace fulcrum::testing {

struct RandomCall {
    const CallKind* kind = nullptr;
    uint32_t seed = 0;  // of its values
    CallTargets targets;
};

struct RandomProgram {
    uint32_t seed = 0;
    RandomStyle style;
    std::vector<RandomCall> calls;
};

struct ProgramFailure {
    size_t call = 0;  // which
    std::string what;
};

class ProgramPlayer {
public:
    ProgramPlayer() : two_(2), four_(4) {}

    // Empty: nothing failed.
    std::optional<ProgramFailure> Play(const RandomProgram& program);
    // The program without calls that are not needed for its failure.
    RandomProgram Shrink(RandomProgram program, const ProgramFailure& failure);

private:
    ThreadPool two_, four_;
};

RandomProgram MakeProgram(uint32_t seed);
// Its seed, what failed, its calls.
std::string Describe(const RandomProgram& program, const ProgramFailure& failure);

}  // namespace fulcrum::testing
