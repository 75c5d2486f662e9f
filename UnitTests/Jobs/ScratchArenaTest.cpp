#include <Fulcrum/Jobs/ScratchArena.h>

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace fulcrum {
namespace {

template <class T>
bool IsAligned(std::span<T> piece) {
    return reinterpret_cast<uintptr_t>(piece.data()) % ScratchArena::kAlignment == 0;
}

TEST(ScratchArena, GivesAlignedPiecesThatDoNotOverlap) {
    ScratchArena arena;
    std::vector<std::span<uint32_t>> pieces;
    for (uint32_t i = 0; i < 500; ++i) {
        pieces.push_back(arena.Allocate<uint32_t>(i));
        EXPECT_EQ(pieces[i].size(), i);
        EXPECT_TRUE(IsAligned(pieces[i]));
        for (uint32_t& value : pieces[i]) value = i;
    }
    for (uint32_t i = 0; i < 500; ++i)
        for (const uint32_t value : pieces[i]) ASSERT_EQ(value, i);
}

TEST(ScratchArena, GivesPiecesOfAnyType) {
    struct alignas(64) Line {
        float values[16];
    };
    ScratchArena arena;
    EXPECT_TRUE(IsAligned(arena.Allocate<char>(3)));
    EXPECT_TRUE(IsAligned(arena.Allocate<Line>(5)));
    EXPECT_TRUE(IsAligned(arena.Allocate<double>(1)));
}

TEST(ScratchArena, ReservesNothingForNothing) {
    ScratchArena arena;
    EXPECT_TRUE(arena.Allocate<int>(0).empty());
    arena.Reset();
    EXPECT_EQ(arena.CapacityInBytes(), 0u);
}

void TakeAStepsMemory(ScratchArena& arena, size_t megabytes) {
    for (size_t i = 0; i < megabytes * 16; ++i) {
        const std::span<std::byte> piece = arena.Allocate<std::byte>(64 * 1024);
        piece.front() = piece.back() = std::byte{1};
    }
}

TEST(ScratchArena, SettlesInOneBlockThatHoldsAStep) {
    ScratchArena arena;
    TakeAStepsMemory(arena, 5);
    EXPECT_GT(arena.BlockCount(), 1u);
    arena.Reset();
    EXPECT_EQ(arena.BlockCount(), 1u);
    const size_t settled = arena.CapacityInBytes();
    EXPECT_GE(settled, size_t{5} << 20);
    EXPECT_LE(settled, size_t{10} << 20);  // doubling wastes at most half
    const std::byte* first = arena.Allocate<std::byte>(1).data();
    for (int step = 0; step < 10; ++step) {
        arena.Reset();
        EXPECT_EQ(arena.Allocate<std::byte>(1).data(), first);
        arena.Reset();
        TakeAStepsMemory(arena, 5);
        EXPECT_EQ(arena.BlockCount(), 1u);
        EXPECT_EQ(arena.CapacityInBytes(), settled);
    }
}

TEST(ScratchArena, HasRoomForOnePieceOfAnySize) {
    ScratchArena arena;
    arena.Allocate<int>(1);
    const std::span<std::byte> piece = arena.Allocate<std::byte>(3'000'001);
    piece.back() = std::byte{1};
    EXPECT_TRUE(IsAligned(piece));
}

TEST(ScratchArena, RefusesMoreThanThereIs) {
    ScratchArena arena;
    EXPECT_THROW(arena.Allocate<double>(std::numeric_limits<size_t>::max() / 4), std::bad_alloc);
    EXPECT_EQ(arena.Allocate<int>(4).size(), 4u);
}

}  // namespace
}  // namespace fulcrum
