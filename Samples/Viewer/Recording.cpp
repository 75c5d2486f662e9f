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
           a.rotation.z == b.rotation.z && a.rotation.w == b.rotation.w && a.velocity == b.velocity &&
           a.awake == b.awake && a.island == b.island && a.isThere == b.isThere;
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

void AppendJoints(Recording& recording, const RecordedFrameJoints& joints, RecordedFrame& frame) {
    for (size_t i = recording.latestJoints.size(); i < recording.joints.size(); ++i)
        recording.latestJoints.push_back({.joint = static_cast<uint32_t>(i), .enabled = false});
    for (const RecordedJointState& state : joints.states) {
        if (state.joint >= recording.latestJoints.size() || state == recording.latestJoints[state.joint]) continue;
        recording.latestJoints[state.joint] = state;
        frame.joints.push_back(state);
    }
    frame.jointErrors = joints.errors;
}

void AppendDrawing(const RecordedFrameDrawing& drawing, RecordedFrame& frame) {
    for (const RecordedLine& line : drawing.lines)
        if (fulcrum::IsFinite(line.from) && fulcrum::IsFinite(line.to)) frame.lines.push_back(line);
    for (const RecordedPoint& point : drawing.points)
        if (fulcrum::IsFinite(point.place)) frame.points.push_back(point);
}

}  // namespace

bool WantsContacts(const Recording& recording) { return recording.frames.size() % recording.contactInterval == 0; }

void AppendFrame(Recording& recording, double time, std::span<const RecordedState> states,
                 std::span<const RecordedContact> contacts, const RecordedFrameJoints& joints,
                 const RecordedFrameDrawing& drawing, std::span<const RecordedShapeChange> shapes,
                 const RecordedFigures& figures) {
    RecordedFrame frame;
    frame.figures = figures;
    frame.time = time;
    const size_t known = recording.latest.size();
    for (size_t i = known; i < recording.bodies.size(); ++i)
        recording.latest.emplace_back().body = static_cast<uint32_t>(i);
    for (const RecordedState& state : states) {
        if (state.body >= recording.latest.size() || !IsFinite(state)) continue;
        RecordedState& latest = recording.latest[state.body];
        if (state.body < known && !IsEqual(state, latest)) frame.states.push_back(state);
        latest = state;
    }
    // New bodies come last, and with the frame, whether named or not.
    frame.states.insert(frame.states.end(), recording.latest.begin() + static_cast<ptrdiff_t>(known),
                        recording.latest.end());
    if (WantsContacts(recording)) {
        frame.contacts = EvenChoice(contacts);
        frame.hasContacts = true;
        recording.contactCount += frame.contacts.size();
        recording.largestContactCut = std::max(recording.largestContactCut, contacts.size() - frame.contacts.size());
    }
    AppendJoints(recording, joints, frame);
    AppendDrawing(drawing, frame);
    frame.shapes.assign(shapes.begin(), shapes.end());
    recording.frames.push_back(std::move(frame));
    ThinContacts(recording);
}

std::vector<RecordedPresence> PresencesOf(const Recording& recording) {
    std::vector<std::vector<RecordedPresence>> ofBody(recording.bodies.size());
    for (size_t i = 0; i < recording.frames.size(); ++i) {
        for (const RecordedState& state : recording.frames[i].states) {
            std::vector<RecordedPresence>& own = ofBody[state.body];
            if (own.empty())
                own.push_back({state.body, recording.bodies[state.body].shape, i, recording.frames.size()});
            if (!state.isThere) own.back().until = i;
        }
        for (const RecordedShapeChange& change : recording.frames[i].shapes) {
            std::vector<RecordedPresence>& own = ofBody[change.body];
            if (own.empty() || own.back().until <= i) continue;
            if (own.back().from < i) {
                own.back().until = i;
                own.push_back({change.body, change.shape, i, recording.frames.size()});
            }
            own.back().shape = change.shape;
        }
    }
    std::vector<RecordedPresence> all;
    for (const auto& own : ofBody)
        std::copy_if(own.begin(), own.end(), std::back_inserter(all),
                     [](const RecordedPresence& one) { return one.from < one.until; });
    return all;
}

Status CheckRecording(const Recording& recording) {
    const auto unknown = [](const char* user, size_t index, const char* used, size_t number) {
        return Error{ErrorCode::UnknownId, std::string("the recording's ") + user + " " + std::to_string(index) +
                                               " names " + used + " " + std::to_string(number) + ", which it lacks"};
    };
    for (size_t i = 0; i < recording.shapes.size(); ++i) {
        const RecordedShape& shape = recording.shapes[i];
        for (const RecordedChild& child : shape.children)
            if (child.shape >= i) return unknown("shape", i, "the earlier shape", child.shape);
        for (const auto& triangle : shape.triangles)
            for (uint32_t corner : triangle)
                if (corner >= shape.vertices.size()) return unknown("shape", i, "the vertex", corner);
    }
    for (size_t i = 0; i < recording.bodies.size(); ++i)
        if (recording.bodies[i].shape >= recording.shapes.size())
            return unknown("body", i, "the shape", recording.bodies[i].shape);
    for (size_t i = 0; i < recording.joints.size(); ++i)
        if (const uint32_t body = std::max(recording.joints[i].bodyA, recording.joints[i].bodyB);
            body >= recording.bodies.size())
            return unknown("joint", i, "the body", body);
    for (size_t i = 0; i < recording.frames.size(); ++i) {
        const RecordedFrame& frame = recording.frames[i];
        for (const RecordedJointState& state : frame.joints)
            if (state.joint >= recording.joints.size()) return unknown("frame", i, "the joint", state.joint);
        if (const uint32_t joint = std::max(frame.jointErrors.distanceJoint, frame.jointErrors.angleJoint);
            joint > 0 && joint >= recording.joints.size())
            return unknown("frame", i, "the joint", joint);
        for (const RecordedState& state : frame.states)
            if (state.body >= recording.bodies.size()) return unknown("frame", i, "the body", state.body);
        for (const RecordedShapeChange& change : frame.shapes) {
            if (change.body >= recording.bodies.size()) return unknown("frame", i, "the body", change.body);
            if (change.shape >= recording.shapes.size()) return unknown("frame", i, "the shape", change.shape);
        }
        if (const uint32_t body = std::max(frame.figures.deepestA, frame.figures.deepestB);
            body > 0 && body >= recording.bodies.size())
            return unknown("frame", i, "the body", body);
        for (const RecordedContact& contact : frame.contacts)
            if (const uint32_t body = std::max(contact.bodyA, contact.bodyB); body >= recording.bodies.size())
                return unknown("frame", i, "the body", body);
    }
    return Done{};
}

}  // namespace fulcrum
