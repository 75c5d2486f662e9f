#include <Fulcrum/Constraints/Direct/BlockCholesky.h>

#include <cmath>

namespace fulcrum {

namespace {

bool FactorizeDiagonal(Block6& block) {
    for (int c = 0; c < 6; ++c) {
        const double pivot = block.columns[c][c];
        if (!(pivot > 0)) return false;
        const double inverse = 1 / std::sqrt(pivot);
        const Lanes6 column = Lanes6(block.columns[c]) * inverse;
        column.StoreTo(block.columns[c]);
        for (int k = c + 1; k < 6; ++k)
            (Lanes6(block.columns[k]) - column * block.columns[c][k]).StoreTo(block.columns[k]);
        block.columns[c][c] = inverse;
    }
    return true;
}

// block := block L^-T
void DivideByTransposed(Block6& block, const Block6& diagonal) {
    Lanes6 columns[6];
    for (int c = 0; c < 6; ++c) {
        Lanes6 sum(block.columns[c]);
        for (int k = 0; k < c; ++k) sum = sum - columns[k] * diagonal.columns[k][c];
        columns[c] = sum * diagonal.columns[c][c];
        columns[c].StoreTo(block.columns[c]);
    }
}

}  // namespace

BlockMatrix MakeBlockMatrix(const DirectPattern& pattern, ScratchArena& scratch) {
    return {scratch.Allocate<Block6>(pattern.Bodies()), scratch.Allocate<Block6>(pattern.Blocks())};
}

bool Factorize(const DirectPattern& pattern, const BlockMatrix& matrix, std::span<uint32_t> blockOfRow) {
    const uint32_t *columns = pattern.Columns(), *rowOf = pattern.RowOf(), *rows = pattern.Rows(),
                   *blockOf = pattern.BlockOf(), *columnOf = pattern.ColumnOf();
    Block6* lower = matrix.lower.data();
    for (uint32_t j = 0; j < pattern.Bodies(); ++j) {
        Block6& diagonal = matrix.diagonal[j];
        for (uint32_t i = columns[j]; i < columns[j + 1]; ++i) blockOfRow[rowOf[i]] = i;
        for (uint32_t item = rows[j]; item < rows[j + 1]; ++item) {
            const uint32_t own = blockOf[item], end = columns[columnOf[item] + 1];
            SubtractProduct(diagonal, lower[own], lower[own]);
            // What is below in that column is below in this one, too.
            for (uint32_t i = own + 1; i < end; ++i) SubtractProduct(lower[blockOfRow[rowOf[i]]], lower[i], lower[own]);
        }
        if (!FactorizeDiagonal(diagonal)) return false;
        for (uint32_t i = columns[j]; i < columns[j + 1]; ++i) DivideByTransposed(lower[i], diagonal);
    }
    return true;
}

void SolveFactored(const DirectPattern& pattern, const BlockMatrix& factor, std::span<Column6> x) {
    const uint32_t *columns = pattern.Columns(), *rowOf = pattern.RowOf();
    const Block6* lower = factor.lower.data();
    for (uint32_t j = 0; j < pattern.Bodies(); ++j) {
        const Block6& diagonal = factor.diagonal[j];
        Column6& own = x[j];
        for (int c = 0; c < 6; ++c) {
            own[c] *= diagonal.columns[c][c];
            for (int r = c + 1; r < 6; ++r) own[r] -= diagonal.columns[c][r] * own[c];
        }
        for (uint32_t i = columns[j]; i < columns[j + 1]; ++i) {
            Lanes6 sum(x[rowOf[i]]);
            for (int c = 0; c < 6; ++c) sum = sum - Lanes6(lower[i].columns[c]) * own[c];
            sum.StoreTo(x[rowOf[i]]);
        }
    }
    for (uint32_t j = pattern.Bodies(); j-- > 0;) {
        const Block6& diagonal = factor.diagonal[j];
        Column6& own = x[j];
        for (uint32_t i = columns[j]; i < columns[j + 1]; ++i)
            for (int c = 0; c < 6; ++c) own[c] -= Dot(lower[i].columns[c], x[rowOf[i]]);
        for (int c = 6; c-- > 0;) {
            for (int r = c + 1; r < 6; ++r) own[c] -= diagonal.columns[c][r] * own[r];
            own[c] *= diagonal.columns[c][c];
        }
    }
}

}  // namespace fulcrum
