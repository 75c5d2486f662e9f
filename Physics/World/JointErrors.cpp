#include <Fulcrum/Physics/World/JointErrors.h>

#include <Fulcrum/Constraints/Joints/RowErrors.h>
#include <Fulcrum/Constraints/Parts/HingeRotationPart.h>
#include <Fulcrum/Constraints/Parts/RotationEulerPart.h>
#include <Fulcrum/Physics/World/BodyReading.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

JointError ErrorOfLocks(const JointLocks& locks, const JointPose& pose) {
    JointError error;
    const auto axisOf = [](const Quaternion& frame, int k) { return Rotate(frame, Vector3(Vector3::Unit(k))); };
    if (locks.linear == LinearLock::Point) error.distance = Length(pose.offset);
    if (locks.linear == LinearLock::Line) {
        const Vector3 line = axisOf(pose.frameA, locks.line);
        error.distance = Length(Vector3(pose.offset - line * Dot(line, pose.offset)));
    }
    if (locks.angular == AngularLock::All)
        error.angle = Length(RotationVectorOf<float>(pose.frameB * pose.frameA.Conjugate()));
    if (locks.angular == AngularLock::Axis) {
        const Vector3 b = axisOf(pose.frameB, (locks.axis + 1) % 3), c = axisOf(pose.frameB, (locks.axis + 2) % 3);
        const Vec2<float> hinge = HingeError<float>(axisOf(pose.frameA, locks.axis), b, c);
        error.angle = std::sqrt(hinge.x() * hinge.x() + hinge.y() * hinge.y());
    }
    return error;
}

// C as an error, m or rad, >= 0, with that of springs.
float StretchOf(const JointRow& row) {
    if (row.kind == JointRow::Kind::Spring) return std::fabs(row.error);
    return row.kind == JointRow::Kind::SpringAtLeast ? std::max(0.0f, -row.error) : ErrorOf(row);
}

template <class ErrorOfRow>
JointError ErrorOfRows(const JointType& type, JointPose pose, const ErrorOfRow& errorOf) {
    if (type.MaxRows() == 0) return {};
    pose.dt = pose.substepDt = 1.0f / 60;  // of any step: it only adds limits that are not exceeded
    JointRowList list;
    type.RowsAt(pose, list);
    RowErrors errors;
    for (uint32_t i = 0; i < list.count; ++i) {
        const JointRow& row = list.rows[i];
        if (std::isfinite(row.error)) errors.Add(errorOf(row), IsAngle(row), row.isLock);
    }
    return errors.Largest();
}

template <class ErrorOfRow>
JointError ErrorOfJoint(const WorldState& world, uint32_t index, const ErrorOfRow& errorOf) {
    const JointPose pose = PoseOf(world, index);
    const JointType& type = *world.joints.types[index];
    const JointError locks = ErrorOfLocks(type.Locks(), pose), rows = ErrorOfRows(type, pose, errorOf);
    return {std::max(locks.distance, rows.distance), std::max(locks.angle, rows.angle)};
}

}  // namespace

Pose AnchorFrameOf(const WorldState& world, uint32_t index, int side) {
    const JointRecord& record = world.joints.records[index];
    const float(&point)[3] = side == 0 ? record.anchorA : record.anchorB;
    const float(&frame)[4] = side == 0 ? record.frameA : record.frameB;
    const Pose center = world.bodies.CenterPoseOf(world.joints.joints[index].body[side]);
    return {center.Transform(Vector3(point[0], point[1], point[2])),
            center.rotation * Quaternion{frame[0], frame[1], frame[2], frame[3]}};
}

JointPose PoseOf(const WorldState& world, uint32_t index) {
    const Joint& joint = world.joints.joints[index];
    const Pose a = AnchorFrameOf(world, index, 0), b = AnchorFrameOf(world, index, 1);
    JointPose pose;
    pose.armA = (a.position - world.bodies.CenterOf(joint.body[0])).cast<float>();
    pose.armB = (b.position - world.bodies.CenterOf(joint.body[1])).cast<float>();
    pose.offset = (b.position - a.position).cast<float>();
    pose.frameA = a.rotation;
    pose.frameB = b.rotation;
    pose.anchorA = a.position;
    if (joint.type) {
        pose.turnedA = joint.type->turnedA;
        pose.turnedB = joint.type->turnedB;
    }
    return pose;
}

JointError ErrorOfJoint(const WorldState& world, uint32_t index) {
    const JointType& type = *world.joints.types[index];
    return ErrorOfJoint(world, index, [&](const JointRow& row) {
        const bool isAtLimit = IsAtForceLimit(row.error, type.forces[row.slot], row.minForce, row.maxForce);
        return isAtLimit ? 0.0f : ErrorOf(row);
    });
}

JointError StretchOfJoint(const WorldState& world, uint32_t index) { return ErrorOfJoint(world, index, StretchOf); }

}  // namespace fulcrum
