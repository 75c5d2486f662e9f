#include <Fulcrum/Samples/Runner/JointRecorder.h>

#include <Fulcrum/Constraints/Joints/ConeJoint.h>
#include <Fulcrum/Constraints/Joints/DistanceJoint.h>
#include <Fulcrum/Constraints/Joints/GearJoint.h>
#include <Fulcrum/Constraints/Joints/HingeJoint.h>
#include <Fulcrum/Constraints/Joints/LockJoint.h>
#include <Fulcrum/Constraints/Joints/PathJoint.h>
#include <Fulcrum/Constraints/Joints/PulleyJoint.h>
#include <Fulcrum/Constraints/Joints/RackAndPinionJoint.h>
#include <Fulcrum/Constraints/Joints/SixDofJoint.h>
#include <Fulcrum/Constraints/Joints/SliderJoint.h>
#include <Fulcrum/Constraints/Joints/SwingTwistJoint.h>
#include <Fulcrum/Constraints/Joints/WheelJoint.h>

#include <algorithm>

namespace fulcrum {
namespace {

using Kind = RecordedJointKind;

constexpr int kPathPointsPerSegment = 16;
constexpr int kMostPathPoints = 2000;

void AddPath(const Path& path, RecordedJoint& joint) {
    joint.isClosed = path.IsClosed();
    const int count = std::clamp(static_cast<int>(path.End()) * kPathPointsPerSegment, 1, kMostPathPoints);
    for (int i = 0; i <= count; ++i) joint.points.push_back(path.Sample(path.End() * i / count).position);
}

bool HasHardLength(const AxisControl* control) { return control && IsHard(control->limits.spring); }

// Kind, and what only this kind has. A type of the user's own is known by none of these classes.
void AddKind(const JointType& type, const AxisControl* length, const Position& origin, RecordedJoint& joint) {
    const auto is = [&type]<class T>(const T*& as) { return (as = dynamic_cast<const T*>(&type)) != nullptr; };
    const SwingTwistJoint* swingTwist;
    const SixDofJoint* sixDof;
    const GearJoint* gear;
    const RackAndPinionJoint* rack;
    const PulleyJoint* pulley;
    const PathJoint* path;
    if (dynamic_cast<const LockJoint*>(&type)) {
        joint.kind = type.Locks().angular == AngularLock::All ? Kind::Fixed : Kind::Point;
    } else if (dynamic_cast<const DistanceJoint*>(&type)) {
        joint.kind = Kind::Distance;
        joint.isHardLength = HasHardLength(length);
    } else if (dynamic_cast<const HingeJoint*>(&type)) {
        joint.kind = Kind::Hinge;
    } else if (dynamic_cast<const SliderJoint*>(&type)) {
        joint.kind = Kind::Slider;
    } else if (dynamic_cast<const ConeJoint*>(&type)) {
        joint.kind = Kind::Cone;
    } else if (is(swingTwist)) {
        joint.kind = Kind::SwingTwist;
        joint.isPyramid = swingTwist->Shape() == SwingShape::Pyramid;
    } else if (is(sixDof)) {
        joint.kind = Kind::SixDof;
        joint.isPyramid = sixDof->Shape() == SwingShape::Pyramid;
    } else if (is(gear)) {
        joint.kind = Kind::Gear;
        joint.ratio = gear->Ratio();
    } else if (is(rack)) {
        joint.kind = Kind::RackAndPinion;
        joint.ratio = rack->Ratio();
    } else if (is(pulley)) {
        joint.kind = Kind::Pulley;
        joint.ratio = pulley->Ratio();
        joint.isHardLength = HasHardLength(length);
        for (const Position& point : {pulley->FixedPointA(), pulley->FixedPointB()})
            joint.points.push_back((point - origin).cast<float>());
    } else if (is(path)) {
        joint.kind = Kind::Path;
        AddPath(path->GetPath(), joint);
    } else {
        joint.kind = dynamic_cast<const WheelJoint*>(&type) ? Kind::Wheel : Kind::Custom;
    }
}

RecordedJointState StateOf(const JointInterface& joints, JointId id, uint32_t joint) {
    RecordedJointState state{.joint = joint, .enabled = joints.IsEnabled(id)};
    for (size_t k = 0; k < state.limits.size(); ++k) {
        const AxisControl* control = joints.GetControl(id, static_cast<JointAxis>(k));
        if (control && control->limited) state.limits[k] = {control->limits.min, control->limits.max};
    }
    if (const auto* cone = dynamic_cast<const ConeJoint*>(joints.GetType(id)))
        state.limits[static_cast<size_t>(JointAxis::AngularY)] = {0.0f, cone->HalfAngle()};
    return state;
}

// Of what it locks; of a rod or rope that is not springy how far it is out of its range.
JointError ErrorOf(const JointInterface& joints, JointId id, const RecordedJoint& joint, const RecordedRange& length) {
    JointError error = joints.GetError(id);
    if (joint.isHardLength) {
        const auto now = static_cast<float>(joints.GetCoordinate(id, JointAxis::LinearX));
        error.distance = std::max({0.0f, length.min - now, now - length.max});
    }
    return error;
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
        states_.push_back(StateOf(source, ids_[i], i));
        if (!states_.back().enabled) continue;
        const JointError error = ErrorOf(source, ids_[i], joints[i], states_.back().limits[0]);
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
    joint.bodyA = *bodyA;
    joint.bodyB = *bodyB;
    joint.frameA = Relative(system_.Bodies().GetPose(a), source.GetFrameA(id));
    joint.frameB = Relative(system_.Bodies().GetPose(b), source.GetFrameB(id));
    joint.linearLock = static_cast<RecordedLinearLock>(locks.linear);
    joint.angularLock = static_cast<RecordedAngularLock>(locks.angular);
    joint.line = locks.line;
    joint.axis = locks.axis;
    AddKind(type, source.GetControl(id, JointAxis::LinearX), origin_, joint);
    joints.push_back(std::move(joint));
    ids_.push_back(id);
}

}  // namespace fulcrum
