#include <Fulcrum/Physics/Stages/Impact.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>

#include <algorithm>

namespace fulcrum {

namespace {

constexpr int kIterations = 8;

struct Side {
    SymmetricMatrix3 inertia;  // inverse
    Vector3 mass = Vector3::Zero();  // inverse, along the world's axes: zero where a translation is locked
};

class ImpactSolver {
public:
    ImpactSolver(const WorldState& world, const SweepHit& hit, Impact& impact) : hit_(hit), v_(impact) {
        const uint32_t bodies[2] = {hit.body, hit.other};
        for (int s = 0; s < 2; ++s) {
            if (!world.bodies.CanMove(bodies[s])) continue;
            const BodyDynamics& d = world.bodies.dynamics[bodies[s]];
            side_[s] = {impact.masses[s].InverseInertia(), Vector3::Constant(d.inverseMass)};
            Vector3 none = Vector3::Zero();
            d.Lock(side_[s].mass, none);
        }
        for (int i = 0; i < hit.pointCount; ++i) {
            const float approach = Dot<float>(hit.normal, RelativeVelocity(i));
            away_[i] = approach > world.settings.restitutionSpeed ? hit.restitution * approach : 0.0f;
            approaches_ |= approach > 0;
            response_[i] = Response(i, hit.normal);
        }
    }

    bool Run() {
        if (!approaches_) return false;
        for (int k = 0; k < kIterations; ++k)
            for (int i = 0; i < hit_.pointCount; ++i) {
                Push(i);
                Rub(i);
            }
        return true;
    }

private:
    // Of the body against the other.
    Vector3 RelativeVelocity(int i) const {
        return v_.linear[0] + Cross<float>(v_.angular[0], hit_.arms[i]) - v_.linear[1] - Cross<float>(v_.angular[1], hit_.otherArms[i]);
    }
    // What an impulse of 1 N s along a unit vector changes of the relative velocity along it.
    float Response(int i, const Vector3& axis) const {
        const Vector3 a = Cross<float>(hit_.arms[i], axis), b = Cross<float>(hit_.otherArms[i], axis);
        const Vector3 mass = side_[0].mass + side_[1].mass;
        return Dot<float>(axis, Vector3(mass.cwiseProduct(axis))) + Dot<float>(a, Vector3(side_[0].inertia * a)) + Dot<float>(b, Vector3(side_[1].inertia * b));
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
        const float response = response_[i];
        if (!(response > 0)) return;
        const float old = pushed_[i];
        pushed_[i] = std::max(0.0f, old + (Dot<float>(hit_.normal, RelativeVelocity(i)) + away_[i]) / response);
        Apply(i, hit_.normal * (old - pushed_[i]));
    }
    void Rub(int i) {
        if (hit_.friction == 0) return;
        const Vector3 v = RelativeVelocity(i) - hit_.surfaceVelocity, slip = v - hit_.normal * Dot<float>(hit_.normal, v);
        const float speed = Length(slip);
        const float response = speed > 0 ? Response(i, Vector3(slip * (1 / speed))) : 0.0f;
        if (!(response > 0)) return;
        const Vector3 old = rubbed_[i];
        rubbed_[i] = old - slip * (1 / response);
        const float size = Length(rubbed_[i]), most = hit_.friction * pushed_[i];
        if (size > most) rubbed_[i] = rubbed_[i] * (most / size);
        Apply(i, rubbed_[i] - old);
    }

    const SweepHit& hit_;
    Impact& v_;
    Side side_[2];
    bool approaches_ = false;
    float away_[SweepHit::kMaxPoints] = {};      // m/s, speed to part with
    float response_[SweepHit::kMaxPoints] = {};  // 1/kg, along the normal
    float pushed_[SweepHit::kMaxPoints] = {};    // N s
    Vector3 rubbed_[SweepHit::kMaxPoints] = {Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), Vector3::Zero()};
};

// What gravity and forces add to a body's velocity, m/s, from a time of the step on; nothing where the solver has spread it over the step.
Vector3 GainFrom(const WorldState& world, uint32_t body, float time, float dt) {
    if (!world.bodies.CanMove(body) || world.colouring.IsTouched(body)) return Vector3::Zero();
    const float* a = world.bodies.poses[body].acceleration;
    return Vector3(a[0], a[1], a[2]) * ((1 - time) * dt);
}

}  // namespace

Impact FindImpact(const WorldState& world, const SweepHit& hit, float dt) {
    const BodyStore& bodies = world.bodies;
    const uint32_t pair[2] = {hit.body, hit.other};
    Impact impact;
    impact.lasts = world.sweeps.searchBy[hit.other] != SweepStore::SearchBy::None || !bodies.CanMove(hit.other);
    for (int s = 0; s < 2; ++s) {
        const BodyDynamics& d = bodies.dynamics[pair[s]];
        impact.courses[s] = SweepOf(world, pair[s]);
        impact.poses[s] = impact.courses[s].PoseAt(hit.time);
        impact.masses[s] = d.spherical ? bodies.masses[pair[s]] : bodies.MassAlong(pair[s], AxesOf(d, impact.poses[s].rotation));
        impact.gain[s] = GainFrom(world, pair[s], hit.time, dt);
        impact.linear[s] = bodies.LinearVelocityOf(pair[s]) - impact.gain[s];
        impact.angular[s] = bodies.AngularVelocityOf(pair[s]);
    }
    impact.parts = hit.pointCount > 0 && ImpactSolver(world, hit, impact).Run();
    return impact;
}

}  // namespace fulcrum
