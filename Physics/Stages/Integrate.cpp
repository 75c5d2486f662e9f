#include <Fulcrum/Physics/Stages/Integrate.h>

#include <Fulcrum/Constraints/BodyLanes.h>
#include <Fulcrum/Constraints/Joints/JointKernels.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/BodyRows.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/FreeRotation.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

using namespace rows;

// The velocities of a substep: `own` is the unconstrained velocity, `carried` the change by constraints in the last
// substep, if that is carried over.
template <class Real>
struct SubstepVelocity {
    Rows<Real> velocity, unconstrained;
    Twist<Real> own, carried;

    FULCRUM_FORCE_INLINE SubstepVelocity(BodyStore& bodies, const uint32_t (&index)[kBodies<Real>], SubstepStart start)
        : velocity(index, [&](uint32_t body) { return bodies.states[body].VelocityRow(); }),
          unconstrained(index, [&](uint32_t body) { return bodies.unconstrained[body].row; }),
          own{velocity.First(), velocity.Second()} {
        if (start == SubstepStart::Carries)
            carried = {own.linear - unconstrained.First(), own.angular - unconstrained.Second()};
    }
    // Whether constraints have not changed the linear velocity in the last substep. Before `own` is changed.
    FULCRUM_FORCE_INLINE auto IsFree() const {
        const Vec3<Real> before = unconstrained.First();
        return (own.linear.x() == before.x()) & (own.linear.y() == before.y()) & (own.linear.z() == before.z());
    }
    void Write(int count) {
        unconstrained.Set(own.linear, own.angular);
        unconstrained.WriteVectors(count);
        velocity.Set(own.linear + carried.linear, own.angular + carried.angular);
        velocity.WriteVectors(count);  // clamping sets the marks of a body
    }
};

// Corrects the displacement of bodies in free flight: they moved by v h with v at the end of the substep, but the exact
// displacement is v h - a h^2 / 2. Bodies with contact impulses keep v h, since contacts constrain velocities.
template <class Real, class Mask>
FULCRUM_FORCE_INLINE void CorrectFlight(BodyStore& bodies, const uint32_t (&index)[kBodies<Real>], int count,
                                        const Mask& flies, const Vec3<Real>& acceleration, Real h) {
    Rows<Real> displacement(index, [&](uint32_t body) { return bodies.states[body].PoseRow(); });
    // Beyond the largest speed of any body: clamp or freeze.
    const Vec3<Real> gained = acceleration * h;
    const auto isUsual = Dot<Real>(gained, gained) < Real(1e12f);
    displacement.Set(displacement.First() - gained * (h * Real(0.5f)), displacement.Second());
    displacement.Write(count, flies & isUsual);
}

// Velocity that a body has after h seconds of damping 1/s, per unit: exp(-damping h).
float DampingFactor(float damping, float h) { return damping > 0 ? Exp(-damping * h) : 1.0f; }

// The principal axes of jointed bodies in the world after their displacements in the step. inertia: rows of
// BodyDynamics.
template <class Real>
FULCRUM_FORCE_INLINE Mat3<Real> AxesAfter(const BodyStore& bodies, const uint32_t (&index)[kBodies<Real>],
                                          const Real (&inertia)[8], const Rows<Real>& displacement) {
    const Rows<Real> pose(index, [&](uint32_t body) { return bodies.poses[body].Row(); });
    const Vec3<Real> turn = displacement.Second() * displacement.at[BodyState::kHalfTurn];
    const Quat<Real> turned{turn.x(), turn.y(), turn.z(), displacement.at[BodyState::kHalfTurn + 1]};
    const Quat<Real> rotation = turned * QuaternionAt<BodyPose::kRotation>(pose.at);
    return ToMatrix<Real>(rotation * QuaternionAt<BodyDynamics::kPrincipalAxes>(inertia));
}

void IntegrateVelocity(BodyStore& bodies, const JointStore& joints, uint32_t body, float h, SubstepStart start,
                       WorkerFindings& findings) {
    const BodyDynamics& d = bodies.dynamics[body];
    if (d.motion != MotionType::Dynamic) return;
    const float* a = bodies.poses[body].acceleration;
    SubstepVelocity<float> velocity(bodies, {body}, start);
    if (start != SubstepStart::First && velocity.IsFree())
        CorrectFlight<float>(bodies, {body}, 1, true, Vector3(a[0], a[1], a[2]), h);
    Vector3 &v = velocity.own.linear, &w = velocity.own.angular;
    // The velocities of jointed bodies are also those of their joints.
    const bool isJointed = joints.HasAny(body);
    if (start != SubstepStart::First && d.crowded && !isJointed) {
        v = NoFasterThan(v, velocity.unconstrained.First());
        w = NoFasterThan(w, velocity.unconstrained.Second());
        if (d.dispersing) velocity.carried = {};
    }
    v = (v + Vector3(a[0], a[1], a[2]) * h) * DampingFactor(d.linearDamping, h);
    w *= DampingFactor(d.angularDamping, h);
    if (d.hasForce) w += bodies.masses[body].InverseInertia() * bodies.cold[body].torque * h;
    if (d.lockedAxes != LockedAxes::None) {
        d.Lock(v, w);
        d.Lock(velocity.carried.linear, velocity.carried.angular);
    }
    // A velocity that is not finite must not reach the rows and so the neighbors. Store detects the forces and freezes
    // the body.
    if (!IsFinite(v) || !IsFinite(w)) velocity.own = velocity.carried = {};
    findings.clamped += LimitSpeeds(bodies, body, v, w);
    velocity.Write(1);
}

// The rotation vector, rad, of the rotation `before`, followed by that of `turn`. half: HalfTurnOf `before`.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> Composed(const Vec3<Real>& before, const Vec2<Real>& half, const Vec3<Real>& turn) {
    const Vec2<Real> by = HalfTurnOf<Real>(turn);
    const Vec3<Real> vector =
        turn * (by.x() * half.y()) + before * (by.y() * half.x()) + Cross<Real>(turn, before) * (by.x() * half.x());
    const Real cosine = by.y() * half.y() - by.x() * half.x() * Dot<Real>(turn, before);
    // The angle is nearly that of the sum: the sine of half the difference, and its arc sine.
    const Vec3<Real> sum = before + turn;
    const Vec2<Real> guess = HalfTurnOf<Real>(sum);
    const Real squared = Dot<Real>(vector, vector), sine = Sqrt(squared), angle = Sqrt(Dot<Real>(sum, sum));
    const Real rest = sine * guess.y() - cosine * (guess.x() * angle);
    const Real exact = angle + Real(2.0f) * rest * (Real(1.0f) + rest * rest * Real(1.0f / 6));
    // Below the precision of a float it is the sum of both.
    const auto isSmall = squared < Real(1e-12f);
    return vector * Select(isSmall, Real(2.0f), exact / Select(isSmall, Real(1.0f), sine));
}

// Moves bodies by the motion for h seconds. For jointed ones rotations are composed exactly.
template <class Real, class Mask>
FULCRUM_FORCE_INLINE Vec3<Real> Displace(Rows<Real>& displacement, const Twist<Real>& motion, const Mask& isJointed,
                                         Real h, int count) {
    const Vec3<Real> turn = motion.angular * h;
    Vec3<Real> rotation = displacement.Second();
    const bool anyJointed = Any(isJointed);
    if (anyJointed) {
        const Vec3<Real> composed = Composed<Real>(
            rotation, Vec2<Real>(displacement.at[BodyState::kHalfTurn], displacement.at[BodyState::kHalfTurn + 1]),
            turn);
        const Vec3<Real> sum = rotation + turn;
        const auto isFar =
            Max(Dot<Real>(rotation, rotation), Dot<Real>(sum, sum)) > Real(kFarthestTurn * kFarthestTurn);
        for (int k = 0; k < 3; ++k)
            rotation[k] = Select(isJointed, Select(isFar, Real(sum[k]), composed[k]), Real(sum[k]));
    } else {
        rotation += turn;
    }
    displacement.Set(displacement.First() + motion.linear * h, rotation);
    if (anyJointed) SetHalfTurn<Real>(displacement.at);
    displacement.Write(count);
    return rotation;
}

// Rotates the world inertia of jointed bodies with them. Joints act at the ends of bodies, where an outdated inertia
// would give wrong torques.
template <class Real, class Mask>
FULCRUM_FORCE_INLINE void TurnInertia(BodyStore& bodies, const uint32_t (&index)[kBodies<Real>], int count,
                                      const Mask& feels, const Rows<Real>& displacement) {
    const Rows<Real> inertia(index, [&](uint32_t body) { return bodies.dynamics[body].InertiaRow(); });
    const Sym3<Real> turned =
        RotatedDiagonal<Real>(AxesAfter<Real>(bodies, index, inertia.at, displacement), inertia.First());
    Rows<Real> mass(index, [&](uint32_t body) { return bodies.masses[body].Row(); });
    constexpr int i = BodyMass::kInverseInertia;
    mass.at[i] = turned.xx, mass.at[i + 1] = turned.yy, mass.at[i + 2] = turned.zz;
    mass.at[i + 3] = turned.xy, mass.at[i + 4] = turned.xz, mass.at[i + 5] = turned.yz;
    // Of turns beyond what a float resolves there is none.
    const auto isKnown =
        (turned.xx + turned.yy + turned.zz + turned.xy + turned.xz + turned.yz) * Real(0.0f) == Real(0.0f);
    mass.Write(count, feels & isKnown);
}

// For bodies that rotate about two world axes: the gyroscopic torque, and the inertia. before, after: rotations since
// the start of the step, rad.
void TurnAboutTwoAxes(BodyStore& bodies, uint32_t body, const Vector3& before, const Vector3& after) {
    const BodyDynamics& d = bodies.dynamics[body];
    const Quaternion start = bodies.RotationOf(body), end = RotationFromVector(after) * start;
    const Vector3 w = bodies.AngularVelocityOf(body);
    const Vector3 turned = VelocityAboutTwoAxes(d, RotationFromVector(before) * start, end, w);
    float* unconstrained = bodies.unconstrained[body].row;
    for (int k = 0; k < 3; ++k) unconstrained[BodyState::kAngular + k] += turned[k] - w[k];
    bodies.SetVelocity(body, bodies.LinearVelocityOf(body), turned);
    // Of turns beyond what a float resolves there is none.
    const BodyMass mass = bodies.MassAlong(body, AxesOf(d, end));
    if (std::isfinite(Trace(mass))) bodies.masses[body] = mass;
}

// Validates the solved velocity of a body before it moves. If not finite, it must not reach the pose either, which
// constraints of neighbors read.
void LimitSolved(BodyStore& bodies, uint32_t body, WorkerFindings& findings) {
    Vector3 v = bodies.LinearVelocityOf(body), w = bodies.AngularVelocityOf(body);
    if (IsWithinSpeeds(bodies.dynamics[body], v, w)) return;
    if (IsFinite(v) && IsFinite(w)) {
        const Vector3 fastV = v, fastW = w;
        findings.clamped += ShortenSpeeds(bodies, body, v, w);
        // The change by clamping is no constraint impulse: the next substep's warm start must not repeat it.
        float* row = bodies.unconstrained[body].row;
        for (int k = 0; k < 3; ++k) {
            row[BodyState::kLinear + k] += v[k] - fastV[k];
            row[BodyState::kAngular + k] += w[k] - fastW[k];
        }
    } else {
        v = w = Vector3::Zero();
        bodies.unconstrained[body] = {};
    }
    bodies.SetVelocity(body, v, w);
}

// Whether constraints have not changed the linear velocity in this substep.
template <class Real>
FULCRUM_FORCE_INLINE auto Flies(const BodyStore& bodies, const uint32_t (&index)[kBodies<Real>],
                                const Vec3<Real>& velocity) {
    const Rows<Real> unconstrained(index, [&](uint32_t body) { return bodies.unconstrained[body].row; });
    const Vec3<Real> own = unconstrained.First();
    return (own.x() == velocity.x()) & (own.y() == velocity.y()) & (own.z() == velocity.z());
}

void IntegratePose(const MovedBodies& moved, uint32_t body, float h, bool isLast, WorkerFindings& findings) {
    BodyStore& bodies = moved.store;
    const BodyDynamics& d = bodies.dynamics[body];
    if (d.motion != MotionType::Dynamic) return;
    LimitSolved(bodies, body, findings);
    BodyState& s = bodies.states[body];
    if (d.lockedAxes != LockedAxes::None) {
        Vector3 v = bodies.LinearVelocityOf(body), w = bodies.AngularVelocityOf(body);
        d.Lock(v, w);
        bodies.SetVelocity(body, v, w);
    }
    if (d.dispersing) LimitPush(moved.settings, moved.colliders, moved.pairs, bodies, body, h);
    const Twist<float> motion{bodies.LinearVelocityOf(body), bodies.AngularVelocityOf(body)};
    const bool isJointed = moved.joints.HasAny(body);
    Rows<float> displacement({body}, [&](uint32_t) { return s.PoseRow(); });
    const Vector3 turnBefore = displacement.Second(), turn = Displace(displacement, motion, isJointed, h, 1);
    const float* a = bodies.poses[body].acceleration;
    if (isLast && Flies<float>(bodies, {body}, bodies.LinearVelocityOf(body)))
        CorrectFlight<float>(bodies, {body}, 1, true, Vector3(a[0], a[1], a[2]), h);
    if (!isJointed) return;
    if (d.RotatesAboutTwoAxes()) return TurnAboutTwoAxes(bodies, body, turnBefore, turn);
    if (d.HasGyroscopicTorqueAt(bodies.AngularVelocityOf(body)))
        TurnInertia<float>(bodies, {body}, 1, true, displacement);
}

// The lanes of the mask whose bodies may feel a gyroscopic torque, and those that feel it at w, rad/s.
FULCRUM_FORCE_INLINE WideMask<kLanes> MayFeelGyroscopicTorque(const BodyStore& bodies, const Indices& index,
                                                              const WideMask<kLanes>& among) {
    alignas(64) float gyroscopic[kLanes];
    for (int i = 0; i < kLanes; ++i) {
        const BodyDynamics& d = bodies.dynamics[index[i]];
        gyroscopic[i] = d.motion == MotionType::Dynamic && d.HasGyroscopicTorque() ? 1.0f : 0.0f;
    }
    return among & (Lanes::Load(gyroscopic) > Lanes(0.0f));
}
FULCRUM_FORCE_INLINE WideMask<kLanes> FeelsGyroscopicTorque(const WideMask<kLanes>& mayFeel, const Vec3<Lanes>& w) {
    constexpr float kLeast = BodyDynamics::kLeastGyroscopicSpeed * BodyDynamics::kLeastGyroscopicSpeed;
    return mayFeel & (Dot<Lanes>(w, w) > Lanes(kLeast));
}
FULCRUM_FORCE_INLINE WideMask<kLanes> AreJointed(const JointStore& joints, const Indices& index) {
    alignas(64) float jointed[kLanes];
    for (int i = 0; i < kLanes; ++i) jointed[i] = joints.HasAny(index[i]) ? 1.0f : 0.0f;
    return Lanes::Load(jointed) > Lanes(0.0f);
}

// Mask of the lanes whose velocity is within the limit; false if not finite.
WideMask<kLanes> IsWithin(const Vec3<Lanes>& v, const Lanes& limit) {
    const Lanes squared = Dot<Lanes>(v, v);
    return (squared <= limit * limit) & (squared < Lanes(std::numeric_limits<float>::infinity()));
}

// Returns false, and does nothing, if some body needs the scalar code.
bool IntegrateVelocitiesInLanes(BodyStore& bodies, const JointStore& joints, const Indices& index, int count, float h,
                                SubstepStart start) {
    for (uint32_t body : index) {
        const BodyDynamics& d = bodies.dynamics[body];
        if (d.motion != MotionType::Dynamic || d.lockedAxes != LockedAxes::None || d.hasForce) return false;
        if (d.dispersing || (d.crowded && !joints.HasAny(body))) return false;
    }
    const Rows<Lanes> limits(index, [&](uint32_t body) { return bodies.dynamics[body].LimitsRow(); });
    const Lanes zero(0.0f), linearDamping = limits.at[BodyDynamics::kLinearDamping],
                            angularDamping = limits.at[BodyDynamics::kAngularDamping],
                            maxLinear = limits.at[BodyDynamics::kMaxLinearSpeed],
                            maxAngular = limits.at[BodyDynamics::kMaxAngularSpeed];
    if (((linearDamping > zero) | (angularDamping > zero)).Any()) return false;
    SubstepVelocity<Lanes> velocity(bodies, index, start);
    const Rows<Lanes> pose(index, [&](uint32_t body) { return bodies.poses[body].Row(); });
    const Vec3<Lanes> acceleration = VectorAt<BodyPose::kAcceleration>(pose.at);
    const auto flies = start != SubstepStart::First ? velocity.IsFree() : zero > zero;
    velocity.own.linear += acceleration * Lanes(h);
    if (!(IsWithin(velocity.own.linear, maxLinear) & IsWithin(velocity.own.angular, maxAngular)).All()) return false;
    if (flies.Any()) CorrectFlight<Lanes>(bodies, index, count, flies, acceleration, Lanes(h));
    velocity.Write(count);
    return true;
}

bool IntegratePosesInLanes(const MovedBodies& moved, const Indices& index, int count, float h, bool isLast) {
    BodyStore& bodies = moved.store;
    for (const uint32_t body : index) {
        const BodyDynamics& d = bodies.dynamics[body];
        if (d.motion != MotionType::Dynamic || d.lockedAxes != LockedAxes::None || d.dispersing) return false;
    }
    const Rows<Lanes> velocity(index, [&](uint32_t body) { return bodies.states[body].VelocityRow(); });
    const Rows<Lanes> limits(index, [&](uint32_t body) { return bodies.dynamics[body].LimitsRow(); });
    if (!(IsWithin(velocity.First(), limits.at[BodyDynamics::kMaxLinearSpeed]) &
          IsWithin(velocity.Second(), limits.at[BodyDynamics::kMaxAngularSpeed]))
             .All())
        return false;
    Rows<Lanes> displacement(index, [&](uint32_t body) { return bodies.states[body].PoseRow(); });
    const auto isJointed = AreJointed(moved.joints, index);
    Displace(displacement, Twist<Lanes>{velocity.First(), velocity.Second()}, isJointed, Lanes(h), count);
    if (isLast) {
        const auto flies = Flies<Lanes>(bodies, index, velocity.First());
        if (flies.Any()) {
            const Rows<Lanes> pose(index, [&](uint32_t body) { return bodies.poses[body].Row(); });
            CorrectFlight<Lanes>(bodies, index, count, flies, VectorAt<BodyPose::kAcceleration>(pose.at), Lanes(h));
        }
    }
    const auto feels = FeelsGyroscopicTorque(MayFeelGyroscopicTorque(bodies, index, isJointed), velocity.Second());
    if (feels.Any()) TurnInertia(bodies, index, count, feels, displacement);
    return true;
}

// Calls inLanes(indices, count) for kLanes bodies at a time, and oneByOne(body) for each if that returns false.
template <class InLanes, class OneByOne>
void VisitBodies(std::span<const uint32_t> bodies, InLanes&& inLanes, OneByOne&& oneByOne) {
    VisitInLanes(bodies, [&](const Indices& index, int count) {
        if (!inLanes(index, count))
            for (int i = 0; i < count; ++i) oneByOne(index[i]);
    });
}

}  // namespace

void IntegrateVelocities(BodyStore& store, const JointStore& joints, std::span<const uint32_t> bodies, float h,
                         SubstepStart start, WorkerFindings& findings) {
    VisitBodies(
        bodies,
        [&](const Indices& index, int count) {
            return IntegrateVelocitiesInLanes(store, joints, index, count, h, start);
        },
        [&](uint32_t body) { IntegrateVelocity(store, joints, body, h, start, findings); });
}

void AddGyroscopicTorque(BodyStore& store, const JointStore& joints, std::span<const uint32_t> bodies, float h,
                         GyroscopicHalves halves, const WarmStart* starts) {
    VisitInLanes(bodies, [&](const Indices& index, int count) {
        const auto mayFeel = MayFeelGyroscopicTorque(store, index, AreJointed(joints, index));
        if (!mayFeel.Any()) return;
        Rows<Lanes> velocity(index, [&](uint32_t body) { return store.states[body].VelocityRow(); });
        Rows<Lanes> unconstrained(index, [&](uint32_t body) { return store.unconstrained[body].row; });
        const Rows<Lanes> inertia(index, [&](uint32_t body) { return store.dynamics[body].InertiaRow(); });
        const Rows<Lanes> displacement(index, [&](uint32_t body) { return store.states[body].PoseRow(); });
        const Mat3<Lanes> axes = AxesAfter<Lanes>(store, index, inertia.at, displacement);
        const auto changeAt = [&](const Vec3<Lanes>& w) FULCRUM_FORCE_INLINE_LAMBDA {
            return ZeroUnless<Lanes>(FeelsGyroscopicTorque(mayFeel, w),
                                     Vec3<Lanes>(AddGyroscopicTorque<Lanes, GyroscopicRule::Reversible>(
                                                     inertia.First(), axes, w, Lanes(0.5f * h)) -
                                                 w));
        };
        Vec3<Lanes> change(Lanes(0.0f), Lanes(0.0f), Lanes(0.0f));
        if (halves != GyroscopicHalves::First) change = changeAt(velocity.Second());
        if (halves != GyroscopicHalves::Second) {
            const Vec3<Lanes> w = velocity.Second() + change;
            const Rows<Lanes> start(index, [&](uint32_t body) { return starts[body].Row(); });
            InverseMass<Lanes> mass;
            GatherMass<kLanes>(index, store.masses.data(), mass);
            const Vec3<Lanes> warm = mass.inertia * VectorAt<WarmStart::kAngularImpulse>(start.at);
            // What changes a velocity by more than the velocity itself is not resolved by the substep, and counts less.
            const Lanes squared = Dot<Lanes>(w, w);
            const Lanes part = squared / Max(Max(squared, Dot<Lanes>(warm, warm)), Lanes(1e-20f));
            change += changeAt(Vec3<Lanes>(w + warm * part));
        }
        velocity.Set(velocity.First(), velocity.Second() + change);
        velocity.Write(count, mayFeel);
        // It is none by constraints.
        unconstrained.Set(unconstrained.First(), unconstrained.Second() + change);
        unconstrained.Write(count, mayFeel);
    });
}

void IntegratePoses(const MovedBodies& moved, std::span<const uint32_t> bodies, float h, bool isLast,
                    WorkerFindings& findings) {
    VisitBodies(
        bodies, [&](const Indices& index, int count) { return IntegratePosesInLanes(moved, index, count, h, isLast); },
        [&](uint32_t body) { IntegratePose(moved, body, h, isLast, findings); });
}

}  // namespace fulcrum
