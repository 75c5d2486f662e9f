// A user's own scene in the lab: its error is what is seen of it, and advice names a setting that has it.
#include <Fulcrum/Assets/SceneFile.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/PerformanceTest/Accuracy/Advice.h>
#include <Fulcrum/PerformanceTest/Accuracy/Options.h>
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace fulcrum::accuracy {
namespace {

namespace fs = std::filesystem;

class UserScene : public ::testing::Test {
protected:
    UserScene() { fs::create_directories(folder_); }
    ~UserScene() override { fs::remove_all(folder_); }

    // Runs a scene at some substeps of 1/60 s.
    std::vector<RunRecord> RunAt(LabOptions lab, std::initializer_list<int> substeps) const {
        for (const int count : substeps) {
            Setting setting;
            setting.solver.substeps = count;
            lab.settings.push_back(setting);
        }
        return Run(std::move(lab));
    }
    std::vector<RunRecord> Run(LabOptions lab) const {
        lab.folder = folder_ / "runs";
        lab.isQuick = true;
        Result<std::vector<RunRecord>> runs = RunLab(lab);
        EXPECT_TRUE(runs);
        return runs ? std::move(runs.Value()) : std::vector<RunRecord>();
    }

    const fs::path folder_ = fs::path(::testing::TempDir()) / "user_scene_test";
};

// Six cubes of 1 m, of which five press on the lowest contact.
SceneDescription Stack() {
    SceneDescription scene;
    scene.steps = 240;
    scene.settings.accuracy.penetration = std::numeric_limits<float>::infinity();
    scene.bodies.push_back(
        {"floor", {.shape = Box::Create({5, 1, 5}).Value(), .motion = MotionType::Static, .position = {0, -1, 0}}});
    const ShapePtr cube = Box::Create({0.5f, 0.5f, 0.5f}).Value();
    for (int i = 0; i < 6; ++i) scene.bodies.push_back({{}, {.shape = cube, .position = {0, 0.5 + 1.01 * i, 0}}});
    return scene;
}

// What is exceeded in one of twenty steps after half a second.
double OverlapByHand(SceneDescription scene, int substeps) {
    scene.settings.solver.substeps = substeps;
    scene.settings.sleep.enabled = false;
    const auto system = PhysicsSystem::Create(scene.settings).Value();
    EXPECT_TRUE(AddScene(*system, scene));
    std::vector<double> overlaps;
    for (int i = 1; i <= scene.steps; ++i) {
        EXPECT_TRUE(system->Update(1.0 / 60));
        if (i > 30) overlaps.push_back(static_cast<double>(system->Report().largestPenetration) / 0.5);
    }
    std::sort(overlaps.begin(), overlaps.end());
    return overlaps[overlaps.size() * 19 / 20];
}

TEST_F(UserScene, OfAFileHasTheOverlapOfItsContactsAsError) {
    const SceneDescription scene = Stack();
    const std::string file = (folder_ / "stack.json").string();
    ASSERT_TRUE(WriteScene(file, scene));
    const auto command = ParseLabCommand({"advise", file, "--error", "50%"});
    ASSERT_TRUE(command) << command.GetError().message;
    ASSERT_EQ(command.Value().lab.scenes.size(), 1u);
    EXPECT_EQ(command.Value().lab.scenes[0]->FullName(), "stack.json");
    const std::vector<RunRecord> runs = RunAt(command.Value().lab, {4, 16});
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_GT(runs[1].Error(), 0);
    EXPECT_GT(runs[0].Error(), 4 * runs[1].Error());  // with the square of the substeps
    // To one step more or less.
    for (const RunRecord& run : runs)
        EXPECT_NEAR(run.Error() / OverlapByHand(scene, run.setting.solver.substeps), 1, 1e-3);
    const std::string advice = AdviceForError({command.Value().lab.scenes[0], runs}, 0.5);
    EXPECT_NE(advice.find("Cheapest setting with an error of at most 50 %"), std::string::npos) << advice;
    EXPECT_NE(advice.find("stack.json"), std::string::npos) << advice;
}

// The upper cubes press on the two lowest, of which both yield: no setting of these two is exact to a billionth. (With
// one substep the stack sways, and any pair may be the worst.)
TEST_F(UserScene, ThatNoSettingSufficesForSaysWhatStandsInTheWay) {
    const std::string file = (folder_ / "stack.json").string();
    ASSERT_TRUE(WriteScene(file, Stack()));
    const auto command = ParseLabCommand({"advise", file, "--error", "1e-9"});
    ASSERT_TRUE(command) << command.GetError().message;
    std::vector<RunRecord> runs = RunAt(command.Value().lab, {2, 16});
    ASSERT_EQ(runs.size(), 2u);
    // Times of so small a scene are chance, and on a busy machine one may be any multiple of the other.
    for (RunRecord& run : runs) run.microseconds = run.traversals;
    for (const RunRecord& run : runs) EXPECT_NE(run.worst.find("body 1 and body 2"), std::string::npos) << run.worst;
    const SceneRuns scene{command.Value().lab.scenes[0], runs};
    const std::string advice = AdviceForError(scene, 1e-9);
    EXPECT_NE(advice.find("No setting of this grid has an error of at most 1e-07 %"), std::string::npos) << advice;
    EXPECT_NE(advice.find("What stands in the way"), std::string::npos) << advice;
    EXPECT_NE(advice.find(runs[1].worst), std::string::npos) << advice;
    EXPECT_NE(advice.find("it still falls"), std::string::npos) << advice;
    EXPECT_NE(AdviceForBudget(scene, 1e-9).find("times as long"), std::string::npos);
}

TEST_F(UserScene, IsAdvisedTargetsToo) {
    const std::string file = (folder_ / "stack.json").string();
    ASSERT_TRUE(WriteScene(file, Stack()));
    const auto command = ParseLabCommand({"advise", file, "--error", "1%"});
    ASSERT_TRUE(command) << command.GetError().message;
    EXPECT_TRUE(command.Value().lab.advises);
    const auto isTarget = [](const Setting& setting) { return setting.family == Family::Target; };
    EXPECT_TRUE(std::ranges::any_of(AdviceGrid({.contacts = true}), isTarget));
    EXPECT_FALSE(std::ranges::any_of(AdviceGrid({}), isTarget));
    // The scene has no target of its own: with one it is solved directly.
    LabOptions lab = command.Value().lab;
    lab.settings = {Setting{}, {.family = Family::Target, .target = 0.0005f}};
    const std::vector<RunRecord> runs = Run(lab);
    ASSERT_EQ(runs.size(), 2u);
    EXPECT_LT(runs[1].Error(), 0.5 * runs[0].Error());
    const std::string advice = AdviceForError({lab.scenes[0], runs}, runs[1].Error());
    EXPECT_NE(advice.find("settings.accuracy = {.penetration = 0.0005f, .jointError = 0.0005f};"), std::string::npos)
        << advice;
}

// A ball that flies, and one on a spring: nothing that the error is of.
TEST_F(UserScene, InWhichNothingTouchesOrHoldsIsNotMeasured) {
    SceneDescription scene;
    scene.steps = 120;
    const ShapePtr ball = Sphere::Create(0.1f).Value();
    for (const double x : {0.0, 1.0}) scene.bodies.push_back({{}, {.shape = ball, .position = {x, 0, 0}}});
    DistanceJointSettings spring;
    spring.anchorA.point = {1, 1, 0};
    spring.anchorB = JointAnchor{.point = {1, 0, 0}};
    spring.spring.frequency = 1;
    scene.joints.push_back({{}, SceneJoint::kWorld, 1, spring});
    const std::string file = (folder_ / "spring.json").string();
    ASSERT_TRUE(WriteScene(file, scene));
    const auto adviceFor = [&] {
        const auto command = ParseLabCommand({"advise", file, "--error", "1%"});
        EXPECT_TRUE(command) << command.GetError().message;
        return AdviceForError({command.Value().lab.scenes[0], RunAt(command.Value().lab, {4})}, 0.01);
    };
    const std::string advice = adviceFor();
    EXPECT_NE(advice.find("error not measured"), std::string::npos) << advice;
    EXPECT_NE(advice.find("It is not measured here"), std::string::npos) << advice;
    EXPECT_EQ(advice.find("0 %"), std::string::npos) << advice;
    // A rod instead of the spring, on which the ball swings.
    spring.spring = {};
    spring.anchorA.point = {2, 0, 0};
    scene.joints[0].settings = spring;
    ASSERT_TRUE(WriteScene(file, scene));
    const std::string ofRod = adviceFor();
    EXPECT_EQ(ofRod.find("not measured"), std::string::npos) << ofRod;
}

TEST_F(UserScene, OfTheSamplesErrsLessWithMoreSubsteps) {
    const auto command = ParseLabCommand({"advise", "bridge", "--budget", "2ms"});
    ASSERT_TRUE(command) << command.GetError().message;
    const std::vector<RunRecord> runs = RunAt(command.Value().lab, {1, 4, 16});
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_GT(runs[0].Error(), runs[1].Error()) << runs[0].worst << "; " << runs[1].worst;
    EXPECT_GT(runs[1].Error(), runs[2].Error()) << runs[1].worst << "; " << runs[2].worst;
    for (const RunRecord& run : runs) EXPECT_TRUE(run.failedConditions.empty());
}

TEST_F(UserScene, ThatCannotBeReadIsAnError) {
    for (const char* name : {"nothing.json", "bridg"}) {
        const auto command = ParseLabCommand({"advise", name, "--error", "1%"});
        ASSERT_FALSE(command) << name;
        EXPECT_NE(command.GetError().message.find(name[0] == 'n' ? "nothing.json" : "bridge"), std::string::npos)
            << command.GetError().message;
    }
}

}  // namespace
}  // namespace fulcrum::accuracy
