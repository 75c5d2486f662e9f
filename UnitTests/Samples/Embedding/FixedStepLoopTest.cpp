// The game's loop: as many steps as time has passed, and pictures between them.
#include <Fulcrum/Samples/Embedding/FixedStepLoop.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

using samples::FixedStepLoop;

SystemSettings Drifting() {
    SystemSettings settings = NoGravity();
    settings.events.bodies = true;
    return settings;
}

// A body that drifts and spins is drawn on its line, one step behind, at any frame rate.
TEST(FixedStepLoop, PicturesMoveEvenlyAtAnyFrameRate) {
    for (const double frame : {1 / 144.0, 1 / 60.0, 1 / 50.0, 1 / 31.0}) {
        TestWorld world(Drifting());
        const BodyId ball =
            world.Add({.shape = SphereOf(0.5f), .linearVelocity = {3, 0, 0}, .angularVelocity = {0, 2, 0}});
        FixedStepLoop loop(world.System());
        double time = 0;
        for (int i = 0; i < 200; ++i) {
            ASSERT_TRUE(loop.Advance(frame, [](double) {}));
            time += frame;
            if (time < 2 * kStep) continue;
            const Pose drawn = loop.PoseOf(ball);
            EXPECT_NEAR(drawn.position.x(), 3 * (time - kStep), 1e-4) << frame << ", " << i;
            const double angle = 2 * std::atan2(double{drawn.rotation.y}, double{drawn.rotation.w});
            EXPECT_NEAR(std::remainder(angle - 2 * (time - kStep), 2 * kPi), 0, 1e-4) << frame << ", " << i;
        }
    }
}

// The frame rate decides when steps are made, not what they do.
TEST(FixedStepLoop, StepsAreTheSameAtAnyFrameRate) {
    uint64_t hashes[2];
    for (const int rate : {0, 1}) {
        SystemSettings settings;
        settings.events.bodies = true;
        TestWorld world(settings);
        world.AddFloor();
        for (int i = 0; i < 10; ++i) world.Add({.shape = CubeOf(0.5f), .position = {0.1 * i, 1 + 1.2 * i, 0}});
        FixedStepLoop loop(world.System());
        int steps = 0;
        while (steps < 120) {
            const Result<int> done = loop.Advance(rate == 0 ? 1 / 97.0 : kStep, [](double) {});
            ASSERT_TRUE(done);
            steps += done.Value();
        }
        hashes[rate] = world.System().HashState();
    }
    EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(FixedStepLoop, AFrameThatTookLongSlowsTheGameDown) {
    TestWorld world(Drifting());
    FixedStepLoop loop(world.System(), kStep, 4);
    int calls = 0;
    const Result<int> steps = loop.Advance(10, [&](double dt) {
        ++calls;
        EXPECT_EQ(dt, kStep);
    });
    ASSERT_TRUE(steps);
    EXPECT_EQ(steps.Value(), 4);
    EXPECT_EQ(calls, 4);
    EXPECT_LT(loop.Part(), 1);
}

TEST(FixedStepLoop, WhatRestsOrJumpsIsDrawnWhereItIs) {
    TestWorld world(Drifting());
    const BodyId rests = world.Add({.shape = SphereOf(0.5f), .position = {0, 5, 0}});
    const BodyId jumps = world.Add({.shape = SphereOf(0.5f), .linearVelocity = {3, 0, 0}});
    FixedStepLoop loop(world.System());
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(loop.Advance(1.5 * kStep, [](double) {}));
    EXPECT_EQ(loop.PoseOf(rests).position, Position(0, 5, 0));
    ASSERT_TRUE(world.Bodies().SetPose(jumps, {100, 0, 0}, {}));
    loop.Jump(jumps);
    EXPECT_EQ(loop.PoseOf(jumps).position, Position(100, 0, 0));
    ASSERT_TRUE(loop.Advance(1.5 * kStep, [](double) {}));
    EXPECT_GT(loop.PoseOf(jumps).position.x(), 99.9);
}

}  // namespace
}  // namespace fulcrum::testing
