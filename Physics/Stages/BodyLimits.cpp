#include <Fulcrum/Physics/Stages/BodyLimits.h>

#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/BodyPairs.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/SpeedLimits.h>

#include <algorithm>

namespace fulcrum {

namespace {

// BodyState::marks: the sum of these.
enum Mark : int { kLimited = 1, kStopped = 2 };
bool IsMarked(const BodyStore& bodies, uint32_t body, Mark mark) {
    return (static_cast<int>(bodies.states[body].marks) & mark) != 0;
}
void SetMark(BodyStore& bodies, uint32_t body, Mark mark, bool isSet) {
    float& marks = bodies.states[body].marks;
    const int others = static_cast<int>(marks) & ~mark;
    marks = static_cast<float>(isSet ? others | mark : others);
}

// Zero times a number is zero if the number is finite, and NaN if it is not.
Wide<8> ZeroTimes(const float* eight) { return Wide<8>::Load(eight) * Wide<8>(0.0f); }

bool IsFiniteState(const BodyStore& bodies, uint32_t body) {
    const BodyState& state = bodies.states[body];
    Wide<8> odd = ZeroTimes(bodies.poses[body].Row()) + ZeroTimes(bodies.dynamics[body].LimitsRow());
    static_assert(int(BodyPose::kNoFloat) == int(BodyDynamics::kNoFloat));
    odd.Set(BodyPose::kNoFloat, 0.0f);
    odd += ZeroTimes(state.VelocityRow()) + ZeroTimes(state.PoseRow()) + ZeroTimes(bodies.masses[body].Row()) +
           ZeroTimes(bodies.dynamics[body].InertiaRow());
    const Position& rest = bodies.remainders[body].value;
    double place = 0;
    for (int k = 0; k < 3; ++k) place += bodies.poses[body].position[k] * 0.0 + rest[k] * 0.0;
    return (odd == Wide<8>(0.0f)).All() && place == 0;
}

// The pose is finite unless memory was overwritten; then the position is taken from the center of the bounds.
void RepairPose(BodyStore& bodies, const ColliderStore& colliders, uint32_t body) {
    Pose pose = bodies.CenterPoseOf(body);
    const bool isPlaced = IsFinite(pose.position), isTurned = IsFinite(pose.rotation);
    if (isPlaced && isTurned && IsFinite(bodies.remainders[body].value)) return;
    if (!isTurned) pose.rotation = {};
    if (!isPlaced) {
        pose.position = colliders.boundsOrigin;
        Bounds bounds;
        VisitColliders(bodies, colliders, body, [&](uint32_t i) { bounds.Include(colliders.colliders[i].fat); });
        if (!bounds.IsEmpty() && IsFinite(bounds.Center())) pose.position += bounds.Center().cast<double>();
    }
    bodies.SetCenterPose(body, pose);
}

// Limits finite forces whose acceleration is not finite. If forces are not finite, Store freezes the body.
void LimitForces(BodyStore& bodies, uint32_t body) {
    BodyCold& cold = bodies.cold[body];
    if (!IsFinite(cold.force) || !IsFinite(cold.torque)) return;
    cold.force = LimitedPush(cold.force, double{bodies.dynamics[body].inverseMass});
    cold.torque = LimitedPush(cold.torque, Trace(bodies.masses[body]));
}

// Sets velocities and forces to zero.
void BringToRest(BodyStore& bodies, uint32_t body) {
    bodies.states[body] = {};
    bodies.unconstrained[body] = {};
    bodies.cold[body].force.setZero();
    bodies.cold[body].torque.setZero();
    bodies.dynamics[body].hasForce = false;
    SetMark(bodies, body, kStopped, true);
}

void NoteStopped(uint32_t body, WorkerFindings& findings) {
    ++findings.frozen;
    findings.firstFrozen = std::min(findings.firstFrozen, body);
}

void ForgetImpulses(const BodyStore& bodies, const ColliderStore& colliders, PairStore& pairs, JointStore& joints,
                    uint32_t body) {
    VisitPairsOf(bodies, colliders, pairs, {&body, 1}, [&](uint32_t first) {
        for (uint32_t pair = first; pair != PairStore::kNone; pair = pairs.MoreOf(pair)) {
            Pair& its = pairs.pairs[pair];
            if (its.contact != PairStore::kNone) pairs.RecordOf(its).ForgetImpulses();
        }
    });
    joints.VisitOf(body, [&](uint32_t joint) { joints.Forget(joint); });
}

}  // namespace

bool ShortenSpeeds(BodyStore& bodies, uint32_t body, Vector3& v, Vector3& w) {
    const BodyDynamics& d = bodies.dynamics[body];
    constexpr float kRounding = 1 + 1e-6f;
    const auto exceeds = [](const Vector3& x, float limit) { return LengthSquared(x) > limit * limit * kRounding; };
    const bool counts = exceeds(v, d.maxLinearSpeed) || exceeds(w, d.maxAngularSpeed);
    LimitLength(v, d.maxLinearSpeed);
    LimitLength(w, d.maxAngularSpeed);
    const bool isFirst = counts && !IsMarked(bodies, body, kLimited);
    if (isFirst) SetMark(bodies, body, kLimited, true);
    return isFirst;
}

void AdmitBody(BodyStore& bodies, const ColliderStore& colliders, uint32_t body, WorkerFindings& findings) {
    if (!IsFiniteState(bodies, body)) return Freeze(bodies, colliders, body, findings);
    SetMark(bodies, body, kLimited, false);
    const BodyDynamics& d = bodies.dynamics[body];
    if (d.hasForce) LimitForces(bodies, body);
    Vector3 v = bodies.LinearVelocityOf(body), w = bodies.AngularVelocityOf(body);
    if (IsWithinSpeeds(d, v, w)) return;
    findings.clamped += ShortenSpeeds(bodies, body, v, w);
    bodies.SetVelocity(body, v, w);
}

void Freeze(BodyStore& bodies, const ColliderStore& colliders, uint32_t body, WorkerFindings& findings) {
    BodyDynamics& d = bodies.dynamics[body];
    if (!d.frozen) NoteStopped(body, findings);
    d.frozen = true;
    d.slowSeconds = 0;
    bodies.slowMotions[body] = {};
    BringToRest(bodies, body);
    RepairPose(bodies, colliders, body);
    std::fill(std::begin(bodies.poses[body].acceleration), std::end(bodies.poses[body].acceleration), 0.0f);
    bodies.UpdateInertia(body);
}

void Stop(BodyStore& bodies, uint32_t body, WorkerFindings& findings) {
    NoteStopped(body, findings);
    BringToRest(bodies, body);
}

void SettleStopped(std::span<const WorkerFindings> findings, const ColliderStore& colliders, BodyStore& bodies,
                   PairStore& pairs, JointStore& joints, ConstraintColoring& coloring) {
    if (std::none_of(findings.begin(), findings.end(), [](const WorkerFindings& f) { return f.frozen > 0; })) return;
    for (uint32_t body : bodies.awake) {
        if (!IsMarked(bodies, body, kStopped)) continue;
        SetMark(bodies, body, kStopped, false);
        ForgetImpulses(bodies, colliders, pairs, joints, body);
        RecolorJointsOf(bodies, joints, coloring, body);
    }
}

}  // namespace fulcrum
