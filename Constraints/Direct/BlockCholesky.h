// Cholesky factorization of a sparse symmetric matrix of 6x6 blocks, H = L L^T, and the solution of H x = b. Called by
// DirectSolver.cpp. Free functions; all memory is the caller's, in the order of the pattern's places and blocks.
//
// A column takes the products of the earlier columns that have a block in its row, by ascending column (left-looking).
// Nobody else writes to it, so disjoint subtrees of the elimination may be factored by different threads with the same
// bits.
// Source: T. A. Davis, "Direct Methods for Sparse Linear Systems", SIAM 2006, chapter 4.
#pragma once

#include <Fulcrum/Constraints/Direct/Block6.h>
#include <Fulcrum/Constraints/Direct/DirectPattern.h>

#include <span>

namespace fulcrum {

// The lower triangle of a matrix, or of its factor.
struct BlockMatrix {
    std::span<Block6> diagonal;  // by place
    std::span<Block6> lower;     // by block of the pattern
};
BlockMatrix MakeBlockMatrix(const DirectPattern& pattern, ScratchArena& scratch);

// Replaces the matrix by its factor. False if it is not positive definite, or not finite. `blockOfRow`: a word for each
// body, to work with.
bool Factorize(const DirectPattern& pattern, const BlockMatrix& matrix, std::span<uint32_t> blockOfRow);

// Replaces x, by place, by H^-1 x.
void SolveFactored(const DirectPattern& pattern, const BlockMatrix& factor, std::span<Column6> x);

}  // namespace fulcrum
