// Shorthands for settings of joints. Called while a scene is built and before its steps.
#pragma once

#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum {

// Settings of a kind of joint: at a place of the world, with an axis, where the bodies stand.
template <class Settings>
Settings JointOf(BodyId a, BodyId b, const Position& point, const Vector3& axis = Vector3(1, 0, 0)) {
    Settings settings;
    settings.bodyA = a;
    settings.bodyB = b;
    settings.anchorA.point = point;
    settings.anchorA.axis = axis;
    return settings;
}

// B's anchor somewhere else than A's, with the same axis.
template <class Settings>
Settings JointOfTwo(BodyId a, BodyId b, const Position& pointA, const Position& pointB,
                    const Vector3& axis = Vector3(1, 0, 0)) {
    Settings settings = JointOf<Settings>(a, b, pointA, axis);
    settings.anchorB = settings.anchorA;
    settings.anchorB->point = pointB;
    return settings;
}

inline AxisControl Limited(float min, float max, float frequency = 0, float dampingRatio = 0) {
    AxisControl control;
    control.limited = true;
    control.limits.min = min;
    control.limits.max = max;
    control.limits.spring.frequency = frequency;
    control.limits.spring.dampingRatio = dampingRatio;
    return control;
}

// speed: m/s or rad/s; force: N or N m.
inline JointMotor MotorToSpeed(float speed, float force) {
    JointMotor motor;
    motor.mode = MotorMode::ToVelocity;
    motor.targetSpeed = speed;
    motor.minForce = -force;
    motor.maxForce = force;
    return motor;
}

// position: m or rad; frequency: Hz.
inline JointMotor MotorToPosition(float position, float frequency, float dampingRatio = 1) {
    JointMotor motor;
    motor.mode = MotorMode::ToPosition;
    motor.targetPosition = position;
    motor.spring.frequency = frequency;
    motor.spring.dampingRatio = dampingRatio;
    return motor;
}

// A small static body to hang things from.
inline BodyId AddHook(SceneWorld& world, const Position& position) {
    return world.Add({.shape = world.SphereOf(0.05f), .motion = MotionType::Static, .position = position});
}

}  // namespace fulcrum
