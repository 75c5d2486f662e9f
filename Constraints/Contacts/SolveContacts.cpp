#include <Fulcrum/Constraints/Contacts/ContactRows.h>

namespace fulcrum {

namespace {

using namespace contacts;

template <Pass kPass, int N, bool kFixedB>
FULCRUM_FORCE_INLINE void SolveAllRows(ContactBatch<N, kFixedB>& batch, BodyState* states,
                                       const ContactSolveSettings& settings) {
    if (batch.bounces || (!kFixedB && batch.surfaces)) return SolveRareRows<kPass>(batch, states, settings);
    SolveRows<kPass, false>(batch, states, settings);
}

}  // namespace

void ContactSolveSettings::Soften(float frequency, float dampingRatio, float h, float maxPushSpeed) {
    const PushSoftness push = PushSoftnessOf(frequency, dampingRatio, h);
    pushRate = push.pushRate;
    massScale = push.softness.massScale;
    impulseScale = push.softness.impulseScale;
    constexpr float kSoftest = 0.125f;  // least softness: keeps impulses bounded
    mostStiffer = (1 - kSoftest) * impulseScale;
    stiffening = impulseScale / maxPushSpeed;
}

template <int N, bool kFixedB>
void WarmStartContacts(ContactBatch<N, kFixedB>& batch, BodyState* states) {
    WarmStartRows(batch, states);
}

template <int N, bool kFixedB>
void SolveContactVelocities(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    if (settings.relaxes && !MovesByItself(batch).Any()) SolveAllRows<Pass::Push>(batch, states, settings);
    else SolveAllRows<Pass::PushAndFriction>(batch, states, settings);
}

template <int N, bool kFixedB>
void UpdateSeparations(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    using Real = Wide<N>;
    Twists<N, kFixedB> twists;
    Gather<BodyRow::Displacement>(batch, states, twists);
    const NormalMotion<Real> motion =
        NormalMotionOf(batch, RelativeTwist<BodyRow::Displacement>(batch, twists, settings.elapsed));
    for (int i = 0; i < batch.pointCount; ++i) {
        auto& row = batch.rows[i];
        row.separation = row.startSeparation + MotionOf(row, motion);
    }
}

template <int N, bool kFixedB>
void RelaxContacts(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    UpdateSeparations(batch, states, settings);
    SolveAllRows<Pass::Relax>(batch, states, settings);
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                       \
    template void WarmStartContacts(ContactBatch<lanes, fixedB>&, BodyState*);                                   \
    template void SolveContactVelocities(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&); \
    template void RelaxContacts(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&);          \
    template void UpdateSeparations(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
