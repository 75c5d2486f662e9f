// The command lines of ./fulcrum run and drop, and their error messages.
#include <Fulcrum/Samples/Runner/NearestName.h>
#include <Fulcrum/Samples/Runner/Options.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <gtest/gtest.h>

#include <sstream>

namespace fulcrum {
namespace {

Result<Command> Parse(const std::string& line) {
    std::istringstream words(line);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    return ParseRunnerCommand(arguments);
}

Command Parsed(const std::string& line) {
    const auto command = Parse(line);
    if (command) return command.Value();
    ADD_FAILURE() << line << ": " << command.GetError().message;
    return {};
}

std::string Complaint(const std::string& line) {
    const auto command = Parse(line);
    if (!command) return command.GetError().message;
    ADD_FAILURE() << line << " was understood";
    return {};
}

void ExpectComplaint(const std::string& line, const std::string& part) {
    const std::string complaint = Complaint(line);
    EXPECT_NE(complaint.find(part), std::string::npos) << line << ": " << complaint;
    EXPECT_EQ(complaint.find('\n'), std::string::npos) << complaint;
}

TEST(NearestName, CountsInsertionsRemovalsReplacementsAndSwaps) {
    EXPECT_EQ(EditDistance("", ""), 0);
    EXPECT_EQ(EditDistance("abc", ""), 3);
    EXPECT_EQ(EditDistance("kitten", "sitting"), 3);
    EXPECT_EQ(EditDistance("pyramid", "pyarmid"), 1);
    EXPECT_EQ(EditDistance("drum", "drums"), 1);
}

TEST(NearestName, TreatsCaseAndDashesAsEqual) {
    const std::vector<std::string> names{"tower", "large_pyramid", "pyramid"};
    EXPECT_EQ(NearestName("Large-Pyramid", names), "large_pyramid");
    EXPECT_EQ(NearestName("pyramd", names), "pyramid");
    EXPECT_EQ(NearestName("anything", {}), "");
}

TEST(RunnerOptions, HaveDefaultsThatWork) {
    const Command command = Parsed("run pyramid");
    EXPECT_EQ(command.kind, CommandKind::Run);
    ASSERT_TRUE(command.scene);
    EXPECT_STREQ(command.scene->name, "pyramid");
    EXPECT_TRUE(command.options.recordHtml && command.options.recordGlb);
    EXPECT_EQ(command.options.StepsOf(*command.scene), command.scene->steps);
    EXPECT_DOUBLE_EQ(command.options.dt, 1.0 / 60);
    EXPECT_GE(command.options.threads, 1);
    EXPECT_EQ(command.options.solver.substeps, SolverSettings().substeps);
    EXPECT_EQ(command.options.seed, 1u);
}

TEST(RunnerOptions, AreAllRead) {
    const Command command = Parsed(
        "run tower --steps 12 --dt 0.01 --threads 3 --substeps 2 --velocity-iterations 7 --position-iterations 0 "
        "--position-correction baumgarte --record glb --json out.json --seed 18446744073709551615");
    EXPECT_EQ(command.options.StepsOf(*command.scene), 12);
    EXPECT_DOUBLE_EQ(command.options.dt, 0.01);
    EXPECT_EQ(command.options.threads, 3);
    EXPECT_EQ(command.options.solver.substeps, 2);
    EXPECT_EQ(command.options.solver.velocityIterations, 7);
    EXPECT_EQ(command.options.solver.positionIterations, 0);
    EXPECT_EQ(command.options.solver.positionCorrection, PositionCorrection::Baumgarte);
    EXPECT_FALSE(command.options.recordHtml);
    EXPECT_TRUE(command.options.recordGlb);
    EXPECT_EQ(command.options.json, "out.json");
    EXPECT_EQ(command.options.seed, UINT64_MAX);
}

TEST(RunnerOptions, SayWhereToAndWhetherToSpeak) {
    const Command command = Parsed("run tower --out some/where --quiet"), usual = Parsed("run tower");
    EXPECT_EQ(command.options.out, "some/where");
    EXPECT_TRUE(command.options.isQuiet);
    EXPECT_EQ(usual.options.out, "out");
    EXPECT_FALSE(usual.options.isQuiet);
}

TEST(RunnerOptions, TellTheVersionAndHelpWithACommand) {
    EXPECT_EQ(Parsed("--version").kind, CommandKind::Version);
    EXPECT_EQ(Parsed("help run").help, Parsed("run --help").help);
    EXPECT_EQ(Parsed("help").help, Parsed("--help").help);
    ExpectComplaint("help rnu", "run");
}

TEST(RunnerOptions, NameTheNarrowPhase) {
    EXPECT_EQ(Parsed("run tower").options.narrowPhase, NarrowPhaseMethod::Automatic);
    EXPECT_EQ(Parsed("run tower --narrow-phase automatic").options.narrowPhase, NarrowPhaseMethod::Automatic);
    EXPECT_EQ(Parsed("run tower --narrow-phase libccd").options.narrowPhase, NarrowPhaseMethod::Libccd);
    EXPECT_EQ(Parsed("drop a.obj --narrow-phase libccd").options.narrowPhase, NarrowPhaseMethod::Libccd);
    ExpectComplaint("run tower --narrow-phase bullet", "--narrow-phase takes automatic or libccd, not 'bullet'");
    ExpectComplaint("run tower --narrow-phase", "--narrow-phase");
    EXPECT_NE(Parsed("run --help").help.find("--narrow-phase"), std::string::npos);
}

TEST(RunnerOptions, SecondsBecomeSteps) {
    const Command five = Parsed("run tower --seconds 5"), third = Parsed("run tower --seconds 0.1 --dt 0.03");
    EXPECT_EQ(five.options.StepsOf(*five.scene), 300);
    EXPECT_EQ(third.options.StepsOf(*third.scene), 4);
    // A scene's own duration is in seconds: half the dt, twice the steps.
    const Command halved = Parsed("run pyramid --dt 0.00833333333333333333");
    EXPECT_EQ(halved.options.StepsOf(*halved.scene), 2 * halved.scene->steps);
}

TEST(RunnerOptions, RecordTakesAList) {
    const Command both = Parsed("run tower --record html,glb"), none = Parsed("run tower --record none");
    EXPECT_TRUE(both.options.recordHtml && both.options.recordGlb);
    EXPECT_FALSE(none.options.recordHtml || none.options.recordGlb);
}

TEST(RunnerOptions, DropTakesAFileAndACount) {
    const Command command = Parsed("drop some/teapot.obj --count 7 --steps 3");
    EXPECT_EQ(command.kind, CommandKind::Drop);
    EXPECT_EQ(command.file, "some/teapot.obj");
    EXPECT_EQ(command.count, 7);
    EXPECT_EQ(command.options.StepsOf(*command.scene), 3);
}

TEST(RunnerOptions, DropMayBeOntoAMesh) {
    const Command command = Parsed("drop teapot.obj --onto bunny.ply --onto-scale 0.5 --onto-up -z");
    EXPECT_EQ(command.onto, "bunny.ply");
    ASSERT_TRUE(command.ontoSettings.scale);
    EXPECT_DOUBLE_EQ(*command.ontoSettings.scale, 0.5);
    EXPECT_EQ(command.ontoSettings.up, UpAxis::MinusZ);
    EXPECT_EQ(command.scene, &DropOntoScene::kScene);
    EXPECT_EQ(Parsed("drop teapot.obj").scene, &DropScene::kScene);
    EXPECT_FALSE(Parsed("drop teapot.obj --onto bunny.ply").ontoSettings.scale);
    ExpectComplaint("drop teapot.obj --onto-scale 2", "--onto");
    ExpectComplaint("drop teapot.obj --onto bunny.ply --onto-scale 0", "nearest valid value is 1e-06");
    ExpectComplaint("drop teapot.obj --onto bunny.ply --onto-up up", "axis of --onto-up");
}

TEST(RunnerOptions, PresetsAreTheSettingsOfTheirNames) {
    EXPECT_EQ(Parsed("run tower --preset fast").options.solver, SolverSettings::Fast());
    EXPECT_EQ(Parsed("run tower --preset balanced").options.solver, SolverSettings{});
    EXPECT_EQ(Parsed("run tower --preset accurate").options.solver, SolverSettings::Accurate());
    EXPECT_EQ(Parsed("run tower --preset reference").options.solver, SolverSettings::Reference());
    // Numbers come on top, wherever they stand.
    SolverSettings more = SolverSettings::Accurate();
    more.velocityIterations = 3;
    EXPECT_EQ(Parsed("run tower --velocity-iterations 3 --preset accurate").options.solver, more);
}

TEST(RunnerOptions, ListAndHelp) {
    EXPECT_EQ(Parsed("list").kind, CommandKind::List);
    EXPECT_NE(Parsed("--help").help.find("drop"), std::string::npos);
    EXPECT_NE(Parsed("").help.find("run"), std::string::npos);
    const Command help = Parsed("run --help");
    EXPECT_EQ(help.kind, CommandKind::Help);
    for (const char* option : {"--steps", "--seconds", "--dt", "--threads", "--substeps", "--velocity-iterations",
                               "--position-iterations", "--position-correction", "--record", "--json", "--seed"})
        EXPECT_NE(help.help.find(option), std::string::npos) << option;
}

TEST(RunnerOptions, ErrorsOfUnknownNamesSuggestTheNearest) {
    ExpectComplaint("run pyramyd", "unknown scene 'pyramyd'; the nearest is 'pyramid'");
    ExpectComplaint("run drumm --steps 3", "'drum'");
    ExpectComplaint("run pyramid --stpes 5", "unknown option '--stpes'; the nearest is '--steps'");
    ExpectComplaint("run --substep=2 pyramid", "unknown option '--substep'; the nearest is '--substeps'");
    ExpectComplaint("run pyramid --velocity_iterations 5", "'--velocity-iterations'");
    ExpectComplaint("run pyramid -steps 5", "'--steps'");
    ExpectComplaint("run pyramid --preset fats", "unknown --preset 'fats'; the nearest is 'fast'");
    ExpectComplaint("run pyramid --record htm", "unknown kind of --record 'htm'; the nearest is 'html'");
    ExpectComplaint("run pyramid --record html,gbl", "'glb'");
    ExpectComplaint("runn pyramid", "unknown command 'runn'; the nearest is 'run'");
    ExpectComplaint("drop teapot.obj --coutn 5", "'--count'");
}

TEST(RunnerOptions, ErrorsOfValuesOutOfRangeSuggestTheNearest) {
    ExpectComplaint("run pyramid --steps 0", "--steps 0 is outside 1 to 10000000; the nearest valid value is 1");
    ExpectComplaint("run pyramid --steps -4", "nearest valid value is 1");
    ExpectComplaint("run pyramid --steps 99999999999999999999", "nearest valid value is 10000000");
    ExpectComplaint("run pyramid --substeps 256", "nearest valid value is 255");
    ExpectComplaint("run pyramid --velocity-iterations 0", "nearest valid value is 1");
    ExpectComplaint("run pyramid --position-iterations 256", "nearest valid value is 255");
    ExpectComplaint("run pyramid --position-correction baumgart", "baumgarte");
    ExpectComplaint("run pyramid --threads 0", "nearest valid value is 1");
    ExpectComplaint("run pyramid --dt 2", "nearest valid value is 1");
    ExpectComplaint("run pyramid --dt inf", "nearest valid value is 1");
    ExpectComplaint("run pyramid --seed -1", "--seed");
    ExpectComplaint("drop teapot.obj --count 0", "nearest valid value is 1");
}

TEST(RunnerOptions, ErrorsOfInvalidNumbersSayWhatIsExpected) {
    ExpectComplaint("run pyramid --steps many", "--steps takes a whole number from 1 to 10000000, not 'many'");
    ExpectComplaint("run pyramid --steps 3.5", "whole number");
    ExpectComplaint("run pyramid --steps 3x", "whole number");
    ExpectComplaint("run pyramid --dt nan", "a number");
    ExpectComplaint("run pyramid --dt", "--dt");
    ExpectComplaint("run pyramid --record none,html", "none stands alone");
    ExpectComplaint("run pyramid --record ,", "--record takes");
}

TEST(RunnerOptions, MissingAndSurplusWordsAreNamed) {
    ExpectComplaint("run", "scene's name");
    ExpectComplaint("drop", "mesh file");
    ExpectComplaint("run pyramid tower", "one argument too many: 'tower'");
    ExpectComplaint("run pyramid --steps 5 --seconds 3", "--seconds");
    ExpectComplaint("list pyramid", "one argument too many");
}

}  // namespace
}  // namespace fulcrum
