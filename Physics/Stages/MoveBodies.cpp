// Ends the step for each body: bodies with constraints move by their accumulated displacement, bodies without contacts
// and joints by exact free flight.
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/Crowd.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/FreeRotation.h>
#include <Fulcrum/Physics/Stages/Integrate.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/Stages/Stillness.h>

#include <algorithm>

namespace fulcrum {

namespace {

// Result of the step for a body.
struct Ending {
    uint32_t body = 0;
    Vector3 displacement = Vector3::Zero();  // m
    Vector3 v = Vector3::Zero();             // m/s, at the end of the step
    FreeTurn turn;                           // free rotation, if any
    bool fliesFreely = false;                // no contacts or joints
    bool isJointed = false;
    float slowSpeed = 0;  // m/s, see SlowSpeed
    float meanSpeed = 0;  // m/s, of bodies with joints
};

// A body without contacts and joints: x += v t + a t^2 / 2, exact under constant acceleration. Returns whether its
// torque-free rotation is still to be computed.
bool FlyFreely(BodyStore& bodies, Ending& ending, const StepContext& step, WorkerFindings& findings) {
    const BodyDynamics& d = *ending.turn.body;
    const float* a = bodies.poses[ending.body].acceleration;
    Vector3 &v = ending.v, &w = ending.turn.angularVelocity;
    const Vector3 before = v;
    ending.fliesFreely = true;
    v += Vector3(a[0], a[1], a[2]) * step.dt;
    if (d.linearDamping > 0) v *= Exp(-d.linearDamping * step.dt);
    if (d.lockedAxes != LockedAxes::None) d.Lock(v, w);
    findings.clamped += LimitSpeeds(bodies, ending.body, v, w);
    Vector3& change = ending.displacement;
    change = (before + v) * (0.5f * step.dt);
    if (d.lockedAxes != LockedAxes::None) d.Lock(change, w);
    const bool feelsTop = d.HasGyroscopicTorqueAt(w);
    if (d.hasForce) {
        const Vector3 torque = bodies.cold[ending.body].torque;
        Vector3 pushed = w + bodies.masses[ending.body].InverseInertia() * torque * step.dt;
        const bool isLimited = LengthSquared(pushed) > d.maxAngularSpeed * d.maxAngularSpeed;
        // Clamped at once, before the rotation.
        if (isLimited) findings.clamped += LimitSpeeds(bodies, ending.body, v, pushed);
        if (isLimited || !feelsTop) w = pushed;
        else ending.turn.torque = torque;
    }
    if (feelsTop) return true;
    if (d.RotatesAboutTwoAxes()) {
        RotateAboutTwoAxes(ending.turn, step.dt);
        return false;
    }
    ending.turn.rotation = Normalized(RotationFromVector(Vector3(w * step.dt)) * ending.turn.rotation);
    return false;
}

// Corrects the angular velocity of bodies with contacts for their rotation in the step. The solver computes it with the
// inertia at the start of the step. If the axis of a spinning thin rod rotates in the step while the velocity stays
// constant in world axes, the spin becomes a rotation of the rod itself, with a thousand times the energy. If energy
// would increase by more than a twentieth, the velocity is rotated with the body just far enough to avoid that. Smaller
// changes, as of bodies rocking to rest, are left to damping by the support.
Vector3 CarriedAlong(const BodyDynamics& d, const Quaternion& before, const Quaternion& after, const Vector3& w) {
    constexpr float kGain = 1.0001f;
    const auto energyOf = [&](const Quaternion& rotation, const Vector3& velocity) {
        return TwiceRotationalEnergy<float>(d, InverseRotate(rotation * d.PrincipalAxes(), velocity));
    };
    const float wanted = energyOf(before, w), gain = energyOf(after, w) - wanted;
    if (!(gain > (kGain - 1) * wanted)) return w;
    // The energy of w + s (carried - w) is a parabola in s that equals `wanted` at 1 and at gain / curvature.
    const Vector3 change = Rotate(after, InverseRotate(before, w)) - w;
    const float curvature = energyOf(after, change);
    return w + change * (gain < curvature ? gain / curvature : 1.0f);
}

void MoveSolved(BodyStore& bodies, const JointStore& joints, Ending& ending, float dt) {
    const uint32_t body = ending.body;
    BodyState& s = bodies.states[body];
    const BodyDynamics& d = bodies.dynamics[body];
    Quaternion& rotation = ending.turn.rotation;
    Vector3& w = ending.turn.angularVelocity;
    ending.displacement = Vector3(s.deltaPosition[0], s.deltaPosition[1], s.deltaPosition[2]);
    if (d.crowded && !joints.HasAny(body)) {
        const auto& free = bodies.unconstrained[body].row;
        ending.v = NoFasterThan(ending.v, VectorAt<BodyState::kLinear>(free));
        w = NoFasterThan(w, VectorAt<BodyState::kAngular>(free));
    }
    // Impacts displace bodies without regard to speed limits and locked axes (BounceContacts.h), so these are applied
    // here.
    Vector3 turn(s.deltaRotation[0], s.deltaRotation[1], s.deltaRotation[2]);
    LimitLength(ending.displacement, d.maxLinearSpeed * dt);
    LimitLength(turn, d.maxAngularSpeed * dt);
    if (d.lockedAxes != LockedAxes::None) d.Lock(ending.displacement, turn);
    const Quaternion before = rotation;
    rotation = Normalized(RotationFromVector(turn) * rotation);
    // For jointed bodies every substep has done what follows.
    if (joints.HasAny(body)) return;
    if (d.RotatesAboutTwoAxes()) w = VelocityAboutTwoAxes(d, before, rotation, w);
    if (!d.HasGyroscopicTorqueAt(w)) return;
    w = CarriedAlong(d, before, rotation, w);
    w = AddGyroscopicTorque<float>(Vector3(d.inverseInertia[0], d.inverseInertia[1], d.inverseInertia[2]),
                                   AxesOf(d, rotation), w, dt);
}

// Speed from the displacement of the step, for bodies with joints: corrections of their poses are no part of the
// velocities.
float MeanSpeed(const BodyStore& bodies, uint32_t body, float slow, float dt) {
    const BodyState& s = bodies.states[body];
    const float inverseDt = 1.0f / dt;
    return FarthestSpeed(bodies, body, slow,
                         Vector3(s.deltaPosition[0], s.deltaPosition[1], s.deltaPosition[2]) * inverseDt,
                         Vector3(s.deltaRotation[0], s.deltaRotation[1], s.deltaRotation[2]) * inverseDt);
}

// Whether a body rests on others: it has been slow for as long as falling asleep takes, and is neither jointed nor
// weightless.
bool IsAtRest(const BodyStore& bodies, const Ending& ending, const SleepSettings& sleep) {
    const BodyDynamics& d = *ending.turn.body;
    const float* a = bodies.poses[ending.body].acceleration;
    return d.slowSeconds > 0 && d.slowSeconds >= sleep.seconds && !ending.fliesFreely && !ending.isJointed &&
           d.motion == MotionType::Dynamic && (a[0] != 0 || a[1] != 0 || a[2] != 0);
}
// Contacts hardly damp the slow modes of stacks (Docs/Step.md): what rests is damped while it decelerates, so that a
// swing loses energy before each of its turning points, and what topples, rolls or slides is left alone.
void DampSwings(Ending& ending, float dt) {
    constexpr float kRate = 24;     // 1/s
    constexpr float kLeast = 0.1f;  // 1/s, deceleration over speed: less is rounding
    // The mean velocity of the step is displacement / dt, that at its end v.
    if (!(Dot(ending.displacement, ending.v) > (1 + 0.5f * kLeast * dt) * dt * LengthSquared(ending.v))) return;
    const float part = 1 / (1 + kRate * dt);
    ending.v *= part;
    ending.turn.angularVelocity *= part;
}

// Whether the velocity changes by force and torque of this step are finite.
bool PushIsFinite(const BodyStore& bodies, uint32_t body) {
    if (!bodies.dynamics[body].hasForce) return true;
    const float* a = bodies.poses[body].acceleration;
    const SymmetricMatrix3 inverse = bodies.masses[body].InverseInertia();
    return IsFinite(Vector3(a[0], a[1], a[2])) && IsFinite(Vector3(inverse * bodies.cold[body].torque));
}

// Whether a body that nothing holds is accelerated: it moves on, however slowly, although damping may leave it little
// speed. Forces that balance to a thousandth do not count.
bool IsPulled(const BodyStore& bodies, uint32_t body, const Vector3& systemGravity) {
    constexpr float kBalanced = 1e-3f;
    const BodyDynamics& d = bodies.dynamics[body];
    const float* a = bodies.poses[body].acceleration;
    const Vector3 gravity = bodies.GravityOf(body, systemGravity) * d.gravityFactor;
    float squared = LengthSquared(d.AlongFreeTranslations(Vector3(a[0], a[1], a[2]))), scale = LengthSquared(gravity);
    if (d.hasForce) {
        const BodyCold& cold = bodies.cold[body];
        const Vector3 turn = bodies.masses[body].InverseInertia() * cold.torque * d.outerRadius;
        squared = std::max(squared, LengthSquared(turn));
        scale = std::max(scale, LengthSquared(cold.force) * d.inverseMass * d.inverseMass);
    }
    return squared > kBalanced * kBalanced * scale;
}

class BodyMover {
public:
    BodyMover(const StepContext& step, const ColliderStore& colliders, const JointStore& joints,
              const ConstraintColoring& coloring, const CrowdState& crowd, BodyStore& bodies, SweepStore& sweeps)
        : step_(step),
          colliders_(colliders),
          joints_(joints),
          coloring_(coloring),
          crowd_(crowd),
          bodies_(bodies),
          sweeps_(sweeps) {}

    // Moves a range of the awake bodies.
    void Move(JobRange range, WorkerFindings& findings) const {
        Ending endings[kTurnsTogether];
        FreeTurn* const turns[kTurnsTogether] = {&endings[0].turn, &endings[1].turn, &endings[2].turn,
                                                 &endings[3].turn};
        int waiting = 0;
        const auto turnTogether = [&] {
            RotateTogether(turns, waiting, step_.dt);
            for (int i = 0; i < waiting; ++i) Finish(endings[i], findings);
            waiting = 0;
        };
        for (uint32_t i = range.begin; i < range.end; ++i) {
            Ending& ending = endings[waiting];
            bool together;
            if (!Begin(bodies_.awake[i], findings, ending, together)) continue;
            if (!together) Finish(ending, findings);
            else if (++waiting == kTurnsTogether) turnTogether();
        }
        if (waiting > 0) turnTogether();
    }

private:
    // Computes the result of the step for a body. Returns false if there is nothing to do. `together`: its rotation is
    // still to be computed, in lanes with others.
    bool Begin(uint32_t body, WorkerFindings& findings, Ending& ending, bool& together) const {
        const BodyDynamics& d = bodies_.dynamics[body];
        together = false;
        if (d.frozen) {
            bodies_.states[body] = {};  // discards the solver's result
            return false;
        }
        ending = {.body = body,
                  .v = bodies_.LinearVelocityOf(body),
                  .turn = {&d, bodies_.RotationOf(body), bodies_.AngularVelocityOf(body)},
                  .slowSpeed = SlowSpeed(step_.settings.sleep, d)};
        if (sweeps_.isKept) sweeps_.starts[body] = {bodies_.CenterPoseOf(body), step_.number};
        if (d.motion == MotionType::Kinematic) {
            ending.displacement = ending.v * step_.dt;
            ending.turn.rotation =
                Normalized(RotationFromVector(Vector3(ending.turn.angularVelocity * step_.dt)) * ending.turn.rotation);
        } else if (coloring_.IsTouched(body)) {
            MoveSolved(bodies_, joints_, ending, step_.dt);
        } else if (FlyFreely(bodies_, ending, step_, findings)) {
            together = IsSymmetric(d);
            if (!together) RotateFreely(ending.turn, step_.dt);
        }
        ending.isJointed = joints_.HasAny(body);
        if (step_.settings.sleep.enabled && ending.isJointed)
            ending.meanSpeed = MeanSpeed(bodies_, body, ending.slowSpeed, step_.dt);
        return true;
    }

    void Finish(Ending& ending, WorkerFindings& findings) const {
        const uint32_t body = ending.body;
        const BodyDynamics& d = bodies_.dynamics[body];
        Vector3 &v = ending.v, &w = ending.turn.angularVelocity;
        if (ending.fliesFreely && d.angularDamping > 0) w *= Exp(-d.angularDamping * step_.dt);
        if (!PushIsFinite(bodies_, body)) return Freeze(bodies_, colliders_, body, findings);
        if (!IsFinite(ending.displacement) || !IsFinite(ending.turn.rotation) || !IsFinite(v) || !IsFinite(w))
            return Stop(bodies_, body, findings);
        BodyState& state = bodies_.states[body];
        state = {.marks = state.marks};
        if (d.dispersing) v = OwnVelocity(bodies_, crowd_.dispersing, body, v, step_.dt);
        if (IsAtRest(bodies_, ending, step_.settings.sleep)) DampSwings(ending, step_.dt);
        findings.clamped += LimitSpeeds(bodies_, body, v, w);
        bodies_.SetVelocity(body, v, w);
        const Quaternion before = bodies_.RotationOf(body);
        bodies_.MoveCenter(body, ending.displacement, ending.turn.rotation);
        bodies_.ForgetForces(body);
        if (d.motion == MotionType::Dynamic && (step_.settings.sleep.enabled || !ending.isJointed))
            MeasureSlowness(ending, before, findings);
    }

    void MeasureSlowness(const Ending& ending, const Quaternion& before, WorkerFindings& findings) const {
        BodyDynamics& d = bodies_.dynamics[ending.body];
        const float speed =
            std::max(FarthestSpeed(bodies_, ending.body, ending.slowSpeed, ending.v, ending.turn.angularVelocity),
                     ending.meanSpeed);
        // Jointed ones keep the velocities with which they are separated.
        const bool isPushed = d.crowded && !joints_.HasAny(ending.body);
        const bool slow = !isPushed && speed < ending.slowSpeed &&
                          !(ending.fliesFreely && IsPulled(bodies_, ending.body, step_.settings.gravity));
        const bool wasSlow = d.slowSeconds > 0;
        d.slowSeconds = slow ? d.slowSeconds + step_.dt : 0.0f;
        const SleepSettings& sleep = step_.settings.sleep;
        if (slow) {
            const SlowMotion::Mean now = MeanVelocity(ending.displacement, before, ending.turn.rotation, step_.dt);
            Follow(bodies_.slowMotions[ending.body], now, wasSlow, sleep, step_.dt);
        }
        findings.sleepCandidates += sleep.enabled && d.allowSleep && slow && d.slowSeconds >= sleep.seconds;
    }

    const StepContext& step_;
    const ColliderStore& colliders_;
    const JointStore& joints_;
    const ConstraintColoring& coloring_;
    const CrowdState& crowd_;
    BodyStore& bodies_;
    SweepStore& sweeps_;
};

}  // namespace

uint32_t MoveBodies(const StepContext& step, const ColliderStore& colliders, const JointStore& joints,
                    const ConstraintColoring& coloring, const CrowdState& crowd, BodyStore& bodies, SweepStore& sweeps,
                    const StepWorkers& workers, StepReport& report) {
    if (sweeps.isKept) {
        sweeps.dt = step.dt;
        sweeps.starts.resize(bodies.Size());
    }
    const BodyMover mover(step, colliders, joints, coloring, crowd, bodies, sweeps);
    workers.jobs.ParallelFor(static_cast<uint32_t>(bodies.awake.size()), 64,
                             [&](JobRange range) { mover.Move(range, workers.findings[range.worker]); });
    uint32_t sleepCandidates = 0, firstFrozen = ~0u;
    for (const WorkerFindings& findings : workers.findings) {
        sleepCandidates += findings.sleepCandidates;
        report.clampedBodies += findings.clamped;
        report.frozenBodies += findings.frozen;
        firstFrozen = std::min(firstFrozen, findings.firstFrozen);
    }
    if (firstFrozen != ~0u) report.firstFrozen = bodies.IdOf(firstFrozen);
    return sleepCandidates;
}

}  // namespace fulcrum
