#include <Fulcrum/Constraints/Contacts/ContactNote.h>

#include <Fulcrum/Constraints/Contacts/ContactKernels.h>

#include <limits>

namespace fulcrum {

using namespace contacts;

namespace {

// The rows of eight floats that start at a member of the notes.
template <int N, bool kFixedB, class Member>
FULCRUM_FORCE_INLINE void FindRows(const ContactBatch<N, kFixedB>& batch, ContactNote* notes, Member member,
                                   float* (&rows)[N]) {
    for (int lane = 0; lane < N; ++lane) rows[lane] = notes[batch.contact[lane]].*member;
}

template <class Real>
FULCRUM_FORCE_INLINE Real FiniteOrZero(const Real& x) {
    return Select(Abs(x) <= Real(std::numeric_limits<float>::max()), x, Real(0.0f));
}

}  // namespace

// Approach speed v at the time of impact: v^2 = u^2 + 2 a gap, with u the current approach speed and a the closing
// acceleration.
template <int N, bool kFixedB>
void BeginNotes(const ContactBatch<N, kFixedB>& batch, const ConstSolverBodies& bodies, ContactNote* notes) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    Twists<N, kFixedB> twists;
    GatherVelocities(batch, bodies.states, twists);
    const NormalMotion<Real> motion = NormalMotionOf(batch, RelativeTwist<BodyRow::Velocity>(batch, twists, 0));
    const Vec3<Real> a = GatherAcceleration<N>(batch.bodyA, bodies.poses),
                     b = GatherAcceleration<N>(batch.bodyB, bodies.poses);
    const Real closing = Dot<Real>(Vec3<Real>(a - b), batch.normal);
    Real row[8], none[8];
    for (int k = 0; k < 8; ++k) row[k] = none[k] = zero;
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& point = batch.rows[i];
        const Real approach = Max(-MotionOf(point, motion), zero), gap = Max(point.startSeparation, zero);
        row[ContactNote::kApproachSpeeds + i] =
            FiniteOrZero(Sqrt(Max(approach * approach + Real(2.0f) * closing * gap, zero)));
    }
    SetVectorAt<ContactNote::kNormal>(row, batch.normal);
    float* rows[N];
    FindRows(batch, notes, &ContactNote::approachSpeed, rows);
    ScatterRows<N>(rows, row, batch.count);
    FindRows(batch, notes, &ContactNote::impulse, rows);
    ScatterRows<N>(rows, none, batch.count);
}

template <int N, bool kFixedB>
void AddImpulses(const ContactBatch<N, kFixedB>& batch, const Wide<N> (&normal)[ContactNote::kMaxPoints],
                 const Wide<N> (&friction)[3], ContactNote* notes) {
    using Real = Wide<N>;
    float* rows[N];
    FindRows(batch, notes, &ContactNote::impulse, rows);
    Real row[8];
    GatherRows<N>(reinterpret_cast<const float* const(&)[N]>(rows), row);
    for (int i = 0; i < batch.pointCount; ++i) row[ContactNote::kNormalImpulses + i] += FiniteOrZero(normal[i]);
    const Vec3<Real> slide = batch.tangent1 * friction[0] + batch.tangent2 * friction[1];
    for (int k = 0; k < 3; ++k) row[ContactNote::kFrictionImpulse + k] += FiniteOrZero(slide[k]);
    row[ContactNote::kTwistImpulse] += FiniteOrZero(friction[2]);
    ScatterRows<N>(rows, row, batch.count);
}

template <int N, bool kFixedB>
void AddRowImpulses(const ContactBatch<N, kFixedB>& batch, ContactNote* notes) {
    Wide<N> normal[ContactNote::kMaxPoints];
    for (int i = 0; i < batch.pointCount; ++i) normal[i] = batch.rows[i].impulse;
    AddImpulses(batch, normal, batch.frictionImpulse, notes);
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                       \
    template void BeginNotes(const ContactBatch<lanes, fixedB>&, const ConstSolverBodies&, ContactNote*);        \
    template void AddRowImpulses(const ContactBatch<lanes, fixedB>&, ContactNote*);                              \
    template void AddImpulses(const ContactBatch<lanes, fixedB>&, const Wide<lanes>(&)[ContactNote::kMaxPoints], \
                              const Wide<lanes>(&)[3], ContactNote*);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
