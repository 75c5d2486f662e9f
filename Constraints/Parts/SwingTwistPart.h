// Up to three rows that limit the rotation of two joint frames: a swing in an ellipse or a pyramid, a twist in a range,
// each axis locked, limited or free. Called by whoever keeps swing and twist as one part, which gathers the bodies'
// lanes before and scatters them after. One thread per part.
//
// SwingTwist.h has the limits and how errors and axes follow from them.
//   a_i   unit axis of row i in world space           C_i   its error, rad: dC_i/dt = a_i . (w2 - w1)
//   Constraint:  C_i = 0 where locked, C_i >= 0 where limited
//   Jacobian:    row i = [0, -a_i, 0, a_i]            K_i = a_i . (I1^-1 + I2^-1) a_i
//   A solve changes the row's impulse by delta lambda = -massScale K_i^-1 (J v + b_i) - impulseScale * total lambda and
//   keeps the total at 0 or above where the row is a limit. b_i = C_i biasRate; where a limit is not reached yet b_i =
//   C_i gapRate and the row is hard: with gapRate = 1 / h the limit is met at the end of the substep and not before.
// The rows are solved one after another, because each has its own limit.
#pragma once

#include <Fulcrum/Constraints/Parts/PairMotion.h>
#include <Fulcrum/Constraints/Parts/RowSoftness.h>
#include <Fulcrum/Constraints/Parts/SwingTwist.h>
#include <Fulcrum/Constraints/Parts/SymmetricInverse.h>

#include <limits>

namespace fulcrum {

// Rows 0 and 1 are of the swing, 2 is of the twist. A row that is not there has the axis zero.
template <class Real>
struct SwingTwistRows {
    static constexpr int kCount = 3;
    struct Row {
        Vec3<Real> axis = Vec3<Real>(Real(0.0f), Real(0.0f), Real(0.0f));  // world space
        Real error = Real(0.0f);                                           // rad
        Real lowest = Real(0.0f);  // N m s, of the total impulse: 0 or -infinite
    };
    std::array<Row, kCount> row;
};

// Of the limits whose error is below `reach`, rad, in frame A of this rotation in world space. Of the two ends of one
// range the nearer one.
inline SwingTwistRows<float> RowsOf(const RotationLimitList& list, const Quaternion& frameA,
                                    float reach = std::numeric_limits<float>::infinity()) {
    SwingTwistRows<float> rows;
    bool isTaken[SwingTwistRows<float>::kCount] = {};
    for (const RotationLimit& limit : list) {
        const int i = limit.slot / 2;
        if (!limit.isLocked && (!(limit.error < reach) || (isTaken[i] && limit.error >= rows.row[i].error))) continue;
        isTaken[i] = true;
        rows.row[i] = {Rotate(frameA, limit.axis), limit.error,
                       limit.isLocked ? -std::numeric_limits<float>::infinity() : 0.0f};
    }
    return rows;
}

// Puts one constraint's rows into a lane, 0 <= lane < N.
template <int N>
inline void SetLane(SwingTwistRows<Wide<N>>& lanes, int lane, const SwingTwistRows<float>& rows) {
    for (int i = 0; i < SwingTwistRows<float>::kCount; ++i) {
        for (int k = 0; k < 3; ++k) lanes.row[i].axis[k].Set(lane, rows.row[i].axis[k]);
        lanes.row[i].error.Set(lane, rows.row[i].error);
        lanes.row[i].lowest.Set(lane, rows.row[i].lowest);
    }
}

// How rows are corrected. biasRate: 1/s, >= 0; gapRate: 1/s, of limits that are not reached yet.
template <class Real>
struct SwingTwistCorrection {
    Real biasRate = Real(0.0f), gapRate = Real(0.0f);
    RowSoftness<Real> softness;
};

// What a snapshot keeps of the part.
template <class Real>
struct SwingTwistState {
    Vec3<Real> totalLambda = Vec3<Real>(Real(0.0f), Real(0.0f), Real(0.0f));
};

// Real: float, or Wide<N> for N constraints; both give the same bits.
template <class Real>
class SwingTwistPart {
public:
    using Mask = MaskOf<Real>;
    using Vector = Vec3<Real>;
    using State = SwingTwistState<Real>;
    using Rows = SwingTwistRows<Real>;
    static constexpr int kRows = Rows::kCount;

    // Once per substep. Leaves the total impulses for the warm start, but zero where a row is inactive.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void CalculateProperties(const InverseMass<Real>& mass1, const InverseMass<Real>& mass2, const Rows& rows,
                             const SwingTwistCorrection<Real>& correction) {
        const Sym3<Real> k = AngularInverseMass<kSide1, kSide2>(mass1, mass2);
        const Real zero(0.0f), one(1.0f);
        for (int i = 0; i < kRows; ++i) {
            const auto& row = rows.row[i];
            Solved& solved = rows_[i];
            const Mask isOpen = (row.error > zero) & (row.lowest >= zero);
            solved.axis = row.axis;
            solved.lowest = row.lowest;
            solved.effectiveMass = SymmetricInverse(Between(row.axis, k, row.axis));
            solved.bias = row.error * Select(isOpen, correction.gapRate, correction.biasRate);
            solved.softness.massScale = Select(isOpen, one, correction.softness.massScale);
            solved.softness.impulseScale = Select(isOpen, zero, correction.softness.impulseScale);
        }
        ForgetInactive();
    }

    void Deactivate() {
        for (Solved& row : rows_) row.effectiveMass = Real(0.0f);
        ForgetInactive();
    }
    // The lanes that `mask` names.
    void Deactivate(Mask mask) {
        for (Solved& row : rows_) row.effectiveMass = Select(mask, Real(0.0f), row.effectiveMass);
        ForgetInactive();
    }
    // Any row, or one of them.
    Mask IsActive() const {
        return rows_[0].effectiveMass + rows_[1].effectiveMass + rows_[2].effectiveMass > Real(0.0f);
    }
    Mask IsActive(int row) const { return rows_[row].effectiveMass > Real(0.0f); }

    // Applies the impulses of the step before, scaled by dt / dt of that step. A limit's is along another axis where
    // the swing has moved along the edge meanwhile; the solve makes up for that.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void WarmStart(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                   const InverseMass<Real>& mass2, Real dtRatio) {
        for (int i = 0; i < kRows; ++i) {
            totalLambda_[i] = Select(IsActive(i), totalLambda_[i] * dtRatio, Real(0.0f));
            ApplyImpulse<kSide1, kSide2>(velocity1, velocity2, mass1, mass2, rows_[i].axis, totalLambda_[i]);
        }
    }

    // One iteration. Returns where anything was applied.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolveVelocity(Twist<Real>& velocity1, Twist<Real>& velocity2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2) {
        Mask any = Real(0.0f) > Real(0.0f);
        for (int i = 0; i < kRows; ++i) {
            const Solved& row = rows_[i];
            const Real miss = RelativeMotion<kSide1, kSide2>(velocity1, velocity2, i) + row.bias;
            const Real impulse = row.effectiveMass * (miss * row.softness.massScale);
            const Real candidate = totalLambda_[i] - (impulse + totalLambda_[i] * row.softness.impulseScale);
            // NaN goes through and counts as nothing below.
            const Real totalLambda = Max(row.lowest, candidate);
            const Real deltaLambda = Select(IsActive(i), totalLambda - totalLambda_[i], Real(0.0f));
            const Mask applied =
                ApplyImpulse<kSide1, kSide2>(velocity1, velocity2, mass1, mass2, row.axis, deltaLambda);
            totalLambda_[i] = Select(applied, totalLambda, totalLambda_[i]);
            any = any | applied;
        }
        return any;
    }

    // One position pass: turns the bodies (displacement since the start of the step) by -K^-1 baumgarte C along J, of
    // limits only where they are exceeded. rows: as the poses are now. Rows that were inactive at set-up take part as
    // well, if the part is active; the softness is left out.
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Mask SolvePosition(Twist<Real>& displacement1, Twist<Real>& displacement2, const InverseMass<Real>& mass1,
                       const InverseMass<Real>& mass2, const Rows& rows, Real baumgarte) const {
        const Sym3<Real> k = AngularInverseMass<kSide1, kSide2>(mass1, mass2);
        Mask any = Real(0.0f) > Real(0.0f);
        Twist<Real> turned1, turned2;  // in this pass: the next row's error has changed by that
        for (const auto& row : rows.row) {
            const Real mass = Select(IsActive(), SymmetricInverse(Between(row.axis, k, row.axis)), Real(0.0f));
            const Vector motion = AngularMotion<kSide1, kSide2>(turned1, turned2);
            const Mask isOpen = (row.error > Real(0.0f)) & (row.lowest >= Real(0.0f));
            const Real error = Select(isOpen, row.error, baumgarte * row.error) + Dot<Real>(row.axis, motion);
            const Real lambda = Max(row.lowest, -(mass * error));
            ApplyImpulse<kSide1, kSide2>(turned1, turned2, mass1, mass2, row.axis, lambda);
            any = any | ApplyImpulse<kSide1, kSide2>(displacement1, displacement2, mass1, mass2, row.axis, lambda);
        }
        return any;
    }

    // A row's J applied to velocities (rad/s), or to displacements: the change of C to first order (rad).
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    Real RelativeMotion(const Twist<Real>& motion1, const Twist<Real>& motion2, int row) const {
        return Dot<Real>(rows_[row].axis, AngularMotion<kSide1, kSide2>(motion1, motion2));
    }

    // N m s, one per row.
    const Vector& GetTotalLambda() const { return totalLambda_; }
    void SetTotalLambda(const Vector& totalLambda) { totalLambda_ = totalLambda; }
    // Without the softness; zero where the row is inactive. kg m2.
    Real GetEffectiveMass(int row) const { return rows_[row].effectiveMass; }

    State SaveState() const { return {totalLambda_}; }
    void RestoreState(const State& state) { totalLambda_ = state.totalLambda; }

private:
    struct Solved {
        Vector axis = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
        Real lowest = Real(0.0f), effectiveMass = Real(0.0f), bias = Real(0.0f);
        RowSoftness<Real> softness;
    };

    // NaN counts as zero, so that one bad constraint spoils no body.
    template <BodySide kSide1, BodySide kSide2>
    static Mask ApplyImpulse(Twist<Real>& motion1, Twist<Real>& motion2, const InverseMass<Real>& mass1,
                             const InverseMass<Real>& mass2, const Vector& axis, Real lambda) {
        const Mask applied = Abs(lambda) > Real(0.0f);
        AddAngularImpulse<kSide1, kSide2>(motion1, motion2, mass1, mass2, Vector(axis * lambda), applied);
        return applied;
    }
    void ForgetInactive() {
        for (int i = 0; i < kRows; ++i) totalLambda_[i] = Select(IsActive(i), totalLambda_[i], Real(0.0f));
    }

    std::array<Solved, kRows> rows_;
    Vector totalLambda_ = Vector(Real(0.0f), Real(0.0f), Real(0.0f));
};

}  // namespace fulcrum
