#include <Fulcrum/Physics/Stages/Impact.h>

#include <Fulcrum/Constraints/BodyLanes.h>
#include <Fulcrum/Constraints/Restitution.h>
#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/FreeRotation.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

constexpr int kIterations = 8;
// Relative to the inverse masses: if locked axes leave less response than this along the impulse, the bodies could only
// separate by a speed along other axes, a hundred times the approach speed. Such points get no impulse.
constexpr float kLeastResponse = 1e-4f;

class ImpactSolver {
public:
    ImpactSolver(const ImpactStores& stores, const SweepHit& hit, Impact& impact) : hit_(hit), v_(impact) {
        const uint32_t bodies[2] = {hit.body, hit.other};
        for (int s = 0; s < 2; ++s) {
            if (!stores.bodies.CanMove(bodies[s])) continue;
            const BodyDynamics& d = stores.bodies.dynamics[bodies[s]];
            const MassOverride& o = hit.massOverride;
            InverseMass<float>& side = side_[s];
            side = {d.inverseMass, impact.masses[s].InverseInertia()};
            if (s == 0) ScaleMass(side, o.inverseMassScaleA, o.inverseInertiaScaleA);
            else ScaleMass(side, o.inverseMassScaleB, o.inverseInertiaScaleB);
            leastResponse_ += kLeastResponse * side.mass.x();
            side.mass = d.AlongFreeTranslations(side.mass);
        }
        for (int i = 0; i < hit.pointCount; ++i) {
            slipsBefore_[i] = Slip(i);
            const float approach = Dot<float>(hit.normal, RelativeVelocity(i));
            bounceSpeeds_[i] = BounceSpeed<float>(hit.restitution, approach, stores.step.settings.restitutionSpeed);
            approaches_ |= approach > 0;
            v_.approachSpeed = std::max(v_.approachSpeed, approach);
            normalResponses_[i] = Response(i, hit.normal);
        }
    }

    bool Run() {
        if (!approaches_) return false;
        const Vector3 linear[2] = {v_.linear[0], v_.linear[1]}, angular[2] = {v_.angular[0], v_.angular[1]};
        // A single row needs no iterations.
        const int iterations = hit_.pointCount == 1 && hit_.friction == 0 ? 1 : kIterations;
        for (int k = 0; k < iterations; ++k)
            for (int i = 0; i < hit_.pointCount; ++i) {
                Push(i);
                SolveFriction(i);
            }
        const float part = PassiveFraction();
        for (int s = 0; s < 2 && part < 1; ++s) {
            v_.linear[s] = linear[s] + (v_.linear[s] - linear[s]) * part;
            v_.angular[s] = angular[s] + (v_.angular[s] - angular[s]) * part;
        }
        for (int i = 0; i < hit_.pointCount; ++i) {
            v_.normalImpulses[i] = normalImpulses_[i] * part;
            v_.frictionImpulse -= frictionImpulses_[i] * part;
        }
        return true;
    }

private:
    // Velocity of the body relative to the other.
    Vector3 RelativeVelocity(int i) const {
        return v_.linear[0] + Cross<float>(v_.angular[0], hit_.arms[i]) - v_.linear[1] -
               Cross<float>(v_.angular[1], hit_.otherArms[i]);
    }
    // The same relative to the other's surface, which may have a surface velocity.
    Vector3 Slip(int i) const { return RelativeVelocity(i) - hit_.surfaceVelocity; }
    // Factor of all impulses for which they do no positive work. The work is J . (u + u') / 2, with u and u' the
    // relative velocities of the points before and after; Newton's law at several points or with friction may make it
    // positive. 1 if it is not.
    float PassiveFraction() const {
        float first = 0, second = 0;  // work = first part + second part^2
        for (int i = 0; i < hit_.pointCount; ++i) {
            const Vector3 impulse = frictionImpulses_[i] - hit_.normal * normalImpulses_[i];
            first += Dot<float>(impulse, slipsBefore_[i]);
            second += 0.5f * Dot<float>(impulse, Vector3(Slip(i) - slipsBefore_[i]));
        }
        if (!(first + second > 0)) return 1;
        return second > 0 ? std::clamp(-first / second, 0.0f, 1.0f) : 0.0f;
    }
    // Change of the relative velocity along a unit vector by an impulse of 1 N s along it.
    float Response(int i, const Vector3& axis) const {
        const Vector3 a = Cross<float>(hit_.arms[i], axis), b = Cross<float>(hit_.otherArms[i], axis);
        const Vector3 mass = side_[0].mass + side_[1].mass;
        return Dot<float>(axis, Vector3(mass.cwiseProduct(axis))) + Dot<float>(a, Vector3(side_[0].inertia * a)) +
               Dot<float>(b, Vector3(side_[1].inertia * b));
    }
    // On the body; the other gets the opposite.
    void Apply(int i, const Vector3& impulse) {
        for (int s = 0; s < 2; ++s) {
            const Vector3 own = s == 0 ? impulse : Vector3(-impulse);
            v_.linear[s] += own.cwiseProduct(side_[s].mass);
            v_.angular[s] += side_[s].inertia * Cross<float>(s == 0 ? hit_.arms[i] : hit_.otherArms[i], own);
        }
    }
    void Push(int i) {
        const float response = normalResponses_[i];
        if (!(response > leastResponse_)) return;
        const float old = normalImpulses_[i];
        normalImpulses_[i] =
            std::max(0.0f, old + (Dot<float>(hit_.normal, RelativeVelocity(i)) + bounceSpeeds_[i]) / response);
        Apply(i, hit_.normal * (old - normalImpulses_[i]));
    }
    void SolveFriction(int i) {
        if (hit_.friction == 0) return;
        const Vector3 v = Slip(i), slip = v - hit_.normal * Dot<float>(hit_.normal, v);
        const float speed = Length(slip);
        const float response = speed > 0 ? Response(i, Vector3(slip * (1 / speed))) : 0.0f;
        if (!(response > 0)) return;
        const Vector3 old = frictionImpulses_[i];
        frictionImpulses_[i] = old - slip * (1 / response);
        const float size = Length(frictionImpulses_[i]), most = hit_.friction * normalImpulses_[i];
        if (size > most) frictionImpulses_[i] = frictionImpulses_[i] * (most / size);
        Apply(i, frictionImpulses_[i] - old);
    }

    const SweepHit& hit_;
    Impact& v_;
    InverseMass<float> side_[2];
    bool approaches_ = false;
    float leastResponse_ = 0;                           // 1/kg
    Vector3 slipsBefore_[SweepHit::kMaxPoints];         // m/s, see Slip
    float bounceSpeeds_[SweepHit::kMaxPoints] = {};     // m/s: separation speeds
    float normalResponses_[SweepHit::kMaxPoints] = {};  // 1/kg, along the normal
    float normalImpulses_[SweepHit::kMaxPoints] = {};   // N s
    Vector3 frictionImpulses_[SweepHit::kMaxPoints] = {Vector3::Zero(), Vector3::Zero(), Vector3::Zero(),
                                                       Vector3::Zero()};
};

// Whether contacts took part of the velocity that gravity and forces have given a body since a time of its sweep.
bool IsCarried(const ImpactStores& stores, const Sweep& sweep) {
    return !sweep.waits && stores.sweeps.IsOfStep(sweep.body, stores.step.number) &&
           stores.coloring.IsTouched(sweep.body);
}

// m2/s2, the work per kilogram of gravity and forces since a time of a sweep.
float WorkSince(const BodyStore& bodies, const Sweep& sweep, float time) {
    const float* a = bodies.poses[sweep.body].acceleration;
    return Dot<float>(Vector3(a[0], a[1], a[2]), Vector3(sweep.DisplacementRate() * (1 - time)));
}

// m/s: velocity that gravity and forces have given a body since a time of its sweep. If contacts took part of it, it is
// computed from the work along the path since then, so that going back in time conserves energy.
Vector3 GainSince(const ImpactStores& stores, const Sweep& sweep, float time) {
    if (sweep.waits || !stores.sweeps.IsOfStep(sweep.body, stores.step.number)) return Vector3::Zero();
    const float* a = stores.bodies.poses[sweep.body].acceleration;
    const Vector3 acceleration(a[0], a[1], a[2]);
    const float rest = (1 - time) * stores.step.dt;
    if (!IsCarried(stores, sweep)) return acceleration * rest;
    const float work = WorkSince(stores.bodies, sweep, time);
    const float along = Dot<float>(acceleration, stores.bodies.LinearVelocityOf(sweep.body)),
                square = LengthSquared(acceleration);
    if (!(square > 0) || (work < 0 && along >= 0)) return Vector3::Zero();
    // |v - a s|^2 = |v|^2 - 2 work: the solution nearest to 0; if there is none, the minimum of |v - a s|.
    const float root = along * along - 2 * square * work;
    const float seconds = root < 0 ? along / square : 2 * work / (along + std::copysign(std::sqrt(root), along));
    return acceleration * (std::isfinite(seconds) ? std::clamp(seconds, -rest, rest) : 0.0f);
}

// The part of that work that `since` could not account for is taken from the whole velocity: this happens for impacts
// at the end of a long displacement that leave a body little speed along it.
void TakeWork(const BodyStore& bodies, const Sweep& sweep, float time, Impact& impact, int side) {
    constexpr float kNotRounding = 1e-4f;
    const BodyDynamics& d = bodies.dynamics[sweep.body];
    const float wanted = LengthSquared(bodies.LinearVelocityOf(sweep.body)) - 2 * WorkSince(bodies, sweep, time);
    const float linear = LengthSquared(impact.linear[side]), excess = linear - wanted;
    const Vector3 inBody = InverseRotate(impact.poses[side].rotation * d.PrincipalAxes(), impact.angular[side]);
    const float all = linear + TwiceRotationalEnergy<float>(d, inBody) * d.inverseMass;
    if (!(excess > kNotRounding * all)) return;
    const float part = std::sqrt(std::max(0.0f, 1 - excess / all));
    impact.linear[side] *= part;
    impact.angular[side] *= part;
}

// m/s: velocity that gravity and forces give it until the end of the step. A body carried by a contact does not fall,
// but one that moves up is slowed down.
Vector3 GainUntilEnd(const ImpactStores& stores, uint32_t body, const Vector3& v, const Vector3& since, float rest) {
    const float* a = stores.bodies.poses[body].acceleration;
    const Vector3 acceleration(a[0], a[1], a[2]);
    const bool carried = stores.coloring.IsTouched(body) || !stores.sweeps.IsOfStep(body, stores.step.number);
    if (!carried || Dot<float>(v, acceleration) < 0) return acceleration * rest;
    return Dot<float>(since, acceleration) > 0 ? since : Vector3(Vector3::Zero());
}

// Angular velocity after `seconds` (negative: before) of free rotation, which conserves angular momentum and energy,
// not angular velocity. Computed in the body's frame, so that energy is conserved although the sweep only approximates
// the rotation by a constant rate up to `then`.
Vector3 TurnedFreely(const BodyDynamics& d, const Quaternion& rotation, const Vector3& w, float seconds,
                     const Quaternion& then) {
    if (d.motion != MotionType::Dynamic) return w;
    if (d.RotatesAboutTwoAxes()) return VelocityAboutTwoAxes(d, rotation, then, w);
    if (!d.HasGyroscopicTorqueAt(w)) return w;
    const auto energyOf = [&](const Vector3& inBody) {
        return TwiceRotationalEnergy<float>(d, InverseRotate(d.PrincipalAxes(), inBody));
    };
    FreeTurn turn{&d, rotation, w};
    RotateFreely(turn, seconds);
    const Vector3 end = InverseRotate(turn.rotation, turn.angularVelocity);
    const float before = energyOf(InverseRotate(rotation, w)), after = energyOf(end);
    return after > 0 ? Rotate(then, Vector3(end * std::sqrt(before / after))) : w;
}

// The sweep rotates at its initial rate: otherwise bodies that have just bounced could seem to hit again.
Impact::Rest FlyOn(const ImpactStores& stores, uint32_t body, const Quaternion& rotation, const Vector3& v,
                   const Vector3& w, const Vector3& since, float rest) {
    const BodyDynamics& d = stores.bodies.dynamics[body];
    Vector3 gain = GainUntilEnd(stores, body, v, since, rest), none = Vector3::Zero();
    d.Lock(gain, none);
    Impact::Rest on{(v + gain * 0.5f) * rest, w * rest, v + gain, w};
    on.angular = TurnedFreely(d, rotation, w, rest, RotationFromVector(on.turn) * rotation);
    LimitLength(on.linear, d.maxLinearSpeed);
    LimitLength(on.angular, d.maxAngularSpeed);
    return on;
}

}  // namespace

Impact FindImpact(const ImpactStores& stores, const SweepHit& hit) {
    const BodyStore& bodies = stores.bodies;
    const uint32_t pair[2] = {hit.body, hit.other};
    const float rest = (1 - hit.time) * stores.step.dt;
    Impact impact;
    Vector3 since[2];
    for (int s = 0; s < 2; ++s) {
        const BodyDynamics& d = bodies.dynamics[pair[s]];
        impact.sweeps[s] = SweepOf(stores.step, stores.bodies, stores.sweeps, pair[s]);
        impact.poses[s] = impact.sweeps[s].PoseAt(hit.time);
        impact.masses[s] =
            d.spherical ? bodies.masses[pair[s]] : bodies.MassAlong(pair[s], AxesOf(d, impact.poses[s].rotation));
        since[s] = bodies.CanMove(pair[s]) ? GainSince(stores, impact.sweeps[s], hit.time) : Vector3(Vector3::Zero());
        impact.linear[s] = bodies.LinearVelocityOf(pair[s]) - since[s];
        const Vector3 w = bodies.AngularVelocityOf(pair[s]);
        impact.angular[s] = impact.sweeps[s].waits
                                ? w
                                : TurnedFreely(d, impact.sweeps[s].RotationAt(1), w, -rest, impact.poses[s].rotation);
        // Gravity has no effect along locked axes.
        if (d.lockedAxes != LockedAxes::None) d.Lock(impact.linear[s], impact.angular[s]);
        if (bodies.CanMove(pair[s]) && IsCarried(stores, impact.sweeps[s]))
            TakeWork(bodies, impact.sweeps[s], hit.time, impact, s);
        impact.arrivingLinear[s] = impact.linear[s];
        impact.arrivingAngular[s] = impact.angular[s];
    }
    impact.bounces = hit.pointCount > 0 && !hit.isBlocked && ImpactSolver(stores, hit, impact).Run();
    impact.isFinite = true;
    for (int s = 0; s < 2; ++s) {
        if (!bodies.CanMove(pair[s])) continue;
        LimitLength(impact.linear[s], bodies.dynamics[pair[s]].maxLinearSpeed);
        LimitLength(impact.angular[s], bodies.dynamics[pair[s]].maxAngularSpeed);
        impact.rests[s] =
            FlyOn(stores, pair[s], impact.poses[s].rotation, impact.linear[s], impact.angular[s], since[s], rest);
        const Impact::Rest& on = impact.rests[s];
        impact.isFinite &=
            IsFinite(on.linear) && IsFinite(on.angular) && IsFinite(on.displacement) && IsFinite(on.turn);
    }
    return impact;
}

}  // namespace fulcrum
