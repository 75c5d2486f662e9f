#include <Fulcrum/Samples/Runner/JointRecorder.h>

#include <Fulcrum/Constraints/Joints/JointDrawing.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

constexpr int kPathPointsPerSegment = 16;
constexpr int kMostPathPoints = 2000;

void AddPath(const Path& path, RecordedJoint& joint) {
    joint.isClosed = path.IsClosed();
    const int count = std::clamp(static_cast<int>(path.End()) * kPathPointsPerSegment, 1, kMostPathPoints);
    for (int i = 0; i <= count; ++i) joint.points.push_back(path.Sample(path.End() * i / count).position);
}

void AddDrawing(const JointDrawing& drawing, const AxisControl* length, const Position& origin, RecordedJoint& joint) {
    joint.rotations = drawing.rotations;
    joint.translations = drawing.translations;
    joint.steering = drawing.steering;
    joint.trackA = drawing.trackA;
    joint.trackB = drawing.trackB;
    joint.isPyramid = drawing.isPyramid;
    joint.coneAngle = drawing.coneAngle;
    joint.circleA = drawing.circleA;
    joint.circleB = drawing.circleB;
    joint.isRope = drawing.isRope;
    joint.isHardLength = drawing.isRope && length && IsHard(length->limits.spring);
    joint.ratio = drawing.ropeRatio;
    for (const Position& point : drawing.ropePoints) joint.points.push_back((point - origin).cast<float>());
    joint.isPath = drawing.path != nullptr;
    if (drawing.path) AddPath(*drawing.path, joint);
}

RecordedJointState StateOf(const JointInterface& joints, JointId id, uint32_t index, const RecordedJoint& joint) {
    RecordedJointState state{.joint = index, .enabled = joints.IsEnabled(id)};
    for (size_t k = 0; k < state.limits.size(); ++k) {
        const AxisControl* control = joints.GetControl(id, static_cast<JointAxis>(k));
        if (control && control->limited) state.limits[k] = {control->limits.min, control->limits.max};
    }
    if (std::isfinite(joint.coneAngle))
        for (const JointAxis axis : {JointAxis::AngularY, JointAxis::AngularZ})
            state.limits[static_cast<size_t>(axis)] = {-joint.coneAngle, joint.coneAngle};
    return state;
}

}  // namespace

RecordedFrameJoints JointRecorder::Collect(std::vector<RecordedJoint>& joints) {
    const JointInterface& source = system_.Joints();
    source.Visit([&](JointId id) { AddNew(id, joints); });
    states_.clear();
    RecordedJointErrors errors;
    for (uint32_t i = 0; i < ids_.size(); ++i) {
        if (!source.Exists(ids_[i])) {
            states_.push_back({.joint = i, .enabled = false});
            continue;
        }
        states_.push_back(StateOf(source, ids_[i], i, joints[i]));
        if (!states_.back().enabled) continue;
        const JointError error = source.GetError(ids_[i]);
        if (error.distance > errors.distance) {
            errors.distance = error.distance;
            errors.distanceJoint = i;
        }
        if (error.angle > errors.angle) {
            errors.angle = error.angle;
            errors.angleJoint = i;
        }
    }
    return {states_, errors};
}

void JointRecorder::AddNew(JointId id, std::vector<RecordedJoint>& joints) {
    if (seen_.size() <= id.index) seen_.resize(id.index + 1);
    if (seen_[id.index] == id) return;
    seen_[id.index] = id;
    const JointInterface& source = system_.Joints();
    const BodyId a = source.GetBodyA(id), b = source.GetBodyB(id);
    const std::optional<uint32_t> bodyA = bodyOf_(a), bodyB = bodyOf_(b);
    if (!bodyA || !bodyB) return;
    const JointType& type = *source.GetType(id);
    const JointLocks locks = type.Locks();
    RecordedJoint joint;
    joint.kind = type.Kind();
    joint.bodyA = *bodyA;
    joint.bodyB = *bodyB;
    joint.frameA = Relative(system_.Bodies().GetPose(a), source.GetFrameA(id));
    joint.frameB = Relative(system_.Bodies().GetPose(b), source.GetFrameB(id));
    joint.linearLock = static_cast<RecordedLinearLock>(locks.linear);
    joint.angularLock = static_cast<RecordedAngularLock>(locks.angular);
    joint.line = locks.line;
    joint.axis = locks.axis;
    AddDrawing(type.Drawing(), source.GetControl(id, JointAxis::LinearX), origin_, joint);
    joints.push_back(std::move(joint));
    ids_.push_back(id);
}

}  // namespace fulcrum
