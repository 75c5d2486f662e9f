// The row kernels of contacts. SolveContacts.cpp instantiates them for ordinary contacts, SolveRareContacts.cpp for
// those with restitution or surface velocity. Two files, because compilers limit the amount of inlining per file.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactKernels.h>

namespace fulcrum::contacts {

// The friction rows. Sticking: the impulse that stops the slip, if it is inside the friction cone. Sliding: the impulse
// on the cone that opposes the slip, found by a projected gradient step with one mass for all directions, because
// bodies also rotate and the impulse that stops the slip is not parallel to it. Then torsional friction. limit: N s,
// friction times the sum of the normal impulses. slip: m/s along t1 and t2, rad/s
// about n. Computes the totals of t1, t2 and twist, and their change from `total`.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void SolveFriction(const ContactBatch<N, kFixedB>& batch, const Wide<N> (&total)[3], Wide<N> limit,
                                        const Wide<N> (&slip)[3], Wide<N> (&solved)[3], Wide<N> (&change)[3]) {
    using Real = Wide<N>;
    const Real* inverse = batch.frictionInverse;
    const Real* response = batch.frictionResponse;
    const Real step1 = -inverse[0] * slip[0];
    const Real step2 = -inverse[1] * (slip[1] + response[0] * step1);
    const Real stick1 = total[0] + step1, stick2 = total[1] + step2;
    const auto sticks = stick1 * stick1 + stick2 * stick2 <= limit * limit;
    const Real slide1 = total[0] - batch.slideMass * slip[0], slide2 = total[1] - batch.slideMass * slip[1];
    const Real lengthSquared = slide1 * slide1 + slide2 * slide2;
    const Real scale =
        Select(lengthSquared <= limit * limit, Real(1.0f), limit / Sqrt(Max(lengthSquared, Real(1e-30f))));
    solved[0] = Select(sticks, stick1, Real(slide1 * scale));
    solved[1] = Select(sticks, stick2, Real(slide2 * scale));
    change[0] = solved[0] - total[0];
    change[1] = solved[1] - total[1];

    const Real twistLimit = limit * batch.twistRadius;
    const Real spin = slip[2] + response[1] * change[0] + response[2] * change[1];
    solved[2] = Clamp(total[2] - inverse[2] * spin, -twistLimit, twistLimit);
    change[2] = solved[2] - total[2];
}

// Lanes without a surface velocity stay bit-identical, negative zeros included.
template <class Real>
FULCRUM_FORCE_INLINE Real MoveBy(Real velocity, Real surface) {
    return Select(surface == Real(0.0f), velocity, velocity + surface);
}

// m/s along t1 and t2, rad/s about n. kHasSurfaces: two dynamic bodies may have a surface velocity.
template <bool kHasSurfaces, int N, bool kFixedB>
FULCRUM_FORCE_INLINE void FindSlip(const ContactBatch<N, kFixedB>& batch, const Twist<Wide<N>>& relative,
                                   const ContactSolveSettings& settings, Wide<N> (&slip)[3]) {
    slip[0] = Dot<Wide<N>>(relative.linear, batch.tangent1);
    slip[1] = Dot<Wide<N>>(relative.linear, batch.tangent2);
    slip[2] = Dot<Wide<N>>(relative.angular, batch.normal);
    if constexpr (kHasSurfaces && !kFixedB)
        if (batch.hasSurface) {
            const SurfaceMotion<Wide<N>> surface = GatherSurfaceMotion(batch, settings.rare->surfaceVelocities);
            slip[0] = MoveBy(slip[0], surface.v1);
            slip[1] = MoveBy(slip[1], surface.v2);
            slip[2] = MoveBy(slip[2], surface.spin);
        }
}
// Adds to the slip what impulses of the normals change of it.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void AddSlipByNormals(const ContactBatch<N, kFixedB>& batch, const NormalImpulses<Wide<N>>& normal,
                                           Wide<N> (&slip)[3]) {
    for (int k = 0; k < 3; ++k)
        slip[k] = slip[k] + normal.sum * batch.coupling[0][k] + normal.sumB * batch.coupling[1][k] -
                  normal.sumA * batch.coupling[2][k];
}

// The unconstrained velocities: without the constraint impulses of this substep, but with those of impacts; `solved` if
// the settings have none.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void GatherFree(const ContactBatch<N, kFixedB>& batch, const ContactSolveSettings& settings,
                                     const Twists<N, kFixedB>& solved, Twists<N, kFixedB>& free) {
    free = solved;
    if (!settings.unconstrained) return;
    const auto gather = [&](const uint32_t(&bodies)[N], float*(&rows)[N], Wide<N>(&row)[8]) {
        for (int i = 0; i < N; ++i) rows[i] = settings.unconstrained + 8 * size_t(bodies[i]);
        GatherRows<N>(reinterpret_cast<const float* const(&)[N]>(rows), row);
    };
    gather(batch.bodyA, free.rowsA, free.a);
    if constexpr (!kFixedB) gather(batch.bodyB, free.rowsB, free.b);
}
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void ScatterFree(const ContactBatch<N, kFixedB>& batch, const ContactSolveSettings& settings,
                                      const Twists<N, kFixedB>& free) {
    if (settings.unconstrained) Scatter(batch, free);
}

// What only contacts with restitution need: gathered when it is used, so that batches have no room for it.
template <class Real>
struct Bounciness {
    Real restitution;   // 0..1
    Real closing;       // m/s2: relative acceleration of the bodies towards each other along the normal, by gravity and
                        // forces
    Real acceleration;  // m/s2 of gravity and forces, of the body that has the larger one
};
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE Bounciness<Wide<N>> GatherBounciness(const ContactBatch<N, kFixedB>& batch,
                                                          const RareContactData& data) {
    using Real = Wide<N>;
    alignas(64) float restitution[N];
    for (int i = 0; i < N; ++i) restitution[i] = data.records[batch.contact[i]].restitution;
    const Vec3<Real> a = GatherAcceleration<N>(batch.bodyA, data.poses),
                     b = GatherAcceleration<N>(batch.bodyB, data.poses);
    return {Real::Load(restitution), Dot<Real>(Vec3<Real>(a - b), batch.normal),
            Sqrt(Max(Dot<Real>(a, a), Dot<Real>(b, b)))};
}

// m/s, impact speed: v^2 = u^2 + 2 a gap, with u the approach speed before the gravity of a substep of h seconds, and a
// the closing acceleration.
template <class Real>
FULCRUM_FORCE_INLINE Real ImpactSpeed(const Bounciness<Real>& bounciness, const Real& approach, const Real& gap,
                                      const Real& h) {
    const Real before = Max(approach - bounciness.closing * h, Real(0.0f));
    return Sqrt(Max(before * before + Real(2.0f) * bounciness.closing * gap, Real(0.0f)));
}
// m/s, restitution threshold: slower impacts do not bounce. At least a few substeps of gravity, so that bodies pressed
// together by gravity come to rest.
template <class Real>
FULCRUM_FORCE_INLINE Real SlowestImpact(const Bounciness<Real>& bounciness, const ContactSolveSettings& settings) {
    const Real slowest(settings.restitutionSpeed), few(4.0f / settings.inverseDt);
    return Select(bounciness.closing > Real(0.0f), slowest, Min(slowest, few * bounciness.acceleration));
}

// What an iteration solves. If relax iterations follow, friction is not solved together with penetration recovery: a
// friction row would react to the recovery velocity, but too late for the positions, and layers of boxes would creep.
enum class Pass {
    Push,             // normal rows, with penetration recovery
    PushAndFriction,  // the same with friction: if no relax iteration follows, body B moves by itself, or without
                      // recovery
    Relax             // friction and normal rows, without penetration recovery
};

// The lanes whose body B is kinematic and moves, or has a surface velocity.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE WideMask<N> MovesByItself(const ContactBatch<N, kFixedB>& batch) {
    using Real = Wide<N>;
    if constexpr (!kFixedB) return Real(0.0f) > Real(0.0f);
    else {
        const Twist<Real>& velocity = batch.sideB.velocity;
        return Dot<Real>(velocity.linear, velocity.linear) + Dot<Real>(velocity.angular, velocity.angular) > Real(0.0f);
    }
}
// What falls flat would turn by the order of its rows. So the points of a manifold are first solved together where the
// rows would change much, by more than half of their impulses and than a step of gravity: of a hit, in which all of
// them approach, equal impulses stop the mean approach; where they part, the impulses of the warm start are scaled
// back, such that their work is least. speed: as below. changes: of the impulses.
template <Pass kPass, int N, bool kFixedB>
[[gnu::noinline]] void SolveTogether(ContactBatch<N, kFixedB>& batch, const ContactSolveSettings& settings,
                                     Wide<N>* speed, NormalImpulses<Wide<N>>& changes) {
    using Real = Wide<N>;
    const Real zero(0.0f), one(1.0f);
    Real parting = zero, count = zero, change = zero, sum = zero;
    auto isMuch = batch.rows[1].inverseResponse > zero, overlaps = zero > zero;
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& row = batch.rows[i];
        const auto isUsed = row.inverseResponse > zero;
        isMuch = isMuch & ((speed[i] < zero) | (row.impulse > zero) | ~isUsed);
        if constexpr (kPass != Pass::Relax) overlaps = overlaps | (isUsed & (row.separation < zero));
        parting += Select(isUsed, speed[i], zero);
        count += Select(isUsed, one, zero);
        change += row.inverseResponse * speed[i];
        sum += row.impulse;
    }
    const auto hits = parting < zero;
    isMuch = isMuch & (Real(2.0f) * Abs(change) > sum) & (Abs(parting) > count * Real(settings.leastError)) &
             ~(hits & overlaps);      // the recovery of overlaps is no hit
    if (batch.isGuided) [[unlikely]]  // their rows are under-relaxed
        isMuch = isMuch & LanesWhere<N>([&](int i) { return batch.locks[i] == 0; });
    if (!isMuch.Any()) return;
    // Along these impulses, with least energy.
    Real along[ContactRecord::kMaxPoints], response[ContactRecord::kMaxPoints];
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& row = batch.rows[i];
        along[i] = Select(isMuch & (row.inverseResponse > zero), Select(hits, one, row.impulse), zero);
        response[i] = along[i] * InverseOrZero(row.inverseResponse);
        for (int j = 0; j < i; ++j) {
            response[i] += along[j] * batch.response[PairIndex(j, i)];
            response[j] += along[i] * batch.response[PairIndex(j, i)];
        }
    }
    Real work = zero, energy = zero;
    for (int i = 0; i < batch.pointCount; ++i) {
        work += along[i] * speed[i];
        energy += along[i] * response[i];
    }
    const Real best = -work * InverseOrZero(energy), part = Select(hits, Max(best, zero), Clamp(best, -one, zero));
    for (int i = 0; i < batch.pointCount; ++i) {
        auto& row = batch.rows[i];
        row.impulse += part * along[i];
        changes.Add(row, part * along[i]);
        speed[i] += part * response[i];
    }
}

// One Gauss-Seidel sweep over the normal rows. total: returns their impulses. speed: m/s along the normal, biases for
// gaps and recovery included; updated to the remaining error. stiffer: 0..1, reduction of the softness of rows with
// overlap.
template <Pass kPass, int N, bool kFixedB>
FULCRUM_FORCE_INLINE void SweepNormals(const ContactBatch<N, kFixedB>& batch, const ContactSolveSettings& settings,
                                       const Wide<N>* stiffer, Wide<N>* speed, Wide<N>* total) {
    using Real = Wide<N>;
    const Real zero(0.0f), one(1.0f);
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& row = batch.rows[i];
        Real wanted;
        if constexpr (kPass == Pass::Relax) {
            wanted = row.impulse - row.inverseResponse * speed[i];
        } else {
            const auto overlaps = row.separation < zero;
            wanted = Select(overlaps, row.impulse * (Real(1.0f - settings.impulseScale) + stiffer[i]), row.impulse) -
                     row.inverseResponse *
                         Select(overlaps, speed[i] * Min(Real(settings.massScale) + stiffer[i], one), speed[i]);
        }
        total[i] = Max(wanted, zero);
        const Real change = total[i] - row.impulse;
        for (int j = i + 1; j < batch.pointCount; ++j) speed[j] += batch.response[PairIndex(i, j)] * change;
    }
}

// One velocity iteration over all rows of a batch: friction, then the normal rows. kRare: contacts may have
// restitution, a surface velocity on a dynamic second body, or gentle lanes.
template <Pass kPass, bool kRare, int N, bool kFixedB>
FULCRUM_FORCE_INLINE void SolveRows(ContactBatch<N, kFixedB>& batch, BodyState* states,
                                    const ContactSolveSettings& settings) {
    using Real = Wide<N>;
    // Where they are used: after velocity iterations, and for contacts that are iterated alone.
    constexpr bool kFindsErrors = kPass != Pass::Relax || N == 1;
    const Real zero(0.0f);
    Twists<N, kFixedB> twists;
    Gather<BodyRow::Velocity>(batch, states, twists);
    const Twist<Real> relative = RelativeTwist<BodyRow::Velocity>(batch, twists, settings.elapsed);
    NormalMotion<Real> motion = NormalMotionOf(batch, relative);

    // Separated points may close their gap within the substep (speculative), touching points may not approach,
    // overlapping points are separated softly.
    Real speed[ContactRecord::kMaxPoints], total[ContactRecord::kMaxPoints];
    [[maybe_unused]] Real stiffer[ContactRecord::kMaxPoints];
    // Bouncing contacts must keep their approach speed until the impact: the rows do not stop it, nor do relax
    // iterations before the gap has closed.
    [[maybe_unused]] WideMask<N> bounces[ContactRecord::kMaxPoints];
    if constexpr (kRare)
        if (batch.bounces) {
            Twists<N, kFixedB> free;
            GatherFree(batch, settings, twists, free);
            const NormalMotion<Real> own =
                NormalMotionOf(batch, RelativeTwist<BodyRow::Velocity>(batch, free, settings.elapsed));
            const Bounciness<Real> bounciness = GatherBounciness(batch, *settings.rare);
            const Real h(1.0f / settings.inverseDt), slowest = SlowestImpact(bounciness, settings);
            for (int i = 0; i < batch.pointCount; ++i) {
                const auto& row = batch.rows[i];
                const Real gap = Max(row.separation, zero);
                bounces[i] = ImpactSpeed(bounciness, Real(Max(-MotionOf(row, own), zero)), gap, h) > slowest;
                if constexpr (kPass == Pass::Relax) bounces[i] = bounces[i] | (row.separation > zero);
                bounces[i] = bounces[i] & (bounciness.restitution > zero);
            }
        }
    const auto findSpeeds = [&] {
        const Real inverseDt(settings.inverseDt), pushRate(settings.pushRate);
        Real fastest(-settings.maxPushSpeed);
        if constexpr (kRare)
            for (int lane = 0; lane < N; ++lane)
                if (batch.gentle >> lane & 1) fastest.Set(lane, -settings.rare->gentlePushSpeed);
        for (int i = 0; i < batch.pointCount; ++i) {
            const auto& row = batch.rows[i];
            speed[i] = MotionOf(row, motion) + Max(row.separation, zero) * inverseDt;
            if constexpr (kRare)
                if (batch.bounces) speed[i] = Select(bounces[i], Max(speed[i], zero), speed[i]);
            if constexpr (kPass != Pass::Relax) {
                // The remaining approach speed is added to the recovery speed: in a pile that is hit hard, one
                // iteration does not stop the bodies completely.
                const Real wanted = (row.separation + Real(settings.slop)) * pushRate;
                const Real push = Clamp(wanted, fastest + Min(speed[i], zero), zero);
                speed[i] += push;
                const Real deep = Real(-settings.impulseScale) * (row.separation * batch.inverseSoftDepth + Real(1.0f));
                stiffer[i] =
                    Clamp(Max((push - wanted) * Real(settings.stiffening), deep), zero, Real(settings.mostStiffer));
            }
        }
    };
    findSpeeds();
    [[maybe_unused]] Real friction[3], slip[3];
    [[maybe_unused]] const auto frictionLimit = [&] {
        Real sum = zero;
        for (int i = 0; i < batch.pointCount; ++i) sum += total[i];
        return batch.friction * sum;
    };
    // If relax iterations follow, only lanes with a moving kinematic body or a surface velocity have friction here: a
    // load on a turntable or belt would otherwise lag one substep behind. Other lanes stay bit-identical.
    [[maybe_unused]] WideMask<N> rides;
    if constexpr (kPass == Pass::PushAndFriction) rides = settings.relaxes ? MovesByItself(batch) : zero == zero;
    const auto where = [&](const Real& withFriction, [[maybe_unused]] const Real& without) {
        if constexpr (kPass == Pass::PushAndFriction) return Select(rides, withFriction, without);
        else return withFriction;
    };
    if constexpr (kPass != Pass::Push) {
        // Friction comes first, so non-penetration wins; but its limit is computed from the normal impulses of this
        // iteration, not of the previous one.
        SweepNormals<kPass>(batch, settings, stiffer, speed, total);
        FindSlip<kRare>(batch, relative, settings, slip);
        Real solved[3];
        SolveFriction<N, kFixedB>(batch, batch.frictionImpulse, frictionLimit(), slip, solved, friction);
        for (int k = 0; k < 3; ++k) {
            batch.frictionImpulse[k] = where(solved[k], batch.frictionImpulse[k]);
            motion.linear = where(motion.linear + batch.coupling[0][k] * friction[k], motion.linear);
            motion.angular1 = where(motion.angular1 + batch.coupling[1][k] * friction[k], motion.angular1);
            motion.angular2 = where(motion.angular2 + batch.coupling[2][k] * friction[k], motion.angular2);
        }
        findSpeeds();
    }
    NormalImpulses<Real> changes;
    if (batch.pointCount > 1) {  // most contacts are slower than all that is solved together
        Real largest = zero;
        for (int i = 0; i < batch.pointCount; ++i)
            largest = Max(largest, Select(batch.rows[i].impulse > zero, Abs(speed[i]), -speed[i]));
        if ((largest > Real(settings.leastError)).Any()) SolveTogether<kPass>(batch, settings, speed, changes);
    }
    SweepNormals<kPass>(batch, settings, stiffer, speed, total);
    [[maybe_unused]] WideMask<N> isUnsolved = zero > zero, isHit = isUnsolved;
    [[maybe_unused]] const Real hitError =
        Max(Real(settings.hitError) / batch.inverseSoftDepth, Real(settings.leastError));
    [[maybe_unused]] const Real mostError =
        Max(Real(settings.mostError) / batch.inverseSoftDepth, Real(settings.leastError));
    for (int i = 0; i < batch.pointCount; ++i) {
        auto& row = batch.rows[i];
        const Real change = total[i] - row.impulse;
        changes.Add(row, change);
        row.impulse = total[i];
        if constexpr (kFindsErrors) {
            isUnsolved = isUnsolved | (Abs(change) > row.inverseResponse * mostError);
            if constexpr (kFixedB) isHit = isHit | (Abs(change) > row.inverseResponse * hitError);
        }
    }
    if constexpr (kPass == Pass::PushAndFriction && kFixedB)
        if (settings.relaxes && rides.Any()) {
            // Once more after the normals, which change the slip: a load on a turntable would creep inwards.
            const Real* response = batch.frictionResponse;
            for (int k = 0; k < 3; ++k) slip[k] += friction[k] * InverseOrZero(batch.frictionInverse[k]);
            AddSlipByNormals(batch, changes, slip);
            slip[0] += response[0] * friction[1] + response[1] * friction[2];
            slip[1] += response[0] * friction[0] + response[2] * friction[2];
            slip[2] += response[1] * friction[0] + response[2] * friction[1];
            Real solved[3], more[3];
            SolveFriction<N, kFixedB>(batch, batch.frictionImpulse, frictionLimit(), slip, solved, more);
            for (int k = 0; k < 3; ++k) {
                batch.frictionImpulse[k] = where(solved[k], batch.frictionImpulse[k]);
                friction[k] += more[k];
            }
        }
    if constexpr (kFindsErrors) {
        batch.unsolved = static_cast<uint16_t>(isUnsolved.ToBits() & LanesOf(batch));
        batch.hits = static_cast<uint16_t>(isHit.ToBits() & LanesOf(batch));
    }

    Vec3<Real> force = batch.normal * changes.sum, torque = NormalTorque(batch, changes.sumA, changes.sumB);
    if constexpr (kPass != Pass::Push)
        for (int k = 0; k < 3; ++k) {
            force[k] = where(force[k] + (batch.tangent1[k] * friction[0] + batch.tangent2[k] * friction[1]), force[k]);
            torque[k] = where(torque[k] + batch.normal[k] * friction[2], torque[k]);
        }
    ApplyToBoth<N, kFixedB>(batch, twists, force, torque);
    Scatter(batch, twists);
}

template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE void WarmStartRows(ContactBatch<N, kFixedB>& batch, BodyState* states) {
    Twists<N, kFixedB> twists;
    Gather<BodyRow::Velocity>(batch, states, twists);
    const Twist<Wide<N>> wrench = TotalWrench(batch);
    ApplyToBoth<N, kFixedB>(batch, twists, wrench.linear, wrench.angular);
    Scatter(batch, twists);
}

// For batches with restitution, with a surface velocity between two dynamic bodies, or with gentle lanes where there is
// recovery.
template <Pass kPass, int N, bool kFixedB>
void SolveRareRows(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings);

template <Pass kPass, int N, bool kFixedB>
FULCRUM_FORCE_INLINE void SolveAllRows(ContactBatch<N, kFixedB>& batch, BodyState* states,
                                       const ContactSolveSettings& settings) {
    const bool isGentle = batch.gentle != 0 && settings.pushRate > 0;
    if (batch.bounces || (!kFixedB && batch.hasSurface) || isGentle)
        return SolveRareRows<kPass>(batch, states, settings);
    SolveRows<kPass, false>(batch, states, settings);
}

}  // namespace fulcrum::contacts
