#include <Fulcrum/Physics/Recording/Shrink.h>

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Recording/CallPlayer.h>
#include <Fulcrum/Physics/Recording/CallRecorder.h>
#include <Fulcrum/Physics/Recording/RecordingFormat.h>

#include <algorithm>
#include <optional>

namespace fulcrum {

namespace {

// A call, or a body or joint of a batch.
struct ProgramCall {
    static constexpr size_t kWhole = ~size_t{0};
    size_t entry = 0, part = kWhole;
    bool isStep = false, creates = false, createsBody = false;
};
using Program = std::vector<ProgramCall>;

struct Outcome {
    bool fails = false;
    Program used;  // the calls up to the failure without those that were left out or refused
};

class Shrinker {
public:
    Shrinker(const CallRecording& recording, const RecordedObjects& objects, const FailureCheck& failure,
             const ShrinkSettings& settings)
        : recording_(recording), objects_(objects), failure_(failure), settings_(settings) {}

    Result<ShrinkReport> Run() {
        program_ = WholeProgram();
        ShrinkReport report{.before = SizeOf(program_)};
        Result<Outcome> first = Play(program_, nullptr);
        if (!first) return first.GetError();
        if (!first.Value().fails)
            return Error{ErrorCode::Unsupported, "the recording does not fail in this way when it is played"};
        program_ = std::move(first.Value().used);
        // Bodies first: each takes the calls that name it along. The failure moves as bodies disappear, so that steps
        // may be left out that had to stay before, and in turn.
        for (size_t before = 0; before != program_.size() && !IsUsedUp();) {
            before = program_.size();
            if (MaybeError error = LeaveOut([](const ProgramCall& call) { return call.creates; })) return *error;
            if (MaybeError error = LeaveOut([](const ProgramCall&) { return true; })) return *error;
        }
        report.after = SizeOf(program_);
        report.replays = replays_;
        Result<Outcome> last = Play(program_, &report.recording);
        if (!last) return last.GetError();
        return report;
    }

private:
    Program WholeProgram() const {
        Program program;
        const auto entries = recording_.Entries();
        for (size_t i = 0; i < entries.size(); ++i) {
            if (entries[i].kind != EntryKind::Call) continue;
            const CallRow& row = CallRows()[entries[i].row];
            const BatchSize batch = SizeOfBatch(recording_, i, objects_);
            for (size_t part = 0; part < batch.bodies + batch.joints; ++part)
                program.push_back({i, part, false, true, part < batch.bodies});
            if (batch.bodies + batch.joints == 0)
                program.push_back(
                    {i, ProgramCall::kWhole, row.tag == StepTag(), row.noteCreated != nullptr, row.tag == CreateTag()});
        }
        return program;
    }

    ProgramSize SizeOf(const Program& program) const {
        ProgramSize size{.calls = program.size()};
        for (const ProgramCall& call : program) {
            size.steps += call.isStep;
            size.bodies += call.createsBody;
        }
        return size;
    }

    bool IsUsedUp() const { return replays_ >= settings_.mostReplays; }

    // Leaves out what it can of the calls that are `eligible`, in runs of them: half of them, then a quarter and so on.
    template <class Eligible>
    MaybeError LeaveOut(const Eligible& eligible) {
        const auto places = [&] {
            std::vector<size_t> found;
            for (size_t i = 0; i < program_.size(); ++i)
                if (eligible(program_[i])) found.push_back(i);
            return found;
        };
        std::vector<size_t> candidates = places();
        for (size_t length = (candidates.size() + 1) / 2; length > 0; length /= 2) {
            // From the end: later calls depend on earlier ones.
            for (size_t end = candidates.size(); end > 0 && !IsUsedUp();) {
                const size_t begin = end - std::min(length, end);
                Program shorter;
                for (size_t i = 0, next = begin; i < program_.size(); ++i) {
                    if (next < end && i == candidates[next]) ++next;
                    else shorter.push_back(program_[i]);
                }
                Result<Outcome> outcome = Play(shorter, nullptr);
                if (!outcome) return outcome.GetError();
                if (outcome.Value().fails) {
                    program_ = std::move(outcome.Value().used);
                    candidates = places();
                    end = std::min(begin, candidates.size());
                } else {
                    end = begin;
                }
            }
        }
        return {};
    }

    // Plays a program up to its failure; `recorded`, if not null, becomes a recording of the first world.
    Result<Outcome> Play(const Program& program, std::vector<std::byte>* recorded) {
        ++replays_;
        if (settings_.progress) settings_.progress(replays_, program.size());
        const CallRecorder::Sink none;
        if (settings_.isolation) {
            IsolatedRun run = settings_.isolation(
                [&](const CallRecorder::Sink& send) { (void)bool(PlayHere(program, recorded ? send : none)); });
            if (recorded) *recorded = std::move(run.sent);
            return Outcome{run.hasDied, program};
        }
        if (!recorded) return PlayHere(program, none);
        return PlayHere(program, [recorded](std::span<const std::byte> bytes) {
            recorded->insert(recorded->end(), bytes.begin(), bytes.end());
            return true;
        });
    }

    Result<Outcome> PlayHere(const Program& program, const CallRecorder::Sink& record) {
        std::vector<CallPlayer> players;
        std::vector<PhysicsSystem*> worlds;
        players.reserve(settings_.jobs.size());
        for (JobSystem* const jobs : settings_.jobs) {
            players.emplace_back(recording_, objects_, settings_.sources, true);
            if (Status started = players.back().Start(jobs); !started) return started.GetError();
            worlds.push_back(&players.back().System());
        }
        std::unique_ptr<CallRecorder> recorder;
        if (record) {
            auto created = CallRecorder::Create(*worlds[0], record, settings_.sources.customShapes);
            if (!created) return created.GetError();
            recorder = std::move(created.Value());
        }
        Outcome outcome;
        for (const ProgramCall& call : program) {
            bool isDone = false;
            for (CallPlayer& player : players) {
                const Result<PlayedCall> played =
                    call.part == ProgramCall::kWhole ? player.Play(call.entry) : player.PlayPart(call.entry, call.part);
                if (!played) return played.GetError();
                isDone |= played.Value().isDone;
            }
            if (isDone) outcome.used.push_back(call);
            if (call.isStep && failure_ && failure_(worlds)) {
                outcome.fails = true;
                break;
            }
        }
        return outcome;
    }

    const CallRecording& recording_;
    const RecordedObjects& objects_;
    const FailureCheck& failure_;
    const ShrinkSettings& settings_;
    Program program_;
    size_t replays_ = 0;
};

template <class Fails>
bool AnyBody(const PhysicsSystem& system, const Fails& fails) {
    bool found = false;
    system.VisitBodies([&](BodyId id) { found |= fails(system.Bodies(), id); });
    return found;
}

}  // namespace

FailureCheck FailureOfFrozenBody() {
    return [](std::span<PhysicsSystem* const> worlds) {
        return AnyBody(*worlds[0], [](const BodyInterface& bodies, BodyId id) { return bodies.IsFrozen(id); });
    };
}

FailureCheck FailureOfSpeed(float speed) {
    return [speed](std::span<PhysicsSystem* const> worlds) {
        return AnyBody(*worlds[0], [speed](const BodyInterface& bodies, BodyId id) {
            return Length(bodies.GetLinearVelocity(id)) > speed;
        });
    };
}

FailureCheck FailureOfHeight(double height) {
    return [height](std::span<PhysicsSystem* const> worlds) {
        return AnyBody(*worlds[0], [height](const BodyInterface& bodies, BodyId id) {
            return bodies.GetMotionType(id) == MotionType::Dynamic && bodies.GetCenterOfMass(id).y() < height;
        });
    };
}

FailureCheck FailureOfDifference() {
    return [](std::span<PhysicsSystem* const> worlds) {
        const uint64_t hash = worlds[0]->HashState();
        return !std::ranges::all_of(worlds, [&](PhysicsSystem* world) { return world->HashState() == hash; });
    };
}

Result<ShrinkReport> Shrink(const CallRecording& recording, const FailureCheck& failure,
                            const ShrinkSettings& settings) {
    const DefaultFloats floats;
    if (settings.jobs.empty()) return Error{ErrorCode::OutOfRange, "jobs is empty; the program needs a world"};
    if (!failure && !settings.isolation) return Error{ErrorCode::Unsupported, "failure is empty; nothing would fail"};
    const Result<RecordedObjects> objects = ReadObjects(recording, settings.sources);
    if (!objects) return objects.GetError();
    return Shrinker(recording, objects.Value(), failure, settings).Run();
}

}  // namespace fulcrum
