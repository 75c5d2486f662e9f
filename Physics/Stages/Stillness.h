// Which bodies are slow, and whether one that is slow stays so: what still accelerates, or moves on uniformly, does not
// sleep (Docs/Architecture.md). Used by Store and Sleep; free functions, any thread.
#pragma once

#include <Fulcrum/Physics/World/BodyStore.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

// m/s: slower bodies may fall asleep. For small bodies given in radii per second.
inline float SlowSpeed(const SleepSettings& sleep, const BodyDynamics& body) {
    constexpr float kRadiiPerSecond = 1;
    return std::min(sleep.linearSpeed, kRadiiPerSecond * body.outerRadius);
}

// m/s: upper bound of the speed of any point of a body with velocities v and w. By its bounding sphere, or, if that
// gives `slow` or more, by the corners of its box: a thin rod rotating about its own length hardly moves.
inline float FarthestSpeed(const BodyStore& bodies, uint32_t body, float slow, const Vector3& v, const Vector3& w) {
    const float linear = Length(v), simple = linear + Length(w) * bodies.dynamics[body].outerRadius;
    if (simple < slow || linear >= slow) return simple;
    const Bounds& box = bodies.cold[body].shape->LocalBounds();
    const Vector3 reach = box.lower.cwiseAbs().cwiseMax(box.upper.cwiseAbs());
    const Vector3 turn = InverseRotate(bodies.RotationOf(body), w).cwiseAbs();
    const Vector3 most(turn.y() * reach.z() + turn.z() * reach.y(), turn.z() * reach.x() + turn.x() * reach.z(),
                       turn.x() * reach.y() + turn.y() * reach.x());
    return std::min(simple, linear + Length(most));
}

// The means are exponential, over a sixteenth and a quarter of the time of falling asleep: of the speed that a body had
// when it became slow, e^-4 is left when it may sleep, 0.9 mm/s of 5 cm/s.
inline constexpr float kLately = 1.0f / 16, kBefore = 1.0f / 4;
inline float MeanSeconds(const SleepSettings& sleep, float dt) { return std::max(sleep.seconds, dt); }

// Of a step of dt seconds.
inline SlowMotion::Mean MeanVelocity(const Vector3& displacement, const Quaternion& from, const Quaternion& to,
                                     float dt) {
    const Quaternion turn = to * from.Conjugate();
    return {displacement * (1 / dt), Vector3(turn.x, turn.y, turn.z) * ((turn.w < 0 ? -2.0f : 2.0f) / dt)};
}

// Follows the velocity of a step. At constant acceleration a mean over t seconds lags behind by that times t. Over a
// step of a fraction f of t it keeps (1 - f / 2) / (1 + f / 2), e^-f to third order.
inline void Follow(SlowMotion& motion, const SlowMotion::Mean& now, bool wasSlow, const SleepSettings& sleep,
                   float dt) {
    if (!wasSlow) {
        motion = {now, now};
        return;
    }
    const auto follow = [&](SlowMotion::Mean& mean, float part) {
        const float gain = std::min(dt / (part * MeanSeconds(sleep, dt) + 0.5f * dt), 1.0f);
        mean.linear += (now.linear - mean.linear) * gain;
        mean.angular += (now.angular - mean.angular) * gain;
    };
    follow(motion.lately, kLately);
    follow(motion.before, kBefore);
}

struct Unrest {
    float speed = 0;         // m/s, of the farthest point
    float acceleration = 0;  // m/s2, of the center; of the rotation: as below
};

// m/s: what spins as fast has the energy of the mass at this speed. An impulse that is wrong by p changes the velocity
// of the center by p / m, and this at an arm r by as much times r sqrt(m / I): by 1.6 at the surface of a ball, 1.7 at
// the end of a rod, 2.1 at the corner of a cube.
inline float SpeedOfSpin(const BodyStore& bodies, uint32_t body, const Vector3& w) {
    const BodyDynamics& d = bodies.dynamics[body];
    const double energy = RotationalEnergy(d, bodies.RotationOf(body), w);
    return static_cast<float>(std::sqrt(2 * energy * static_cast<double>(d.inverseMass)));
}

inline bool IsRestless(const BodyStore& bodies, uint32_t body, const Unrest& most, const SleepSettings& sleep,
                       float dt) {
    constexpr float kOfSpin = 2;
    const auto& [lately, before] = bodies.slowMotions[body];
    const float change = most.acceleration * (kBefore - kLately) * MeanSeconds(sleep, dt);
    return FarthestSpeed(bodies, body, most.speed, lately.linear, lately.angular) > most.speed ||
           Length(Vector3(lately.linear - before.linear)) > change ||
           SpeedOfSpin(bodies, body, lately.angular - before.angular) > kOfSpin * change;
}

// What a body at rest alone on the ground may show. A fifth of the slow speed, 1 cm/s, is the drift that sleep ends.
// The solver leaves a thousandth of the weight unbalanced; where there is none, the slow speed changes by as much in
// the time of falling asleep.
inline Unrest LeastUnrest(const BodyStore& bodies, uint32_t body, const SystemSettings& settings, float dt) {
    constexpr float kDrift = 0.2f, kUnbalanced = 1e-3f;
    const BodyDynamics& d = bodies.dynamics[body];
    const float slow = SlowSpeed(settings.sleep, d);
    float weight = Length(settings.gravity);
    if (d.special) weight = std::max(weight, Length(bodies.GravityOf(body, settings.gravity)));
    return {kDrift * slow, kUnbalanced * std::max(weight, slow / MeanSeconds(settings.sleep, dt))};
}

}  // namespace fulcrum
