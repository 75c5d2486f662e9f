// The stages of a step by their names: what reports, pictures and pages say of them.
#include <Fulcrum/UnitTests/Support/TestWorld.h>
#include <Fulcrum/UnitTests/Support/WorldAccess.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <set>
#include <string>

namespace fulcrum::testing {
namespace {

std::vector<std::string> StageNames() {
    std::vector<std::string> names;
    for (int stage = 0; stage < kStageCount; ++stage) names.push_back(StageName(stage));
    return names;
}

TEST(Stages, HaveNamesOfTheirOwn) {
    const std::vector<std::string> names = StageNames();
    EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
    EXPECT_EQ(names.front(), "UpdateBounds");
    EXPECT_EQ(names.back(), "Sleep");
}

TEST(Stages, TogetherTakeTheTimeOfTheStep) {
    TestWorld world;
    world.AddFloor();
    for (int i = 0; i < 20; ++i) world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}});
    world.Steps(10);
    const StepReport& report = world.Report();
    for (size_t i = 0; i < report.stageMs.size(); ++i)
        EXPECT_GE(report.stageMs[i], 0) << StageName(static_cast<int>(i));
    EXPECT_GT(report.totalMs, 0);
    EXPECT_NEAR(std::accumulate(report.stageMs.begin(), report.stageMs.end(), 0.0), report.totalMs,
                1e-6 * report.totalMs);
}

// The first column of the table of Docs/Step.md.
TEST(Stages, AreInTheirOrderInTheDocs) {
    std::ifstream page(FULCRUM_SOURCE_DIR "/Docs/Step.md");
    std::vector<std::string> names;
    for (std::string line; std::getline(page, line) && line.find("## ") != 0;)
        if (line.find("| ") == 0 && line.find("| ---") != 0) names.push_back(line.substr(2, line.find(" |") - 2));
    ASSERT_FALSE(names.empty());
    EXPECT_EQ(names.front(), "stage");
    names.erase(names.begin());
    EXPECT_EQ(names, StageNames());
}

// A body on a seam of two flush boxes rests on them, and is pushed by neither's side: what the solver did not see is no
// contact that anyone is told of.
TEST(Stages, ContactsOfASeamAreNotShown) {
    TestWorld world;
    const ShapePtr tile = BoxOf(1, 0.5f, 1);
    for (int i = 0; i < 2; ++i)
        world.Add({.shape = tile, .motion = MotionType::Static, .position = {2.0 * i - 1, -0.5, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.1f),
                                  .position = {-0.6, 0.0995, 0},
                                  .linearVelocity = {3, 0, 0},
                                  .material = {.friction = 0}});
    size_t seams = 0;
    for (int step = 0; step < 24; ++step) {
        world.Step();
        seams += static_cast<size_t>(
            std::ranges::count_if(WorldOf(world.System()).pairs.pairs, [](const Pair& pair) { return pair.onSeam; }));
        world.System().VisitContacts([&](const ContactView& contact) {
            EXPECT_FALSE(contact.points.empty());
            EXPECT_LT(std::fabs(contact.normal.x()), 0.1f) << "step " << step;
        });
    }
    EXPECT_GT(seams, 0u);
    EXPECT_NEAR(world.VelocityOf(box).x(), 3, 0.01);
    EXPECT_GT(world.PositionOf(box).x(), 0.3);
}

}  // namespace
}  // namespace fulcrum::testing
