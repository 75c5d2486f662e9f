#include <Fulcrum/Samples/Viewer/PageJoints.h>

#include <Fulcrum/Samples/Viewer/PageColumn.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

constexpr double kMost = 1e9;  // m or rad; larger numbers are clamped, so that 53 bits hold their steps

// NaN counts as 0.
int64_t StepsOf(double value, double step) {
    return value == value ? std::llround(std::clamp(value, -kMost, kMost) / step) : 0;
}

Steps3 PlaceSteps(const Vector3& v) {
    return {StepsOf(v.x(), kJointStep), StepsOf(v.y(), kJointStep), StepsOf(v.z(), kJointStep)};
}

using FrameSteps = std::array<int64_t, 7>;

FrameSteps StepsOf(const RelativePose& pose) {
    const Steps3 place = PlaceSteps(pose.position);
    const Quaternion& q = pose.rotation;
    const auto turn = [](double part) { return StepsOf(part, 1 / kJointRotationSteps); };
    return {place[0], place[1], place[2], turn(q.x), turn(q.y), turn(q.z), turn(q.w)};
}

// In the order in which they first appear.
std::vector<std::string> KindsOf(const Recording& recording) {
    std::vector<std::string> kinds;
    for (const RecordedJoint& joint : recording.joints)
        if (std::find(kinds.begin(), kinds.end(), joint.kind) == kinds.end()) kinds.push_back(joint.kind);
    return kinds;
}

uint64_t FlagsOf(const RecordedJoint& joint) {
    uint64_t flags = 0, bit = 1;
    for (const bool flag : {joint.isPyramid, joint.isHardLength, joint.isClosed, joint.rotations, joint.translations,
                            joint.steering, joint.isRope, joint.isPath}) {
        if (flag) flags |= bit;
        bit *= 2;
    }
    return flags;
}

// One more than the number; 0: none.
uint64_t TrackOf(const std::optional<int>& axis) { return axis ? static_cast<uint64_t>(*axis + 1) : 0; }
uint64_t CircleOf(const std::optional<float>& radius) {
    return radius ? static_cast<uint64_t>(std::max<int64_t>(0, StepsOf(*radius, kJointStep))) + 1 : 0;
}

Column Joints(const Recording& recording) {
    Column column;
    const std::vector<std::string> kinds = KindsOf(recording);
    int64_t bodyA = 0, bodyB = 0, ratio = 0;
    FrameSteps frameA{}, frameB{};
    for (const RecordedJoint& joint : recording.joints) {
        column.PutUnsigned(static_cast<uint64_t>(std::find(kinds.begin(), kinds.end(), joint.kind) - kinds.begin()));
        column.PutUnsigned(static_cast<uint64_t>(joint.linearLock));
        column.PutUnsigned(static_cast<uint64_t>(joint.angularLock));
        column.PutUnsigned(joint.line);
        column.PutUnsigned(joint.axis);
        column.PutUnsigned(FlagsOf(joint));
        column.PutUnsigned(TrackOf(joint.trackA));
        column.PutUnsigned(TrackOf(joint.trackB));
        column.PutUnsigned(CircleOf(joint.circleA));
        column.PutUnsigned(CircleOf(joint.circleB));
        const FrameSteps newA = StepsOf(joint.frameA), newB = StepsOf(joint.frameB);
        const int64_t newRatio = StepsOf(joint.ratio, kJointRatioStep);
        column.PutSigned(joint.bodyA - bodyA);
        column.PutSigned(joint.bodyB - bodyB);
        column.PutSigned(newRatio - ratio);
        column.PutDifference(newA, frameA);
        column.PutDifference(newB, frameB);
        column.PutUnsigned(joint.points.size());
        Steps3 last{};
        for (const Vector3& point : joint.points) {
            const Steps3 place = PlaceSteps(point);
            column.PutDifference(place, last);
            last = place;
        }
        bodyA = joint.bodyA;
        bodyB = joint.bodyB;
        ratio = newRatio;
        frameA = newA;
        frameB = newB;
    }
    return column;
}

// The ends of all ranges, and which of them there are.
struct Ends {
    std::array<int64_t, 12> steps{};
    uint64_t present = 0;
};

// `last` goes on for ends that there are not.
Ends EndsOf(const RecordedJointState& state, const Ends& last) {
    Ends ends{last.steps, 0};
    for (size_t i = 0; i < ends.steps.size(); ++i) {
        const float end = i % 2 ? state.limits[i / 2].max : state.limits[i / 2].min;
        if (!std::isfinite(end)) continue;
        ends.steps[i] = StepsOf(end, kJointStep);
        ends.present |= uint64_t{1} << i;
    }
    return ends;
}

Column States(const Recording& recording) {
    Column column;
    std::vector<Ends> latest(recording.joints.size());
    for (const RecordedFrame& frame : recording.frames) {
        column.PutUnsigned(frame.joints.size());
        uint32_t expected = 0;
        for (const RecordedJointState& state : frame.joints) {
            column.PutUnsigned(state.joint - expected);
            expected = state.joint + 1;
            Ends& last = latest[state.joint];
            const Ends ends = EndsOf(state, last);
            const bool isOther = ends.present != last.present || ends.steps != last.steps;
            column.PutUnsigned((state.enabled ? 1u : 0u) | (isOther ? 2u : 0u));
            if (!isOther) continue;
            column.PutUnsigned(ends.present);
            for (size_t i = 0; i < ends.steps.size(); ++i)
                if (ends.present >> i & 1) column.PutSigned(ends.steps[i] - last.steps[i]);
            last = ends;
        }
    }
    return column;
}

Column Errors(const Recording& recording) {
    const auto steps = [](float error) {
        return static_cast<uint64_t>(std::max<int64_t>(0, StepsOf(error, kJointErrorStep)));
    };
    Column column;
    for (const RecordedFrame& frame : recording.frames) {
        const RecordedJointErrors& errors = frame.jointErrors;
        column.PutUnsigned(steps(errors.distance));
        column.PutUnsigned(errors.distanceJoint);
        column.PutUnsigned(steps(errors.angle));
        column.PutUnsigned(errors.angleJoint);
    }
    return column;
}

}  // namespace

std::array<std::string, 3> JointColumns(const Recording& recording) {
    if (recording.joints.empty()) return {};
    return {Joints(recording).Bytes(), States(recording).Bytes(), Errors(recording).Bytes()};
}

nlohmann::ordered_json JointHeader(const Recording& recording) {
    return {{"count", recording.joints.size()},     {"kinds", KindsOf(recording)},  {"step", kJointStep},
            {"rotationSteps", kJointRotationSteps}, {"ratioStep", kJointRatioStep}, {"errorStep", kJointErrorStep}};
}

}  // namespace fulcrum
