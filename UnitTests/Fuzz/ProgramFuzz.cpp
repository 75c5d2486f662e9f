// Programs of public calls, as UnitTests/Random plays them: the bytes say which calls, the seeds of their arguments and
// what they act upon. The invariants are checked after each call.
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/UnitTests/Fuzz/FuzzTargets.h>
#include <Fulcrum/UnitTests/Random/Program.h>

#include <cstdio>

namespace fulcrum::testing {

namespace {

std::vector<const CallKind*> AllCalls() {
    std::vector<const CallKind*> all;
    for (const std::span<const CallKind> calls :
         {BodyCalls(), WorldCalls(), JointCalls(), RagdollCalls(), QueryCalls(), ShapeCalls()})
        for (const CallKind& call : calls) all.push_back(&call);
    return all;
}

constexpr size_t kMostCalls = 40;

void RunProgram(std::span<const uint8_t> bytes) {
    static const std::vector<const CallKind*> calls = AllCalls();
    static ProgramPlayer player;
    FuzzReader reader(bytes);
    RandomProgram program;
    program.style.oddChance = static_cast<float>(reader.Get<uint8_t>() % 4) * 0.02f;
    while (reader.Left() > 0 && program.calls.size() < kMostCalls) {
        RandomCall call;
        call.kind = calls[reader.Get<uint8_t>() % calls.size()];
        call.seed = reader.Get<uint16_t>();
        const uint8_t bodies = reader.Get<uint8_t>(), others = reader.Get<uint8_t>();
        call.targets = {bodies % 8u, bodies / 8u % 8u, others % 4u, others / 4u % Twin::kRagdollSlots};
        program.calls.push_back(call);
    }
    SetMisuseHandler([](const Error&) {});
    const auto failure = player.Play(program);
    SetMisuseHandler(nullptr);
    if (failure) std::fprintf(stderr, "%s\n", Describe(program, *failure).c_str());
    Promise(!failure, "programs of public calls keep the invariants");
}

std::vector<FuzzBytes> SeedsOfPrograms() {
    const std::vector<const CallKind*> calls = AllCalls();
    std::vector<FuzzBytes> seeds;
    for (uint32_t number = 1; number <= 8; ++number) {
        const RandomProgram program = MakeProgram(number);
        FuzzBytes seed = {static_cast<uint8_t>(number)};
        for (const RandomCall& call : program.calls) {
            const auto kind = std::find(calls.begin(), calls.end(), call.kind) - calls.begin();
            seed.push_back(static_cast<uint8_t>(kind));
            Append(seed, static_cast<uint16_t>(call.seed));
            seed.push_back(static_cast<uint8_t>(call.targets.bodyA % 8 + call.targets.bodyB % 8 * 8));
            seed.push_back(static_cast<uint8_t>(call.targets.joint % 4 + call.targets.ragdoll * 4));
        }
        seeds.push_back(seed);
    }
    return seeds;
}

}  // namespace

const FuzzTarget kProgramTarget{"program", RunProgram, SeedsOfPrograms, 40};

}  // namespace fulcrum::testing
