// The life that parts of one to three rows share: rows solved together as one block, hard or soft, with their impulses
// and states. A part derives from it and adds its set-up, its Jacobian and the impulses along it. One thread per part.
//
//   K = J M^-1 J^T                       b  bias, m/s or rad/s            C  error, m or rad
//   A solve changes the impulses by delta lambda = -massScale K^-1 (J v + b) - impulseScale * total lambda and adds
//   M^-1 J^T delta lambda to the velocities; (1, 0) is the hard block, which reaches J v = -b (RowSoftness.h).
//   A position pass moves the bodies by -K^-1 baumgarte C along J.
//
// The part keeps its Jacobian, the masses are handed in at every call as in the axis part. A block that no body can
// answer is inactive; a lane that is inactive changes nothing.
#pragma once

#include <Fulcrum/Constraints/Parts/PairMotion.h>
#include <Fulcrum/Constraints/Parts/RowSoftness.h>
#include <Fulcrum/Constraints/Parts/SymmetricInverse.h>

namespace fulcrum {

namespace detail {

// Rows as one number, or as a vector and a matrix; the parts below are written once for all.
template <class Real, int kRows>
struct BlockTypes;
template <class Real>
struct BlockTypes<Real, 1> {
    using Rows = Real;
    using Symmetric = Real;
    static Rows Zero() { return Real(0.0f); }
    static Symmetric NoMass() { return Real(0.0f); }
    static Real Size(const Rows& a) { return Abs(a); }
    static Real Trace(const Symmetric& k) { return k; }
    static Symmetric Without(MaskOf<Real> mask, const Symmetric& k) { return Select(mask, Real(0.0f), k); }
};
template <class Real>
struct BlockTypes<Real, 2> {
    using Rows = Vec2<Real>;
    using Symmetric = Sym2<Real>;
    static Rows Zero() { return Rows(Real(0.0f), Real(0.0f)); }
    static Symmetric NoMass() { return {}; }
    static Real Size(const Rows& a) { return Abs(a.x()) + Abs(a.y()); }
    static Real Trace(const Symmetric& k) { return k.xx + k.yy; }
    static Symmetric Without(MaskOf<Real> mask, const Symmetric& k) {
        const Real zero(0.0f);
        return {Select(mask, zero, k.xx), Select(mask, zero, k.yy), Select(mask, zero, k.xy)};
    }
};
template <class Real>
struct BlockTypes<Real, 3> {
    using Rows = Vec3<Real>;
    using Symmetric = Sym3<Real>;
    static Rows Zero() { return Rows(Real(0.0f), Real(0.0f), Real(0.0f)); }
    static Symmetric NoMass() { return {}; }
    static Real Size(const Rows& a) { return Abs(a.x()) + Abs(a.y()) + Abs(a.z()); }
    static Real Trace(const Symmetric& k) { return k.xx + k.yy + k.zz; }
    static Symmetric Without(MaskOf<Real> mask, const Symmetric& k) {
        const Real zero(0.0f);
        return {Select(mask, zero, k.xx), Select(mask, zero, k.yy), Select(mask, zero, k.zz),
                Select(mask, zero, k.xy), Select(mask, zero, k.xz), Select(mask, zero, k.yz)};
    }
};

template <class Real>
inline Vec2<Real> Choose(MaskOf<Real> mask, const Vec2<Real>& a, const Vec2<Real>& b) {
    return Vec2<Real>(Select(mask, a.x(), b.x()), Select(mask, a.y(), b.y()));
}
template <class Real>
inline Vec3<Real> Choose(MaskOf<Real> mask, const Vec3<Real>& a, const Vec3<Real>& b) {
    return Vec3<Real>(Select(mask, a.x(), b.x()), Select(mask, a.y(), b.y()), Select(mask, a.z(), b.z()));
}
template <class Real>
inline Real Choose(MaskOf<Real> mask, const Real& a, const Real& b) {
    return Select(mask, a, b);
}

}  // namespace detail

// What a snapshot keeps of a block.
template <class Real, int kRows>
struct BlockState {
    using Types = detail::BlockTypes<Real, kRows>;
    typename Types::Rows totalLambda = Types::Zero();
};

// Part derives from BlockPart<Part, Real, kRows> and has, for compile-time sides,
//     Rows RelativeMotion<kSide1, kSide2>(motion1, motion2) const                                   J times motion
//     void AddImpulse<kSide1, kSide2>(motion1, motion2, mass1, mass2, lambda, applied) const        + M^-1 J^T lambda
// Real: float, or Wide<N> for N constraints; both give the same bits. Rows: Real, Vec2<Real> or Vec3<Real>.
template <class Part, class Real, int kRows>
class BlockPart {
    using Types = detail::BlockTypes<Real, kRows>;

public:
    using Mask = MaskOf<Real>;
    using Vector = Vec3<Real>;
    using Rows = typename Types::Rows;
    using Symmetric = typename Types::Symmetric;
    using State = BlockState<Real, kRows>;

    // Another bias, or another softness, for rows that are otherwise as they were set up.
    void SetBias(const Rows& bias) { bias_ = bias; }
    const Rows& GetBias() const { return bias_; }
    void SetSoftness(const RowSoftness<Real>& softness) { softness_ = softness; }
    const RowSoftness<Real>& GetSoftness() const { return softness_; }

    void Deactivate() { SetEffectiveMass(Types::NoMass()); }
    // The lanes that `mask` names.
    void Deactivate(Mask mask) { SetEffectiveMass(Types::Without(mask, effectiveMass_)); }
    Mask IsActive() const { return Types::Trace(effectiveMass_) > Real(0.0f); }

    // Applies the impulse of the step before, scaled by dt / dt of that step.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void WarmStart(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                   const InverseMass<Real>& mass2, Real dtRatio) {
        totalLambda_ = detail::Choose<Real>(IsActive(), Rows(totalLambda_ * dtRatio), Types::Zero());
        ApplyImpulse<kSide1, kSide2>(velocity1, velocity2, mass1, mass2, totalLambda_);
    }

    // One iteration. Returns where anything was applied.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolveVelocity(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2) {
        return ApplyTotalLambda<kSide1, kSide2>(velocity1, velocity2, mass1, mass2,
                                                SolveTotalLambda<kSide1, kSide2>(velocity1, velocity2));
    }
    // The same for a single row whose total impulse stays in [minLambda, maxLambda].
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolveVelocity(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2, Real minLambda, Real maxLambda) requires(kRows == 1) {
        const Real candidate = SolveTotalLambda<kSide1, kSide2>(velocity1, velocity2);
        return ApplyTotalLambda<kSide1, kSide2>(velocity1, velocity2, mass1, mass2,
                                                Clamp(candidate, minLambda, maxLambda));
    }

    // One position pass: moves the bodies (displacement since the start of the step) by -K^-1 baumgarte C along J. The
    // softness is left out; springs have no business here, because their error is their force.
    // error: C as the poses are now; zero where it is satisfied.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolvePosition(Twist<Real>& displacement1, Twist<Real>& displacement2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2, const Rows& error, Real baumgarte) const {
        const Rows lambda = effectiveMass_ * Rows(error * -baumgarte);
        return ApplyImpulse<kSide1, kSide2>(displacement1, displacement2, mass1, mass2, lambda);
    }

    // N s or N m s.
    const Rows& GetTotalLambda() const { return totalLambda_; }
    void SetTotalLambda(const Rows& totalLambda) { totalLambda_ = totalLambda; }
    // K^-1 without the softness; zero where inactive. kg or kg m2.
    const Symmetric& GetEffectiveMass() const { return effectiveMass_; }

    State SaveState() const { return {totalLambda_}; }
    void RestoreState(const State& state) { totalLambda_ = state.totalLambda; }

protected:
    // Leaves the total impulse for the warm start, but zero where the block is inactive.
    void SetRows(const Symmetric& inverseEffectiveMass, const Rows& bias, const RowSoftness<Real>& softness) {
        bias_ = bias;
        softness_ = softness;
        SetEffectiveMass(SymmetricInverse(inverseEffectiveMass));
    }

private:
    const Part& Self() const { return static_cast<const Part&>(*this); }

    // The total impulse after a solve without limits.
    template <BodySide kSide1, BodySide kSide2>
    Rows SolveTotalLambda(const Twist<Real>& velocity1, const Twist<Real>& velocity2) const {
        const Rows miss = Self().template RelativeMotion<kSide1, kSide2>(velocity1, velocity2) + bias_;
        const Rows impulse = effectiveMass_ * Rows(miss * softness_.massScale);
        return totalLambda_ - (impulse + totalLambda_ * softness_.impulseScale);
    }

    template <BodySide kSide1, BodySide kSide2>
    Mask ApplyTotalLambda(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                          const InverseMass<Real>& mass2, const Rows& totalLambda) {
        const Rows deltaLambda = detail::Choose<Real>(IsActive(), Rows(totalLambda - totalLambda_), Types::Zero());
        const Mask applied = ApplyImpulse<kSide1, kSide2>(velocity1, velocity2, mass1, mass2, deltaLambda);
        totalLambda_ = detail::Choose<Real>(applied, totalLambda, totalLambda_);
        return applied;
    }

    // Adds M^-1 J^T lambda where lambda is not zero; NaN counts as zero, so that one bad constraint spoils no body.
    template <BodySide kSide1, BodySide kSide2>
    Mask ApplyImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                      const InverseMass<Real>& mass2, const Rows& lambda) const {
        const Mask applied = Types::Size(lambda) > Real(0.0f);
        Self().template AddImpulse<kSide1, kSide2>(motion1, motion2, mass1, mass2, lambda, applied);
        return applied;
    }

    void SetEffectiveMass(const Symmetric& effectiveMass) {
        effectiveMass_ = effectiveMass;
        totalLambda_ = detail::Choose<Real>(IsActive(), totalLambda_, Types::Zero());
    }

    Symmetric effectiveMass_ = Types::NoMass();
    Rows bias_ = Types::Zero();
    Rows totalLambda_ = Types::Zero();
    RowSoftness<Real> softness_;
};

}  // namespace fulcrum
