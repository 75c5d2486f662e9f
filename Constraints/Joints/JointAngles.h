// Angles of joint frames: the turn of one frame against another about x, counted over any number of turns, and the axes
// along which it changes. Called by the joint types. Free functions, no state.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>

namespace fulcrum {

inline constexpr double kFullTurn = 6.283185307179586;

// Rotation about x within q (its twist, see SwingTwist.h), -pi..pi; 0 where q turns x to -x.
inline float TwistAngle(const Quaternion& q) { return q.w < 0.0f ? 2.0f * Atan2(-q.x, -q.w) : 2.0f * Atan2(q.x, q.w); }

// The angle that differs from `wrapped` by whole turns and is nearest to `expected`, rad.
inline double NearestTurn(double wrapped, double expected) {
    return wrapped + kFullTurn * __builtin_floor((expected - wrapped) / kFullTurn + 0.5);
}

inline const Vector3& AxisOf(const Matrix3& frame, int axis) {
    return axis == 0 ? frame.x : axis == 1 ? frame.y : frame.z;
}

// How far frame B is turned against A about an axis of theirs, 0, 1, 2 for x, y, z, that a joint keeps together.
// -pi..pi.
inline float AngleAbout(const JointPose& pose, int axis) {
    const Quaternion q = pose.frameA.Conjugate() * pose.frameB;
    return TwistAngle({axis == 0 ? q.x : axis == 1 ? q.y : q.z, 0.0f, 0.0f, q.w});
}
// That axis in world space, unit: halfway between the frames' two. With alpha between these, d angle/dt = axis . w /
// cos(alpha / 2), so exact where the joint holds.
inline Vector3 AxisAbout(const JointPose& pose, int axis) {
    const Matrix3 frameA = ToMatrix(pose.frameA), frameB = ToMatrix(pose.frameB);
    return Normalized(Vector3(AxisOf(frameA, axis) + AxisOf(frameB, axis)), AxisOf(frameA, axis));
}

// Whether the axis that a joint keeps together is more than 60 degrees apart. The angle about it then jumps by as much
// as the bodies turn across it: limits wait until the joint has pulled it straight.
inline bool IsTilted(const JointPose& pose, int axis) {
    return Dot(AxisOf(ToMatrix(pose.frameA), axis), AxisOf(ToMatrix(pose.frameB), axis)) < 0.5f;
}

// An angle counted over any number of turns. A body may turn by more than half a turn a step: how far it did tells the
// turn.
struct TurnCount {
    std::array<double, 1> numbers{};  // rad

    double Angle() const { return numbers[0]; }
    // From here on. With limits that the angle is not in, the turn counts that is farthest inside them, or nearest to
    // them.
    void Start(double wrapped, const AxisControl& control);
    // The angle as it is after a step in which it grew by about `turned`, rad.
    double After(double wrapped, double turned) const { return NearestTurn(wrapped, numbers[0] + turned); }
    void Advance(double wrapped, double turned) { numbers = {After(wrapped, turned)}; }
};

}  // namespace fulcrum
