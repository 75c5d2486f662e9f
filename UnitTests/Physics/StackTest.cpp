// Stacks stand, rest on each other with their weight, and hardly overlap.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <random>
#include <vector>

namespace fulcrum::testing {
namespace {

constexpr float kRestingOverlap = 0.005f;  // m

// Worst relative error of the contact forces of a stack against the weights above them.
double WorstWeightError(TestWorld& world, const std::vector<BodyId>& stack, double weight, double dt) {
    double worst = 0;
    for (size_t i = 0; i + 1 < stack.size(); ++i) {
        const double expected = weight * static_cast<double>(stack.size() - 1 - i);
        worst = std::max(worst, std::fabs(world.ForceBetween(stack[i], stack[i + 1], dt) / expected - 1));
    }
    return worst;
}

TEST(Stack, SpheresPressWithTheirWeight) {
    const double dt = 0.005;
    TestWorld world(NoSleep());
    std::vector<BodyId> stack{world.AddFloor()};
    // The tube that holds them.
    const LockedAxes tube = LockedAxes::TranslationX | LockedAxes::TranslationZ;
    for (int i = 0; i < 8; ++i)
        stack.push_back(
            world.Add({.shape = SphereOf(0.05f), .position = {0, 0.05 + 0.1 * i, 0}, .mass = 5, .lockedAxes = tube}));
    world.Run(0.25, dt);
    EXPECT_LT(WorstWeightError(world, stack, 5 * kGravity, dt), 0.05);
    world.Run(2, dt);
    EXPECT_LT(WorstWeightError(world, stack, 5 * kGravity, dt), 1e-3);
    EXPECT_LE(world.Report().largestPenetration, kRestingOverlap);
}

TEST(Stack, BoxesPressWithTheirWeight) {
    TestWorld world(NoSleep());
    std::vector<BodyId> stack{world.AddFloor()};
    for (int i = 0; i < 8; ++i)
        stack.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}, .mass = 5}));
    world.Run(4);
    EXPECT_LT(WorstWeightError(world, stack, 5 * kGravity, kStep), 5e-3);
    EXPECT_LE(world.Report().largestPenetration, kRestingOverlap);
}

TEST(Stack, TwentyBoxesOutOfLineStandAMinuteAndSleep) {
    TestWorld world;
    world.AddFloor();
    std::mt19937 random(7);
    const auto offset = [&] { return 0.02 * (double(random() >> 8) / 16777216.0) - 0.01; };
    std::vector<BodyId> tower;
    std::vector<Position> starts;
    for (int i = 0; i < 20; ++i) {
        const double x = offset(), z = offset();
        starts.push_back({x, 0.5 + i, z});
        tower.push_back(world.Add({.shape = CubeOf(0.5f), .position = starts.back()}));
    }
    bool slept = false;
    float deepest = 0;  // in the last step, when all are at rest
    for (int i = 0; i < 3600 && !slept; ++i) {
        world.Step();
        slept = world.Report().awakeBodies == 0;
        deepest = world.Report().largestPenetration;
    }
    EXPECT_TRUE(slept);
    EXPECT_LE(deepest, kRestingOverlap);
    for (size_t i = 0; i < 20; ++i) EXPECT_LT((world.PositionOf(tower[i]) - starts[i]).norm(), 0.05) << i;
}

TEST(Stack, TwentyBoxesStandAMinuteAwake) {
    TestWorld world(NoSleep());
    world.AddFloor();
    std::mt19937 random(7);
    const auto offset = [&] { return 0.02 * (double(random() >> 8) / 16777216.0) - 0.01; };
    BodyId top;
    Position start;
    for (int i = 0; i < 20; ++i) {
        const double x = offset(), z = offset();
        start = {x, 0.5 + i, z};
        top = world.Add({.shape = CubeOf(0.5f), .position = start});
    }
    world.Run(60);
    EXPECT_LT((world.PositionOf(top) - start).norm(), 0.05);  // 5 % of an edge
}

TEST(Stack, ThePyramidsTopStaysInItsPlace) {
    TestWorld world;
    world.AddFloor();
    const int base = 15;
    BodyId top;
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            top = world.Add({.shape = CubeOf(0.5f), .position = {i + 0.5 * row, 0.5 + row, 0}});
    const Position start = world.PositionOf(top);
    world.Steps(300);
    EXPECT_LT((world.PositionOf(top) - start).norm(), 0.01);
    EXPECT_LE(world.Report().largestPenetration, kRestingOverlap);
}

TEST(Stack, SpheresPressedTogetherOverlapLessThanTheLimit) {
    // 6 x 6 x 6 spheres just above each other, walls about them.
    TestWorld world(NoSleep());
    world.AddFloor();
    for (int side = 0; side < 4; ++side) {
        const double x = side == 0 ? -4.0 : side == 1 ? 4.0 : 0, z = side == 2 ? -4.0 : side == 3 ? 4.0 : 0;
        const ShapePtr wall = side < 2 ? BoxOf(1, 10, 6) : BoxOf(6, 10, 1);
        world.Add({.shape = wall, .motion = MotionType::Static, .position = {x, 9, z}});
    }
    for (int i = 0; i < 216; ++i)
        world.Add({.shape = SphereOf(0.5f), .position = {i % 6 - 2.5, 0.5 + 1.001 * (i / 36), i / 6 % 6 - 2.5}});
    world.Run(5);
    EXPECT_LE(world.Report().largestPenetration, kRestingOverlap);
    EXPECT_TRUE(world.AllFinite());
}

TEST(Stack, AnOverlapIsResolvedGently) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.25, 0}});
    float fastest = 0;
    for (int i = 0; i < 120; ++i) {
        world.Step();
        fastest = std::max(fastest, std::fabs(world.VelocityOf(box).y()));
    }
    // Relaxing takes most of the push's speed out again: what is left is below the setting that bounds the push.
    EXPECT_LT(fastest, 0.5f * world.System().Settings().contactPushSpeed);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, kRestingOverlap);
}

TEST(Stack, NothingMovesInAStackAtRest) {
    // No jitter: awake, at rest, each body's position over a second stays within a tenth of a millimeter.
    TestWorld world(NoSleep());
    world.AddFloor();
    std::vector<BodyId> stack;
    for (int i = 0; i < 5; ++i) stack.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}}));
    world.Run(5);
    std::vector<Position> rest;
    for (BodyId id : stack) rest.push_back(world.PositionOf(id));
    for (int i = 0; i < 60; ++i) {
        world.Step();
        for (size_t k = 0; k < stack.size(); ++k) ASSERT_LT((world.PositionOf(stack[k]) - rest[k]).norm(), 1e-4) << k;
    }
}

}  // namespace
}  // namespace fulcrum::testing
