// A wheel, B, on a chassis, A: it slides along the suspension's axis, may be steered about it, and spins about its
// axle. Solved with the other joints; no threads.
//
//   x, y        of A's frame: the axle as it is unsteered, and the suspension's axis, upwards        d  x axis of B's
//   frame Rotation of frame B against A: about y by delta (steering, AngularY), about z by tau (the axle's tilt, 0),
//   about x by psi (spin, AngularX). With w the relative angular velocity and s = d . y = sin(tau):
//               delta' = w . (y - s d) / (1 - s^2),   tau' = w . (d x y) / |d x y|,   psi' = w . d - s delta'
//   Locks:      line along y; unsteered: rotation but about x
//   Rows:       those of the suspension (LinearY) and of the spin; steered: tau = 0 and those of the steering
#pragma once

#include <Fulcrum/Constraints/Joints/JointAngles.h>

namespace fulcrum {

class WheelJoint final : public JointType {
public:
    // suspension: m, N; its spring is a position motor, its stops are limits. steering: rad, N m, not used where it is
    // not steered. spin: rad, N m; the motor drives, friction brakes.
    WheelJoint(const AxisControl& suspension, bool isSteered, const AxisControl& steering, const AxisControl& spin);

    JointLocks Locks() const override;
    uint32_t MaxRows() const override;
    void Start(const JointPose& pose) override;
    void CollectRows(const JointPose& pose, JointRowList& rows) override;
    AxisControl* Control(JointAxis axis) override;
    uint32_t FirstSlot(JointAxis axis) const override;
    double Coordinate(JointAxis axis, const JointPose& pose) const override;
    std::span<double> State() override { return turns_.numbers; }

private:
    AxisControl suspension_, steering_, spin_;
    bool isSteered_;
    TurnCount turns_;
};

}  // namespace fulcrum
