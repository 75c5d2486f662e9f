#include <Fulcrum/Physics/Stages/ErrorMeter.h>

#include <Fulcrum/Physics/Stages/FindIslands.h>
#include <Fulcrum/Physics/World/UnionFind.h>

#include <algorithm>

namespace fulcrum {

namespace {

using Entry = ConstraintColoring::Entry;
using Kind = ConstraintColoring::Kind;
using Island = ErrorMeter::Island;

Position ToDouble(const Vector3& v) { return v.cast<double>(); }

bool IsMeasured(const BodyDynamics& d) {
    return d.motion == MotionType::Dynamic && !d.frozen && !d.dispersing && d.inverseMass > 0;
}

// N m s about the center of mass. In double: of extreme bodies it is beyond the floats.
Position SpinOf(const BodyDynamics& d, const Quaternion& rotation, const Vector3& w) {
    const Matrix3 axes = AxesOf(d, rotation);
    const Vector3 columns[3] = {axes.x, axes.y, axes.z};
    Position spin = Position::Zero();
    for (int k = 0; k < 3; ++k) {
        if (!(d.inverseInertia[k] > 0)) continue;
        const Position axis = ToDouble(columns[k]);
        spin += axis * (Dot<double>(axis, ToDouble(w)) / double{d.inverseInertia[k]});
    }
    return spin;
}

// Of this step. `rests`: it slept until now, and nothing is applied to it.
ErrorStart StartOf(const BodyStore& bodies, uint32_t body, uint64_t step, bool rests) {
    const BodyDynamics& d = bodies.dynamics[body];
    ErrorStart start{.step = step, .center = bodies.ExactCenterOf(body)};
    if (rests) return start;
    const Vector3 v = bodies.LinearVelocityOf(body), w = bodies.AngularVelocityOf(body);
    const double mass = 1.0 / double{d.inverseMass};
    start.momentum = ToDouble(v) * mass;
    start.own = SpinOf(d, bodies.RotationOf(body), w);
    start.kinetic = 0.5 * mass * ToDouble(v).squaredNorm() + RotationalEnergy(d, bodies.RotationOf(body), w);
    start.angularVelocity = ToDouble(w);
    if (d.hasForce) {
        start.force = ToDouble(bodies.cold[body].force);
        start.torque = ToDouble(bodies.cold[body].torque);
    }
    return start;
}

// The islands of the step, by their lowest body, and what each has to do with the rest of the world.
class IslandFinder {
public:
    IslandFinder(const BodyStore& bodies, ErrorMeter& meter) : bodies_(bodies), meter_(meter), sets_(meter.parents) {}

    void Unite(const JointStore& joints, const ConstraintColoring& coloring, const SweepStore& sweeps) {
        const auto unite = [&](uint32_t a, uint32_t b) {
            if (bodies_.CanMove(a) && bodies_.CanMove(b)) sets_.Unite(a, b);
        };
        const auto hold = [&](uint32_t a, uint32_t b) {
            Touch(a, b);
            Touch(b, a);
        };
        const auto visitAll = [&](auto&& visit) {
            for (const Kind kind : {Kind::Moving, Kind::Fixed, Kind::Joint})
                VisitEntries(coloring, kind, [&](uint32_t, const Entry& entry) { visit(entry.bodyA, entry.bodyB); });
            for (const ReportedHit& hit : sweeps.reported) visit(hit.body, hit.other);
        };
        visitAll(unite);
        visitAll(hold);
        VisitEntries(coloring, Kind::Joint, [&](uint32_t, const Entry& entry) {
            if (joints.types[entry.constraint]->ReactsOnWorld()) IslandOf(MovingBodyOf(entry)).isHeld = true;
        });
    }
    Island& IslandOf(uint32_t body) { return meter_.islands[sets_.Find(body)]; }

private:
    void Touch(uint32_t body, uint32_t other) {
        if (!bodies_.CanMove(body) || bodies_.CanMove(other)) return;
        Island& island = IslandOf(body);
        island.isHeld = true;
        island.isDriven |= bodies_.dynamics[other].motion == MotionType::Kinematic;
    }

    const BodyStore& bodies_;
    ErrorMeter& meter_;
    UnionFind sets_;
};

// Whether the body gives momentum to something else than what it touches.
bool IsHeld(const BodyDynamics& d) {
    return d.lockedAxes != LockedAxes::None || d.linearDamping > 0 || d.angularDamping > 0;
}

// Adds a body to the center of mass of its island; the sums about that come after.
void AddMass(const BodyStore& bodies, uint32_t body, const ErrorStart& start, Island& island) {
    const BodyDynamics& d = bodies.dynamics[body];
    const double mass = 1.0 / double{d.inverseMass};
    island.mass += mass;
    island.before += start.center * mass;
    island.after += bodies.ExactCenterOf(body) * mass;
    island.isHeld |= IsHeld(d);
}

void AddBody(const StepContext& step, const BodyStore& bodies, uint32_t body, const ErrorStart& start, Island& island,
             StepErrors& errors) {
    const ErrorStart end = StartOf(bodies, body, step.number, false);
    const BodyDynamics& d = bodies.dynamics[body];
    const double dt = double{step.dt}, mass = 1.0 / double{d.inverseMass};
    const Position weight = ToDouble(bodies.GravityOf(body, step.settings.gravity)) * (mass * double{d.gravityFactor});
    const Position push = start.force + weight, way = end.center - start.center;
    const double energy = end.kinetic - start.kinetic - Dot<double>(push, way) -
                          0.5 * dt * Dot<double>(start.torque, start.angularVelocity + end.angularVelocity);
    const Position momentum = end.momentum - start.momentum - push * dt;
    // About the island's center of mass, which may move.
    const Position before = start.center - island.before * (1 / island.mass),
                   after = end.center - island.after * (1 / island.mass);
    const Position angular = Cross<double>(after, end.momentum) + end.own - Cross<double>(before, start.momentum) -
                             start.own - Cross<double>((before + after) * 0.5, push) * dt - start.torque * dt;
    errors.energyChange += energy;
    island.sums.energy += energy;
    island.sums.momentum += momentum;
    island.sums.angularMomentum += angular;
    const auto raise = [&](double& most, uint32_t& mostBody, double to) {
        if (mostBody != ~0u && !(to > most)) return;
        most = to;
        mostBody = body;
    };
    raise(island.gain, island.mostGaining, energy);
    raise(island.momentumChange, island.momentumBody, momentum.norm());
    raise(island.angularMomentumChange, island.angularMomentumBody, angular.norm());
}

void ReportIsland(const BodyStore& bodies, const Island& island, StepErrors& errors) {
    const auto raise = [&](double& most, BodyId& body, double to, uint32_t culprit) {
        if (!(to > most)) return;
        most = to;
        body = bodies.IdOf(culprit);
    };
    if (!island.isDriven) raise(errors.energyGain, errors.mostGaining, island.sums.energy, island.mostGaining);
    if (island.isHeld) return;
    raise(errors.momentumError, errors.momentumBody, island.sums.momentum.norm(), island.momentumBody);
    raise(errors.angularMomentumError, errors.angularMomentumBody, island.sums.angularMomentum.norm(),
          island.angularMomentumBody);
}

}  // namespace

void BeginErrors(const StepContext& step, const BodyStore& bodies, ErrorMeter& meter) {
    meter.starts.assign(bodies.Size(), {});
    meter.pushes.assign(bodies.Size(), {});
    for (const uint32_t body : bodies.awake)
        if (IsMeasured(bodies.dynamics[body])) meter.starts[body] = StartOf(bodies, body, step.number, false);
}

void NoteMoved(const BodyStore& bodies, std::span<const uint32_t> moved, std::span<PushNote> pushes) {
    for (const uint32_t body : moved) {
        const BodyState& state = bodies.states[body];
        PushNote& note = pushes[body];
        note.linear = bodies.LinearVelocityOf(body);
        note.angular = bodies.AngularVelocityOf(body);
        for (int k = 0; k < 3; ++k) {
            note.displacement[k] = state.deltaPosition[k];
            note.turn[k] = state.deltaRotation[k];
        }
    }
}

// A push p is what the body moved with and does not keep. Of that, what lies between the velocity without constraints
// and the one that they leave is none: what lands moves on to the surface before it is stopped, and what slides is
// slowed down after it has moved. With d from the former to the latter, <a, b> = m a.b + a.I b, t in 0..1 that makes
// |p + t d| smallest is taken off.
void NotePushes(const BodyStore& bodies, std::span<const uint32_t> moved, float h, std::span<PushNote> pushes) {
    for (const uint32_t body : moved) {
        const BodyDynamics& d = bodies.dynamics[body];
        if (!IsMeasured(d)) continue;
        const BodyState& state = bodies.states[body];
        PushNote& note = pushes[body];
        const Vector3 v = bodies.LinearVelocityOf(body), w = bodies.AngularVelocityOf(body);
        const float* free = bodies.unconstrained[body].row;
        Vector3 linear = note.linear - v, angular = note.angular - w, changeLinear = v, changeAngular = w;
        for (int k = 0; k < 3; ++k) {
            linear[k] += (state.deltaPosition[k] - note.displacement[k]) / h;
            angular[k] += (state.deltaRotation[k] - note.turn[k]) / h;
            changeLinear[k] -= free[BodyState::kLinear + k];
            changeAngular[k] -= free[BodyState::kAngular + k];
        }
        const Quaternion rotation = bodies.RotationOf(body);
        const double mass = 1.0 / double{d.inverseMass};
        const Position push = ToDouble(linear), turn = ToDouble(angular), change = ToDouble(changeLinear),
                       changeTurn = ToDouble(changeAngular), spin = SpinOf(d, rotation, angular),
                       changeSpin = SpinOf(d, rotation, changeAngular);
        const double pushed = mass * Dot<double>(push, push) + Dot<double>(turn, spin),
                     along = mass * Dot<double>(push, change) + Dot<double>(turn, changeSpin),
                     squared = mass * Dot<double>(change, change) + Dot<double>(changeTurn, changeSpin);
        const double part = along < 0 ? std::min(-along / squared, 1.0) : 0.0;
        const double energy = 0.5 * (pushed + part * (2 * along + part * squared));
        note.energy = std::max(note.energy, energy);
    }
}

void EndErrors(const StepContext& step, const BodyStore& bodies, const JointStore& joints,
               const ConstraintColoring& coloring, const SweepStore& sweeps, ErrorMeter& meter, StepErrors& errors) {
    errors.areMeasured = true;
    meter.parents.resize(bodies.Size());
    meter.islands.assign(bodies.Size(), {});
    IslandFinder islands(bodies, meter);
    islands.Unite(joints, coloring, sweeps);
    // In the order of their indices, so that sums do not depend on who woke first.
    const auto visitAwake = [&](auto&& visit) {
        for (uint32_t body = 0; body < bodies.Size(); ++body)
            if (bodies.dynamics[body].awake && IsMeasured(bodies.dynamics[body])) visit(body);
    };
    visitAwake([&](uint32_t body) {
        ErrorStart& start = meter.starts[body];
        if (start.step != step.number) start = StartOf(bodies, body, step.number, true);
        AddMass(bodies, body, start, islands.IslandOf(body));
    });
    visitAwake([&](uint32_t body) { AddBody(step, bodies, body, meter.starts[body], islands.IslandOf(body), errors); });
    visitAwake([&](uint32_t body) {
        if (&islands.IslandOf(body) == &meter.islands[body]) ReportIsland(bodies, meter.islands[body], errors);
    });
    for (uint32_t body = 0; body < bodies.Size(); ++body) {
        const double energy = meter.pushes[body].energy;
        errors.pushEnergy += energy;
        if (!(energy > errors.largestPushEnergy)) continue;
        errors.largestPushEnergy = energy;
        errors.mostPushed = bodies.IdOf(body);
    }
}

}  // namespace fulcrum
