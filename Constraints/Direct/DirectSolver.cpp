#include <Fulcrum/Constraints/Direct/DirectSolver.h>

#include <Fulcrum/Constraints/Direct/InteriorPoint.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// A chord step after which the next would not be that much shorter is taken back: from there a new factor needs fewer
// operations. Lengths of steps, not gradients: those are large wherever a stiff row is a little off.
constexpr double kChordGain = 4;
// The next constants only balance the two methods: halved or doubled, each leaves the mean of factorizations of
// DirectImpactTest's heaps, 29, between 27 and 34, and at most one of the 24 unsolved.
// So many of Newton's steps find the solution, or the next is the interior point method's.
constexpr uint32_t kNewtonSteps = 8;
// That method begins with impulses and multipliers of this many times the usual speed, and ends where the residual is
// that part of it: rows are at the right limits then, and Newton's steps end at once. More than that it rarely takes.
constexpr double kInteriorSpeed = 10, kInteriorEnd = 0.5;
constexpr uint32_t kInteriorSteps = 40;
// A step aims at products that are smaller by the cube of what a step to the limits leaves of them, at least by this.
constexpr double kLeastCentering = 1e-4;

double SquareOf(std::span<const Column6> step) {
    double sum = 0;
    for (const Column6& column : step) sum += Dot(column, column);
    return sum;
}
void AddTo(std::span<Column6> y, std::span<const Column6> step, double factor) {
    for (size_t i = 0; i < y.size(); ++i) (Lanes6(y[i]) + Lanes6(step[i]) * factor).StoreTo(y[i]);
}

// Newton's step, by this factor, from where the model was evaluated last.
void FindStep(const DirectModel& model, const DirectPattern& pattern, const DirectFactor& factor,
              std::span<Column6> step) {
    for (size_t i = 0; i < step.size(); ++i) (Lanes6::Zero() - Lanes6(model.Gradient()[i])).StoreTo(step[i]);
    SolveFactored(pattern, factor.matrix, step);
}

// Everything that a search changes.
struct Search {
    DirectModel& model;
    const DirectPattern& pattern;
    DirectFactor& factor;
    std::span<Column6> y, step;  // one more than bodies: what is none of them stays at 0
    std::span<uint32_t> blockOfRow;
    DirectResult& result;

    // Of the matrix as it was assembled.
    bool Factor() {
        factor.isValid = Factorize(pattern, factor.matrix, blockOfRow);
        result.factorizations += factor.isValid;
        return factor.isValid;
    }
    void FindStep() { fulcrum::FindStep(model, pattern, factor, step.first(pattern.Bodies())); }
};

// Brings y so near to the solution that Newton's steps find it. Limits of friction are then those of the normal
// impulses there, and the model is evaluated. False if a factor cannot be made.
bool ApproachInside(Search& search, const DirectSettings& settings, ScratchArena& scratch) {
    DirectModel& model = search.model;
    const BlockMatrix& matrix = search.factor.matrix;
    std::ranges::fill(search.y, Column6{});
    InteriorPoint inside(model, scratch);
    inside.AssembleSoft(matrix, search.y);
    if (!search.Factor()) return false;
    search.FindStep();
    std::ranges::copy(search.step, search.y.begin());
    search.result.residual = model.Evaluate(search.y);
    inside.Begin(search.y, kInteriorSpeed * settings.speed);
    for (uint32_t i = 0; i < kInteriorSteps && search.result.factorizations < settings.mostFactorizations; ++i) {
        inside.Assemble(matrix);
        if (!search.Factor()) return false;
        const double mu = inside.MeanProduct(0);
        if (!(mu > 0)) return true;
        inside.Aim(search.y, 0, InteriorPoint::Order::First);
        search.FindStep();
        inside.FindChanges(search.step);
        const double left = std::min(inside.MeanProduct(inside.LargestPart()) / mu, 1.0);
        inside.Aim(search.y, std::max(left * left * left, kLeastCentering) * mu, InteriorPoint::Order::Second);
        search.FindStep();
        inside.FindChanges(search.step);
        inside.Advance(search.y, search.step, inside.LargestPart());
        search.result.residual = model.Evaluate(search.y);
        if (search.result.residual < kInteriorEnd * settings.speed) break;
    }
    return true;
}

}  // namespace

DirectResult SolveDirectly(const DirectProblem& problem, const DirectPattern& pattern, const DirectSettings& settings,
                           DirectFactor& factor, std::span<DirectVelocity> velocities, ScratchArena& scratch) {
    using Outcome = DirectResult::Outcome;
    DirectResult result;
    DirectModel model(problem, pattern, settings.tolerance, scratch);
    if (!model.IsCovered()) {
        result.outcome = Outcome::OutsidePattern;
        return result;
    }
    const uint32_t bodies = pattern.Bodies();
    const std::span<Column6> y = scratch.Allocate<Column6>(bodies + 1), step = scratch.Allocate<Column6>(bodies + 1),
                             before = scratch.Allocate<Column6>(bodies + 1);
    Search search{model, pattern, factor, y, step, scratch.Allocate<uint32_t>(bodies), result};
    step.back() = {};
    model.Start(y);
    y.back() = {};

    // What rests has the last impulses but for their rounding.
    if (!factor.isValid && model.HasLast()) {
        model.TrustLast(true);
        model.Evaluate(y);
        model.Assemble(factor.matrix, false);
        if (!search.Factor()) return result;
        search.FindStep();
        AddTo(y, step, 1);
        model.TrustLast(false);
    }
    bool mayChord = factor.isValid, isMarginRight = true, wasInside = false;
    double chord = 0;          // squared length of the last step, if that was a chord step; else 0
    uint32_t newtonSteps = 0;  // of this pass
    result.residual = model.Evaluate(y);
    for (result.passes = 1;;) {
        if (!(result.residual < std::numeric_limits<double>::infinity())) return result;
        if (result.residual <= settings.tolerance) {
            model.RenewLimits();
            const double residual = model.Evaluate(y);
            result.limitsAgree = residual <= std::max(settings.limitTolerance, settings.tolerance);
            if (result.limitsAgree || result.passes == settings.mostPasses) {
                if (residual <= settings.tolerance) {
                    result.residual = residual;
                } else {
                    model.RestoreLimits();
                    model.Evaluate(y);
                }
                model.Store(y, velocities, problem.rows);
                result.outcome = Outcome::Solved;
                return result;
            }
            ++result.passes;
            newtonSteps = 0;
            chord = 0;
        }
        if (mayChord) {
            search.FindStep();
            const double next = SquareOf(step);
            if (chord == 0 || kChordGain * kChordGain * next <= chord) {
                std::copy(y.begin(), y.end(), before.begin());
                AddTo(y, step, 1);
                chord = next;
                ++result.chordSteps;
                result.residual = model.Evaluate(y);
                continue;
            }
            std::copy(before.begin(), before.end(), y.begin());
            model.Evaluate(y);
        }
        if (result.factorizations >= settings.mostFactorizations) {
            result.outcome = Outcome::Capped;
            return result;
        }
        if (newtonSteps == kNewtonSteps && !wasInside) {
            wasInside = true;
            if (!ApproachInside(search, settings, scratch)) return result;
            mayChord = false;
            chord = 0;
            continue;
        }
        model.Assemble(factor.matrix, isMarginRight);
        if (!search.Factor()) return result;
        ++newtonSteps;
        search.FindStep();
        const double along = model.SearchAlong(y, step);
        AddTo(y, step, along);
        // A step that is cut short ends where H changes. One that is lengthened has met more resistance in H than there
        // is.
        mayChord = along == 1;
        if (along > 1) isMarginRight = false;
        chord = 0;
        result.residual = model.Evaluate(y);
    }
}

bool StepDirectly(const DirectProblem& problem, const DirectPattern& pattern, DirectFactor& factor,
                  std::span<DirectVelocity> velocities, ScratchArena& scratch) {
    DirectModel model(problem, pattern, 0, scratch);
    if (!model.IsCovered()) return false;
    const uint32_t bodies = pattern.Bodies();
    const std::span<Column6> y = scratch.Allocate<Column6>(bodies + 1), step = scratch.Allocate<Column6>(bodies);
    model.Start(y);
    y.back() = {};
    model.Evaluate(y);
    if (!factor.isValid) {
        model.Assemble(factor.matrix, false);
        factor.isValid = Factorize(pattern, factor.matrix, scratch.Allocate<uint32_t>(bodies));
        if (!factor.isValid) return false;
    }
    FindStep(model, pattern, factor, step);
    AddTo(y.first(bodies), step, 1);
    model.Store(y, velocities, problem.rows);
    return true;
}

}  // namespace fulcrum
