// What joints drive, so that it does not sleep, however slow it is (JointType::quiet; Docs/Architecture.md, Sleep).
// Called by PrepareJoints for each row, on the worker of its batch.
#pragma once

#include <Fulcrum/Constraints/Joints/JointBatch.h>

namespace fulcrum {

// m per unit of a row: of an angle the radius of gyration of the inertia that it turns, at the heavier body that moves.
template <int N>
float ReachOf(const JointBatch<N>& batch, int lane, const JointRow& row, float inertia) {
    if (!row.about) return 1.0f;
    const auto inverseOf = [&](const InverseMass<Wide<N>>& body) {
        return Max(Max(body.mass.x()[lane], body.mass.y()[lane]), body.mass.z()[lane]);
    };
    const float a = inverseOf(batch.massA), b = inverseOf(batch.massB);
    return Sqrt(inertia * (a > 0.0f && b > 0.0f ? Min(a, b) : Max(a, b)));
}

// What a row that drives its bodies leaves them while it cannot move them on (JointType::quiet). A motor: a tenth of
// its speed, or of what its force would have given them within the time of falling asleep. A spring: the speed at which
// its damping lets go of, and the acceleration due to, kLimitSlop beside its balance, wherever a load puts that.
template <int N>
void NoteDrive(const JointBatch<N>& batch, int lane, const JointRow& row, float mass, const JointSolveSettings& s,
               JointType::Quiet& quiet) {
    using Kind = JointRow::Kind;
    constexpr float kPart = 0.1f;
    const bool isMotor = row.kind == Kind::Speed && !row.isStopped && row.speed != 0.0f;
    const bool isSpring = row.kind == Kind::Spring || (row.kind == Kind::SpringAtLeast && row.error < 0.0f);
    if (!(isMotor || isSpring) || !(mass > 0.0f)) return;
    const float force = (isMotor ? row.speed > 0.0f : row.error < 0.0f) ? row.maxForce : -row.minForce;
    const float reach = ReachOf(batch, lane, row, mass);
    if (!(force > 0.0f) || !(reach > 0.0f)) return;
    // Extreme springs give no number, and then no bound.
    const auto lower = [](float& bound, float to) { bound = to < bound ? to : bound; };
    const float fastest = force < JointRow::kUnlimited ? reach * force / mass : JointRow::kUnlimited;
    if (isMotor) {
        lower(quiet.speed, kPart * Min(reach * Abs(row.speed), fastest * Max(s.sleepSeconds, s.dt)));
        return;
    }
    const SpringConstants<float> spring = ToConstants(row.spring);
    const float squared = spring.squaredFrequency + spring.stiffness / mass,
                decay = spring.decayRate + spring.damping / mass;
    if (!(squared > 0.0f)) return;
    lower(quiet.acceleration, reach * kLimitSlop * squared);
    if (Abs(row.error) > kLimitSlop) lower(quiet.acceleration, kPart * fastest);
    if (decay > 0.0f) lower(quiet.speed, reach * kLimitSlop * squared / decay);
}

}  // namespace fulcrum
