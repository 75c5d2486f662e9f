// Solves an island's constraints at once, by Newton's method with a sparse factorization, where iterations over single
// constraints converge slowly: high mass ratios, long chains, closed loops, tall stacks. Called by the Solve stage, one
// thread per island; all memory is the caller's.
//
// The function (DirectProblem.h) is convex, and quadratic where no row changes between its limits and the range between
// them. A step is H^-1 times the gradient, as far as an exact line search says. Where an old factor of H still makes
// the steps fall by kChordGain or more, no new one is made (chord steps). Where many rows change, an interior point
// method (InteriorPoint.h) brings the search near the solution first.
//
// Friction is limited by the normal impulses, which is no convex function. Passes with fixed limits, each with those
// that the one before has found, agree after a few. Sources: J. Nocedal and S. J. Wright, "Numerical Optimization",
// Springer 2006, chapter 3; C. T. Kelley, "Iterative Methods for Linear and Nonlinear Equations", SIAM 1995, chapter 5
// (chord steps).
#pragma once

#include <Fulcrum/Constraints/Direct/BlockCholesky.h>
#include <Fulcrum/Constraints/Direct/DirectProblem.h>

namespace fulcrum {

// The last factor. It may be used again for as long as the pattern is the same, after steps too.
struct DirectFactor {
    BlockMatrix matrix;  // of the pattern's size
    bool isValid = false;
};
inline DirectFactor MakeDirectFactor(const DirectPattern& pattern, ScratchArena& scratch) {
    return {MakeBlockMatrix(pattern, scratch)};
}

// The pairs of bodies of the rows, for FindDirectPattern.
std::span<const DirectEdge> DirectEdgesOf(std::span<const DirectRow> rows, ScratchArena& scratch);

struct DirectVelocity {
    double v[6];
};

// Writes the velocities, by body, and the rows' impulses, unless the outcome is another than Solved: then both are as
// before. The same bits for the same input; not for bodies or rows in another order. `factor` is used and replaced.
DirectResult SolveDirectly(const DirectProblem& problem, const DirectPattern& pattern, const DirectSettings& settings,
                           DirectFactor& factor, std::span<DirectVelocity> velocities, ScratchArena& scratch);

// One chord step with the last factor, a new one only if there is none, from v* and the impulses as they are: writes
// the velocities alone. Rows are those of the factor, or some of them, with the same J: others would find no resistance
// in it. False if that is impossible.
bool StepDirectly(const DirectProblem& problem, const DirectPattern& pattern, DirectFactor& factor,
                  std::span<DirectVelocity> velocities, ScratchArena& scratch);

}  // namespace fulcrum
