#include <Fulcrum/Physics/Stages/Integrate.h>

#include <Fulcrum/Constraints/BodyLanes.h>
#include <Fulcrum/Constraints/Joints/JointKernels.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/FreeRotation.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>

#include <algorithm>

namespace fulcrum {

namespace {

using Lanes = Wide<kLanes>;
using Indices = uint32_t[kLanes];

// The kernels below are templates over Real: float for one body, Lanes for kLanes bodies.
template <class Real>
inline constexpr int kBodies = sizeof(Real) / sizeof(float);

// Eight numbers of each body.
template <class Real>
struct Rows {
    static constexpr int kCount = kBodies<Real>;
    float* rows[kCount];
    Real at[8];

    template <class RowOf>
    FULCRUM_FORCE_INLINE Rows(const uint32_t (&bodies)[kCount], RowOf&& rowOf) {
        for (int i = 0; i < kCount; ++i) rows[i] = const_cast<float*>(rowOf(bodies[i]));
        if constexpr (std::is_same_v<Real, float>) std::copy_n(rows[0], 8, at);
        else GatherRows<kCount>(reinterpret_cast<const float* const(&)[kCount]>(rows), at);
    }
    Vec3<Real> First() const { return VectorAt<BodyState::kLinear>(at); }
    Vec3<Real> Second() const { return VectorAt<BodyState::kAngular>(at); }
    void Set(const Vec3<Real>& first, const Vec3<Real>& second) {
        SetVectorAt<BodyState::kLinear>(at, first);
        SetVectorAt<BodyState::kAngular>(at, second);
    }
    void Write(int count) const {
        if constexpr (std::is_same_v<Real, float>) std::copy_n(at, 8, rows[0]);
        else ScatterRows<kCount>(rows, at, count);
    }
    // Writes First and Second. For a single body the other two numbers of the row may have changed since they were
    // read, in lanes not.
    void WriteVectors(int count) const {
        if constexpr (std::is_same_v<Real, float>) std::copy_n(at, 6, rows[0]);
        else Write(count);
    }
    // Writes the lanes of the mask.
    void Write(int count, const WideMask<kCount>& mask) {
        const uint32_t lanes = mask.ToBits();
        alignas(32) float nowhere[8];
        for (int i = 0; i < kCount; ++i)
            if (!(lanes >> i & 1u)) rows[i] = nowhere;
        Write(count);
    }
    void Write(int count, bool mask) const {
        if (mask) Write(count);
    }
};

// The velocities of a substep: `own` is the unconstrained velocity, `carried` the change by constraints in the last
// substep.
template <class Real>
struct SubstepVelocity {
    Rows<Real> velocity, unconstrained;
    Twist<Real> own, carried;

    // again: not the first substep of the step.
    FULCRUM_FORCE_INLINE SubstepVelocity(BodyStore& bodies, const uint32_t (&index)[kBodies<Real>], bool again)
        : velocity(index, [&](uint32_t body) { return bodies.states[body].VelocityRow(); }),
          unconstrained(index, [&](uint32_t body) { return bodies.unconstrained[body].row; }),
          own{velocity.First(), velocity.Second()} {
        if (again) carried = {own.linear - unconstrained.First(), own.angular - unconstrained.Second()};
    }
    // Whether constraints have not changed the linear velocity in the last substep.
    FULCRUM_FORCE_INLINE auto IsFree() const {
        const Real zero(0.0f);
        return (carried.linear.x() == zero) & (carried.linear.y() == zero) & (carried.linear.z() == zero);
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

void IntegrateVelocity(BodyStore& bodies, const JointStore& joints, uint32_t body, float h, bool again,
                       WorkerFindings& findings) {
    const BodyDynamics& d = bodies.dynamics[body];
    if (d.motion != MotionType::Dynamic) return;
    const float* a = bodies.poses[body].acceleration;
    SubstepVelocity<float> velocity(bodies, {body}, again);
    if (again && velocity.IsFree()) CorrectFlight<float>(bodies, {body}, 1, true, Vector3(a[0], a[1], a[2]), h);
    Vector3 &v = velocity.own.linear, &w = velocity.own.angular;
    // The velocities of jointed bodies are also those of their joints.
    if (again && d.crowded && !joints.HasAny(body)) {
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

// Composition of rotation vectors: the difference between the rotation vector, rad, of a rotation followed by a small
// one and the sum of their rotation vectors, to second order of the small one (Baker-Campbell-Hausdorff series with all
// terms of first order in it: the inverse left Jacobian). Without it substeps would not reduce the error of a step.
// half: HalfTurnOf `before`.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> CompositionCorrection(const Vec3<Real>& before, const Vec2<Real>& half,
                                                      const Vec3<Real>& turn) {
    // (1 - (t / 2) cot(t / 2)) / t^2 for an angle t.
    const Real squared = Dot<Real>(before, before);
    const Real series = Real(1.0f / 12) + squared * (Real(1.0f / 720) + squared * Real(1.0f / 30240));
    const Real closed = (Real(1.0f) - Real(0.5f) * half.y() / half.x()) / Max(squared, Real(0.1f));
    const Real gamma = Select(squared < Real(0.1f), series, closed);
    const Vec3<Real> across = Cross<Real>(turn, before);
    return across * Real(0.5f) - Cross<Real>(before, across) * gamma + Cross<Real>(turn, across) * Real(1.0f / 12);
}

// Moves bodies by the motion for h seconds. For jointed ones rotations are composed exactly.
template <class Real, class Mask>
FULCRUM_FORCE_INLINE Vec3<Real> Displace(Rows<Real>& displacement, const Twist<Real>& motion, const Mask& isJointed,
                                         Real h, int count) {
    const Vec3<Real> turn = motion.angular * h;
    Vec3<Real> rotation = displacement.Second();
    const bool anyJointed = Any(isJointed);
    if (anyJointed) {
        const Vec3<Real> more = CompositionCorrection<Real>(
            rotation, Vec2<Real>(displacement.at[BodyState::kHalfTurn], displacement.at[BodyState::kHalfTurn + 1]),
            turn);
        const auto isFar = Dot<Real>(rotation, rotation) > Real(joints::kFarthestTurn * joints::kFarthestTurn);
        for (int k = 0; k < 3; ++k) {
            const Real composed = Select(isFar, Real(rotation[k]), Real(rotation[k] + more[k]));
            rotation[k] = Select(isJointed, composed, Real(rotation[k]));
        }
    }
    rotation += turn;
    displacement.Set(displacement.First() + motion.linear * h, rotation);
    if (anyJointed) SetHalfTurn<Real>(displacement.at);
    displacement.Write(count);
    return rotation;
}

// For bodies with gyroscopic torque: applies it to w, rad/s, and rotates their world inertia. Joints act at the ends of
// bodies, where an outdated inertia would give wrong torques. turn: rotation since the start of the step, rad.
template <class Real, class Mask>
FULCRUM_FORCE_INLINE void TurnInertia(BodyStore& bodies, const uint32_t (&index)[kBodies<Real>], int count,
                                      const Mask& feels, const Vec3<Real>& turn, Vec3<Real>& w, Real h) {
    const Rows<Real> pose(index, [&](uint32_t body) { return bodies.poses[body].Row(); });
    const Rows<Real> inertia(index, [&](uint32_t body) { return bodies.dynamics[body].InertiaRow(); });
    Rows<Real> unconstrained(index, [&](uint32_t body) { return bodies.unconstrained[body].row; });
    const Quat<Real> rotation = RotationFromVector<Real>(turn) * QuaternionAt<BodyPose::kRotation>(pose.at);
    const Mat3<Real> axes = ToMatrix<Real>(rotation * QuaternionAt<BodyDynamics::kPrincipalAxes>(inertia.at));
    const Vec3<Real> change =
        AddGyroscopicTorque<Real>(inertia.First(), axes, w, h, Vec3<Real>(w - unconstrained.Second())) - w;
    for (int k = 0; k < 3; ++k) w[k] = Select(feels, Real(w[k] + change[k]), Real(w[k]));
    unconstrained.Set(unconstrained.First(), unconstrained.Second() + change);
    unconstrained.Write(count, feels);
    const Sym3<Real> turned = RotatedDiagonal<Real>(axes, inertia.First());
    Rows<Real> mass(index, [&](uint32_t body) { return bodies.masses[body].Row(); });
    constexpr int i = BodyMass::kInverseInertia;
    mass.at[i] = turned.xx, mass.at[i + 1] = turned.yy, mass.at[i + 2] = turned.zz;
    mass.at[i + 3] = turned.xy, mass.at[i + 4] = turned.xz, mass.at[i + 5] = turned.yz;
    mass.Write(count, feels);
}

// The same for bodies that rotate about two world axes. before, after: rotations since the start of the step, rad.
void TurnAboutTwoAxes(BodyStore& bodies, uint32_t body, const Vector3& before, const Vector3& after) {
    const BodyDynamics& d = bodies.dynamics[body];
    const Quaternion start = bodies.RotationOf(body), end = RotationFromVector(after) * start;
    const Vector3 w = bodies.AngularVelocityOf(body);
    const Vector3 turned = VelocityAboutTwoAxes(d, RotationFromVector(before) * start, end, w);
    float* unconstrained = bodies.unconstrained[body].row;
    for (int k = 0; k < 3; ++k) unconstrained[BodyState::kAngular + k] += turned[k] - w[k];
    bodies.SetVelocity(body, bodies.LinearVelocityOf(body), turned);
    bodies.masses[body] = bodies.MassAlong(body, AxesOf(d, end));
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

// m/s and rad/s: pseudo-velocity of a body by joints that are far apart.
Twist<float> PullOf(const BodyDynamics& d, const BodyState& pseudo) {
    const float(&v)[3] = pseudo.linearVelocity, (&w)[3] = pseudo.angularVelocity;
    Twist<float> pull{Vector3(v[0], v[1], v[2]), Vector3(w[0], w[1], w[2])};
    if (!IsFinite(pull.linear) || !IsFinite(pull.angular)) return {};
    d.Lock(pull.linear, pull.angular);
    return pull;
}

// The part of a velocity opposite to the pull that a body near a static or kinematic one loses: held in place by the
// pull it would otherwise keep accelerating, since no contact stops it.
Vector3 LostTo(const Vector3& pull, const Vector3& v) {
    const float against = -Dot(v, pull);
    return against > 0.0f ? Vector3(pull * Min(against / LengthSquared(pull), 1.0f)) : Vector3(Vector3::Zero());
}

void SlowDown(BodyStore& bodies, uint32_t body, const Twist<float>& pull, Twist<float>& motion) {
    const Vector3 linear = LostTo(pull.linear, motion.linear), angular = LostTo(pull.angular, motion.angular);
    float* unconstrained = bodies.unconstrained[body].row;
    for (int n = 0; n < 3; ++n) {
        unconstrained[BodyState::kLinear + n] += linear[n];
        unconstrained[BodyState::kAngular + n] += angular[n];
    }
    motion.linear += linear;
    motion.angular += angular;
    bodies.SetVelocity(body, motion.linear, motion.angular);
}

// Adds the pull to the motion, and removes LostTo from the body's velocities. Bodies without a pull stay bit-identical.
void AddPull(BodyStore& bodies, uint32_t body, const BodyState& pseudo, Twist<float>& motion) {
    const Twist<float> pull = PullOf(bodies.dynamics[body], pseudo);
    if (pull.linear.isZero(0) && pull.angular.isZero(0)) return;
    if (pseudo.nearFixed > 0.0f) SlowDown(bodies, body, pull, motion);
    motion.linear += pull.linear;
    motion.angular += pull.angular;
    LimitLength(motion.linear, bodies.dynamics[body].maxLinearSpeed);
    LimitLength(motion.angular, bodies.dynamics[body].maxAngularSpeed);
}

// Whether constraints have not changed the linear velocity in this substep.
template <class Real>
FULCRUM_FORCE_INLINE auto Flies(const BodyStore& bodies, const uint32_t (&index)[kBodies<Real>],
                                const Vec3<Real>& velocity) {
    const Rows<Real> unconstrained(index, [&](uint32_t body) { return bodies.unconstrained[body].row; });
    const Vec3<Real> own = unconstrained.First();
    return (own.x() == velocity.x()) & (own.y() == velocity.y()) & (own.z() == velocity.z());
}

void IntegratePose(const MovedBodies& moved, uint32_t body, float h, bool isLast, const BodyState* pseudo,
                   WorkerFindings& findings) {
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
    Twist<float> motion{bodies.LinearVelocityOf(body), bodies.AngularVelocityOf(body)};
    if (pseudo) AddPull(bodies, body, pseudo[body], motion);
    const bool isJointed = moved.joints.HasAny(body);
    Rows<float> displacement({body}, [&](uint32_t) { return s.PoseRow(); });
    const Vector3 turnBefore = displacement.Second(), turn = Displace(displacement, motion, isJointed, h, 1);
    const float* a = bodies.poses[body].acceleration;
    if (isLast && Flies<float>(bodies, {body}, bodies.LinearVelocityOf(body)))
        CorrectFlight<float>(bodies, {body}, 1, true, Vector3(a[0], a[1], a[2]), h);
    if (!isJointed) return;
    if (d.RotatesAboutTwoAxes()) return TurnAboutTwoAxes(bodies, body, turnBefore, turn);
    Vector3 w = bodies.AngularVelocityOf(body);
    if (!d.HasGyroscopicTorqueAt(w)) return;
    TurnInertia(bodies, {body}, 1, true, turn, w, h);
    bodies.SetVelocity(body, bodies.LinearVelocityOf(body), w);
}

// Mask of the lanes whose velocity is within the limit; false if not finite.
WideMask<kLanes> IsWithin(const Vec3<Lanes>& v, const Lanes& limit) {
    const Lanes squared = Dot<Lanes>(v, v);
    return (squared <= limit * limit) & (squared < Lanes(std::numeric_limits<float>::infinity()));
}

// Returns false, and does nothing, if some body needs the scalar code.
bool IntegrateVelocitiesInLanes(BodyStore& bodies, const Indices& index, int count, float h, bool again) {
    for (uint32_t body : index) {
        const BodyDynamics& d = bodies.dynamics[body];
        if (d.motion != MotionType::Dynamic || d.lockedAxes != LockedAxes::None || d.hasForce || d.crowded)
            return false;
    }
    const Rows<Lanes> limits(index, [&](uint32_t body) { return bodies.dynamics[body].LimitsRow(); });
    const Lanes zero(0.0f), linearDamping = limits.at[BodyDynamics::kLinearDamping],
                            angularDamping = limits.at[BodyDynamics::kAngularDamping],
                            maxLinear = limits.at[BodyDynamics::kMaxLinearSpeed],
                            maxAngular = limits.at[BodyDynamics::kMaxAngularSpeed];
    if (((linearDamping > zero) | (angularDamping > zero)).Any()) return false;
    SubstepVelocity<Lanes> velocity(bodies, index, again);
    const Rows<Lanes> pose(index, [&](uint32_t body) { return bodies.poses[body].Row(); });
    const Vec3<Lanes> acceleration = VectorAt<BodyPose::kAcceleration>(pose.at);
    const auto flies = again ? velocity.IsFree() : zero > zero;
    velocity.own.linear += acceleration * Lanes(h);
    if (!(IsWithin(velocity.own.linear, maxLinear) & IsWithin(velocity.own.angular, maxAngular)).All()) return false;
    if (flies.Any()) CorrectFlight<Lanes>(bodies, index, count, flies, acceleration, Lanes(h));
    velocity.Write(count);
    return true;
}

bool IntegratePosesInLanes(const MovedBodies& moved, const Indices& index, int count, float h, bool isLast) {
    BodyStore& bodies = moved.store;
    alignas(64) float jointed[kLanes], gyroscopic[kLanes];
    for (int i = 0; i < kLanes; ++i) {
        const BodyDynamics& d = bodies.dynamics[index[i]];
        if (d.motion != MotionType::Dynamic || d.lockedAxes != LockedAxes::None || d.crowded) return false;
        jointed[i] = moved.joints.HasAny(index[i]) ? 1.0f : 0.0f;
        gyroscopic[i] = d.HasGyroscopicTorque() ? 1.0f : 0.0f;
    }
    Rows<Lanes> velocity(index, [&](uint32_t body) { return bodies.states[body].VelocityRow(); });
    const Rows<Lanes> limits(index, [&](uint32_t body) { return bodies.dynamics[body].LimitsRow(); });
    if (!(IsWithin(velocity.First(), limits.at[BodyDynamics::kMaxLinearSpeed]) &
          IsWithin(velocity.Second(), limits.at[BodyDynamics::kMaxAngularSpeed]))
             .All())
        return false;
    Rows<Lanes> displacement(index, [&](uint32_t body) { return bodies.states[body].PoseRow(); });
    const auto isJointed = Lanes::Load(jointed) > Lanes(0.0f);
    const Vec3<Lanes> turn =
        Displace(displacement, Twist<Lanes>{velocity.First(), velocity.Second()}, isJointed, Lanes(h), count);
    if (isLast) {
        const auto flies = Flies<Lanes>(bodies, index, velocity.First());
        if (flies.Any()) {
            const Rows<Lanes> pose(index, [&](uint32_t body) { return bodies.poses[body].Row(); });
            CorrectFlight<Lanes>(bodies, index, count, flies, VectorAt<BodyPose::kAcceleration>(pose.at), Lanes(h));
        }
    }
    Vec3<Lanes> w = velocity.Second();
    constexpr float kLeast = BodyDynamics::kLeastGyroscopicSpeed * BodyDynamics::kLeastGyroscopicSpeed;
    const auto feels = isJointed & (Lanes::Load(gyroscopic) > Lanes(0.0f)) & (Dot<Lanes>(w, w) > Lanes(kLeast));
    if (!feels.Any()) return true;
    TurnInertia(bodies, index, count, feels, turn, w, Lanes(h));
    velocity.Set(velocity.First(), w);
    velocity.Write(count);
    return true;
}

// Calls inLanes(indices, count) for kLanes bodies at a time, and oneByOne(body) for each if that returns false. Lanes
// beyond the last body repeat it.
template <class InLanes, class OneByOne>
void VisitBodies(std::span<const uint32_t> bodies, InLanes&& inLanes, OneByOne&& oneByOne) {
    while (!bodies.empty()) {
        const size_t count = std::min(bodies.size(), size_t(kLanes));
        Indices index;
        for (size_t i = 0; i < kLanes; ++i) index[i] = bodies[std::min(i, count - 1)];
        if (!inLanes(index, static_cast<int>(count)))
            for (size_t i = 0; i < count; ++i) oneByOne(bodies[i]);
        bodies = bodies.subspan(count);
    }
}

}  // namespace

void IntegrateVelocities(BodyStore& store, const JointStore& joints, std::span<const uint32_t> bodies, float h,
                         bool again, WorkerFindings& findings) {
    VisitBodies(
        bodies,
        [&](const Indices& index, int count) { return IntegrateVelocitiesInLanes(store, index, count, h, again); },
        [&](uint32_t body) { IntegrateVelocity(store, joints, body, h, again, findings); });
}

void IntegratePoses(const MovedBodies& moved, std::span<const uint32_t> bodies, float h, bool isLast,
                    const BodyState* pseudo, WorkerFindings& findings) {
    VisitBodies(
        bodies,
        [&](const Indices& index, int count) {
            return !pseudo && IntegratePosesInLanes(moved, index, count, h, isLast);
        },
        [&](uint32_t body) { IntegratePose(moved, body, h, isLast, pseudo, findings); });
}

}  // namespace fulcrum
