// What counts as an effort that oscillates.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>

#include <gtest/gtest.h>

#include <limits>

namespace fulcrum::accuracy {
namespace {

Setting TightTarget() {
    SolverSettings solver;
    solver.substeps = 1;
    return {.solver = solver, .family = Family::Target, .target = 0.001f};
}

// A ball that bounces twice a second needs effort at each landing, and none in flight.
TEST(EffortReturns, ALandingIsNone) {
    const Setting setting = TightTarget();
    LabRun run(setting, 0, true, 1);
    LabWorld world(run);
    world.AddFloor(0.5f, 1);
    world.Add({.shape = SphereOf(0.2), .position = {0, 0.5, 0}, .material = {.restitution = 1}});
    EffortReturns efforts;
    int rises = 0, last = 0;
    uint32_t returns = 0;
    for (int i = 0; i < 600; ++i) {
        world.Step();
        const int effort = world.Ours("").Report().mostEffort[0].substeps;
        rises += effort > last;
        last = effort;
        returns += efforts.Sample(world.Ours(""));
    }
    EXPECT_GT(rises, 10);
    EXPECT_EQ(returns, 0u);
}

// A cube on a light one, whose own target comes and goes: its contacts stay, its effort falls and rises.
TEST(EffortReturns, ARiseWithTheSameContactsIsOne) {
    const Setting setting = TightTarget();
    LabRun run(setting, 0, true, 1);
    LabWorld world(run);
    world.AddFloor();
    const BodyId light = world.Add({.shape = BoxOf(0.5, 0.5, 0.5), .position = {0, 0.5, 0}});
    world.Add({.shape = BoxOf(0.5, 0.5, 0.5), .position = {0, 1.5, 0}, .mass = 100'000});
    EffortReturns efforts;
    const auto returnsWith = [&](float target) {
        EXPECT_TRUE(world.Ours("").Bodies().SetPenetrationTarget(light, target));
        uint32_t returns = 0;
        for (int i = 0; i < 300; ++i) {
            world.Step();
            returns += efforts.Sample(world.Ours(""));
        }
        return returns;
    };
    EXPECT_EQ(returnsWith(0.001f), 0u) << "the first rise is none";
    constexpr float kAny = std::numeric_limits<float>::infinity();
    returnsWith(kAny);  // falls
    EXPECT_EQ(returnsWith(kAny), 0u) << "an effort that stays is none";
    EXPECT_EQ(returnsWith(0.001f), 1u);
}

}  // namespace
}  // namespace fulcrum::accuracy
