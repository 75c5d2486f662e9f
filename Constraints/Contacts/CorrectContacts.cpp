#include <Fulcrum/Constraints/Contacts/ContactKernels.h>

#include <limits>

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
    Vec3<Real> force = batch.normal * impulses.sum, torque = NormalTorque(batch, impulses.sumA, impulses.sumB);
    // Rows are linear in rotations: no correction turns a body further than they are valid for, nor is one without
    // bound.
    const auto turnOf = [&](const UniformInverseMass<Real>& inverse, const Vec3<Real>& arm) {
        const Vec3<Real> turn = inverse.inertia * (Cross<Real>(arm, force) + torque);
        return Dot<Real>(turn, turn);
    };
    Real squared = turnOf(batch.inverseA, batch.armA);
    if constexpr (!kFixedB) squared = Max(squared, turnOf(batch.sideB.inverse, batch.sideB.arm));
    constexpr float kMostTurn = 0.3f;  // rad
    const auto isNear = squared <= Real(kMostTurn * kMostTurn);
    if (!isNear.All()) [[unlikely]] {
        const auto isKnown = squared < Real(std::numeric_limits<float>::infinity());
        const Real scale = Select(isNear, Real(1.0f), Select(isKnown, Real(kMostTurn) / Sqrt(squared), zero));
        force = ZeroUnless<Real>(scale > zero, Vec3<Real>(force * scale));
        torque = ZeroUnless<Real>(scale > zero, Vec3<Real>(torque * scale));
    }
    ApplyToBoth<N, kFixedB>(batch, twists, force, torque);
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
