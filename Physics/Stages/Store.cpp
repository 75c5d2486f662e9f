// Ends the step for each body: what was solved moves by the sum of its substeps, what has no contact or joint flies
// freely and exactly. Impulses go back to the records.
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/Stages/ContactLoads.h>
#include <Fulcrum/Physics/Stages/Crowd.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/Stages/FreeRotation.h>
#include <Fulcrum/Physics/Stages/Integrate.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/Colors.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>

namespace fulcrum {

namespace {

// What a body does in the step.
struct Ending {
    uint32_t body = 0;
    Vector3 displacement = Vector3::Zero();  // m
    Vector3 v = Vector3::Zero();             // m/s, at its end
    FreeTurn turn;                           // what is found, where it turns freely, or has been found
    bool fliesFreely = false;                // it has no contact or joint
    float pulled = 0;                        // m/s, see PulledSpeed
};

// A body without contacts and joints: x += v t + a t^2 / 2, exact under constant acceleration. Returns whether it is
// still to be turned, keeping its angular momentum.
bool FlyFreely(WorldState& world, Ending& ending, const StepState& step, WorkerFindings& findings) {
    const BodyDynamics& d = *ending.turn.body;
    const float* a = world.bodies.poses[ending.body].acceleration;
    Vector3 &v = ending.v, &w = ending.turn.angularVelocity;
    const Vector3 before = v;
    ending.fliesFreely = true;
    v += Vector3(a[0], a[1], a[2]) * step.dt;
    if (d.linearDamping > 0) v *= Exp(-d.linearDamping * step.dt);
    if (d.lockedAxes != LockedAxes::None) d.Lock(v, w);
    findings.clamped += LimitSpeeds(world, ending.body, v, w);
    Vector3& change = ending.displacement;
    change = (before + v) * (0.5f * step.dt);
    if (d.lockedAxes != LockedAxes::None) d.Lock(change, w);
    const bool feelsTop = d.FeelsGyroscopicTorque(w);
    if (d.hasForce) {
        const Vector3 torque = world.bodies.cold[ending.body].torque;
        Vector3 pushed = w + world.bodies.masses[ending.body].InverseInertia() * torque * step.dt;
        const bool isLimited = LengthSquared(pushed) > d.maxAngularSpeed * d.maxAngularSpeed;
        // What a torque spins up to the largest speed is there at once.
        if (isLimited) findings.clamped += LimitSpeeds(world, ending.body, v, pushed);
        if (isLimited || !feelsTop) w = pushed;
        else ending.turn.torque = torque;
    }
    if (feelsTop) return true;
    ending.turn.rotation = Normalized(RotationFromVector(Vector3(w * step.dt)) * ending.turn.rotation);
    return false;
}

// The solver changed the angular velocity of a body as it stood at the step's beginning. Impulses within the step let
// it turn otherwise than about the velocity of the end; the spin of a thin rod about its own axis, left behind in world
// axes while that turned, is then a turn of the rod itself, with a thousand times the energy. What would gain a
// twentieth is carried along with the body, as far as it takes to gain none; not what rocks as it comes to rest, which
// its support damps.
Vector3 CarriedAlong(const BodyDynamics& d, const Quaternion& before, const Quaternion& after, const Vector3& w) {
    constexpr float kGain = 1.0001f;
    const auto energyOf = [&](const Quaternion& rotation, const Vector3& velocity) {
        return TwiceRotationalEnergy<float>(d, InverseRotate(rotation * d.PrincipalAxes(), velocity));
    };
    const float wanted = energyOf(before, w), gain = energyOf(after, w) - wanted;
    if (!(gain > (kGain - 1) * wanted)) return w;
    // The energy of w + s (carried - w) is a parabola in s that is `wanted` at 1, and at gain / (its curvature).
    const Vector3 change = Rotate(after, InverseRotate(before, w)) - w;
    const float curvature = energyOf(after, change);
    return w + change * (gain < curvature ? gain / curvature : 1.0f);
}

void MoveSolved(WorldState& world, Ending& ending, float dt) {
    const uint32_t body = ending.body;
    BodyState& s = world.bodies.states[body];
    const BodyDynamics& d = world.bodies.dynamics[body];
    Quaternion& rotation = ending.turn.rotation;
    Vector3& w = ending.turn.angularVelocity;
    ending.displacement = Vector3(s.deltaPosition[0], s.deltaPosition[1], s.deltaPosition[2]);
    if (d.crowded) {
        const auto& free = world.bodies.unconstrained[body].row;
        ending.v = NoFasterThan(ending.v, VectorAt<BodyState::kLinear>(free));
        w = NoFasterThan(w, VectorAt<BodyState::kAngular>(free));
    }
    // Impacts move bodies along the way that their speeds before and after them make, whatever limits and locks these
    // are held to (BounceContacts.h).
    Vector3 turn(s.deltaRotation[0], s.deltaRotation[1], s.deltaRotation[2]);
    LimitLength(ending.displacement, d.maxLinearSpeed * dt);
    LimitLength(turn, d.maxAngularSpeed * dt);
    if (d.lockedAxes != LockedAxes::None) d.Lock(ending.displacement, turn);
    const Quaternion before = rotation;
    rotation = Normalized(RotationFromVector(turn) * rotation);
    // With joints every substep has seen to that.
    if (!d.FeelsGyroscopicTorque(w) || world.joints.HasAny(body)) return;
    w = CarriedAlong(d, before, rotation, w);
    w = AddGyroscopicTorque<float>(Vector3(d.inverseInertia[0], d.inverseInertia[1], d.inverseInertia[2]),
                                   AxesOf(d, rotation), w, dt);
}

void ForgetForces(WorldState& world, uint32_t body) {
    world.bodies.cold[body].force.setZero();
    world.bodies.cold[body].torque.setZero();
    world.bodies.dynamics[body].hasForce = false;
}

// m/s: what is slower may fall asleep. Of small bodies so many of their radii a second.
float SlowSpeed(const WorldState& world, uint32_t body) {
    constexpr float kRadiiPerSecond = 1;
    return std::min(world.settings.sleep.linearSpeed, kRadiiPerSecond * world.bodies.dynamics[body].outerRadius);
}

// m/s, of the farthest point of a body that moves by v and turns by w, at most. By its outer ball, or, where that is
// too fast to sleep, by the corners of its box: a thin rod that turns about its own length hardly moves.
float FarthestSpeed(const WorldState& world, uint32_t body, const Vector3& v, const Vector3& w) {
    const float linear = Length(v), simple = linear + Length(w) * world.bodies.dynamics[body].outerRadius;
    const float slow = SlowSpeed(world, body);
    if (simple < slow || linear >= slow) return simple;
    const Bounds& box = world.bodies.cold[body].shape->LocalBounds();
    const Vector3 reach = box.lower.cwiseAbs().cwiseMax(box.upper.cwiseAbs());
    const Vector3 turn = InverseRotate(world.bodies.RotationOf(body), w).cwiseAbs();
    const Vector3 most(turn.y() * reach.z() + turn.z() * reach.y(), turn.z() * reach.x() + turn.x() * reach.z(),
                       turn.x() * reach.y() + turn.y() * reach.x());
    return std::min(simple, linear + Length(most));
}

// What joints pull together moves without a speed at the step's end: pseudo-velocities are none, and relaxing has taken
// pushes out.
float PulledSpeed(const WorldState& world, uint32_t body, float dt) {
    const BodyState& s = world.bodies.states[body];
    if (!world.settings.sleep.enabled || !world.joints.HasAny(body)) return 0;
    const float inverseDt = 1.0f / dt;
    return FarthestSpeed(world, body, Vector3(s.deltaPosition[0], s.deltaPosition[1], s.deltaPosition[2]) * inverseDt,
                         Vector3(s.deltaRotation[0], s.deltaRotation[1], s.deltaRotation[2]) * inverseDt);
}

void MeasureSlowness(WorldState& world, uint32_t body, float speed, float dt, WorkerFindings& findings) {
    BodyDynamics& d = world.bodies.dynamics[body];
    const SleepSettings& sleep = world.settings.sleep;
    const bool slow = d.allowSleep && !d.crowded && speed < SlowSpeed(world, body);
    d.slowSeconds = slow ? d.slowSeconds + dt : 0.0f;
    findings.sleepCandidates += slow && d.slowSeconds >= sleep.seconds;
}

// Whether force and torque of this step changed the velocity by finite amounts.
bool PushIsFinite(const WorldState& world, uint32_t body) {
    if (!world.bodies.dynamics[body].hasForce) return true;
    const float* a = world.bodies.poses[body].acceleration;
    const SymmetricMatrix3 inverse = world.bodies.masses[body].InverseInertia();
    return IsFinite(Vector3(a[0], a[1], a[2])) && IsFinite(Vector3(inverse * world.bodies.cold[body].torque));
}

// Whether continuous collision or sensors need to know how bodies move within the step.
bool KeepsStarts(const WorldState& world) { return world.bodies.continuousCount > 0 || !world.sensors.IsEmpty(); }

// Finds how a body ends the step. False: it has nothing to end. `together`: it is still to be turned, one of several.
bool BeginEnding(WorldState& world, uint32_t body, const StepState& step, SweepStore& sweeps, WorkerFindings& findings,
                 Ending& ending, bool& together) {
    BodyStore& bodies = world.bodies;
    const BodyDynamics& d = bodies.dynamics[body];
    together = false;
    if (d.frozen) {
        bodies.states[body] = {};  // whatever rows have made of it
        return false;
    }
    ending = {.body = body,
              .v = bodies.LinearVelocityOf(body),
              .turn = {&d, bodies.RotationOf(body), bodies.AngularVelocityOf(body)}};
    if (KeepsStarts(world)) sweeps.starts[body] = {bodies.CenterPoseOf(body), world.step};
    if (d.motion == MotionType::Kinematic) {
        ending.displacement = ending.v * step.dt;
        ending.turn.rotation =
            Normalized(RotationFromVector(Vector3(ending.turn.angularVelocity * step.dt)) * ending.turn.rotation);
    } else if (world.coloring.IsTouched(body)) {
        MoveSolved(world, ending, step.dt);
    } else if (FlyFreely(world, ending, step, findings)) {
        together = IsSymmetric(d);
        if (!together) RotateFreely(ending.turn, step.dt);
    }
    ending.pulled = PulledSpeed(world, body, step.dt);
    return true;
}

void FinishEnding(WorldState& world, Ending& ending, const StepState& step, WorkerFindings& findings) {
    BodyStore& bodies = world.bodies;
    const uint32_t body = ending.body;
    const BodyDynamics& d = bodies.dynamics[body];
    Vector3 &v = ending.v, &w = ending.turn.angularVelocity;
    if (ending.fliesFreely && d.angularDamping > 0) w *= Exp(-d.angularDamping * step.dt);
    if (!PushIsFinite(world, body)) return Freeze(world, body, findings);
    if (!IsFinite(ending.displacement) || !IsFinite(ending.turn.rotation) || !IsFinite(v) || !IsFinite(w))
        return Stop(world, body, findings);
    BodyState& state = bodies.states[body];
    state = {.marks = state.marks};
    if (d.dispersing) v = OwnVelocity(world, step.crowd.dispersing, body, v, step.dt);
    findings.clamped += LimitSpeeds(world, body, v, w);
    bodies.SetVelocity(body, v, w);
    bodies.MoveCenter(body, ending.displacement, ending.turn.rotation);
    if (d.hasForce) ForgetForces(world, body);
    if (world.settings.sleep.enabled && d.motion == MotionType::Dynamic)
        MeasureSlowness(world, body, std::max(FarthestSpeed(world, body, v, w), ending.pulled), step.dt, findings);
}

void EndBodies(WorldState& world, JobRange range, const StepState& step, SweepStore& sweeps, WorkerFindings& findings) {
    Ending endings[kTurnsTogether];
    FreeTurn* const turns[kTurnsTogether] = {&endings[0].turn, &endings[1].turn, &endings[2].turn, &endings[3].turn};
    int waiting = 0;
    const auto turnTogether = [&] {
        RotateTogether(turns, waiting, step.dt);
        for (int i = 0; i < waiting; ++i) FinishEnding(world, endings[i], step, findings);
        waiting = 0;
    };
    for (uint32_t i = range.begin; i < range.end; ++i) {
        Ending& ending = endings[waiting];
        bool together;
        if (!BeginEnding(world, world.bodies.awake[i], step, sweeps, findings, ending, together)) continue;
        if (!together) FinishEnding(world, ending, step, findings);
        else if (++waiting == kTurnsTogether) turnTogether();
    }
    if (waiting > 0) turnTogether();
}

// How the batches of a group are stored.
struct StoreScale {
    float dt;               // s, of the step
    float impulseScale;     // see Effort
    const SinkScale* sink;  // of contacts; null where nobody asks how deep they sink
};

template <int N, bool kFixedB>
void StoreBatch(WorldState& world, const ContactBatch<N, kFixedB>& batch, const StoreScale& scale,
                WorkerFindings& findings) {
    StoreContacts(batch, world.pairs.records.data(), scale.impulseScale);
    if (scale.sink) findings.loadsChanged |= NoteSinks(world, batch, *scale.sink);
}
template <int N>
void StoreBatch(WorldState& world, const JointBatch<N>& batch, const StoreScale& scale, WorkerFindings&) {
    StoreJoints(batch, world.joints.records.data(), world.joints.types.data(), world.bodies.states.data(), scale.dt,
                scale.impulseScale);
}
template <int N>
void StoreBatch(WorldState& world, const BallBatch<N>& batch, const StoreScale& scale, WorkerFindings&) {
    StoreJoints(batch, world.joints.records.data(), scale.dt, scale.impulseScale);
}

template <class Batch>
void StoreAll(WorldState& world, const std::vector<Batch>& batches, uint32_t begin, uint32_t end,
              const StoreScale& scale, std::span<WorkerFindings> workers) {
    world.jobs->ParallelFor(end - begin, 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            StoreBatch(world, batches[begin + i], scale, workers[range.worker]);
    });
}

// How often loads that became less are noted, in steps.
constexpr uint64_t kStepsToForget = 16;

// Groups lie one after the other: those without an effort of their own are stored together.
void StoreImpulses(WorldState& world, const StepState& step, std::span<WorkerFindings> workers) {
    const SolverLayout& layout = step.solver;
    const SystemSettings& settings = world.settings;
    const bool notesSinks = HeedsLoads(settings);
    const bool notesLarge = notesSinks && (settings.accuracy.largeIslands || layout.OverflowCount() > 0);
    const float softness = SoftnessOf(settings, step.substepDt);
    // impulseScale: see Effort; stiffness: see ContactLoad.
    const auto sinkScaleOf = [&](float impulseScale, uint8_t stiffness) {
        return SinkScale{.perLevel = 1 / LargestUnnotedSink(settings.accuracy),
                         .inverseDt = 1 / (step.substepDt * impulseScale),
                         .softness = softness,
                         .depthScale = 1 / (impulseScale * impulseScale),
                         .gravity = settings.gravity,
                         .stiffness = std::max<uint8_t>(stiffness, 1),
                         .forgets = world.step % kStepsToForget == 0};
    };
    uint32_t stored[kBatchKinds] = {};
    const auto storeTo = [&](auto&& endOf, const StoreScale& scale) {
        ForEachBatchList(layout, [&](const auto& list, BatchKind kind) {
            const uint32_t end = endOf(list, kind);
            StoreAll(world, list.batches, stored[kind], end, scale, workers);
            stored[kind] = end;
        });
    };
    const SinkScale usualSink = sinkScaleOf(1, 1);
    const StoreScale usual{step.dt, 1, notesSinks ? &usualSink : nullptr};
    for (const SolverGroup& group : layout.groups) {
        const bool isFirst = &group == &layout.groups.front();
        if (!group.isLarge && group.effort == SolverSettings{0, 0, 0}) continue;
        const float impulseScale = EffortOf(world, step, group).impulseScale;
        const SinkScale sink = sinkScaleOf(impulseScale, group.stiffness);
        const StoreScale scale{step.dt, impulseScale, (group.isLarge ? notesLarge : notesSinks) ? &sink : nullptr};
        if (isFirst)
            ForEachOverflowList(layout, [&](const auto& batches) {
                StoreAll(world, batches, 0, static_cast<uint32_t>(batches.size()), scale, workers);
            });
        if (group.colorsBegin == group.colorsEnd) continue;
        const ColorBatches &first = layout.colors[group.colorsBegin], &last = layout.colors[group.colorsEnd - 1];
        storeTo([&](const auto&, BatchKind kind) { return first.of[kind].begin; }, usual);
        storeTo([&](const auto&, BatchKind kind) { return last.of[kind].end; }, scale);
    }
    storeTo([](const auto& list, BatchKind) { return list.count; }, usual);
    for (WorkerFindings& findings : workers) {
        world.pairs.loadVersion += findings.loadsChanged;
        findings.loadsChanged = false;
    }
}

// Serial, in the order of the joints.
void BreakJoints(WorldState& world, std::vector<JointId>& broken) {
    world.joints.breakable.Visit([&](uint32_t index) {
        Joint& joint = world.joints.joints[index];
        if (joint.color.color == 0xFF) return;
        const JointRecord& record = world.joints.records[index];
        const auto length = [](const float(&v)[3]) { return Length(Vector3(v[0], v[1], v[2])); };
        if (length(record.totalForce) <= joint.breakForce && length(record.totalTorque) <= joint.breakTorque) return;
        joint.enabled = false;
        world.joints.Forget(index);
        UncolorJoint(world, index);
        for (uint32_t body : joint.body) RequeueColliders(world, body);
        broken.push_back(world.joints.IdOf(index));
    });
}

}  // namespace

uint32_t Store(WorldState& world, const StepState& step, SweepStore& sweeps, std::vector<JointId>& broken,
               std::span<WorkerFindings> workers, StepReport& report) {
    StoreImpulses(world, step, workers);
    if (KeepsStarts(world)) {
        sweeps.dt = step.dt;
        sweeps.starts.resize(world.bodies.Size());
    }
    world.jobs->ParallelFor(static_cast<uint32_t>(world.bodies.awake.size()), 64,
                            [&](JobRange range) { EndBodies(world, range, step, sweeps, workers[range.worker]); });
    BreakJoints(world, broken);

    SettleStopped(world, workers);
    uint32_t sleepCandidates = 0, firstFrozen = ~0u;
    for (const WorkerFindings& findings : workers) {
        sleepCandidates += findings.sleepCandidates;
        report.clampedBodies += findings.clamped;
        report.frozenBodies += findings.frozen;
        firstFrozen = std::min(firstFrozen, findings.firstFrozen);
    }
    if (firstFrozen != ~0u) report.firstFrozen = world.bodies.IdOf(firstFrozen);
    return sleepCandidates;
}

}  // namespace fulcrum
