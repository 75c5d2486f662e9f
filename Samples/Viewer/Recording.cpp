#include <Fulcrum/Samples/Viewer/Recording.h>

#include <algorithm>
#include <utility>

namespace fulcrum {
namespace {

bool IsFinite(const RecordedState& s) {
    return fulcrum::IsFinite(s.position) && fulcrum::IsFinite(s.rotation) && fulcrum::IsFinite(s.velocity);
}

bool IsEqual(const RecordedState& a, const RecordedState& b) {
    return a.position == b.position && a.rotation.x == b.rotation.x && a.rotation.y == b.rotation.y &&
           a.rotation.z == b.rotation.z && a.rotation.w == b.rotation.w && a.velocity == b.velocity && a.awake == b.awake &&
           a.island == b.island;
}

// Halves the number of frames with contacts until they fit.
void ThinContacts(Recording& recording) {
    while (recording.contactCount > kMostContacts) {
        recording.contactInterval *= 2;
        for (size_t i = 0; i < recording.frames.size(); ++i) {
            RecordedFrame& frame = recording.frames[i];
            if (!frame.hasContacts || i % recording.contactInterval == 0) continue;
            recording.contactCount -= frame.contacts.size();
            frame.contacts = {};
            frame.hasContacts = false;
        }
    }
}

std::vector<RecordedContact> EvenChoice(std::span<const RecordedContact> contacts) {
    const size_t count = std::min(contacts.size(), kMostContactsPerFrame);
    std::vector<RecordedContact> chosen(count);
    for (size_t i = 0; i < count; ++i) chosen[i] = contacts[i * contacts.size() / count];
    return chosen;
}

}  // namespace

bool WantsContacts(const Recording& recording) {
    return recording.frames.size() % recording.contactInterval == 0;
}

void AppendFrame(Recording& recording, double time, std::span<const RecordedState> states,
                 std::span<const RecordedContact> contacts) {
    RecordedFrame frame;
    frame.time = time;
    for (size_t i = recording.latest.size(); i < recording.bodies.size(); ++i)
        recording.latest.emplace_back().body = static_cast<uint32_t>(i);
    for (const RecordedState& state : states) {
        RecordedState& latest = recording.latest[state.body];
        if (!IsFinite(state) || (!recording.frames.empty() && IsEqual(state, latest))) continue;
        latest = state;
        frame.states.push_back(state);
    }
    if (WantsContacts(recording)) {
        frame.contacts = EvenChoice(contacts);
        frame.hasContacts = true;
        recording.contactCount += frame.contacts.size();
        recording.largestContactCut = std::max(recording.largestContactCut, contacts.size() - frame.contacts.size());
    }
    recording.frames.push_back(std::move(frame));
    ThinContacts(recording);
}

}  // namespace fulcrum
