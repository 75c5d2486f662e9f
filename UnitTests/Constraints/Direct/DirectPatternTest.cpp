// The symbolic factorization has every block that the numeric one needs, chains and trees have no fill, and what is too
// dear is refused.
#include "DirectGraphs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace fulcrum {
namespace {

// Blocks of the factor for a given order, by elimination.
std::set<std::pair<uint32_t, uint32_t>> ExpectedBlocks(const DirectPattern& pattern, const DirectEdges& edges) {
    std::set<std::pair<uint32_t, uint32_t>> blocks;  // column, row
    const auto add = [&](uint32_t a, uint32_t b) { blocks.insert(std::minmax(a, b)); };
    for (const DirectEdge& e : edges) add(pattern.PlaceOf(e.a), pattern.PlaceOf(e.b));
    for (uint32_t column = 0; column < pattern.Bodies(); ++column) {
        std::vector<uint32_t> rows;
        for (const auto& [c, row] : blocks)
            if (c == column) rows.push_back(row);
        for (size_t i = 0; i < rows.size(); ++i)
            for (size_t k = 0; k < i; ++k) add(rows[k], rows[i]);
    }
    return blocks;
}

void CheckPattern(const DirectPattern& pattern, const DirectEdges& edges) {
    std::vector<uint32_t> places;
    for (uint32_t i = 0; i < pattern.Bodies(); ++i) places.push_back(pattern.PlaceOf(i));
    std::sort(places.begin(), places.end());
    for (uint32_t i = 0; i < pattern.Bodies(); ++i) ASSERT_EQ(places[i], i);

    std::set<std::pair<uint32_t, uint32_t>> blocks, items;
    for (uint32_t column = 0; column < pattern.Bodies(); ++column)
        for (uint32_t i = pattern.Columns()[column]; i < pattern.Columns()[column + 1]; ++i) {
            const uint32_t row = pattern.RowOf()[i];
            ASSERT_GT(row, column);
            if (i > pattern.Columns()[column]) {
                ASSERT_GT(row, pattern.RowOf()[i - 1]);
            }
            blocks.insert({column, row});
            ASSERT_EQ(pattern.BlockAt(row, column), i);
            ASSERT_EQ(pattern.BlockAt(column, row), i);
        }
    ASSERT_EQ(blocks, ExpectedBlocks(pattern, edges));
    ASSERT_EQ(blocks.size(), pattern.Blocks());
    ASSERT_EQ(pattern.Cost().blocks, pattern.Blocks() + pattern.Bodies());
    for (uint32_t row = 0; row < pattern.Bodies(); ++row)
        for (uint32_t i = pattern.Rows()[row]; i < pattern.Rows()[row + 1]; ++i) {
            const uint32_t column = pattern.ColumnOf()[i];
            if (i > pattern.Rows()[row]) {
                ASSERT_GT(column, pattern.ColumnOf()[i - 1]);
            }
            ASSERT_EQ(pattern.BlockAt(row, column), pattern.BlockOf()[i]);
            items.insert({column, row});
        }
    ASSERT_EQ(items, blocks);
}

TEST(DirectPattern, HasEveryBlockOfTheFactor) {
    ScratchArena scratch;
    for (uint32_t seed = 0; seed < 50; ++seed) {
        const uint32_t bodies = 2 + seed;
        const DirectEdges edges = RandomEdges(bodies, bodies * (1 + seed % 4) / 2, seed);
        CheckPattern(*FindDirectPattern(bodies, edges, scratch), edges);
        scratch.Reset();
    }
    const DirectEdges grid = GridEdges(9, 7);
    CheckPattern(*FindDirectPattern(63, grid, scratch), grid);
}

TEST(DirectPattern, OfBodiesWithoutEdgesIsEmpty) {
    ScratchArena scratch;
    for (const uint32_t bodies : {0u, 1u, 5u}) {
        const auto pattern = FindDirectPattern(bodies, {}, scratch);
        EXPECT_EQ(pattern->Bodies(), bodies);
        EXPECT_EQ(pattern->Blocks(), 0u);
    }
}

TEST(DirectPattern, ChainsAndTreesHaveNoFill) {
    ScratchArena scratch;
    EXPECT_EQ(FindDirectPattern(1000, ChainEdges(1000), scratch)->Blocks(), 999u);
    for (uint32_t seed = 0; seed < 10; ++seed)
        EXPECT_EQ(FindDirectPattern(500, TreeEdges(500, seed), scratch)->Blocks(), 499u);
}

// Nested dissection needs 31/4 n log2 n blocks for n bodies (A. George, "Nested Dissection of a Regular Finite Element
// Mesh", 1973; for nine neighbors, so less for four), a band as wide as the grid n^1.5.
TEST(DirectPattern, GridsHaveLittleFill) {
    ScratchArena scratch;
    for (const uint32_t width : {8u, 16u, 32u, 64u}) {
        const double n = width * width;
        const auto pattern = FindDirectPattern(width * width, GridEdges(width, width), scratch);
        EXPECT_LT(pattern->Blocks(), 7.75 * n * std::log2(n));
        EXPECT_LT(pattern->Blocks(), 0.8 * std::pow(n, 1.5));
        scratch.Reset();
    }
}

// Of the last body 72 operations, of every other one also 216 for its block and 432 for the product.
TEST(DirectPattern, CostOfAChainIsExact) {
    ScratchArena scratch;
    EXPECT_EQ(FindDirectPattern(100, ChainEdges(100), scratch)->Cost().flops, 99 * (72 + 216 + 432) + 72);
}

TEST(DirectPattern, RefusesWhatIsTooDear) {
    ScratchArena scratch;
    const DirectEdges edges = GridEdges(20, 20);
    const DirectCost cost = FindDirectPattern(400, edges, scratch)->Cost();
    const DirectCost flops{cost.flops / 400, 1e9}, blocks{1e9, cost.blocks / 400};
    const auto isFound = [&](DirectCost most, double times) {
        return FindDirectPattern(400, edges, scratch, {most.flops * times, most.blocks * times}).has_value();
    };
    EXPECT_TRUE(isFound(flops, 1.001));
    EXPECT_FALSE(isFound(flops, 0.999));
    EXPECT_TRUE(isFound(blocks, 1.001));
    EXPECT_FALSE(isFound(blocks, 0.999));
}

TEST(DirectPattern, IsTheSameInCopiedWords) {
    ScratchArena scratch;
    const DirectEdges edges = RandomEdges(40, 80, 7);
    const DirectPattern pattern = *FindDirectPattern(40, edges, scratch);
    EXPECT_EQ(pattern.Words().size(), DirectPattern::WordsOf(pattern.Bodies(), pattern.Blocks()));
    const std::vector<uint32_t> words(pattern.Words().begin(), pattern.Words().end());
    CheckPattern(pattern.WithWords(words), edges);
}

}  // namespace
}  // namespace fulcrum
