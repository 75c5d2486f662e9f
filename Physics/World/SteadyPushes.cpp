#include <Fulcrum/Physics/World/SteadyPushes.h>

#include <algorithm>

namespace fulcrum {

namespace {

// What changes by less than this part of it is the same. Force and torque share a scale, by the body's size: a torque
// that is next to nothing beside the force may change by any part of itself.
constexpr float kSamePart = 0.01f;

bool IsSame(const BodyPush& a, const BodyPush& b, float radius) {
    const float force = Length(a.force) + Length(a.torque) / radius;
    return Length(Vector3(b.force - a.force)) <= kSamePart * force &&
           Length(Vector3(b.torque - a.torque)) <= kSamePart * force * radius;
}

}  // namespace

void BeginPushes(const SleepStores& stores) {
    BodyStore& bodies = stores.bodies;
    if (bodies.pushed.Size() == 0) return;
    bodies.pushed.Visit([&](uint32_t body) {
        BodyCold& cold = bodies.cold[body];
        const BodyDynamics& d = bodies.dynamics[body];
        const BodyPush now{cold.force, cold.torque};
        constexpr float kLeastRadius = 1e-6f;  // m, of what has no geometry
        const bool isSame = !now.IsZero() && IsSame(cold.lastPush, now, std::max(d.outerRadius, kLeastRadius));
        if (!d.awake && isSame && cold.isSteady) return;  // the push that it fell asleep under is kept as it was then
        // A push that came and went within a step is over: what follows from it shows in the body's speed.
        if (now.IsZero() ? cold.isSteady : !isSame) WakeBody(stores, body);
        cold.isSteady = isSame;
        cold.lastPush = now;
        if (now.IsZero()) bodies.pushed.Erase(body);
    });
}

void ForgetPush(BodyStore& bodies, uint32_t body) {
    bodies.ForgetForces(body);
    bodies.cold[body].lastPush = {};
    bodies.cold[body].isSteady = false;
    bodies.pushed.Erase(body);
}

void EndPushes(BodyStore& bodies) {
    if (bodies.pushed.Size() == 0) return;
    bodies.pushed.Visit([&](uint32_t body) {
        if (!bodies.dynamics[body].awake) bodies.ForgetForces(body);
    });
}

void BeginSingleMoves(BodyStore& bodies) {
    if (bodies.singleMoves.Size() == 0) return;
    bodies.singleMoves.Visit([&](uint32_t body) {
        SingleMove& move = bodies.cold[body].singleMove;
        if (move == SingleMove::Next) {
            move = SingleMove::Last;
            return;
        }
        move = SingleMove::None;
        bodies.singleMoves.Erase(body);
        bodies.SetVelocity(body, Vector3::Zero(), Vector3::Zero());
    });
}

}  // namespace fulcrum
