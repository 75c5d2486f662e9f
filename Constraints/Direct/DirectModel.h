// The direct solver's function of the velocities (DirectProblem.h), in coordinates in which every body has the mass 1:
// value by value what a Newton step needs. Used by DirectSolver.cpp alone.
//
// With M^-1 = S S^T, S lower triangular, v = v* + S y. Then (v - v*)^T M (v - v*) = y^T y, and Jacobians become J S. A
// direction in which a body cannot move has a zero column in S: no row moves it, and the matrix has 1 there. It is
// eliminated, not heavy, and no mass is ever inverted. An unbalanced impulse over the mass is the gradient times the
// square root of the inverse mass.
#pragma once

#include <Fulcrum/Constraints/Direct/BlockCholesky.h>
#include <Fulcrum/Constraints/Direct/DirectProblem.h>
#include <Fulcrum/Constraints/Direct/DirectSolver.h>

namespace fulcrum {

// J^T D J of a few rows of the same bodies, which are added to H block by block.
class DirectProducts {
public:
    bool IsFull() const { return count_ == kMost; }
    void Add(const Column6& a, const Column6& b, double d) {
        a_[count_] = a;
        b_[count_] = b;
        (Lanes6(a) * d).StoreTo(weightedA_[count_]);
        (Lanes6(b) * d).StoreTo(weightedB_[count_++]);
    }
    // Null: there is no such block. Empties itself.
    void AddTo(Block6* ofA, Block6* ofB, Block6* ofBoth, bool isAFirst) {
        if (ofA) AddProducts(*ofA, weightedA_, a_, count_);
        if (ofB) AddProducts(*ofB, weightedB_, b_, count_);
        if (ofBoth) AddProducts(*ofBoth, isAFirst ? weightedB_ : weightedA_, isAFirst ? a_ : b_, count_);
        count_ = 0;
    }

private:
    static constexpr int kMost = 8;
    int count_ = 0;
    Column6 a_[kMost], b_[kMost], weightedA_[kMost], weightedB_[kMost];
};

class DirectModel {
public:
    // Arrays of columns are by place, with one more for what is none of the bodies.
    DirectModel(const DirectProblem& problem, const DirectPattern& pattern, double margin, ScratchArena& scratch);
    // False: a row has no place in the pattern.
    bool IsCovered() const { return isCovered_; }

    // The change of velocity by the last impulses.
    void Start(std::span<Column6> y) const;
    // Whether rows are at their limits, here and there, as the last impulses say, instead of the velocities. Where
    // little has changed those tell better: a stiff row's impulse changes with its velocity as much as with a rounding
    // of it.
    void TrustLast(bool trusts) { trustsLast_ = trusts; }
    bool HasLast() const;  // whether some limited row has an impulse

    // Velocities of the rows, impulses and gradient at y. Returns the residual, m/s.
    double Evaluate(std::span<const Column6> y);
    std::span<const Column6> Gradient() const { return gradient_; }
    // H at what was evaluated last. With the margin: also of one-sided rows that separate by less than it.
    void Assemble(const BlockMatrix& matrix, bool withMargin) const;
    // The factor of the step at which the function is least along it, beginning with what was evaluated last.
    double SearchAlong(std::span<const Column6> y, std::span<const Column6> step);

    // Limits of friction by the normal impulses that were evaluated last, and back to those before.
    void RenewLimits();
    void RestoreLimits();

    void Store(std::span<const Column6> y, std::span<DirectVelocity> velocities, std::span<DirectRow> rows) const;

private:
    friend class InteriorPoint;

    struct Body {
        double linear[3], angular[6];  // S: diagonal; lower triangle by rows
        double velocity[6];            // v*
        double residualScale;          // sqrt(1 / kg)
        // G in these coordinates, and its force at v*; of the rotation.
        double stiffness[6], force[3];
    };
    struct Jacobian {
        Column6 a, b;
    };
    struct Row {
        double c, d, lo, hi;      // d: 1 / gamma, 0 in tangent rows
        double speed, stepSpeed;  // at y, and of the step
        double impulse;
        double margin;    // impulse beyond the limits that counts as within
        double last;      // impulse before
        bool wasLimited;  // and whether it was at a limit
    };
    struct Patch {
        uint32_t firstNormal, tangent;  // rows; the second tangent and twist follow
        uint32_t run;
        double friction, twistRadius;
        double d;                   // of the tangents
        double limit, limitBefore;  // N s
        bool wasSliding;            // by the last impulses
    };
    // Consecutive rows of the same bodies.
    struct Run {
        uint32_t begin, end;
        uint32_t a, b;   // places
        uint32_t block;  // of the pattern, kNone: of one body
        bool isAFirst;   // the block is in the column of A
    };

    struct Slope {
        double value, change;  // change: its derivative
    };

    void SetLimit(Patch& patch, double limit);
    // Speeds at y, and changes of speed by a step.
    void FindSpeeds(std::span<const Column6> y);
    void FindStepSpeeds(std::span<const Column6> step);
    // The part of H, and of the gradient at y, by masses and stiffness.
    void AssembleMasses(const BlockMatrix& matrix) const;
    void FindGradientOfMasses(std::span<const Column6> y);
    // Adds what was collected, of rows of a run.
    void AddToMatrix(DirectProducts& products, const Run& run, const BlockMatrix& matrix) const;
    Slope SlopeAt(double factor, double start, double quadratic) const;

    const DirectPattern& pattern_;
    bool isCovered_ = true, hasStiffness_ = false, trustsLast_ = false;
    std::span<Body> bodies_;  // by place
    std::span<Jacobian> jacobians_;
    std::span<Row> rows_;
    std::span<Patch> patches_;
    std::span<Run> runs_;
    std::span<Column6> gradient_;
};

}  // namespace fulcrum
