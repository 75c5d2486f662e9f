// Factor and solution of sparse matrices of blocks against Eigen's dense ones.
#include "DirectGraphs.h"

#include <Fulcrum/Constraints/Direct/BlockCholesky.h>

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <limits>

namespace fulcrum {
namespace {

// I + sum over edges of w J^T J with J random and w up to `stiffest`, in the places of the pattern.
struct RandomMatrix {
    RandomMatrix(const DirectPattern& pattern, const DirectEdges& edges, double stiffest, uint32_t seed)
        : dense(Eigen::MatrixXd::Identity(6 * pattern.Bodies(), 6 * pattern.Bodies())) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (const DirectEdge& edge : edges) {
            Eigen::VectorXd row = Eigen::VectorXd::Zero(dense.rows());
            for (int k = 0; k < 6; ++k) {
                row[6 * pattern.PlaceOf(edge.a) + k] = uniform(random);
                row[6 * pattern.PlaceOf(edge.b) + k] = uniform(random);
            }
            dense += stiffest * std::abs(uniform(random)) * row * row.transpose();
        }
    }
    void CopyTo(const DirectPattern& pattern, const BlockMatrix& matrix) const {
        const auto copy = [&](Block6& block, uint32_t row, uint32_t column) {
            for (int c = 0; c < 6; ++c)
                for (int r = 0; r < 6; ++r) block.columns[c][r] = dense(6 * row + r, 6 * column + c);
        };
        for (uint32_t j = 0; j < pattern.Bodies(); ++j) {
            copy(matrix.diagonal[j], j, j);
            for (uint32_t i = pattern.Columns()[j]; i < pattern.Columns()[j + 1]; ++i)
                copy(matrix.lower[i], pattern.RowOf()[i], j);
        }
    }
    Eigen::MatrixXd dense;
};

void CheckFactorAndSolution(uint32_t bodies, const DirectEdges& edges, double stiffest, uint32_t seed) {
    ScratchArena scratch;
    const DirectPattern pattern = *FindDirectPattern(bodies, edges, scratch);
    const RandomMatrix random(pattern, edges, stiffest, seed);
    const BlockMatrix matrix = MakeBlockMatrix(pattern, scratch);
    random.CopyTo(pattern, matrix);
    ASSERT_TRUE(Factorize(pattern, matrix, scratch.Allocate<uint32_t>(bodies)));

    // Backward error of a Cholesky factorization: n times the rounding of the largest element; times 10 for sums of
    // squares of rows.
    const double bound = 10 * 6 * bodies * 1.1e-16 * random.dense.cwiseAbs().maxCoeff();
    Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(6 * bodies, 6 * bodies);
    for (uint32_t j = 0; j < bodies; ++j)
        for (int c = 0; c < 6; ++c) {
            for (int r = c; r < 6; ++r)
                factor(6 * j + r, 6 * j + c) =
                    r == c ? 1 / matrix.diagonal[j].columns[c][c] : matrix.diagonal[j].columns[c][r];
            for (uint32_t i = pattern.Columns()[j]; i < pattern.Columns()[j + 1]; ++i)
                for (int r = 0; r < 6; ++r)
                    factor(6 * pattern.RowOf()[i] + r, 6 * j + c) = matrix.lower[i].columns[c][r];
        }
    EXPECT_LT((factor * factor.transpose() - random.dense).cwiseAbs().maxCoeff(), bound);

    const Eigen::VectorXd b = Eigen::VectorXd::Random(6 * bodies);
    std::vector<Column6> x(bodies);
    for (uint32_t i = 0; i < 6 * bodies; ++i) x[i / 6][static_cast<int>(i % 6)] = b[i];
    SolveFactored(pattern, matrix, x);
    const Eigen::VectorXd solution = Eigen::Map<Eigen::VectorXd>(x[0].v, 6 * bodies),
                          expected = random.dense.llt().solve(b);
    EXPECT_LT((random.dense * solution - b).cwiseAbs().maxCoeff(), bound * (1 + solution.cwiseAbs().maxCoeff()));
    if (stiffest == 1) {
        EXPECT_LT((solution - expected).norm(), 1e-12 * expected.norm());
    }
}

TEST(BlockCholesky, AgreesWithDenseFactorsOfRandomGraphs) {
    for (uint32_t seed = 0; seed < 20; ++seed) {
        const uint32_t bodies = 2 + 2 * seed;
        CheckFactorAndSolution(bodies, RandomEdges(bodies, 2 * bodies, seed), 1, seed);
        CheckFactorAndSolution(bodies, RandomEdges(bodies, 2 * bodies, seed), 1e6, seed);
    }
}

TEST(BlockCholesky, AgreesWithDenseFactorsOfGridsChainsAndTrees) {
    CheckFactorAndSolution(80, GridEdges(10, 8), 1, 1);
    CheckFactorAndSolution(80, GridEdges(10, 8), 1e6, 1);
    CheckFactorAndSolution(50, ChainEdges(50), 1, 2);
    CheckFactorAndSolution(50, TreeEdges(50, 3), 1, 3);
    CheckFactorAndSolution(7, {}, 1, 4);
}

TEST(BlockCholesky, SaysThatAMatrixIsNotPositiveDefinite) {
    ScratchArena scratch;
    const DirectEdges edges = ChainEdges(4);
    const DirectPattern pattern = *FindDirectPattern(4, edges, scratch);
    const RandomMatrix random(pattern, edges, 1, 1);
    const BlockMatrix matrix = MakeBlockMatrix(pattern, scratch);
    for (const double wrong : {-1.0, 0.0, std::numeric_limits<double>::quiet_NaN()})
        for (uint32_t body = 0; body < 4; ++body) {
            random.CopyTo(pattern, matrix);
            matrix.diagonal[body].columns[3][3] = wrong;
            EXPECT_FALSE(Factorize(pattern, matrix, scratch.Allocate<uint32_t>(4)));
        }
}

}  // namespace
}  // namespace fulcrum
