// Angles of joint frames: the turn of one frame against another about x, counted over any number of turns, and the axes
// along which it changes. Called by the joint types. Free functions, no state.
#pragma once

#include <Fulcrum/Constraints/Joints/JointType.h>

#include <cmath>

namespace fulcrum {

inline constexpr double kFullTurn = 6.283185307179586;

// Rotation about x within q (its twist, see SwingTwist.h), -pi..pi; 0 where q turns x to -x.
inline float TwistAngle(const Quaternion& q) {
    return q.w < 0.0f ? 2.0f * Atan2(-q.x, -q.w) : 2.0f * Atan2(q.x, q.w);
}

// The angle that differs from `wrapped` by whole turns and is nearest to `expected`, rad.
inline double NearestTurn(double wrapped, double expected) {
    return wrapped + kFullTurn * std::floor((expected - wrapped) / kFullTurn + 0.5);
}

// The axis that the twist of frame B against A turns about, unit: halfway between the two x axes. With alpha between
// these, d twist/dt = axis . w / cos(alpha / 2), and a joint that keeps them together has alpha = 0.
inline Vector3 TwistAxis(const Matrix3& frameA, const Matrix3& frameB) {
    return Normalized(Vector3(frameA.x + frameB.x), frameA.x);
}

// An angle counted over any number of turns. A body may turn by more than half a turn a step: the speeds at both ends of a
// step tell how far it came.
struct TurnCount {
    std::array<double, 2> numbers{};  // rad, rad/s

    double Angle() const { return numbers[0]; }
    void Set(double angle) { numbers = {angle, 0.0}; }
    void Advance(double wrapped, double speed, double dt) {
        numbers = {NearestTurn(wrapped, numbers[0] + 0.5 * (numbers[1] + speed) * dt), speed};
    }
};

}  // namespace fulcrum
