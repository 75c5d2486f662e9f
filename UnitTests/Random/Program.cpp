#include <Fulcrum/UnitTests/Random/Program.h>

#include <cstdlib>
#include <sstream>

namespace fulcrum::testing {

namespace {

// All calls that a style allows, with the sum of the weights up to each.
struct Menu {
    std::vector<const CallKind*> kinds;
    std::vector<float> upTo;

    void Add(std::span<const CallKind> calls, float factor) {
        for (const CallKind& kind : calls) {
            kinds.push_back(&kind);
            upTo.push_back((upTo.empty() ? 0 : upTo.back()) + kind.weight * factor);
        }
    }
    const CallKind* Draw(RandomPoses& random) const {
        const float at = random.Between(0, upTo.back());
        size_t i = 0;
        while (i + 1 < kinds.size() && upTo[i] <= at) ++i;
        return kinds[i];
    }
};

Menu MenuOf(const RandomStyle& style) {
    Menu menu;
    menu.Add(BodyCalls(), 1);
    menu.Add(WorldCalls(), 1);
    menu.Add(JointCalls(), style.joints ? 1.0f : 0.0f);
    menu.Add(RagdollCalls(), style.ragdolls ? 1.0f : 0.0f);
    menu.Add(QueryCalls(), 0.7f);
    menu.Add(ShapeCalls(), 0.7f);
    return menu;
}

// Kinds of arguments that FULCRUM_RANDOM_OFF=name,name leaves out.
struct Switch {
    const char* name;
    bool RandomStyle::*field;
};
constexpr Switch kSwitches[] = {
    {"notFinite", &RandomStyle::notFinite},
    {"extremeSpeeds", &RandomStyle::extremeSpeeds},
    {"extremeForces", &RandomStyle::extremeForces},
    {"extremePlaces", &RandomStyle::extremePlaces},
    {"extremeSizes", &RandomStyle::extremeSizes},
    {"extremeSettings", &RandomStyle::extremeSettings},
    {"badEnumerators", &RandomStyle::badEnumerators},
    {"nullShapes", &RandomStyle::nullShapes},
    {"joints", &RandomStyle::joints},
    {"ragdolls", &RandomStyle::ragdolls},
    {"sensors", &RandomStyle::sensors},
    {"continuous", &RandomStyle::continuous},
    {"changeSettings", &RandomStyle::changeSettings},
};

void SwitchOff(RandomStyle& style) {
    const char* const asked = std::getenv("FULCRUM_RANDOM_OFF");
    const std::string off = std::string(",") + (asked ? asked : "") + ",";
    for (const Switch& one : kSwitches)
        if (off.find(std::string(",") + one.name + ",") != std::string::npos) style.*one.field = false;
}

RandomStyle StyleOf(uint32_t seed, RandomPoses& random) {
    constexpr float kOddChances[] = {0, 0, 0.01f, 0.05f};
    RandomStyle style;
    SwitchOff(style);
    style.oddChance = kOddChances[seed % 4];
    style.notFinite = style.notFinite && random.Chance(0.5f);
    style.joints = style.joints && random.Chance(0.5f);
    style.ragdolls = style.ragdolls && style.joints && random.Chance(0.5f);
    return style;
}

constexpr size_t kMostCalls = 80;

bool FailsAlike(const std::optional<ProgramFailure>& failure, const std::string& what) {
    return failure && failure->what.substr(0, 12) == what.substr(0, 12);
}

}  // namespace

RandomProgram MakeProgram(uint32_t seed) {
    RandomPoses random(seed * 2654435761u + 1);
    RandomProgram program{seed, StyleOf(seed, random), {}};
    const Menu menu = MenuOf(program.style);
    const CallKind* const create = &BodyCalls()[0];
    const CallKind* const floor = &BodyCalls()[1];
    const size_t count = 20 + random.Below(kMostCalls - 20);
    const uint32_t bodies = 4 + random.Below(Twin::kBodySlots - 4), joints = 1 + random.Below(Twin::kJointSlots);
    for (size_t i = 0; i < count; ++i) {
        const CallTargets targets{random.Below(bodies), random.Below(bodies), random.Below(joints),
                                  random.Below(Twin::kRagdollSlots)};
        const CallKind* kind = i < 6 ? create : menu.Draw(random);
        if (i == 0 && random.Chance(0.8f)) kind = floor;
        program.calls.push_back({kind, static_cast<uint32_t>(random.Below(1u << 30)), targets});
    }
    return program;
}

RandomProgram ProgramPlayer::Shrink(RandomProgram program, const ProgramFailure& failure) {
    program.calls.resize(std::min(program.calls.size(), failure.call + 1));
    for (size_t length = program.calls.size() / 2; length > 0; length /= 2) {
        for (size_t first = 0; first < program.calls.size();) {
            RandomProgram shorter = program;
            const size_t last = std::min(first + length, shorter.calls.size());
            shorter.calls.erase(shorter.calls.begin() + static_cast<std::ptrdiff_t>(first),
                                shorter.calls.begin() + static_cast<std::ptrdiff_t>(last));
            if (FailsAlike(Play(shorter), failure.what)) program = std::move(shorter);
            else first += length;
        }
    }
    return program;
}

std::string Describe(const RandomProgram& program, const ProgramFailure& failure) {
    std::ostringstream text;
    text << "program " << program.seed << " (odd " << program.style.oddChance << "), call " << failure.call;
    if (failure.call < program.calls.size()) text << " " << program.calls[failure.call].kind->name;
    text << ": " << failure.what << "\n";
    for (size_t i = 0; i < program.calls.size(); ++i) {
        const RandomCall& call = program.calls[i];
        text << "    " << i << " " << call.kind->name << " seed " << call.seed << " bodies " << call.targets.bodyA
             << " " << call.targets.bodyB << " joint " << call.targets.joint << "\n";
    }
    return text.str();
}

}  // namespace fulcrum::testing
