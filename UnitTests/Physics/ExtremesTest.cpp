// Far away, no time, changing time steps, many bodies at one point, more contacts than colors.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <limits>
#include <vector>

namespace fulcrum::testing {
namespace {

struct Outcome {
    std::vector<Position> positions;  // relative to the origin of the scene
    uint64_t sleepStep = 0;
};

Outcome StackAt(const Position& origin) {
    TestWorld world;
    world.AddFloor({}, origin);
    std::vector<BodyId> stack;
    for (int i = 0; i < 6; ++i)
        stack.push_back(
            world.Add({.shape = CubeOf(0.5f), .position = origin + Position(0.01 * (i % 2), 0.6 + 1.1 * i, 0)}));
    Outcome outcome;
    for (int i = 0; i < 600 && outcome.sleepStep == 0; ++i) {
        world.Step();
        if (world.Report().awakeBodies == 0) outcome.sleepStep = world.Report().step;
    }
    for (BodyId id : stack) outcome.positions.push_back(world.PositionOf(id) - origin);
    return outcome;
}

TEST(FarAway, AStackBehavesAsAtTheOrigin) {
    const Outcome near = StackAt({0, 0, 0});
    ASSERT_NE(near.sleepStep, 0u);
    for (double kilometers : {10.0, 1000.0, 10000.0}) {
        const Outcome far = StackAt(Position(1, 0, 0) * kilometers * 1000);
        EXPECT_EQ(far.sleepStep, near.sleepStep) << kilometers << " km";
        for (size_t i = 0; i < near.positions.size(); ++i)
            EXPECT_LT((far.positions[i] - near.positions[i]).norm(), 1e-3) << kilometers << " km, box " << i;
    }
}

TEST(FarAway, AFastBallBouncesAsAtTheOrigin) {
    const auto after = [](const Position& origin) {
        TestWorld world;
        world.AddFloor({}, origin);
        const BodyId ball = world.Add({.shape = SphereOf(0.2f),
                                       .position = origin + Position(0, 10, 0),
                                       .linearVelocity = {0, -10, 0},
                                       .material = {.restitution = 0.8f}});
        world.Run(2.5);
        return Position(world.PositionOf(ball) - origin);
    };
    const Position near = after({0, 0, 0});
    EXPECT_LT((after({1e7, 0, 0}) - near).norm(), 1e-3);
    EXPECT_LT((after({0, 1e7, 0}) - near).norm(), 1e-3);
}

TEST(TimeStep, ZeroChangesNothing) {
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f),
                                  .position = {0, 0.6, 0},
                                  .rotation = RotationAbout({0, 0, 1}, 0.1),
                                  .angularVelocity = {1, 2, 3}});
    world.Steps(10);
    const BodyBits before = BitsOf(world, box);
    world.Steps(10, 0);
    EXPECT_EQ(BitsOf(world, box), before);
    EXPECT_EQ(world.Report().bodies, 2u);
}

TEST(TimeStep, ZeroDoesNotChangeTheFuture) {
    const auto run = [](int pauses) {
        TestWorld world;
        world.AddFloor();
        const BodyId box =
            world.Add({.shape = CubeOf(0.5f), .position = {0, 1, 0}, .rotation = RotationAbout({0, 0, 1}, 0.1)});
        world.Steps(30);
        world.Steps(pauses, 0);
        world.Steps(60);
        return BitsOf(world, box);
    };
    EXPECT_EQ(run(0), run(3));
}

TEST(TimeStep, TinyAndAlternatingStepsKeepAStack) {
    TestWorld world(NoSleep());
    world.AddFloor();
    std::vector<BodyId> stack;
    for (int i = 0; i < 6; ++i) stack.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}}));
    // Each change of the time step disturbs the stack a little: it moves, but stands, within 5 % of an edge.
    for (int i = 0; i < 300; ++i) world.Step(i % 2 ? 1.0 / 30 : 1.0 / 240);
    for (size_t i = 0; i < 6; ++i)
        EXPECT_LT((world.PositionOf(stack[i]) - Position(0, 0.5 + double(i), 0)).norm(), 0.05) << i;
    world.Steps(10, 1e-5);
    world.Steps(100);
    for (size_t i = 0; i < 6; ++i)
        EXPECT_NEAR(world.PositionOf(stack[i]).y(), 0.5 + static_cast<double>(i), 0.005) << i;
}

TEST(TimeStep, EveryLengthKeepsThingsFinite) {
    for (double dt : {1e-300, 1e-42, 1e-30, 1e-12, 1e-5, 0.1, 1.0}) {
        TestWorld world(NoSleep());
        world.AddFloor();
        for (int i = 0; i < 6; ++i) world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}});
        world.Steps(60, dt);
        EXPECT_TRUE(world.AllFinite()) << dt;
        world.Steps(60);
        EXPECT_TRUE(world.AllFinite()) << dt << ", then 1/60";
    }
}

TEST(TimeStep, ATenthOfASecondKeepsAStack) {
    SystemSettings settings = NoSleep();
    settings.accuracy.penetration = std::numeric_limits<float>::infinity();  // with the four substeps alone
    TestWorld world(settings);
    world.AddFloor();
    BodyId top;
    for (int i = 0; i < 4; ++i) top = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}});
    world.Run(10, 0.1);
    // Substeps of h = 1/40 s allow springs of at most w = 2 pi 0.21 / h. A point bears a quarter of the load, with an
    // effective mass of a quarter of its box: at a corner of a cube 1 / m + 2 (0.5 / (m / 6) 0.5) = 4 /
    // m. So a contact of k boxes above it and itself is pressed by k g / w^2, twice that between two boxes: (4 + 2 (3 +
    // 2 + 1)) g / w^2 = 56 mm, and a little more in a stack, where rows that are solved earlier are violated again by
    // later ones.
    const double w = 2 * kPi * 40 * std::sqrt(2 / 45.0), sink = 16 * kGravity / (w * w);
    EXPECT_NEAR(world.PositionOf(top).y(), 3.5 - sink, 0.25 * sink);
}

TEST(Coincident, SpheresAtOnePointComeApart) {
    TestWorld world(NoGravity());
    std::vector<BodyId> spheres;
    for (int i = 0; i < 128; ++i) spheres.push_back(world.Add({.shape = SphereOf(0.5f), .position = {1, 2, 3}}));
    world.Step();
    EXPECT_LE(world.Report().contacts, 128u * 16);  // not each with each, see Crowd.h
    EXPECT_TRUE(world.AllFinite());
    world.Steps(30);
    EXPECT_TRUE(world.AllFinite());
    EXPECT_EQ(world.Report().frozenBodies, 0u);
    for (BodyId id : spheres) EXPECT_LT((world.PositionOf(id) - Position(1, 2, 3)).norm(), 3);
}

TEST(Colors, APlateWithMoreBodiesThanColorsHoldsThemAll) {
    TestWorld world(NoSleep());
    const BodyId floor = world.AddFloor();
    const BodyId plate = world.Add({.shape = BoxOf(6, 0.25f, 6), .position = {0, 0.25, 0}, .mass = 1000});
    std::vector<BodyId> boxes;
    for (int i = 0; i < 100; ++i)
        boxes.push_back(
            world.Add({.shape = CubeOf(0.4f), .position = {i % 10 * 1.0 - 4.5, 0.9, i / 10 * 1.0 - 4.5}, .mass = 10}));
    world.Run(3);
    EXPECT_GT(world.Report().overflowConstraints, 0u);
    EXPECT_LE(world.Report().colors, 64u);
    for (BodyId id : boxes) {
        EXPECT_NEAR(world.PositionOf(id).y(), 0.9, 0.005);
        EXPECT_NEAR(world.ForceBetween(plate, id), 10 * kGravity, 0.01 * 10 * kGravity);
    }
    EXPECT_NEAR(world.ForceBetween(plate, floor), 2000 * kGravity, 0.01 * 2000 * kGravity);
}

TEST(Compound, EveryChildTouches) {
    TestWorld world(NoSleep());
    const BodyId floor = world.AddFloor();
    // A table: it stands on four legs.
    const ShapePtr leg = BoxOf(0.1f, 0.5f, 0.1f);
    const ShapePtr table = CompoundOf({{.shape = BoxOf(1, 0.1f, 1), .position = {0, 1.1f, 0}},
                                       {.shape = leg, .position = {-0.8f, 0.5f, -0.8f}},
                                       {.shape = leg, .position = {0.8f, 0.5f, -0.8f}},
                                       {.shape = leg, .position = {-0.8f, 0.5f, 0.8f}},
                                       {.shape = leg, .position = {0.8f, 0.5f, 0.8f}}});
    const BodyId id = world.Add({.shape = table, .mass = 20});
    const BodyId cup = world.Add({.shape = CubeOf(0.1f), .position = {0.5, 1.3, 0.5}, .mass = 1});
    world.Run(2);
    EXPECT_EQ(world.Report().contacts, 5u);
    EXPECT_NEAR(world.PositionOf(id).y(), 0, 0.005);
    EXPECT_NEAR(world.PositionOf(cup).y(), 1.3, 0.005);
    EXPECT_NEAR(world.ForceBetween(id, floor), 21 * kGravity, 0.01 * 21 * kGravity);
}

}  // namespace
}  // namespace fulcrum::testing
