#include <Fulcrum/Constraints/Direct/DirectSolver.h>

#include <Fulcrum/Constraints/Direct/DirectModel.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// A chord step after which the next would not be that much shorter is taken back: from there a new factor needs fewer
// operations. Lengths of steps, not gradients: those are large wherever a stiff row is a little off.
constexpr double kChordGain = 4;

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
    // One more than bodies: what is none of them stays at 0.
    const uint32_t bodies = pattern.Bodies();
    const std::span<Column6> y = scratch.Allocate<Column6>(bodies + 1), step = scratch.Allocate<Column6>(bodies + 1),
                             before = scratch.Allocate<Column6>(bodies + 1);
    const std::span<uint32_t> blockOfRow = scratch.Allocate<uint32_t>(bodies);
    step.back() = {};
    model.Start(y);
    y.back() = {};

    const auto findStep = [&] { FindStep(model, pattern, factor, step.first(bodies)); };
    bool mayChord = factor.isValid, isMarginRight = true;
    double chord = 0;  // squared length of the last step, if that was a chord step; else 0
    result.residual = model.Evaluate(y);
    for (result.passes = 1;;) {
        if (!(result.residual < std::numeric_limits<double>::infinity())) return result;
        if (result.residual <= settings.tolerance) {
            model.RenewLimits();
            const double residual = model.Evaluate(y);
            result.limitsAgree = residual <= settings.tolerance;
            if (result.limitsAgree || result.passes == settings.mostPasses) {
                if (result.limitsAgree) {
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
            chord = 0;
        }
        if (mayChord) {
            findStep();
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
        if (result.factorizations == settings.mostFactorizations) {
            result.outcome = Outcome::Capped;
            return result;
        }
        model.Assemble(factor.matrix, isMarginRight);
        factor.isValid = Factorize(pattern, factor.matrix, blockOfRow);
        if (!factor.isValid) return result;
        ++result.factorizations;
        findStep();
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
