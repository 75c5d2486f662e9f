// Wheel joint: the wheel, B, slides along the suspension's axis of the chassis, A, may be steered about it, and spins
// about its axle.
//
//   x, y        of A's frame: the unsteered axle, and the suspension's axis, upwards
//   d           x axis of B's frame
//   Rotation of frame B against A: about y by delta (steering, AngularY), about z by tau (the axle's tilt, 0), about x
//   by psi (spin, AngularX). With w the relative angular velocity and s = d . y = sin(tau):
//               delta' = w . (y - s d) / (1 - s^2),   tau' = w . (d x y) / |d x y|,   psi' = w . d - s delta'
//   Locks:      line along y; unsteered: rotation but about x
//   Rows:       those of the suspension (LinearY) and of the spin; steered: tau = 0 and those of the steering
#pragma once

#include <Fulcrum/Constraints/Joints/JointAngles.h>
#include <Fulcrum/Physics/JointSettings.h>

namespace fulcrum {

// B, a wheel, spins about the anchor's axis, its axle, and slides along the anchor's normal, which points upwards and
// is the steering axis.
struct WheelJointSettings : JointSettings {
    WheelJointSettings() { anchorA.normal = Vector3(0, 1, 0); }

    // m, N; zero if the anchors coincide. The motor's spring carries the chassis, the limits are the stops.
    AxisControl suspension = {
        .limited = true,
        .limits = {.min = -0.2f, .max = 0.2f},
        .motor = {.mode = MotorMode::ToPosition,
                  .spring = {.mode = SpringMode::StiffnessAndDamping, .stiffness = 4.0e4f, .damping = 4.0e3f}}};
    bool isSteered = false;
    // rad, N m; used if steered.
    AxisControl steering = {
        .limited = true, .limits = {.min = -0.6f, .max = 0.6f}, .motor = {.mode = MotorMode::ToPosition, .spring = {}}};
    AxisControl spin{};  // rad, N m; the motor drives, friction brakes
};
MaybeError Check(const WheelJointSettings& settings);
std::unique_ptr<JointType> MakeType(const WheelJointSettings& settings);

class WheelJoint final : public JointType {
public:
    // suspension: m, N; its spring is a position motor, its stops are limits. steering: rad, N m, only used if
    // isSteered. spin: rad, N m; the motor drives, friction brakes.
    WheelJoint(const AxisControl& suspension, bool isSteered, const AxisControl& steering, const AxisControl& spin);

    const char* Kind() const override { return "wheel"; }
    JointDrawing Drawing() const override;
    JointLocks Locks() const override;
    uint32_t MaxRows() const override;
    void Start(const JointPose& pose) override;
    void CollectRows(const JointPose& pose, JointRowList& rows) override;
    void RowsAt(const JointPose& pose, JointRowList& rows) const override { RowsOfCopy(*this, pose, rows); }
    AxisControl* Control(JointAxis axis) override;
    uint32_t FirstSlot(JointAxis axis) const override;
    double Coordinate(JointAxis axis, const JointPose& pose) const override;
    std::span<double> State() override { return turns_.numbers; }
    void VisitSettings(const SettingVisitor& visit) override { visit(isSteered_); }

private:
    AxisControl suspension_, steering_, spin_;
    bool isSteered_;
    TurnCount turns_;
};

}  // namespace fulcrum
