// The command lines of ./fulcrum accuracy and ./fulcrum advise.
#include <Fulcrum/PerformanceTest/Accuracy/Options.h>
#include <Fulcrum/PerformanceTest/Accuracy/Registry.h>

namespace fulcrum::accuracy {
namespace {

TEST(LabOptions, DefaultsAreTheFullGridOfAllScenes) {
    const auto command = ParseLabCommand({});
    ASSERT_TRUE(command);
    EXPECT_EQ(command.Value().lab.scenes.size(), AllLabScenes().size());
    EXPECT_FALSE(command.Value().lab.isQuick);
    EXPECT_EQ(command.Value().lab.threads, 1);
    EXPECT_EQ(command.Value().lab.folder, "out/accuracy");
}

TEST(LabOptions, AllAreTaken) {
    const auto command = ParseLabCommand({"--scene", "incline", "--quick", "--threads", "2", "--out", "here",
                                          "--resume", "--table", "Docs/Accuracy.md"});
    ASSERT_TRUE(command);
    EXPECT_EQ(command.Value().lab.scenes.size(), 2u);
    EXPECT_TRUE(command.Value().lab.isQuick && command.Value().lab.resumes);
    EXPECT_EQ(command.Value().lab.threads, 2);
    EXPECT_EQ(command.Value().lab.folder, "here");
    EXPECT_EQ(command.Value().table, "Docs/Accuracy.md");
}

TEST(LabOptions, SoakIsOneLongRunOfItsOwn) {
    const auto command = ParseLabCommand({"--soak"});
    ASSERT_TRUE(command);
    ASSERT_EQ(command.Value().lab.scenes.size(), 1u);
    EXPECT_EQ(command.Value().lab.scenes[0]->FullName(), "soak");
    EXPECT_EQ(command.Value().lab.settings, std::vector<Setting>{Setting{}});
    EXPECT_FALSE(command.Value().lab.isQuick);
    EXPECT_FALSE(ParseLabCommand({"--soak", "--quick"}));
    EXPECT_FALSE(ParseLabCommand({"--soak", "--scene", "incline"}));
    EXPECT_FALSE(ParseLabCommand({"--soak", "--baseline", "x.json"}));
}

TEST(LabOptions, TargetsAreComparedWhereSomethingIsSolved) {
    const auto command = ParseLabCommand({"--targets", "--quick", "--out", "here"});
    ASSERT_TRUE(command);
    EXPECT_TRUE(command.Value().lab.comparesTargets && command.Value().lab.isQuick);
    EXPECT_EQ(command.Value().lab.folder, "here/targets");
    for (const LabScene* scene : command.Value().lab.scenes) EXPECT_NE(scene->FullName(), "projectile");
    EXPECT_GT(command.Value().lab.scenes.size(), 40u);
    EXPECT_FALSE(ParseLabCommand({"--targets", "--soak"}));
    EXPECT_FALSE(ParseLabCommand({"--targets", "--save", "x.json"}));
}

TEST(LabOptions, RecordsOneSettingOrAll) {
    EXPECT_FALSE(ParseLabCommand({"--quick"}).Value().recordings.AreWanted());
    const auto one = ParseLabCommand({"--quick", "--record", "soft 1/60 4 1 1"});
    ASSERT_TRUE(one);
    EXPECT_EQ(one.Value().recordings.setting, "soft 1/60 4 1 1");
    EXPECT_TRUE(one.Value().recordings.isQuick && one.Value().recordings.AreWanted());
    EXPECT_TRUE(ParseLabCommand({"--recordings"}).Value().recordings.isOfAll);
}

TEST(LabOptions, ScenesMayBeLeftOut) {
    const size_t all = AllLabScenes().size();
    EXPECT_EQ(ParseLabCommand({"--without", "huge.box,coincident.4096"}).Value().lab.scenes.size(), all - 2);
    EXPECT_EQ(ParseLabCommand({"--scene", "incline", "--without", "incline.stick"}).Value().lab.scenes.size(), 1u);
    EXPECT_FALSE(ParseLabCommand({"--without", "hug.box"}));
    EXPECT_FALSE(ParseLabCommand({"--scene", "pendulum", "--without", "pendulum"}));
}

TEST(LabOptions, AnUnknownSceneIsAnsweredWithTheNearest) {
    const auto command = ParseLabCommand({"--scene", "inclin"});
    ASSERT_FALSE(command);
    EXPECT_NE(command.GetError().message.find("incline"), std::string::npos) << command.GetError().message;
}

TEST(LabOptions, AdviseTakesPartsAndPerCentAndMilliseconds) {
    const auto error = ParseLabCommand({"advise", "weight", "--error", "1%"});
    ASSERT_TRUE(error);
    EXPECT_DOUBLE_EQ(error.Value().adviseError.value(), 0.01);
    EXPECT_TRUE(error.Value().lab.isQuick);
    EXPECT_FALSE(error.Value().lab.resumes) << "the engine may have changed";
    EXPECT_TRUE(ParseLabCommand({"advise", "weight", "--error", "1%", "--out", "mine"}).Value().lab.resumes);
    EXPECT_DOUBLE_EQ(ParseLabCommand({"advise", "weight", "--error", "0.02"}).Value().adviseError.value(), 0.02);
    EXPECT_DOUBLE_EQ(ParseLabCommand({"advise", "weight", "--budget", "2ms"}).Value().adviseBudget.value(), 2);
    EXPECT_FALSE(ParseLabCommand({"advise", "weight", "--error", "much"}));
    EXPECT_FALSE(ParseLabCommand({"advise", "weight"}));
    EXPECT_FALSE(ParseLabCommand({"advise", "--error", "1%"}));
}

}  // namespace
}  // namespace fulcrum::accuracy
