// Base class of the parts with two and three rows (locks of joints): the rows are solved together as one block, hard or
// soft. A derived part adds its set-up, its Jacobian and the impulses along it. One thread per part.
//
//   K = J M^-1 J^T                       b  bias, m/s or rad/s            C  error, m or rad
//   A solve changes the impulses by delta lambda = -massScale K^-1 (J v + b) - impulseScale * total lambda and adds
//   M^-1 J^T delta lambda to the velocities; (1, 0) is the hard block, which reaches J v = -b (RowSoftness.h).
//   A position pass moves the bodies by -K^-1 baumgarte C along J.
//
// The part keeps its Jacobian; the masses are passed to every call and must be those of the set-up. A block is inactive
// if no body can move; an inactive lane changes nothing.
#pragma once

#include <Fulcrum/Constraints/Parts/PairMotion.h>
#include <Fulcrum/Constraints/Parts/RowSoftness.h>
#include <Fulcrum/Constraints/Parts/SymmetricInverse.h>

namespace fulcrum {

namespace detail {

// Vector and symmetric matrix types of two or three rows.
template <class Real, int kRows>
struct BlockTypes;
template <class Real>
struct BlockTypes<Real, 2> {
    using Rows = Vec2<Real>;
    using Symmetric = Sym2<Real>;
    static Rows Zero() { return Rows(Real(0.0f), Real(0.0f)); }
    static Symmetric NoMass() { return {}; }
    static Real Size(const Rows& a) { return Abs(a.x()) + Abs(a.y()); }
    static Real Trace(const Symmetric& k) { return k.xx + k.yy; }
};
template <class Real>
struct BlockTypes<Real, 3> {
    using Rows = Vec3<Real>;
    using Symmetric = Sym3<Real>;
    static Rows Zero() { return Rows(Real(0.0f), Real(0.0f), Real(0.0f)); }
    static Symmetric NoMass() { return {}; }
    static Real Size(const Rows& a) { return Abs(a.x()) + Abs(a.y()) + Abs(a.z()); }
    static Real Trace(const Symmetric& k) { return k.xx + k.yy + k.zz; }
};

template <class Real>
inline Vec2<Real> Choose(MaskOf<Real> mask, const Vec2<Real>& a, const Vec2<Real>& b) {
    return Vec2<Real>(Select(mask, a.x(), b.x()), Select(mask, a.y(), b.y()));
}
template <class Real>
inline Vec3<Real> Choose(MaskOf<Real> mask, const Vec3<Real>& a, const Vec3<Real>& b) {
    return Vec3<Real>(Select(mask, a.x(), b.x()), Select(mask, a.y(), b.y()), Select(mask, a.z(), b.z()));
}

}  // namespace detail

// The state of a block that is saved and restored.
template <class Real, int kRows>
struct BlockState {
    using Types = detail::BlockTypes<Real, kRows>;
    typename Types::Rows totalLambda = Types::Zero();
};

// Part derives from BlockPart<Part, Real, kRows> and has
//     Rows RelativeMotion(motion1, motion2) const                                   J times motion
//     void AddImpulse(motion1, motion2, mass1, mass2, lambda, applied) const        + M^-1 J^T lambda
// Real: float, or Wide<N> for N constraints; both give the same bits. Rows: Vec2<Real> or Vec3<Real>.
template <class Part, class Real, int kRows>
class BlockPart {
    using Types = detail::BlockTypes<Real, kRows>;

public:
    using Mask = MaskOf<Real>;
    using Vector = Vec3<Real>;
    using Rows = typename Types::Rows;
    using Symmetric = typename Types::Symmetric;
    using State = BlockState<Real, kRows>;

    // Once per substep, after the set-up. bias: b, m/s or rad/s.
    void SetBias(const Rows& bias, const RowSoftness<Real>& softness) {
        bias_ = bias;
        softness_ = softness;
    }
    const Rows& GetBias() const { return bias_; }

    Mask IsActive() const { return Types::Trace(effectiveMass_) > Real(0.0f); }

    // Applies the total impulse.
    void WarmStart(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                   const InverseMass<Real>& mass2) const {
        AddNonZero(velocity1, velocity2, mass1, mass2, totalLambda_, IsActive());
    }

    // One iteration. Returns the mask of lanes in which an impulse was applied.
    Mask SolveVelocity(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2) {
        const Rows error = Self().RelativeMotion(velocity1, velocity2) + bias_;
        const Rows impulse = effectiveMass_ * Rows(error * softness_.massScale);
        return AddLambda(velocity1, velocity2, mass1, mass2, SoftDelta(impulse, totalLambda_, softness_.impulseScale),
                         IsActive());
    }
    // The second half of SolveVelocity, for a change of the impulses that was solved together with other parts: applies
    // it in the lanes of `mask`.
    FULCRUM_FORCE_INLINE Mask AddLambda(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                                        const InverseMass<Real>& mass2, const Rows& deltaLambda, const Mask& mask) {
        const Mask applied = AddNonZero(velocity1, velocity2, mass1, mass2, deltaLambda, mask);
        totalLambda_ = detail::Choose<Real>(applied, Rows(totalLambda_ + deltaLambda), totalLambda_);
        return applied;
    }

    // One position pass: moves the bodies (displacement since the start of the step) by -K^-1 baumgarte C along J.
    // Ignores the softness; not for springs, whose error is their force. error: C at the current poses; zero where it
    // is satisfied.
    Mask SolvePosition(Twist<Real>& displacement1, Twist<Real>& displacement2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2, const Rows& error, Real baumgarte) const {
        const Rows lambda = effectiveMass_ * Rows(error * -baumgarte);
        return AddNonZero(displacement1, displacement2, mass1, mass2, lambda, IsActive());
    }

    // N s or N m s.
    const Rows& GetTotalLambda() const { return totalLambda_; }
    void SetTotalLambda(const Rows& totalLambda) { totalLambda_ = totalLambda; }
    // K^-1 without the softness; zero if inactive. kg or kg m2.
    const Symmetric& GetEffectiveMass() const { return effectiveMass_; }

    // In place of that of the set-up, once per substep after it: for a generalized or damped inverse of K.
    void SetEffectiveMass(const Symmetric& effectiveMass) { effectiveMass_ = effectiveMass; }

    State SaveState() const { return {totalLambda_}; }
    void RestoreState(const State& state) { totalLambda_ = state.totalLambda; }

protected:
    // Takes K. The block is hard and without bias until SetBias. Keeps the total impulse for the warm start, but sets
    // it to zero if the block is inactive.
    void SetInverseEffectiveMass(const Symmetric& inverseEffectiveMass) {
        bias_ = Types::Zero();
        softness_ = {};
        effectiveMass_ = SymmetricInverse(inverseEffectiveMass);
        totalLambda_ = detail::Choose<Real>(IsActive(), totalLambda_, Types::Zero());
    }

private:
    const Part& Self() const { return static_cast<const Part&>(*this); }

    // Adds M^-1 J^T lambda in the lanes of `mask` with a lambda other than zero; NaN counts as zero, so that one bad
    // constraint cannot spread NaN to bodies. Returns these lanes.
    FULCRUM_FORCE_INLINE Mask AddNonZero(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                                         const InverseMass<Real>& mass2, const Rows& lambda, const Mask& mask) const {
        const Mask applied = (Types::Size(lambda) > Real(0.0f)) & mask;
        Self().AddImpulse(motion1, motion2, mass1, mass2, lambda, applied);
        return applied;
    }

    Symmetric effectiveMass_ = Types::NoMass();
    Rows bias_ = Types::Zero();
    Rows totalLambda_ = Types::Zero();
    RowSoftness<Real> softness_;
};

}  // namespace fulcrum
