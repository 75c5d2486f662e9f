#include <Fulcrum/Physics/Recording/Replay.h>

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Recording/CallPlayer.h>
#include <Fulcrum/Physics/Recording/RecordingFormat.h>

#include <algorithm>

namespace fulcrum {

namespace {

constexpr uint64_t kMostStepsToABody = 600;

class Replayer {
public:
    Replayer(const CallRecording& recording, const ReplaySettings& settings, const RecordedObjects& objects)
        : recording_(recording), settings_(settings), player_(recording, objects, settings.sources, false) {}

    Result<ReplayReport> Run() {
        if (Status started = player_.Start(settings_.jobs); !started) return started.GetError();
        const auto entries = recording_.Entries();
        for (size_t i = 0; i < entries.size(); ++i) {
            if (MaybeError error = Play(i)) return *error;
            const bool isSearching = report_.divergence && report_.divergence->bodies.empty();
            if (isStopped_ || (report_.divergence && !isSearching)) break;
            if (isSearching && report_.steps >= report_.divergence->step + kMostStepsToABody) break;
        }
        if (report_.divergence) Describe(*report_.divergence);
        report_.stateHash = player_.System().HashState();
        return std::move(report_);
    }

private:
    MaybeError Play(size_t number) {
        const CallRecording::Entry& entry = recording_.Entries()[number];
        switch (entry.kind) {
            case EntryKind::Call: return PlayCall(number);
            case EntryKind::Bodies: CompareBodies(entry); return {};
            case EntryKind::Step: EndStep(entry); return {};
            default: return {};
        }
    }

    MaybeError PlayCall(size_t number) {
        const CallRow& row = CallRows()[recording_.Entries()[number].row];
        isInStep_ = row.tag == StepTag();
        const Result<PlayedCall> played = player_.Play(number);
        if (!played) return played.GetError();
        ++report_.calls;
        if (row.tag == StepTag()) ++report_.steps;
        const PlayedCall& call = played.Value();
        if (row.noteCreated && call.created != call.recorded && !report_.divergence) {
            report_.divergence = Divergence{.step = report_.steps + 1};
            why_ = std::string(row.name) + " created something else than when it was recorded";
            if (!call.isDone) why_ += ": " + call.error.message;
        }
        return {};
    }

    // Before a step that follows other calls, and after each.
    void CompareBodies(const CallRecording::Entry& entry) {
        const std::span<const std::byte> data = recording_.DataOf(entry);
        for (size_t at = 0; at < data.size(); at += sizeof(BodyHash)) {
            BodyHash changed;
            std::memcpy(&changed, data.data() + at, sizeof changed);
            if (changed.body >= kMostBodies) continue;
            expected_.resize(std::max(expected_.size(), size_t{changed.body} + 1));
            expected_[changed.body] = changed.hash;
        }
        hashes_.Update(player_.System());
        if (std::ranges::equal(hashes_.All(), expected_)) return;
        if (report_.divergence && !report_.divergence->bodies.empty()) return;
        std::vector<uint32_t> differing;
        const size_t count = std::max(expected_.size(), hashes_.All().size());
        const auto at = [](const std::vector<uint32_t>& hashes, size_t i) { return i < hashes.size() ? hashes[i] : 0; };
        for (uint32_t i = 0; i < count; ++i)
            if (at(expected_, i) != at(hashes_.All(), i)) differing.push_back(i);
        if (differing.empty()) return;
        if (!report_.divergence) report_.divergence = Divergence{.step = StepNow(), .isInStep = isInStep_};
        report_.divergence->bodiesStep = StepNow();
        std::vector<BodyId> existing(count);
        player_.System().VisitBodies([&](BodyId id) { existing[id.index] = id; });
        for (const uint32_t i : differing)  // one that does not exist here has its index alone
            report_.divergence->bodies.push_back(existing[i].index == i ? existing[i] : BodyId{i, 0});
    }

    void EndStep(const CallRecording::Entry& entry) {
        uint64_t hash = 0;
        std::memcpy(&hash, recording_.DataOf(entry).data(), sizeof hash);
        const bool isSame = hash == player_.System().HashState();
        if (!isSame && !report_.divergence) report_.divergence = Divergence{.step = report_.steps, .isInStep = true};
        if (settings_.afterStep && !settings_.afterStep(player_.System())) isStopped_ = true;
    }

    // The step to which a difference belongs: the one that has just ended, or the next.
    uint64_t StepNow() const { return report_.steps + (isInStep_ ? 0 : 1); }

    void Describe(Divergence& divergence) const {
        std::string& what = divergence.what;
        what = "step " + std::to_string(divergence.step) + " differs";
        if (!divergence.isInStep) what = "calls before step " + std::to_string(divergence.step) + " had another effect";
        if (!why_.empty()) what += ": " + why_;
        if (divergence.bodies.empty()) {
            what += ": contacts, joints or timers, no body until step " + std::to_string(report_.steps);
            return;
        }
        if (divergence.bodiesStep != divergence.step)
            what += " in contacts, joints or timers, at step " + std::to_string(divergence.bodiesStep);
        what += divergence.bodies.size() == 1 ? ": body" : ": bodies";
        constexpr size_t kMost = 8;
        for (size_t i = 0; i < std::min(divergence.bodies.size(), kMost); ++i)
            what += (i ? ", " : " ") + std::to_string(divergence.bodies[i].index);
        if (divergence.bodies.size() > kMost)
            what += " and " + std::to_string(divergence.bodies.size() - kMost) + " more";
    }

    static constexpr uint32_t kMostBodies = 1u << 28;

    const CallRecording& recording_;
    const ReplaySettings& settings_;
    CallPlayer player_;
    ReplayReport report_;
    std::string why_;
    BodyHashes hashes_;
    std::vector<uint32_t> expected_;  // hashes of bodies, by index
    bool isInStep_ = false, isStopped_ = false;
};

}  // namespace

Result<ReplayReport> Replay(const CallRecording& recording, const ReplaySettings& settings) {
    const DefaultFloats floats;
    const Result<RecordedObjects> objects = ReadObjects(recording, settings.sources);
    if (!objects) return objects.GetError();
    return Replayer(recording, settings, objects.Value()).Run();
}

}  // namespace fulcrum
