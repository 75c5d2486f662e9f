// Angles of joint frames: the rotation of frame B relative to frame A about an axis, counted over any number of
// revolutions, and the world axis about which it changes. Called by the joint types. Free functions, no state.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>

namespace fulcrum {

inline constexpr double kFullTurn = 6.283185307179586;

// Rotation about x within q (its twist, see SwingTwist.h), -pi..pi; 0 if q takes x to -x.
inline float TwistAngle(const Quaternion& q) { return q.w < 0.0f ? 2.0f * Atan2(-q.x, -q.w) : 2.0f * Atan2(q.x, q.w); }

// `wrapped` plus the number of whole revolutions that brings it nearest to `expected`, rad.
inline double NearestTurn(double wrapped, double expected) {
    return wrapped + kFullTurn * __builtin_floor((expected - wrapped) / kFullTurn + 0.5);
}

inline const Vector3& AxisOf(const Matrix3& frame, int axis) {
    return axis == 0 ? frame.x : axis == 1 ? frame.y : frame.z;
}

// Rotation angle of frame B relative to A about the axis (0, 1, 2: x, y, z) that the joint keeps aligned. -pi..pi.
inline float AngleAbout(const JointPose& pose, int axis) {
    const Quaternion q = pose.frameA.Conjugate() * pose.frameB;
    return TwistAngle({axis == 0 ? q.x : axis == 1 ? q.y : q.z, 0.0f, 0.0f, q.w});
}
// That axis in world space, unit: halfway between the axes of both frames. With alpha the angle between these, d
// angle/dt = axis . w / cos(alpha / 2), exact if the joint has no error.
inline Vector3 AxisAbout(const JointPose& pose, int axis) {
    const Matrix3 frameA = ToMatrix(pose.frameA), frameB = ToMatrix(pose.frameB);
    return Normalized(Vector3(AxisOf(frameA, axis) + AxisOf(frameB, axis)), AxisOf(frameA, axis));
}

// Whether the axes that the joint keeps aligned are more than 60 degrees apart. The angle about them is then
// ill-defined and may jump, so limits are inactive until the joint has aligned the axes again.
inline bool IsTilted(const JointPose& pose, int axis) {
    return Dot(AxisOf(ToMatrix(pose.frameA), axis), AxisOf(ToMatrix(pose.frameB), axis)) < 0.5f;
}

// An angle counted over any number of revolutions. A body may rotate by more than half a revolution per step: its
// integrated rotation resolves the ambiguity.
struct TurnCount {
    std::array<double, 1> numbers{};  // rad

    double Angle() const { return numbers[0]; }
    // Starts counting at this angle. If it is outside the limits, the number of revolutions is chosen that puts it
    // farthest inside, or nearest to, the limits.
    void Start(double wrapped, const AxisControl& control);
    // The angle after a step in which it changed by approximately `turned`, rad.
    double After(double wrapped, double turned) const { return NearestTurn(wrapped, numbers[0] + turned); }
    void Advance(double wrapped, double turned) { numbers = {After(wrapped, turned)}; }
};

}  // namespace fulcrum
