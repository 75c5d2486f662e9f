// A primal-dual interior point method for the direct solver's function, for where Newton's steps end at one kink after
// another: impacts of many bodies, whose rows and friction change between their limits and the range between them. Used
// by DirectSolver.cpp alone.
//
// The impulse l of a row with limits, and a multiplier of each limit, are variables:
//     J v + c + gamma l - low + high = 0,    low (l - lo) = mu,    high (hi - l) = mu
// and of a patch, whose tangents' impulse f is in a disc of radius L,
//     J v + c + gamma f + (multiplier / L) f = 0,    multiplier (L^2 - f^2) / (2 L) = mu
// All stay inside their limits while mu goes to 0. A step costs one factorization, of the same pattern, and two
// solutions: the first finds how far mu may fall, the second aims there, to second order. Limits of friction follow the
// normal impulses from step to step, so that in the end they agree.
// Sources: S. Mehrotra, "On the Implementation of a Primal-Dual Interior Point Method", SIAM Journal on Optimization 2,
// 1992; J. Nocedal and S. J. Wright, "Numerical Optimization", Springer 2006, chapter 19.
#pragma once

#include <Fulcrum/Constraints/Direct/DirectModel.h>

namespace fulcrum {

class InteriorPoint {
public:
    InteriorPoint(DirectModel& model, ScratchArena& scratch);

    // For the beginning: H and gradient with every row as soft as its bodies are light. y: 0.
    void AssembleSoft(const BlockMatrix& matrix, std::span<const Column6> y);
    // After the step from there, at which y is and the model was evaluated: impulses and multipliers of that size,
    // inside their limits. speed: m/s, of the least of them.
    void Begin(std::span<const Column6> y, double speed);

    // H where the model was evaluated last. Limits of friction are renewed.
    void Assemble(const BlockMatrix& matrix);
    // Sets the gradient for a step towards products mu, J: to first order, or to second by the changes found last.
    enum class Order { First, Second };
    void Aim(std::span<const Column6> y, double mu, Order order);
    // The changes of all variables by the step.
    void FindChanges(std::span<const Column6> step);
    // The part of the step that leaves all inside, at most 1.
    double LargestPart() const;
    // J, mean of the products, after a part of the step.
    double MeanProduct(double part) const;
    void Advance(std::span<Column6> y, std::span<const Column6> step, double part);

private:
    using Row = DirectModel::Row;
    using Patch = DirectModel::Patch;
    // A limit: 0 where there is none. `aim` is that of the product.
    struct Multiplier {
        double value, change, aim;
    };
    struct Limited {
        bool hasLow, hasHigh;
        double impulse, change;
        Multiplier low, high;
        // By the linearized equations the impulse is `target` - weight J step.
        double weight, target;
        double response;  // 1/kg: J M^-1 J^T
    };
    struct Disc {
        bool isUsed;
        Multiplier multiplier;
        double room, change, curvature;  // (L^2 - f^2) / (2 L), and its change: change part - curvature part^2
        double xx, xy, yy;               // weight of the tangents
    };

    void SetGradient(std::span<const Column6> y);
    void AddWeighted(const BlockMatrix& matrix) const;
    void AddDiscs(const BlockMatrix& matrix) const;

    DirectModel& model_;
    std::span<Limited> rows_;  // by row; also those of tangents, whose weights are in `discs_`
    std::span<Disc> discs_;    // by patch
};

}  // namespace fulcrum
