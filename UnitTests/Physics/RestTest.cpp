// What rests stays at rest, whatever its size and whatever the effort, and errors fall with effort: contacts are
// springs as stiff as substeps and passes allow, and friction leaves pushes alone.
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace fulcrum::testing {
namespace {

// m/s, of any body's center in a second, by poses alone.
double FastestInASecond(TestWorld& world, const std::vector<BodyId>& bodies) {
    double fastest = 0;
    std::vector<Position> before(bodies.size());
    for (int step = 0; step < 60; ++step) {
        for (size_t i = 0; i < bodies.size(); ++i) before[i] = world.PositionOf(bodies[i]);
        world.Step();
        for (size_t i = 0; i < bodies.size(); ++i)
            fastest = std::max(fastest, (world.PositionOf(bodies[i]) - before[i]).norm() / kStep);
    }
    return fastest;
}
bool AllAsleep(TestWorld& world, const std::vector<BodyId>& bodies) {
    return std::ranges::none_of(bodies, [&](BodyId id) { return world.Bodies().IsAwake(id); });
}

// Square layers of cubes of 2 m, each cube on four of the layer below, so far apart in height.
std::vector<BodyId> AddPyramid(TestWorld& world, int layers, double gap) {
    world.AddFloor();
    std::vector<BodyId> bodies;
    for (int i = 0; i < layers; ++i)
        for (int j = i / 2; j < layers - (i + 1) / 2; ++j)
            for (int k = i / 2; k < layers - (i + 1) / 2; ++k) {
                const double shift = i % 2 == 0 ? 0 : 1;
                bodies.push_back(
                    world.Add({.shape = CubeOf(1), .position = {2 * j + shift, 1 + (2 + gap) * i, 2 * k + shift}}));
            }
    return bodies;
}
// A wall of cubes of 1 m that tapers to one.
std::vector<BodyId> AddFlatPyramid(TestWorld& world, int layers) {
    world.AddFloor();
    std::vector<BodyId> bodies;
    for (int i = 0; i < layers; ++i)
        for (int j = 0; j < layers - i; ++j)
            bodies.push_back(world.Add({.shape = CubeOf(0.5f), .position = {j + 0.5 * i, 0.5 + i, 0}}));
    return bodies;
}

TEST(Rest, PyramidsStopCreepingAndFallAsleep) {
    const int layers = kIsSanitized ? 5 : 15;
    for (const double gap : {0.0, 0.05, 0.5}) {
        TestWorld world(NoSleep());
        const std::vector<BodyId> bodies = AddPyramid(world, layers, gap);
        world.Run(8);
        EXPECT_LT(FastestInASecond(world, bodies), 2e-4) << gap;
        TestWorld sleepy;
        const std::vector<BodyId> sleepers = AddPyramid(sleepy, layers, gap);
        sleepy.Run(5);
        EXPECT_TRUE(AllAsleep(sleepy, sleepers)) << gap;
    }
}

// Layers that fall onto each other hit cubes beside their centers. Rows that are solved exactly hold these level, so
// that none moves sideways: what drift there is must fall with the iterations. While impacts had friction in relax
// iterations only, after the poses were integrated, four left 0.8 of the drift of one.
TEST(Rest, FallenPyramidsDriftLessWithMoreIterations) {
    const int most = kIsSanitized ? 4 : 16;
    for (const double gap : {0.4, 0.5, 0.6}) {
        if (kIsSanitized && gap != 0.5) continue;
        double before = std::numeric_limits<double>::infinity();
        for (int iterations = 1; iterations <= most; iterations *= 4) {
            SystemSettings settings = NoSleep();
            settings.solver.velocityIterations = settings.solver.positionIterations = iterations;
            TestWorld world(settings);
            const std::vector<BodyId> bodies = AddPyramid(world, 8, gap);
            std::vector<Position> starts;
            for (BodyId id : bodies) starts.push_back(world.PositionOf(id));
            world.Run(2);
            double drift = 0;  // m, mean
            for (size_t i = 0; i < bodies.size(); ++i) {
                const Position moved = world.PositionOf(bodies[i]) - starts[i];
                drift += std::hypot(moved.x(), moved.z()) / static_cast<double>(bodies.size());
            }
            EXPECT_LT(drift, 0.5 * before) << iterations << " iterations, gap " << gap;
            before = drift;
        }
        EXPECT_LT(before, most == 16 ? 2e-3 : 8e-3) << gap;
    }
}

// Springs of frequency f = sqrt((V + P) / 45) / h sink by the load over w^2: as h^2 / (V + P).
TEST(Rest, FlatPyramidsRestAtEveryEffortAndSinkByItsSquare) {
    const int efforts[][3] = {{1, 4, 2}, {2, 1, 1}, {4, 1, 1},  {4, 2, 1}, {4, 1, 2},
                              {4, 4, 4}, {8, 1, 1}, {16, 1, 1}, {64, 1, 1}};
    constexpr int kLayers = 10;
    constexpr double kUsual = 2.83e-3 * 16 * 2;  // m: sink times h^-2 and passes, measured
    for (const auto& [substeps, velocityIterations, positionIterations] : efforts) {
        SystemSettings settings = NoSleep();
        settings.solver.substeps = substeps;
        settings.solver.velocityIterations = velocityIterations;
        settings.solver.positionIterations = positionIterations;
        settings.accuracy.penetration = std::numeric_limits<float>::infinity();  // with this effort alone
        const std::string effort = std::to_string(substeps) + " " + std::to_string(velocityIterations) + " " +
                                   std::to_string(positionIterations);
        TestWorld world(settings);
        const std::vector<BodyId> bodies = AddFlatPyramid(world, kLayers);
        world.Run(6);
        EXPECT_LT(FastestInASecond(world, bodies), 1e-4) << effort;
        const double passes = velocityIterations + positionIterations,
                     sink = kLayers - 0.5 - world.PositionOf(bodies.back()).y();
        EXPECT_NEAR(sink * substeps * substeps * passes, kUsual, 0.25 * kUsual) << effort;
    }
}

// 5050 boxes a meter thick and 100 m high: with the system's substeps they sway in their plane, lean out of it within
// eight seconds, and fall.
TEST(Rest, AWallOfAHundredLayersFallsAsleep) {
    if (kIsSanitized) GTEST_SKIP() << "minutes";
    TestWorld world;
    const std::vector<BodyId> bodies = AddFlatPyramid(world, 100);
    std::vector<Position> starts;
    for (const BodyId id : bodies) starts.push_back(world.PositionOf(id));
    world.Run(1);
    EXPECT_GT(world.Report().mostEffort[0].substeps, 4);
    double time = 1;
    for (; time < 10 && !AllAsleep(world, bodies); time += 0.5) world.Run(0.5);
    EXPECT_LT(time, 9);
    for (size_t i = 0; i < bodies.size(); ++i)
        EXPECT_LT((world.PositionOf(bodies[i]) - starts[i]).norm(), 0.1) << i;  // 0.07 of it the top's sink
}

// A wave of toppling blocks. Pushes that stay in the velocities, and friction limited by pushes, made it slower with
// each substep more.
TEST(Rest, AWaveOfBlocksRunsAsFastAtEveryEffort) {
    const auto speedOf = [](int substeps) {
        SystemSettings settings = NoSleep();
        settings.solver.substeps = substeps;
        TestWorld world(settings);
        world.AddFloor();
        std::vector<BodyId> blocks;
        for (int i = 0; i < 60; ++i)
            blocks.push_back(world.Add({.shape = BoxOf(0.05f, 0.5f, 0.25f), .position = {0.35 * i, 0.5, 0}}));
        EXPECT_TRUE(world.Bodies().SetVelocity(blocks[0], {0.6f, 0, 0}, {0, 0, -1.2f}));
        const auto topples = [&](BodyId id) { return std::fabs(world.Bodies().GetPose(id).rotation.z) > 0.1f; };
        int first = 0, step = 0;
        for (; step < 1200 && !topples(blocks[50]); ++step) {
            world.Step();
            if (first == 0 && topples(blocks[20])) first = step;
        }
        return 0.35 * 30 / ((step - first) * kStep);
    };
    const double usual = speedOf(4);
    for (const int substeps : {8, 16, 32}) EXPECT_NEAR(speedOf(substeps), usual, 0.015 * usual) << substeps;
}

// Friction of the floor is mu m g: all four boxes together get v = (F / m - mu g) t.
TEST(Rest, AForceAcceleratesABoxWithOthersOnTopByTheFormula) {
    for (const double dt : {kStep, 2e-4}) {
        TestWorld world(NoSleep());
        world.AddFloor();
        std::vector<BodyId> boxes;
        for (int i = 0; i < 4; ++i)
            boxes.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}, .mass = 1}));
        world.Run(0.5, dt);
        const double force = 1.4 * 0.5 * 4 * kGravity;
        const auto steps = std::lround(0.25 / dt);
        for (int i = 0; i < steps; ++i) {
            EXPECT_TRUE(world.Bodies().AddForce(boxes[0], Vector3(static_cast<float>(force), 0, 0)));
            world.Step(dt);
        }
        const double expected = (force / 4 - 0.5 * kGravity) * static_cast<double>(steps) * dt;
        double momentum = 0;
        for (const BodyId id : boxes) momentum += double{world.VelocityOf(id).x()};
        EXPECT_NEAR(momentum / 4, expected, 0.04 * expected) << dt;
    }
}

// What rests is damped while it decelerates (Docs/Step.md): slow sliding and rolling, and what is weightless, is not.
TEST(Rest, SlowMotionThatDoesNotSwingGoesOn) {
    TestWorld world(NoSleep());
    world.AddFloor({.friction = 0});
    std::vector<BodyId> boxes;
    for (const float speed : {0.06f, 0.03f})
        boxes.push_back(world.Add({.shape = CubeOf(0.5f),
                                   .position = {0, 0.5, 100 * double{speed}},
                                   .linearVelocity = {speed, 0, 0},
                                   .material = {.friction = 0}}));
    world.Run(5);
    EXPECT_NEAR(world.VelocityOf(boxes[0]).x(), 0.06f, 1e-5f);
    EXPECT_NEAR(world.VelocityOf(boxes[1]).x(), 0.03f, 1e-5f);

    // Down a slope of 0.1 degrees: a = 5/7 g sin.
    SystemSettings settings = NoSleep();
    settings.gravity = Vector3(static_cast<float>(kGravity * std::sin(0.1 * kDegree)),
                               static_cast<float>(-kGravity * std::cos(0.1 * kDegree)), 0);
    TestWorld slope(settings);
    slope.AddFloor();
    const BodyId ball = slope.Add({.shape = SphereOf(0.5f), .position = {0, 0.5, 0}});
    slope.Run(3);
    const double expected = 5.0 / 7 * kGravity * std::sin(0.1 * kDegree) * 3;
    EXPECT_NEAR(slope.VelocityOf(ball).x(), expected, 0.01 * expected);

    settings.gravity = Vector3::Zero();
    TestWorld space(settings);
    BodyId pair[2];
    for (int i = 0; i < 2; ++i)
        pair[i] = space.Add({.shape = CubeOf(0.5f), .position = {0, double(i), 0}, .linearVelocity = {0.03f, 0, 0}});
    space.Run(5);
    for (const BodyId id : pair) EXPECT_NEAR(space.VelocityOf(id).x(), 0.03f, 1e-6f);
}

// A stack that must stay awake comes to rest like one that may sleep.
TEST(Rest, AStackThatMayNotSleepStopsSwaying) {
    TestWorld world;
    world.AddFloor();
    std::vector<BodyId> stack;
    for (int i = 0; i < 10; ++i)
        stack.push_back(world.Add({.shape = CubeOf(0.5f),
                                   .position = {0.01 * (i * 7 % 3 - 1), 0.5 + i, 0.01 * (i * 5 % 3 - 1)},
                                   .allowSleep = false}));
    world.Run(5);
    EXPECT_FALSE(AllAsleep(world, stack));
    EXPECT_LT(FastestInASecond(world, stack), 1e-4);
}

// What a heavy load has pressed down comes back to its place, and no farther.
TEST(Rest, WhatALoadLeavesRisesNoHigherThanItsPlace) {
    for (const int substeps : {4, 16}) {
        SystemSettings settings = NoSleep();
        settings.solver.substeps = substeps;
        TestWorld world(settings);
        world.AddFloor();
        const BodyId below = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 1000}),
                     load = world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}, .mass = 1e5f});
        world.Run(5);
        EXPECT_GT(world.PositionOf(below).y(), 0.499) << substeps;
        EXPECT_TRUE(world.Bodies().Remove(load));
        double highest = 0;
        for (int i = 0; i < 120; ++i) {
            world.Step();
            highest = std::max(highest, world.PositionOf(below).y());
        }
        EXPECT_LT(highest, 0.501) << substeps;
        EXPECT_GT(highest, 0.4995) << substeps;
    }
}

// Springs as stiff as the short ones of these steps allow would throw up what the long ones let sink; long ones that
// begin with a part of their load, or with the effort of short ones, let it drift by centimeters.
TEST(Rest, AStackOutOfLineStandsWhileStepsAlternate) {
    struct Case {
        double shorter, longer;  // s
        int each;                // so many steps of the one, then of the other
    };
    for (const int substeps : {4, 16})
        for (const Case& steps :
             {Case{1.0 / 240, 1.0 / 30, 1}, Case{1.0 / 60, 1.0 / 30, 1}, Case{1.0 / 240, 1.0 / 30, 30}})
            for (const int boxes : {6, 10, 20}) {  // so long that what grows from block to block shows
                SystemSettings settings = NoSleep();
                settings.solver.substeps = substeps;
                TestWorld world(settings);
                world.AddFloor();
                std::vector<BodyId> stack;
                std::vector<Position> starts;
                for (int i = 0; i < boxes; ++i) {
                    starts.push_back({0.01 * (i * 7 % 3 - 1), 0.5 + i, 0.01 * (i * 5 % 3 - 1)});
                    stack.push_back(world.Add({.shape = CubeOf(0.5f), .position = starts.back()}));
                }
                for (int i = 0; i < (kIsSanitized ? 300 : 1800); ++i)
                    world.Step(i / steps.each % 2 == 0 ? steps.shorter : steps.longer);
                for (size_t i = 0; i < stack.size(); ++i)
                    EXPECT_LT((world.PositionOf(stack[i]) - starts[i]).norm(), 0.02)
                        << substeps << " substeps, " << boxes << " boxes, " << steps.longer << " s, each " << steps.each
                        << ", " << i;
            }
}

}  // namespace
}  // namespace fulcrum::testing
