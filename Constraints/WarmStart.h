// The warm start of a substep, where it is explicit: the impulses of the last substep of all constraints, summed by
// body, and scaled by island so that they never raise what an exact solution lowers.
//
// With v the island's velocities, lambda the impulses, J their Jacobian, b the biases of their rows (v included only as
// far as it belongs to bodies that are not dynamic) and gamma the softness (RowSoftness.h), a solution minimizes over
// the impulses
//     |v + M^-1 J^T lambda|^2_M / 2 + b lambda + gamma lambda^2 / 2
// A warm start that is scaled by s takes it to its least value along lambda:
//     s = -(v . p + b lambda) / (p . M^-1 p + gamma lambda^2), p = J^T lambda, within 0 and 1
// Without biases that is the kinetic energy, which then does not rise.
#pragma once

#include <Fulcrum/Constraints/Parts/BodyState.h>
#include <Fulcrum/Constraints/Parts/SymmetricInverse.h>

namespace fulcrum {

// Of one body: a row of eight floats. ScaleWarmStarts replaces the impulses by the changes of velocity that they make.
struct alignas(32) WarmStart {
    float impulse[3] = {0, 0, 0}, angularImpulse[3] = {0, 0, 0};  // N s; N m s about the center of mass
    // W and J per second: b lambda and gamma lambda^2 of constraints, each at one of its bodies.
    float work = 0, softWork = 0;

    float* Row() { return impulse; }
    const float* Row() const { return impulse; }
    enum Places { kImpulse = 0, kAngularImpulse = 3, kWork = 6, kSoftWork = 7 };
    // Once the island's scale is known.
    float Scale() const { return work; }
    void SetScale(float scale) { work = scale; }
};
static_assert(sizeof(WarmStart) == 32);
FULCRUM_CHECK_PLACE(WarmStart, impulse, 0, WarmStart::kImpulse);
FULCRUM_CHECK_PLACE(WarmStart, angularImpulse, 0, WarmStart::kAngularImpulse);
FULCRUM_CHECK_PLACE(WarmStart, work, 0, WarmStart::kWork);
FULCRUM_CHECK_PLACE(WarmStart, softWork, 0, WarmStart::kSoftWork);

// Adds the impulses of constraints on their bodies, onA and onB, and their work (b lambda, gamma lambda^2), which goes
// to A, or to B where A is not dynamic. Bodies that are not dynamic (bits of fixedA, fixedB) are not written. starts:
// by body.
template <int N>
FULCRUM_FORCE_INLINE void AddWarmStart(WarmStart* starts, const uint32_t (&bodyA)[N], const uint32_t (&bodyB)[N],
                                       int count, uint32_t fixedA, uint32_t fixedB, const Twist<Wide<N>>& onA,
                                       const Twist<Wide<N>>& onB, const Vec2<Wide<N>>& work) {
    using Real = Wide<N>;
    const auto add = [&](const uint32_t(&bodies)[N], uint32_t fixed, const Twist<Real>& impulse, uint32_t withoutWork) {
        alignas(32) float nowhere[8];
        float* rows[N];
        for (int i = 0; i < N; ++i) rows[i] = starts[bodies[i]].Row();
        Real row[8];
        GatherRows<N>(reinterpret_cast<const float* const(&)[N]>(rows), row);
        for (int k = 0; k < 3; ++k) {
            row[WarmStart::kImpulse + k] += impulse.linear[k];
            row[WarmStart::kAngularImpulse + k] += impulse.angular[k];
        }
        Real part(1.0f);
        if (withoutWork != 0)
            for (int i = 0; i < N; ++i) part.Set(i, withoutWork >> i & 1u ? 0.0f : 1.0f);
        row[WarmStart::kWork] += work.x() * part;
        row[WarmStart::kSoftWork] += work.y() * part;
        if (fixed != 0)
            for (int i = 0; i < N; ++i)
                if (fixed >> i & 1u) rows[i] = nowhere;
        ScatterRows<N>(rows, row, count);
    };
    add(bodyA, fixedA, onA, fixedA);
    add(bodyB, fixedB, onB, ~fixedA);
}

// The scales of the islands by lane, from the dynamic bodies.
template <int N>
FULCRUM_FORCE_INLINE Wide<N> GatherScale(const WarmStart* starts, const uint32_t (&bodyA)[N],
                                         const uint32_t (&bodyB)[N], uint32_t fixedA) {
    Wide<N> scale(0.0f);
    for (int i = 0; i < N; ++i) scale.Set(i, starts[fixedA >> i & 1u ? bodyB[i] : bodyA[i]].Scale());
    return scale;
}

}  // namespace fulcrum
