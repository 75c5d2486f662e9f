// Two bodies with a joint, in any pose, and a check of a type's Jacobians against finite differences of its constraint
// functions C.
#pragma once

#include "../Parts/RandomBodies.h"

#include <Fulcrum/Constraints/Joints/JointAngles.h>

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace fulcrum::testing {

inline Quaternion About(const Vector3& axis, float angle) { return RotationFromVector(Vector3(axis * angle)); }
inline Quaternion AboutX(float angle) { return About(Vector3(1, 0, 0), angle); }
inline Quaternion AboutY(float angle) { return About(Vector3(0, 1, 0), angle); }
inline Quaternion AboutZ(float angle) { return About(Vector3(0, 0, 1), angle); }
inline Quaternion RandomRotation(RandomPoses& random) {
    const Vector3 axis = AnyDirection(random);
    return About(axis, random.Between(-3.0f, 3.0f));
}

// Bodies A and B, each with an anchor and a frame in its own coordinates.
struct JointBodies {
    Position place[2] = {Position::Zero(), Position::Zero()};
    Quaternion rotation[2];
    Vector3 anchor[2] = {Vector3::Zero(), Vector3::Zero()};
    Quaternion frame[2];
    Twist<float> velocity[2];
    Vector3 turned[2] = {Vector3::Zero(), Vector3::Zero()};  // rad, in the step before
    float dt = 1.0f / 60.0f;

    static JointBodies AtRandom(RandomPoses& random) {
        JointBodies bodies;
        for (int i = 0; i < 2; ++i) {
            bodies.place[i] = random.InBox(3.0f).cast<double>();
            bodies.rotation[i] = RandomRotation(random);
            bodies.anchor[i] = random.InBox(1.0f);
            bodies.frame[i] = RandomRotation(random);
        }
        return bodies;
    }
    Quaternion FrameOf(int i) const { return Normalized(rotation[i] * frame[i]); }
    Vector3 ArmOf(int i) const { return Rotate(rotation[i], anchor[i]); }
    Position AnchorOf(int i) const { return place[i] + ArmOf(i).cast<double>(); }

    // Moves B so that its frame is rotated by `turn` and its anchor is at `offset`, both relative to A's frame.
    void PlaceB(const Vector3& offset, const Quaternion& turn) {
        rotation[1] = Normalized(FrameOf(0) * turn * frame[1].Conjugate());
        place[1] = AnchorOf(0) + (Rotate(FrameOf(0), offset) - ArmOf(1)).cast<double>();
    }
    void Move(int body, const Twist<float>& way) {
        place[body] += way.linear.cast<double>();
        rotation[body] = Normalized(RotationFromVector(way.angular) * rotation[body]);
    }
    // One step along the velocities.
    void Step() {
        for (int i = 0; i < 2; ++i) Move(i, {velocity[i].linear * dt, velocity[i].angular * dt});
    }
    JointPose Pose() const {
        JointPose pose;
        pose.armA = ArmOf(0);
        pose.armB = ArmOf(1);
        pose.offset = (AnchorOf(1) - AnchorOf(0)).cast<float>();
        pose.frameA = FrameOf(0);
        pose.frameB = FrameOf(1);
        pose.velocityA = velocity[0];
        pose.velocityB = velocity[1];
        pose.turnedA = turned[0];
        pose.turnedB = turned[1];
        pose.dt = dt;
        pose.substepDt = dt / 4;
        pose.anchorA = AnchorOf(0);
        return pose;
    }
};

// The rows by slot.
template <class Type>
std::map<int, JointRow> RowsOf(Type& type, const JointPose& pose) {
    JointRowList list;
    type.CollectRows(pose, list);
    EXPECT_LE(list.count, type.MaxRows());
    std::map<int, JointRow> rows;
    for (uint32_t i = 0; i < list.count; ++i) {
        EXPECT_FALSE(rows.contains(list.rows[i].slot)) << "slot used twice";
        rows[list.rows[i].slot] = list.rows[i];
    }
    return rows;
}

// Every row but those of Speed has a C, and J must be its derivative: by moving each body a little along and about each
// axis. C is exact to some 1e-7 of its size, so differences over 2 * 4e-3 to some 5e-5; C''' (4e-3)^2 / 6 adds about as
// much where C bends on a scale of 1 m or 1 rad, and ten times that near poles.
template <class Type>
void ExpectJacobiansOf(const Type& type, const JointBodies& bodies, float tolerance = 1e-3f) {
    constexpr float kWay = 4e-3f;
    const auto rowsAt = [&](int body, int axis, float way) {
        JointBodies moved = bodies;
        Twist<float> twist;
        (axis < 3 ? twist.linear : twist.angular)[axis % 3] = way;
        moved.Move(body, twist);
        Type copy = type;
        return RowsOf(copy, moved.Pose());
    };
    Type copy = type;
    const auto rows = RowsOf(copy, bodies.Pose());
    EXPECT_FALSE(rows.empty());
    for (int body = 0; body < 2; ++body)
        for (int axis = 0; axis < 6; ++axis) {
            auto ahead = rowsAt(body, axis, kWay), behind = rowsAt(body, axis, -kWay);
            for (const auto& [slot, row] : rows) {
                if (row.kind == JointRow::Kind::Speed) continue;
                ASSERT_TRUE(ahead.contains(slot) && behind.contains(slot));
                const float difference = (ahead[slot].error - behind[slot].error) / (2 * kWay);
                const Twist<float>& j = body == 0 ? row.jacobian.a : row.jacobian.b;
                const float expected = (axis < 3 ? j.linear : j.angular)[axis % 3] * (body == 0 ? -1.0f : 1.0f);
                EXPECT_NEAR(difference, expected, tolerance * (1.0f + std::fabs(expected)))
                    << "slot " << slot << " body " << body << " axis " << axis;
            }
        }
}

inline AxisControl Limited(float min, float max) {
    AxisControl control;
    control.limited = true;
    control.limits.min = min;
    control.limits.max = max;
    return control;
}
inline AxisControl Driven(MotorMode mode, float target) {
    AxisControl control;
    control.motor.mode = mode;
    (mode == MotorMode::ToPosition ? control.motor.targetPosition : control.motor.targetSpeed) = target;
    return control;
}

}  // namespace fulcrum::testing
