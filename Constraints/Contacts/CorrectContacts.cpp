#include <Fulcrum/Constraints/Contacts/ContactKernels.h>

namespace fulcrum {

using namespace contacts;

// Non-linear Gauss-Seidel over the normal rows: with C the separation plus slop at the current poses, a point moves the
// bodies by lambda = -K^-1 baumgarte C along J where C < 0, which changes the C of the points after it.
template <int N, bool kFixedB>
void CorrectContacts(const ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    using Real = Wide<N>;
    const Real zero(0.0f), part(settings.baumgarte), most(settings.mostCorrection);
    Twists<N, kFixedB> twists;
    Gather<BodyRow::Displacement>(batch, states, twists);
    const NormalMotion<Real> motion =
        NormalMotionOf(batch, RelativeTwist<BodyRow::Displacement>(batch, twists, settings.elapsed));
    Real missing[ContactRecord::kMaxPoints];  // m: correction of the point in this iteration
    for (int i = 0; i < batch.pointCount; ++i) {
        const auto& row = batch.rows[i];
        const Real separation = row.startSeparation + MotionOf(row, motion);
        missing[i] = Min((separation + Real(settings.slop)) * -part, most);
    }
    const NormalImpulses<Real> impulses = SweepMissing(batch, missing);
    if (!(impulses.sum > zero).Any()) return;
    ApplyToBoth<N, kFixedB>(batch, twists, batch.normal * impulses.sum,
                            NormalTorque(batch, impulses.sumA, impulses.sumB));
    SetHalfTurn<Real>(twists.a);
    if constexpr (!kFixedB) SetHalfTurn<Real>(twists.b);
    Scatter(batch, twists);
}

#define FULCRUM_INSTANTIATE(lanes, fixedB) \
    template void CorrectContacts(const ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
