// Where the blocks of the Cholesky factor of an island's matrix are, and what a factorization costs, before one is
// made. Called where an island is found or its constraints have changed; DirectSolver.h and BlockCholesky.h read it for
// as long as every pair of bodies with a row in common is among its edges. Free functions, no state.
//
// The matrix has a 6x6 block for each body and each pair of bodies with a row in common. Eliminating a body connects
// all of its neighbors to each other. Each time the body with the fewest is taken, the one with the smallest index
// among equals: chains and trees then need no block that the matrix does not have. Source: A. George and J. W. H. Liu,
// "The Evolution of the Minimum Degree Ordering Algorithm", SIAM Review 31, 1989.
#pragma once

#include <Fulcrum/Jobs/ScratchArena.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace fulcrum {

// Two different bodies with a row in common.
struct DirectEdge {
    uint32_t a, b;
};

// Of a factorization.
struct DirectCost {
    double flops = 0;   // operations
    double blocks = 0;  // of the factor, those of the diagonal included
};

// Places are positions in the order of elimination. All arrays are parts of `words`: whoever keeps a pattern for longer
// than its arena copies these.
class DirectPattern {
public:
    DirectPattern() = default;
    DirectPattern(uint32_t bodies, uint32_t blocks, const DirectCost& cost, std::span<const uint32_t> words)
        : bodies_(bodies), blocks_(blocks), cost_(cost), words_(words) {}
    DirectPattern WithWords(std::span<const uint32_t> words) const { return {bodies_, blocks_, cost_, words}; }
    static size_t WordsOf(uint32_t bodies, uint32_t blocks) {
        return 3 * static_cast<size_t>(bodies) + 2 + 3 * static_cast<size_t>(blocks);
    }

    uint32_t Bodies() const { return bodies_; }
    uint32_t Blocks() const { return blocks_; }  // below the diagonal
    const DirectCost& Cost() const { return cost_; }
    std::span<const uint32_t> Words() const { return words_; }

    // By body.
    uint32_t PlaceOf(uint32_t body) const { return words_[body]; }
    // By place, and one more: the first block of a column. RowOf: by block, the place of its row; ascending in a
    // column, and later than the column's.
    const uint32_t* Columns() const { return At(0); }
    const uint32_t* RowOf() const { return At(2 * size_t{bodies_} + 2); }
    // By place, and one more: the first item of a row. Items: the row's blocks, by ascending column, and these columns.
    const uint32_t* Rows() const { return At(size_t{bodies_} + 1); }
    const uint32_t* BlockOf() const { return At(2 * size_t{bodies_} + 2 + blocks_); }
    const uint32_t* ColumnOf() const { return At(2 * size_t{bodies_} + 2 + 2 * size_t{blocks_}); }

    // The block of two places; kNone: there is none.
    static constexpr uint32_t kNone = ~0u;
    uint32_t BlockAt(uint32_t placeA, uint32_t placeB) const;

private:
    const uint32_t* At(size_t word) const { return words_.data() + bodies_ + word; }

    uint32_t bodies_ = 0, blocks_ = 0;
    DirectCost cost_;
    std::span<const uint32_t> words_;
};

// Edges in any order, each any number of times. Nothing if the cost exceeds `mostPerBody` times the number of bodies,
// which shows early. The result is in memory of the arena.
std::optional<DirectPattern> FindDirectPattern(
    uint32_t bodies, std::span<const DirectEdge> edges, ScratchArena& scratch,
    const DirectCost& mostPerBody = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()});

}  // namespace fulcrum
