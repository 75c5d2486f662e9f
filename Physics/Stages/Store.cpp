// Ends the step for each body: what was solved moves by the sum of its substeps, what nothing touched flies freely and
// exactly. Impulses go back to the records.
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Physics/Stages/Effort.h>
#include <Fulcrum/Physics/Stages/Integrate.h>

#include <algorithm>

namespace fulcrum {

namespace {

// The axis of rotation wanders the faster the more the principal moments differ: so many substeps that it turns by little
// in each, for a body that turns by `angle` in the step.
int RotationSubsteps(const BodyDynamics& d, float angle) {
    constexpr float kSmall = 0.1f;  // rad: errors of some 1e-8 a substep, as of the float that keeps the rotation
    const auto [low, high] = std::minmax({d.inverseInertia[0], d.inverseInertia[1], d.inverseInertia[2]});
    const float wandering = angle * (1.0f - low / high);
    return static_cast<int>(std::clamp(wandering / kSmall, 0.0f, 63.0f)) + 1;
}

// The axis about which the two other principal moments are equal; 3: there is none.
int SymmetryAxis(const BodyDynamics& d) {
    constexpr float kEqual = 1e-5f;
    for (int k = 0; k < 3; ++k) {
        const float a = d.inverseInertia[(k + 1) % 3], b = d.inverseInertia[(k + 2) % 3];
        if (std::fabs(a - b) <= kEqual * std::min(a, b)) return k;
    }
    return 3;
}

// A body that turns freely about its centre of mass, its angular momentum L (kg m2/s, world axes) given. In double: the axis in the
// middle doubles what it misses every 2 radians or so, and the roundings of many substeps in float were a fiftieth of a turn after
// ten of them.
struct FreeTop {
    using Vector = Vec3<double>;
    using Rotation = Quat<double>;
    Vector inverse;     // of the principal moments
    Vector momentum;
    Rotation rotation;  // of the principal axes

    static Rotation Unit(const Rotation& q) {
        const double scale = 1.0 / std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
        return {q.x * scale, q.y * scale, q.z * scale, q.w * scale};
    }
    static Rotation Turned(const Vector& by, const Rotation& at) { return RotationFromVector<double>(by) * at; }
    Vector VelocityAt(const Rotation& at) const {
        const Mat3<double> axes = ToMatrix<double>(at);
        return axes * Vector(axes.TransposeMultiply(momentum).cwiseProduct(inverse));
    }

    // Exact for a body of which the two moments beside `axis` are equal: it turns at constant rates about L and about its own axis,
    // since L / I and, in the body, the part of L along the axis do not change.
    void AdvanceSymmetric(int axis, double h) {
        const double across = inverse[(axis + 1) % 3];
        Vector spin = Vector::Zero();
        spin[axis] = InverseRotate<double>(rotation, momentum)[axis] * (inverse[axis] - across) * h;
        rotation = Unit(Turned(momentum * (across * h), rotation) * RotationFromVector<double>(spin));
    }
    // Of the fourth order, on the rotations, by two exponentials (E. Celledoni, A. Marthinsen, B. Owren, Commutator-free Lie group
    // methods, Future Generation Computer Systems 19, 2003): dq/dt = (I(q)^-1 L) q / 2.
    void Advance(double h) {
        const Vector w1 = VelocityAt(rotation);
        const Rotation half = Turned(w1 * (0.5 * h), rotation);
        const Vector w2 = VelocityAt(half);
        const Vector w3 = VelocityAt(Turned(w2 * (0.5 * h), rotation));
        const Vector w4 = VelocityAt(Turned((w3 - w1 * 0.5) * h, half));
        const Vector middle = (w2 + w3) * 2.0;
        const double part = h / 12.0;
        rotation = Unit(Turned((w4 * 3.0 + middle - w1) * part, Turned((w1 * 3.0 + middle - w4) * part, rotation)));
    }
};

// Keeps the angular momentum, but for a torque that acts all along.
void RotateFreely(const BodyDynamics& d, Quaternion& rotation, Vector3& w, const Vector3& torque, float dt) {
    using Vector = FreeTop::Vector;
    const auto exact = [&](const Quaternion& q) { return FreeTop::Unit({q.x, q.y, q.z, q.w}); };
    const FreeTop::Rotation principal = exact(d.PrincipalAxes());
    // The principal axes turn; the frame of the body follows at the end.
    FreeTop top{Vector(d.inverseInertia[0], d.inverseInertia[1], d.inverseInertia[2]), Vector::Zero(), exact(rotation) * principal};
    Vector momentum = InverseRotate<double>(top.rotation, w.cast<double>());
    for (int k = 0; k < 3; ++k) momentum[k] = top.inverse[k] > 0 ? momentum[k] / top.inverse[k] : 0.0;
    top.momentum = Rotate<double>(top.rotation, momentum);
    const int symmetry = SymmetryAxis(d);
    const int substeps = symmetry < 3 ? 1 : RotationSubsteps(d, Length(w) * dt);
    const double h = static_cast<double>(dt) / substeps;
    const Vector kick = torque.cast<double>() * (0.5 * h);
    for (int i = 0; i < substeps; ++i) {
        top.momentum += kick;
        if (symmetry < 3) top.AdvanceSymmetric(symmetry, h);
        else top.Advance(h);
        top.momentum += kick;
    }
    w = top.VelocityAt(top.rotation).cast<float>();
    const FreeTop::Rotation q = top.rotation * principal.Conjugate();
    rotation = Normalized(Quaternion{static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)});
}

// What a body does in the step.
struct Motion {
    Vector3 displacement;  // m
    Quaternion rotation;   // at its end
};

// A body that no contact touched: x += v t + a t^2 / 2, exact under constant acceleration.
void FlyFreely(WorldState& world, uint32_t body, const StepContext& step, Motion& motion, Vector3& v, Vector3& w,
               WorkerFindings& findings) {
    const BodyDynamics& d = world.bodies.dynamics[body];
    const float* a = world.bodies.poses[body].acceleration;
    const Vector3 before = v;
    v += Vector3(a[0], a[1], a[2]) * step.dt;
    if (d.linearDamping > 0) v *= Exp(-d.linearDamping * step.dt);
    Vector3& change = motion.displacement;
    change = (before + v) * (0.5f * step.dt);
    if (d.lockedAxes != LockedAxes::None) {
        d.Lock(v, w);
        d.Lock(change, w);
    }
    const Vector3 torque = d.hasForce ? world.bodies.cold[body].torque : Vector3(Vector3::Zero());
    const bool fastLinear = ClampLength(v, d.maxLinearSpeed), fastAngular = ClampLength(w, d.maxAngularSpeed);
    findings.clamped += fastLinear || fastAngular;
    if (d.FeelsGyroscopicTorque(w)) {
        RotateFreely(d, motion.rotation, w, torque, step.dt);
    } else {
        if (d.hasForce) w += world.bodies.masses[body].InverseInertia() * torque * step.dt;
        motion.rotation = Normalized(RotationFromVector(Vector3(w * step.dt)) * motion.rotation);
    }
    if (d.angularDamping > 0) w *= Exp(-d.angularDamping * step.dt);
}

void MoveSolved(WorldState& world, uint32_t body, Motion& motion, Vector3& w, float dt) {
    BodyState& s = world.bodies.states[body];
    const BodyDynamics& d = world.bodies.dynamics[body];
    motion.displacement = Vector3(s.deltaPosition[0], s.deltaPosition[1], s.deltaPosition[2]);
    motion.rotation = Normalized(RotationFromVector(Vector3(s.deltaRotation[0], s.deltaRotation[1], s.deltaRotation[2])) * motion.rotation);
    // With joints every substep has seen to that.
    if (d.FeelsGyroscopicTorque(w) && !world.joints.HasAny(body)) w = AddGyroscopicTorque<float>(Vector3(d.inverseInertia[0], d.inverseInertia[1], d.inverseInertia[2]), AxesOf(d, motion.rotation), w, dt);
}

void ForgetForces(WorldState& world, uint32_t body) {
    world.bodies.cold[body].force.setZero();
    world.bodies.cold[body].torque.setZero();
    world.bodies.dynamics[body].hasForce = false;
}

// Stops a body whose state is not finite, at its last good pose; it stays there like a static one.
void Freeze(WorldState& world, uint32_t body, WorkerFindings& findings) {
    world.bodies.SetVelocity(body, Vector3::Zero(), Vector3::Zero());
    world.bodies.dynamics[body].frozen = true;
    world.bodies.UpdateInertia(body);
    ForgetForces(world, body);
    ++findings.frozen;
    findings.firstFrozen = std::min(findings.firstFrozen, body);
}

// m/s, of the farthest point of a body that moves by v and turns by w, at most. By its outer ball, or, where that is too fast to
// sleep, by the corners of its box: a thin rod that turns about its own length hardly moves.
float FarthestSpeed(const WorldState& world, uint32_t body, const Vector3& v, const Vector3& w) {
    const float linear = Length(v), simple = linear + Length(w) * world.bodies.dynamics[body].outerRadius;
    const float slow = world.settings.sleep.linearSpeed;
    if (simple < slow || linear >= slow) return simple;
    const Bounds& box = world.bodies.cold[body].shape->LocalBounds();
    const Vector3 reach = box.lower.cwiseAbs().cwiseMax(box.upper.cwiseAbs());
    const Vector3 turn = InverseRotate(world.bodies.RotationOf(body), w).cwiseAbs();
    const Vector3 most(turn.y() * reach.z() + turn.z() * reach.y(), turn.z() * reach.x() + turn.x() * reach.z(),
                       turn.x() * reach.y() + turn.y() * reach.x());
    return std::min(simple, linear + Length(most));
}

// What joints pull together moves without a speed at the step's end: relaxing has taken it out.
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
    const bool slow = d.allowSleep && speed < sleep.linearSpeed;
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

// Whether somebody asks how bodies move within the step.
bool KeepsStarts(const WorldState& world) { return world.sweeps.users > 0 || !world.sensors.IsEmpty(); }

void EndBody(WorldState& world, uint32_t body, const StepContext& step, WorkerFindings& findings) {
    BodyStore& bodies = world.bodies;
    BodyDynamics& d = bodies.dynamics[body];
    Motion motion{Vector3::Zero(), bodies.RotationOf(body)};
    Vector3 v = bodies.LinearVelocityOf(body), w = bodies.AngularVelocityOf(body);
    if (d.frozen) return;
    if (KeepsStarts(world)) world.sweeps.starts[body] = {bodies.CentrePoseOf(body), world.report.step};
    if (d.motion == MotionType::Kinematic) {
        motion.displacement = v * step.dt;
        motion.rotation = Normalized(RotationFromVector(Vector3(w * step.dt)) * motion.rotation);
    } else if (world.colouring.IsTouched(body)) {
        MoveSolved(world, body, motion, w, step.dt);
    } else {
        FlyFreely(world, body, step, motion, v, w, findings);
    }
    const float pulled = PulledSpeed(world, body, step.dt);
    bodies.states[body] = {};
    if (!IsFinite(motion.displacement) || !IsFinite(motion.rotation) || !IsFinite(v) || !IsFinite(w) || !PushIsFinite(world, body)) {
        Freeze(world, body, findings);
        return;
    }
    bodies.SetVelocity(body, v, w);
    bodies.MoveCentre(body, motion.displacement, motion.rotation);
    if (d.hasForce) ForgetForces(world, body);
    if (world.settings.sleep.enabled && d.motion == MotionType::Dynamic)
        MeasureSlowness(world, body, std::max(FarthestSpeed(world, body, v, w), pulled), step.dt, findings);
}

template <int N, bool kFixedB>
void StoreBatch(WorldState& world, const ContactBatch<N, kFixedB>& batch, float, float impulseScale) {
    StoreContacts(batch, world.pairs.records.data(), impulseScale);
}
template <int N>
void StoreBatch(WorldState& world, const JointBatch<N>& batch, float dt, float impulseScale) {
    StoreJoints(batch, world.joints.records.data(), world.joints.types.data(), world.bodies.states.data(), dt, impulseScale);
}

template <class Batch>
void StoreAll(WorldState& world, const std::vector<Batch>& batches, uint32_t begin, uint32_t end, float dt, float impulseScale) {
    world.jobs->ParallelFor(end - begin, 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) StoreBatch(world, batches[begin + i], dt, impulseScale);
    });
}

// Groups lie one after the other: those without an effort of their own are stored together.
void StoreImpulses(WorldState& world, const StepContext& step) {
    const SolverLayout& layout = world.solver;
    uint32_t moving = 0, fixed = 0, joints = 0;
    const auto storeTo = [&](uint32_t movingEnd, uint32_t fixedEnd, uint32_t jointsEnd, float impulseScale) {
        StoreAll(world, layout.moving, moving, movingEnd, step.dt, impulseScale);
        StoreAll(world, layout.fixed, fixed, fixedEnd, step.dt, impulseScale);
        StoreAll(world, layout.joints, joints, jointsEnd, step.dt, impulseScale);
        moving = movingEnd;
        fixed = fixedEnd;
        joints = jointsEnd;
    };
    for (const SolverGroup& group : layout.groups) {
        if (group.effort == SolverSettings{0, 0, 0} || group.coloursBegin == group.coloursEnd) continue;
        const ColourBatches& first = layout.colours[group.coloursBegin];
        const ColourBatches& last = layout.colours[group.coloursEnd - 1];
        storeTo(first.moving.begin, first.fixed.begin, first.jointsBegin, 1.0f);
        storeTo(last.moving.end, last.fixed.end, last.jointsEnd, EffortOf(world, step, group).impulseScale);
    }
    storeTo(layout.movingCount, layout.fixedCount, layout.jointCount, 1.0f);
    const auto storeOverflow = [&](const auto& batches) {
        StoreAll(world, batches, 0, static_cast<uint32_t>(batches.size()), step.dt, 1.0f);
    };
    storeOverflow(layout.overflowMoving);
    storeOverflow(layout.overflowFixed);
    storeOverflow(layout.overflowJoints);
}

// Serial, in the order of the joints.
void BreakJoints(WorldState& world) {
    world.joints.breakable.Visit([&](uint32_t index) {
        Joint& joint = world.joints.joints[index];
        if (joint.colour.colour == 0xFF) return;
        const JointRecord& record = world.joints.records[index];
        const auto length = [](const float (&v)[3]) { return Length(Vector3(v[0], v[1], v[2])); };
        if (length(record.totalForce) <= joint.breakForce && length(record.totalTorque) <= joint.breakTorque) return;
        joint.enabled = false;
        world.joints.Forget(index);
        UncolourJoint(world, index);
        for (uint32_t body : joint.body) RequeueColliders(world, body);
        world.broken.push_back(world.joints.IdOf(index));
    });
}

}  // namespace

void Store(WorldState& world, const StepContext& step) {
    StoreImpulses(world, step);
    if (KeepsStarts(world)) world.sweeps.starts.resize(world.bodies.Size());
    world.jobs->ParallelFor(static_cast<uint32_t>(world.bodies.awake.size()), 64, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            EndBody(world, world.bodies.awake[i], step, world.findings[range.worker]);
    });
    BreakJoints(world);
    world.lastSubstepDt = step.substepDt;

    uint32_t firstFrozen = ~0u;
    for (const WorkerFindings& findings : world.findings) {
        world.report.clampedBodies += findings.clamped;
        world.report.frozenBodies += findings.frozen;
        firstFrozen = std::min(firstFrozen, findings.firstFrozen);
    }
    if (firstFrozen == ~0u) return;
    world.report.firstFrozen = world.bodies.IdOf(firstFrozen);
    for (uint32_t body : world.bodies.awake)
        if (world.bodies.dynamics[body].frozen) RecolourJointsOf(world, body);
}

}  // namespace fulcrum
