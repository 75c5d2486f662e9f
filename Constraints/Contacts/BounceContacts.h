// Impacts of contacts with restitution, applied in every velocity iteration before the rows are solved. Impacts
// propagate: a body that is hit passes the impact on to the bodies it touches in the same iteration, those pass it on
// in the next.
//
// Newton's law of restitution at each point, v+ = -e v-, for all points of a contact that hit together;
// Coulomb friction with a tangential restitution of 0. The impulses are scaled down where they would add energy, which
// Newton's law may do with several points or with friction (W. J. Stronge, Impact Mechanics, 2000).
//
// Speed at the time of impact: v^2 = u^2 + 2 a gap, with u the approach speed before the substep's gravity and a the
// closing acceleration. The speed at the end of the substep is that of free flight with initial speed e v from the
// surface: with restitution 1 energy is neither gained nor lost, wherever in the substep the impact happens.
//
// Bodies move with the new velocity only for the rest of the substep after the impact. So they are displaced by minus
// the velocity change times the time before the impact, or, in relax iterations, which run after the poses moved, by
// the velocity change times the time since.
//
// Impact impulses are never warm started: they are added to the unconstrained velocities, too.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactNote.h>
#include <Fulcrum/Constraints/Contacts/ContactRows.h>

#include <algorithm>
#include <limits>

namespace fulcrum::contacts {

// The contact points that collide together, within a substep after the first of them.
template <class Real>
struct Hits {
    static constexpr int kPoints = ContactRecord::kMaxPoints;
    Real speed[kPoints];  // m/s: separation speed that the point must reach; 0: not hit
    Real time;            // s from the beginning of the substep to the first hit
};

// Separations are current: in relax iterations those at the end of the substep.
template <bool kRelax, int N, bool kFixedB>
FULCRUM_FORCE_INLINE Hits<Wide<N>> FindHits(const ContactBatch<N, kFixedB>& batch,
                                            const Bounciness<Wide<N>>& bounciness, const ContactSolveSettings& settings,
                                            const NormalMotion<Wide<N>>& free, const NormalMotion<Wide<N>>& velocity) {
    using Real = Wide<N>;
    const float dt = 1.0f / settings.inverseDt;
    const Real zero(0.0f), h(dt), closing = bounciness.closing;
    Hits<Real> hits;
    hits.time = h;
    Real approach[Hits<Real>::kPoints], gap[Hits<Real>::kPoints];
    WideMask<N> mayBeHit[Hits<Real>::kPoints];
    auto isAnyHit = zero > zero;
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& row = batch.rows[i];
        approach[i] = Max(Min(-MotionOf(row, free), -MotionOf(row, velocity)), zero);
        const Real start = kRelax ? row.separation + approach[i] * h : row.separation;  // at the start of the substep
        gap[i] = Max(start, zero);
        const auto isImpact = ImpactSpeed(bounciness, approach[i], gap[i], h) > SlowestImpact(bounciness, settings);
        mayBeHit[i] = isImpact & (bounciness.restitution > zero) & (row.inverseResponse > zero);
        const auto isHit = mayBeHit[i] & (start <= approach[i] * h);
        isAnyHit = isAnyHit | isHit;
        const Real time = Min(gap[i] / Max(approach[i], Real(1e-30f)), h);
        hits.time = Select(isHit, Min(hits.time, time), hits.time);
    }
    // With the first one those are hit that would be within the duration of a substep after it: whether points are hit
    // together does not depend on when the substep ends. All of them are at that time. Free flight is integrated
    // exactly, including a h^2 / 2 (Integrate.cpp).
    const Real fall = closing * (h - hits.time), lift = closing * h;
    for (int i = 0; i < batch.pointCount; ++i) {
        const Real way = Min(gap[i], Real(approach[i] * hits.time));
        const Real after = bounciness.restitution * ImpactSpeed(bounciness, approach[i], way, h);
        const Real leaving = Sqrt(Max(fall * fall + after * after - lift * lift, zero)) - fall;
        // A body that gravity draws away from what it hits, such as a ball below a ceiling, leaves faster than it came.
        const Real fastest = approach[i] - Real(2.0f) * Min(closing, zero) * h;
        const auto isHit = isAnyHit & mayBeHit[i] & (gap[i] <= approach[i] * (hits.time + h));
        hits.speed[i] = Select(isHit, Clamp(leaving, Real(1e-6f), fastest), zero);
    }
    return hits;
}

// The impulses that give the points that are hit their separation speeds, and the sums of these impulses.
template <int N, bool kFixedB>
FULCRUM_FORCE_INLINE NormalImpulses<Wide<N>> FindImpulses(const ContactBatch<N, kFixedB>& batch,
                                                          const NormalMotion<Wide<N>>& motion,
                                                          const Wide<N> (&leaving)[ContactRecord::kMaxPoints],
                                                          Wide<N> (&impulses)[ContactRecord::kMaxPoints]) {
    using Real = Wide<N>;
    constexpr int kPasses = 8;  // fixed, since the lanes of a batch have different numbers of points
    const Real zero(0.0f);
    Real missing[ContactRecord::kMaxPoints];
    for (int i = 0; i < batch.pointCount; ++i) {
        missing[i] = MotionOf(batch.rows[i], motion) - leaving[i];
        impulses[i] = zero;
    }
    for (int pass = 0; pass < kPasses; ++pass)
        for (int i = 0; i < batch.pointCount; ++i) {
            const auto& row = batch.rows[i];
            const Real wanted = Max(impulses[i] - row.inverseResponse * missing[i], zero);
            const Real change = Select(leaving[i] > zero, wanted - impulses[i], zero);
            impulses[i] += change;
            missing[i] += Select(row.inverseResponse > zero, change / row.inverseResponse, zero);
            for (int j = 0; j < batch.pointCount; ++j)
                if (j != i) missing[j] += batch.response[i < j ? PairIndex(i, j) : PairIndex(j, i)] * change;
        }
    NormalImpulses<Real> sum;
    for (int i = 0; i < batch.pointCount; ++i) sum.Add(batch.rows[i], impulses[i]);
    return sum;
}

template <bool kRelax, int N, bool kFixedB>
void BounceContacts(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    using Real = Wide<N>;
    const float dt = 1.0f / settings.inverseDt;
    const float elapsed = kRelax ? settings.elapsed : settings.elapsed - 0.5f * dt;
    const Real zero(0.0f), one(1.0f);
    // Impact speeds are measured on velocities without this substep's constraint impulses: neither penetration recovery
    // nor a warm start is an impact. Relax iterations, in which recovery velocities are removed, use the solved
    // velocities.
    Twists<N, kFixedB> free, solved, displacement;
    Gather<BodyRow::Velocity>(batch, states, solved);
    GatherFree(batch, settings, solved, free);
    const Twists<N, kFixedB>& velocity = kRelax ? solved : free;
    Gather<BodyRow::Displacement>(batch, states, displacement);
    const Bounciness<Real> bounciness = GatherBounciness(batch, *settings.rare);
    // Recomputed, because impacts of this iteration have displaced bodies. Lanes without restitution stay
    // bit-identical.
    const auto findSeparations = [&] {
        const NormalMotion<Real> moved =
            NormalMotionOf(batch, RelativeTwist<BodyRow::Displacement>(batch, displacement, elapsed));
        for (int i = 0; i < batch.pointCount; ++i) {
            auto& row = batch.rows[i];
            row.separation =
                Select(bounciness.restitution > zero, row.startSeparation + MotionOf(row, moved), row.separation);
        }
    };
    findSeparations();
    const Twist<Real> relative = RelativeTwist<BodyRow::Velocity>(batch, velocity, settings.elapsed);
    const NormalMotion<Real> motion = NormalMotionOf(batch, relative);
    const NormalMotion<Real> freeMotion =
        NormalMotionOf(batch, RelativeTwist<BodyRow::Velocity>(batch, free, settings.elapsed));
    const Hits<Real> hits = FindHits<kRelax>(batch, bounciness, settings, freeMotion, motion);
    Real largest = zero;
    for (int i = 0; i < batch.pointCount; ++i) largest = Max(largest, hits.speed[i]);
    if (!(largest > zero).Any()) return;

    Real impulses[ContactRecord::kMaxPoints];
    const NormalImpulses<Real> normal = FindImpulses(batch, motion, hits.speed, impulses);
    Real slip[3];
    FindSlip<true>(batch, relative, settings, slip);
    AddSlipByNormals(batch, normal, slip);
    const Real none[3] = {zero, zero, zero};
    Real friction[3], change[3];
    SolveFriction<N, kFixedB>(batch, none, batch.friction * normal.sum, slip, friction, change);

    Twists<N, kFixedB> changed = velocity;
    ApplyToBoth<N, kFixedB>(batch, changed,
                            batch.normal * normal.sum + batch.tangent1 * friction[0] + batch.tangent2 * friction[1],
                            NormalTorque(batch, normal.sumA, normal.sumB) + batch.normal * friction[2]);
    // The work of the impulses scaled by s is s rate + s^2 rest, with rest the energy they would give to bodies at
    // rest; work against gravity in the rest of the substep is included.
    const auto rateOf = [&](const Twists<N, kFixedB>& twists) {
        const Twist<Real> of = RelativeTwist<BodyRow::Velocity>(batch, twists, settings.elapsed);
        return WorkOf(normal, NormalMotionOf(batch, of)) + friction[0] * Dot<Real>(of.linear, batch.tangent1) +
               friction[1] * Dot<Real>(of.linear, batch.tangent2) + friction[2] * Dot<Real>(of.angular, batch.normal);
    };
    const Real rateBefore = rateOf(velocity), rest = Real(0.5f) * (rateOf(changed) - rateBefore);
    const Real rate = Min(rateBefore + bounciness.closing * (Real(dt) - hits.time) * normal.sum, zero);
    const Real part = Select(rest > -rate, -rate / Max(rest, Real(1e-30f)), one);
    Real sum = zero;
    for (int k = 0; k < 6; ++k) {
        sum += changed.a[k] * changed.a[k];
        if constexpr (!kFixedB) sum += changed.b[k] * changed.b[k];
    }
    const auto isHit = (largest > zero) & (sum * part < Real(std::numeric_limits<float>::max()));
    if (batch.hasNotes) {
        const Real done = Select(isHit, part, zero);
        for (int i = 0; i < batch.pointCount; ++i) impulses[i] = impulses[i] * done;
        for (Real& f : friction) f = f * done;
        AddImpulses(batch, impulses, friction, settings.notes);
    }
    const Real shift = kRelax ? Real(dt) - hits.time : -hits.time;
    const auto apply = [&](const Real(&before)[8], const Real(&after)[8], Real(&own)[8], Real(&v)[8], Real(&x)[8]) {
        // Bodies that an impact would rotate by more than half a revolution within the substep are not displaced.
        Real turnSquared = zero;
        for (int k = BodyState::kAngular; k < BodyState::kAngular + 3; ++k) {
            const Real turn = (after[k] - before[k]) * part * shift;
            turnSquared += turn * turn;
        }
        const Real way = Select(turnSquared < Real(10.0f), shift, zero);
        for (int k = 0; k < 6; ++k) {
            const Real difference = (after[k] - before[k]) * part;
            const auto isOwn = own[k] == v[k];  // unchanged values stay bit-identical
            const Real changedOwn = own[k] + difference;
            v[k] = Select(isHit, Select(isOwn, changedOwn, v[k] + difference), v[k]);
            own[k] = Select(isHit, changedOwn, own[k]);
            x[k] = Select(isHit, x[k] + difference * way, x[k]);
        }
        Real turned[8];
        std::copy_n(x, 8, turned);
        SetHalfTurn<Real>(turned);
        for (int k = 6; k < 8; ++k) x[k] = Select(isHit, turned[k], x[k]);
    };
    const Twists<N, kFixedB> unchanged = velocity;
    apply(unchanged.a, changed.a, free.a, solved.a, displacement.a);
    if constexpr (!kFixedB) apply(unchanged.b, changed.b, free.b, solved.b, displacement.b);
    Scatter(batch, solved);
    Scatter(batch, displacement);
    ScatterFree(batch, settings, free);
    findSeparations();
    // A bouncing body is displaced to where its trajectory left the surface, so there is no penetration to recover.
    for (int i = 0; i < batch.pointCount; ++i)
        batch.rows[i].separation =
            Select(hits.speed[i] > zero, Max(batch.rows[i].separation, zero), batch.rows[i].separation);
}

}  // namespace fulcrum::contacts
