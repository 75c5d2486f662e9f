// What the report says of islands that were solved with more than the settings' effort: how much, and for whom.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace fulcrum::testing {
namespace {

// A cube of 1 m, its center at so many m.
BodyId AddCube(TestWorld& world, const Position& at, float mass = 1000) {
    return world.Add({.shape = CubeOf(0.5f), .position = at, .mass = mass});
}

TEST(EffortReport, NamesTheLightCubeUnderAHeavyOne) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId light = AddCube(world, {0, 0.5, 0});
    AddCube(world, {0, 1.5, 0}, 2e5f);
    AddCube(world, {10, 0.5, 0});
    world.Steps(60);
    const StepReport& report = world.Report();
    EXPECT_EQ(report.islands, 2u);
    ASSERT_EQ(report.islandsWithMoreEffort, 1u);
    EXPECT_TRUE(report.mostEffort[0].isDirect);
    EXPECT_EQ(report.mostEffort[0].substeps, SolverSettings{}.substeps);
    EXPECT_EQ(report.mostEffort[0].culprit, light);
    EXPECT_EQ(report.mostEffort[1].substeps, 0);
}

TEST(EffortReport, IsEmptyForAPlainPile) {
    TestWorld world(NoSleep());
    world.AddFloor();
    for (int layer = 0; layer < 4; ++layer)
        for (int i = 0; i < 4 - layer; ++i) AddCube(world, {i + 0.5 * layer, 0.5 + layer, 0});
    for (int step = 0; step < 60; ++step) {
        world.Step();
        EXPECT_EQ(world.Report().islandsWithMoreEffort, 0u) << step;
        EXPECT_EQ(world.Report().mostEffort[0].substeps, 0) << step;
    }
}

// Islands that ask for the same effort are solved together, in lanes: each moves as it would alone, and is reported.
TEST(EffortReport, IslandsOfEqualEffortMoveAsAlone) {
    SystemSettings settings = NoSleep();
    settings.solver.substeps = 1;
    TestWorld many(settings);
    many.AddFloor();
    std::vector<std::unique_ptr<TestWorld>> alone;
    std::vector<BodyId> ids, single;
    for (int i = 0; i < 9; ++i) {
        const Position at{0, 0.503, 4.0 * i};
        ids.push_back(AddCube(many, at));
        alone.push_back(std::make_unique<TestWorld>(settings));
        alone.back()->AddFloor();
        single.push_back(AddCube(*alone.back(), at));
    }
    uint32_t most = 0;
    for (int step = 0; step < 60; ++step) {
        many.Step();
        uint32_t count = 0;
        for (size_t i = 0; i < ids.size(); ++i) {
            alone[i]->Step();
            count += alone[i]->Report().islandsWithMoreEffort;
            EXPECT_EQ(many.PositionOf(ids[i]), alone[i]->PositionOf(single[i])) << step << ", " << i;
        }
        const StepReport& report = many.Report();
        ASSERT_EQ(report.islandsWithMoreEffort, count) << step;
        most = std::max(most, count);
        if (count == 0) continue;
        EXPECT_EQ(report.mostEffort[0].substeps, 2);
        EXPECT_EQ(report.mostEffort[0].bodies, 1u);
        EXPECT_FALSE(report.mostEffort[0].isDirect);
    }
    EXPECT_EQ(most, 9u);
}

// Measured by the springs of the steps of 1/240 s in between, efforts for those of 1/30 s would come and go for ever.
TEST(EffortReport, EffortsStayWhileStepsAlternate) {
    for (const float target : {0.004f, 0.001f}) {
        SystemSettings settings = NoSleep();
        settings.accuracy.penetration = target;
        TestWorld world(settings);
        world.AddFloor();
        for (int i = 0; i < 5; ++i) AddCube(world, {0.005 * (i * 7 % 3 - 1), 0.5 + i, 0.005 * (i * 5 % 3 - 1)});
        int changes = 0, effort = 0;
        for (int step = 0; step < 600; ++step) {
            world.Step(step % 2 == 0 ? 1.0 / 30 : 1.0 / 240);
            const int now = world.Report().mostEffort[0].substeps;
            changes += step >= 120 && now != effort;
            effort = now;
        }
        EXPECT_EQ(changes, 0) << target;
    }
}

// Six islands whose joints ask for 8 to 13 substeps, and one whose joint asks for fewer than the settings have.
TEST(EffortReport, ListsTheGreatestEffortsFirst) {
    TestWorld world(NoGravity());
    std::vector<BodyId> bodies;
    for (int i = 0; i < 7; ++i) {
        const BodyId a = AddCube(world, {4.0 * i, 0, 0}), b = AddCube(world, {4.0 * i, 1, 0});
        PointJointSettings joint;
        joint.bodyA = a;
        joint.bodyB = b;
        joint.anchorA.point = {4.0 * i, 0.5, 0};
        joint.substeps = i == 6 ? 2 : 8 + i;
        ASSERT_TRUE(world.System().Joints().Create(joint));
        bodies.push_back(a);
        bodies.push_back(b);
    }
    world.Step();
    const StepReport& report = world.Report();
    EXPECT_EQ(report.islandsWithMoreEffort, 6u);
    for (size_t i = 0; i < report.mostEffort.size(); ++i) {
        const size_t island = 5 - i;
        EXPECT_EQ(report.mostEffort[i].substeps, 8 + static_cast<int>(island));
        EXPECT_EQ(report.mostEffort[i].velocityIterations, SolverSettings{}.velocityIterations);
        const BodyId culprit = report.mostEffort[i].culprit;
        EXPECT_TRUE(culprit == bodies[2 * island] || culprit == bodies[2 * island + 1]) << i;
    }
}

}  // namespace
}  // namespace fulcrum::testing
