// Random programs of public calls: whatever a user does, all that can be read stays finite, threads and refused calls
// have no effect, queries agree with each other, and every call returns. A few seconds of it run with the other tests;
// for longer:
//     FULCRUM_RANDOM_SECONDS=3600 FULCRUM_RANDOM_SEED=1000 FulcrumTests --gtest_filter='RandomPrograms.*'
// FULCRUM_RANDOM_PROGRAMS=1 plays one program, the one of the seed: so a failure is played again.
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/UnitTests/Random/Program.h>
#include <Fulcrum/UnitTests/Random/Watch.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace fulcrum::testing {
namespace {

constexpr int kPrograms = Cases(300);
constexpr int kMostFailures = 20;

double FromEnvironment(const char* name, double otherwise) {
    const char* const text = std::getenv(name);
    return text ? std::atof(text) : otherwise;
}

TEST(RandomPrograms, InvariantsHoldWhateverAUserCalls) {
    const double seconds = FromEnvironment("FULCRUM_RANDOM_SECONDS", 0);
    const uint32_t firstSeed = static_cast<uint32_t>(FromEnvironment("FULCRUM_RANDOM_SEED", 1));
    const double programs = FromEnvironment("FULCRUM_RANDOM_PROGRAMS", seconds > 0 ? 1e9 : kPrograms);
    const auto begin = std::chrono::steady_clock::now();
    const auto isTimeUp = [&] {
        return seconds > 0 && std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > seconds;
    };
    const Watch watch(kIsSanitized ? 600 : 60);
    SetMisuseHandler([](const Error&) {});  // null shapes of queries are reported; that is tested elsewhere
    ProgramPlayer player;
    int failures = 0;
    uint32_t played = 0;
    for (; played < programs && failures < kMostFailures && !isTimeUp(); ++played) {
        const RandomProgram program = MakeProgram(firstSeed + played);
        const std::optional<ProgramFailure> failure = player.Play(program);
        if (!failure) continue;
        ++failures;
        std::printf("program %u fails at call %zu, %s; it is shortened\n", program.seed, failure->call,
                    failure->what.c_str());
        std::fflush(stdout);
        const RandomProgram shorter = player.Shrink(program, *failure);
        const std::optional<ProgramFailure> again = player.Play(shorter);
        ADD_FAILURE() << Describe(shorter, again ? *again : *failure);
    }
    SetMisuseHandler(nullptr);
    RecordProperty("programs", static_cast<int>(played));
    EXPECT_GT(played, 0u);
}

// Seeds of programs whose failures led to fixes, while the same seeds give the same programs: whoever changes what is
// drawn replaces them by tests of their own, as has been done for those before (UnitTests/Regression).
TEST(RandomPrograms, InvariantsHoldForSeedsThatOnceFailed) {
    if (kIsSanitized) GTEST_SKIP() << "takes minutes";
    const uint32_t seeds[] = {
        32006483,   // two bodies far larger than the height field between them hit each other again and again: 2.6 s
        430003318,  // a waiting body that one without continuous collision moves into was cast in 64 rounds: 1.1 s
        460003727,  // a shape cast beside a box of 1.7 million meters depended on the order of the tree
        560006105,  // ball joints read for how long a teleport had been before that was read from their record
        421005905,  // a listener's surface velocity of a contact that has no points when a snapshot is saved
    };
    const Watch watch(kIsSanitized ? 600 : 60);
    SetMisuseHandler([](const Error&) {});
    ProgramPlayer player;
    for (const uint32_t seed : seeds) {
        const RandomProgram program = MakeProgram(seed);
        if (const std::optional<ProgramFailure> failure = player.Play(program))
            ADD_FAILURE() << Describe(program, *failure);
    }
    SetMisuseHandler(nullptr);
}

}  // namespace
}  // namespace fulcrum::testing
