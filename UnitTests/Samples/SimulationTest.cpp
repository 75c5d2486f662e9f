// The measuring of a run: its statistics, its report, its recording.
#include <Fulcrum/Math/Wide.h>
#include <Fulcrum/Samples/Runner/Recorder.h>
#include <Fulcrum/Samples/Runner/RunEnvironment.h>
#include <Fulcrum/Samples/Runner/RunReport.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace fulcrum {
namespace {

std::unique_ptr<SceneWorld> Build(const char* name) {
    auto world = SceneWorld::Create(*FindScene(name));
    if (!world) ADD_FAILURE() << world.GetError().message;
    return world ? std::move(world.Value()) : nullptr;
}

TEST(Statistics, OfAHundredSamples) {
    std::vector<double> samples;
    for (int i = 100; i >= 1; --i) samples.push_back(i);
    const Statistics result = Summarize(samples);
    EXPECT_DOUBLE_EQ(result.median, 50.5);
    EXPECT_DOUBLE_EQ(result.mean, 50.5);
    EXPECT_DOUBLE_EQ(result.p99, 99);
    EXPECT_DOUBLE_EQ(result.max, 100);
}

TEST(Statistics, OfOneSampleAndOfNone) {
    const Statistics one = Summarize({3});
    EXPECT_DOUBLE_EQ(one.median, 3);
    EXPECT_DOUBLE_EQ(one.p99, 3);
    EXPECT_DOUBLE_EQ(Summarize({}).max, 0);
}

TEST(Simulation, MeasuresARun) {
    const auto world = Build("tower");
    ASSERT_TRUE(world);
    int calls = 0;
    const auto run = Simulate(*world, 1, 30, 1.0 / 60, 1, [&] { ++calls; });
    ASSERT_TRUE(run) << run.GetError().message;
    const RunFigures& figures = run.Value();
    EXPECT_EQ(calls, 31);
    EXPECT_EQ(world->StepCount(), 31);
    EXPECT_EQ(figures.steps, 30);
    EXPECT_EQ(figures.bodies, 21u);
    EXPECT_EQ(figures.dynamicBodies, 20u);
    EXPECT_EQ(figures.islands, 1u);
    EXPECT_EQ(figures.poseHash, world->System().HashPoses());
    EXPECT_GT(figures.stepMs.median, 0);
    EXPECT_GE(figures.stepMs.max, figures.stepMs.p99);
    EXPECT_GT(figures.memoryBytes, 0u);
    // 20 cubes of 1000 kg at 0.5 .. 19.5 m.
    EXPECT_NEAR(figures.energyAtStart, 9.81 * 1000 * 200, 100);
}

// A tower of cubes falls by nothing: it is pushed by nothing, and gains nothing; who did most is named.
TEST(Simulation, ReportsErrorsWhereTheyAreMeasured) {
    SceneInput input;
    input.measuresErrors = true;
    const Scene& scene = *FindScene("tower");
    auto world = SceneWorld::Create(scene, input);
    ASSERT_TRUE(world);
    const auto run = Simulate(*world.Value(), 0, 60, 1.0 / 60, 1, [] {});
    ASSERT_TRUE(run);
    ASSERT_TRUE(run.Value().errors);
    const ErrorFigures& errors = *run.Value().errors;
    EXPECT_EQ(errors.effort.whose.substr(0, 4), "box ");
    EXPECT_EQ(errors.effort.value, 4);
    EXPECT_TRUE(errors.solvesDirectly);
    EXPECT_EQ(errors.jointError.whose, "");
    EXPECT_NEAR(errors.energyChange, run.Value().energyAtEnd - run.Value().energyAtStart, 1);
    const std::string text = ReportText(ReportLines(scene, run.Value(), 1));
    EXPECT_NE(text.find("Errors of a step, largest"), std::string::npos) << text;
    EXPECT_NE(text.find("loads solved directly"), std::string::npos) << text;
    const auto json = ReportJson("tower", run.Value(), 1)["errors"];
    EXPECT_EQ(json["substeps"]["whose"], errors.effort.whose);
    EXPECT_EQ(json["solves_directly"], true);
    const auto plain = Build("tower");
    const auto without = Simulate(*plain, 0, 2, 1.0 / 60, 1, [] {});
    ASSERT_TRUE(without);
    EXPECT_FALSE(without.Value().errors);
    EXPECT_FALSE(ReportJson("tower", without.Value(), 1).contains("errors"));
}

TEST(Simulation, ReportsForPeopleAndForPrograms) {
    const auto world = Build("tower");
    ASSERT_TRUE(world);
    const auto run = Simulate(*world, 0, 5, 1.0 / 60, 1, [] {});
    ASSERT_TRUE(run);
    const std::string text = ReportText(ReportLines(world->Definition(), run.Value(), 1));
    for (const char* part : {"bodies", "contacts", "islands", "median", "99th", "penetration", "energy", "pose hash",
                             "threads", "substeps", "seed"})
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
    const auto json = ReportJson("tower", run.Value(), 1);
    for (const char* field : {"scene", "threads", "bodies", "contacts", "steps", "median_ms", "mean_ms", "p99_ms",
                              "max_ms", "steps_per_s", "accuracy", "hash", "stages_ms", "settings"})
        EXPECT_TRUE(json.contains(field)) << field;
    EXPECT_EQ(json["hash"].get<std::string>(), HashText(world->System().HashPoses()));
    EXPECT_EQ(json["stages_ms"].size(), static_cast<size_t>(kStageCount));
}

// The figure of a scene whose figure a test sets, after a run of so many steps of 1/60 s; the scene's own is a second.
double theFigure = 0;
std::pair<AccuracyVerdict, std::string> Judged(double figure, int steps, std::optional<AccuracyRange> range) {
    theFigure = figure;
    Scene scene{.name = "judged", .description = "a scene", .steps = 60};
    scene.build = [](SceneWorld& world) { world.AddFloor(1, 1); };
    scene.accuracy = [](const SceneWorld&) { return theFigure; };
    scene.accuracyMeaning = "what a test says";
    scene.accuracyUnit = "m";
    scene.accuracyRange = range;
    const auto world = SceneWorld::Create(scene);
    const auto run = Simulate(*world.Value(), 0, steps, 1.0 / 60, 1, [] {});
    return {VerdictOf(scene, run.Value()), AccuracyText(scene, run.Value())};
}

TEST(Verdict, IsByTheThresholdOfTheScene) {
    const AccuracyRange range{-0.5, 2};
    const auto [good, goodText] = Judged(2, 60, range);
    EXPECT_EQ(good, AccuracyVerdict::Pass);
    EXPECT_EQ(goodText, "2 m, pass: -0.5 to 2 m is asked for (what a test says)");
    const auto [bad, badText] = Judged(-0.51, 60, range);
    EXPECT_EQ(bad, AccuracyVerdict::Fail);
    EXPECT_EQ(badText, "-0.51 m, FAIL: -0.5 to 2 m is asked for (what a test says)");
    EXPECT_EQ(Judged(std::numeric_limits<double>::quiet_NaN(), 60, range).first, AccuracyVerdict::Fail);
}

TEST(Verdict, IsNotGivenOfOtherRuns) {
    const auto [verdict, text] = Judged(1000, 30, AccuracyRange{0, 2});
    EXPECT_EQ(verdict, AccuracyVerdict::Unknown);
    EXPECT_EQ(text, "1000 m, not judged: the threshold, 0 to 2 m, is for 1 s, not 0.5 s (what a test says)");
    EXPECT_EQ(Judged(1000, 60, {}).first, AccuracyVerdict::Unknown);
    EXPECT_EQ(Judged(1000, 60, {}).second, "1000 m, no threshold (what a test says)");
}

TEST(RunDocument, SaysOfWhatItIs) {
    const auto world = Build("tower");
    ASSERT_TRUE(world);
    auto run = Simulate(*world, 0, 3, 1.0 / 60, 1, [] {});
    ASSERT_TRUE(run);
    run.Value().accuracy = std::numeric_limits<double>::quiet_NaN();
    const std::string text = RunDocument(world->Definition(), "tower", run.Value(), 1).dump();
    const auto json = nlohmann::json::parse(text);  // NaN is no JSON
    for (const char* field : {"schema", "program", "version", "date", "commit", "machine", "compiler", "lanes", "units",
                              "scene", "hash", "accuracy", "accuracy_unit", "accuracy_meaning", "accuracy_lowest"})
        EXPECT_TRUE(json.contains(field)) << field;
    EXPECT_EQ(json["schema"], kFileSchema);
    EXPECT_EQ(json["lanes"], kLanes);
    EXPECT_TRUE(json["accuracy"].is_null());
    EXPECT_TRUE(json["accuracy_passed"].is_null());
    EXPECT_EQ(json["machine"]["cores"].is_number(), true);
    // Every field of a quantity says its unit by its ending.
    for (const auto& [name, value] : json["units"].items()) EXPECT_TRUE(value.is_string()) << name;
}

// A box that slides 4 / (2 mu g) = 0.408 m in 0.408 s and rests; another rests all the time.
void BuildSliding(SceneWorld& world) {
    world.AddFloor(20, 20);
    const ShapePtr cube = world.BoxOf(0.5f, 0.5f, 0.5f);
    world.Add({.shape = cube, .position = {0, 0.5, 0}, .linearVelocity = {2, 0, 0}});
    world.Add({.shape = cube, .position = {0, 0.5, 5}});
}

const Scene kSliding{.name = "sliding",
                     .description = "a box slides until it rests",
                     .isBuiltToStand = true,
                     .isClosed = true,
                     .build = BuildSliding};

Result<RunFigures> RunSliding(const Scene& scene, int steps) {
    auto world = SceneWorld::Create(scene);
    if (!world) return world.GetError();
    return Simulate(*world.Value(), 0, steps, 1.0 / 60, 1, [] {});
}

TEST(RestFigures, AreThoseOfABoxThatSlidesUntilItRests) {
    const auto run = RunSliding(kSliding, 120);
    ASSERT_TRUE(run);
    const RunFigures& figures = run.Value();
    const double way = 4 / (2 * 0.5 * 9.81);
    ASSERT_TRUE(figures.drift && figures.sleep && figures.energyRise);
    // As in DriftMeter: the way of a substep.
    EXPECT_NEAR(figures.drift->largest, way, 2.0 / 240);
    EXPECT_NEAR(figures.drift->mean, figures.drift->largest / 2, 1e-4);
    EXPECT_LT(figures.endSpeed.value(), 1e-3);  // it was 2 m/s before the last second
    ASSERT_TRUE(figures.sleep->seconds);
    // Slow from 5 cm/s on, of which the means of its velocity still know something after half a second.
    EXPECT_NEAR(*figures.sleep->seconds, 1.95 / (0.5 * 9.81) + 0.5, 3.5 / 60);
    EXPECT_DOUBLE_EQ(figures.sleep->limit, 2);
    EXPECT_LT(figures.energyRise->relative, 1e-3);
    const auto json = ReportJson("sliding", figures, 1);
    EXPECT_DOUBLE_EQ(json["largest_drift_m"].get<double>(), figures.drift->largest);
    EXPECT_DOUBLE_EQ(json["mean_drift_m"].get<double>(), figures.drift->mean);
    EXPECT_DOUBLE_EQ(json["end_speed_m_s"].get<double>(), *figures.endSpeed);
    EXPECT_DOUBLE_EQ(json["asleep_s"].get<double>(), *figures.sleep->seconds);
    EXPECT_DOUBLE_EQ(json["energy_rise_j"].get<double>(), figures.energyRise->joules);
    EXPECT_DOUBLE_EQ(json["energy_rise"].get<double>(), figures.energyRise->relative);
    const std::string text = ReportText(ReportLines(kSliding, figures, 1));
    for (const char* part : {"drift sideways", "speed in the last second", "all asleep", "energy from nothing"})
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST(RestFigures, AreJudgedByWhatTheyAreRelativeTo) {
    const auto run = RunSliding(kSliding, 12);
    ASSERT_TRUE(run);
    RunFigures figures = run.Value();
    for (const auto& [relative, word] : {std::pair(0.0007, "613.6 kJ, 0.07 % of that at the start, good"),
                                         {0.01, "1 % of that at the start, good"},
                                         {0.02, "2 % of that at the start, fair"},
                                         {0.2, "20 % of that at the start, poor"}}) {
        figures.energyRise = EnergyRise{613.6e3, relative};
        figures.overlapPair = "box 1 and box 2";
        figures.overlap.relative = relative;
        const std::string text = ReportText(ReportLines(kSliding, figures, 1));
        EXPECT_NE(text.find(word), std::string::npos) << text;
        EXPECT_NE(text.find(std::string("of the inner radius, ") + JudgementOf(relative)), std::string::npos) << text;
    }
}

TEST(RestFigures, TheSpeedIsThatOfTheLastSecondOfAShortRun) {
    const auto run = RunSliding(kSliding, 12);
    ASSERT_TRUE(run);
    // The first step brakes by mu g / 60 already, each substep by a quarter of it.
    const double braked = 0.5 * 9.81 / 60;
    EXPECT_LT(run.Value().endSpeed.value(), 2);
    EXPECT_GT(run.Value().endSpeed.value(), 2 - braked);
    ASSERT_TRUE(run.Value().sleep);
    EXPECT_FALSE(run.Value().sleep->seconds);
    EXPECT_EQ(ReportJson("sliding", run.Value(), 1)["asleep_s"], "never");
}

TEST(RestFigures, WhatASceneDoesNotHaveIsNull) {
    Scene scene = kSliding;
    scene.isBuiltToStand = scene.isClosed = scene.sleeping = false;
    const auto run = RunSliding(scene, 3);
    ASSERT_TRUE(run);
    EXPECT_FALSE(run.Value().drift || run.Value().sleep || run.Value().energyRise);
    const auto json = ReportJson("sliding", run.Value(), 1);
    for (const char* field : {"largest_drift_m", "mean_drift_m", "asleep_s", "asleep_limit_s", "energy_rise"})
        EXPECT_TRUE(json.at(field).is_null()) << field;
    EXPECT_TRUE(json["end_speed_m_s"].is_number());
}

TEST(RestFigures, OfARunOfTheirOwnAreTheSame) {
    auto world = SceneWorld::Create(kSliding);
    ASSERT_TRUE(world);
    const auto timed = Simulate(
        *world.Value(), 1, 119, 1.0 / 60, 1, [] {}, RestMeters::Off);
    const auto measured = RunSliding(kSliding, 120);
    ASSERT_TRUE(timed && measured);
    RunFigures figures = timed.Value();
    EXPECT_FALSE(figures.drift || figures.endSpeed || figures.sleep || figures.energyRise);
    EXPECT_TRUE(ReportJson("sliding", figures, 1)["end_speed_m_s"].is_null());
    ASSERT_TRUE(MeasureRest(kSliding, {}, nullptr, 120, 1.0 / 60, figures));
    ASSERT_TRUE(figures.drift && figures.sleep && figures.energyRise);
    EXPECT_EQ(figures.drift->largest, measured.Value().drift->largest);
    EXPECT_EQ(figures.endSpeed, measured.Value().endSpeed);
    EXPECT_EQ(figures.sleep->seconds, measured.Value().sleep->seconds);
    EXPECT_EQ(figures.energyRise->joules, measured.Value().energyRise->joules);
}

TEST(MeasureSleep, TurnsSleepingOn) {
    Scene scene = kSliding;
    scene.sleeping = false;
    const auto sleep = MeasureSleep(scene, {}, nullptr, 1.0 / 60, 5),
               early = MeasureSleep(scene, {}, nullptr, 1.0 / 60, 0.5);
    ASSERT_TRUE(sleep && early);
    ASSERT_TRUE(sleep.Value().seconds);
    // A tenth of a second for the means of the velocity that must have forgotten the braking.
    EXPECT_NEAR(*sleep.Value().seconds, 1.95 / (0.5 * 9.81) + 0.5 + 0.05, 0.05 + 2.5 / 60);
    EXPECT_FALSE(early.Value().seconds);
    EXPECT_DOUBLE_EQ(early.Value().limit, 0.5);
}

TEST(AccuracyOfRuns, GravityDiffersByAMillionth) {
    const auto accuracy = [](const SceneWorld& world) {
        return double{world.System().Settings().gravity.y()} * world.StepCount();
    };
    const Scene scene{.name = "sliding",
                      .description = "a box slides until it rests",
                      .accuracyRuns = 8,
                      .build = BuildSliding,
                      .accuracy = accuracy};
    const auto runs = AccuracyOfRuns(scene, {}, nullptr, 12, 1.0 / 60);
    ASSERT_TRUE(runs);
    ASSERT_EQ(runs.Value().size(), 8u);
    for (int i = 0; i < 8; ++i) {
        const auto gravity = static_cast<float>(double{-9.81f} * (1 + 1e-6 * i));
        EXPECT_EQ(runs.Value()[static_cast<size_t>(i)], 12 * double{gravity}) << i;
    }
    // The first is that of the run that is timed.
    const auto run = RunSliding(scene, 12);
    ASSERT_TRUE(run);
    EXPECT_EQ(run.Value().accuracy, runs.Value()[0]);
}

TEST(Simulation, TimesQueriesOneByOneBesideTheBatch) {
    const auto world = Build("rays");
    ASSERT_TRUE(world);
    const auto run = Simulate(*world, 0, 1, 1.0 / 60, 1, [] {});
    ASSERT_TRUE(run);
    EXPECT_EQ(run.Value().queryCount, 100'000);
    EXPECT_GT(run.Value().singleQueryNs, 0);
    EXPECT_EQ(run.Value().accuracy, 0);
    EXPECT_TRUE(ReportJson("rays", run.Value(), 1).contains("single_query_ns"));
}

TEST(Recorder, KeepsEveryStepOfASmallWorld) {
    const auto world = Build("tower");
    ASSERT_TRUE(world);
    Recorder recorder(*world, 10, 1.0 / 60);
    ASSERT_TRUE(Simulate(*world, 0, 10, 1.0 / 60, 1, [&] { recorder.AfterStep(); }));
    const Recording& recording = recorder.recording;
    EXPECT_EQ(recording.bodies.size(), 21u);
    EXPECT_EQ(recording.shapes.size(), 2u);  // floor and cube, shared
    ASSERT_EQ(recording.frames.size(), 11u);
    EXPECT_DOUBLE_EQ(recording.frames[0].time, 0);
    EXPECT_NEAR(recording.frames[10].time, 10.0 / 60, 1e-12);
    size_t top = 0;
    for (size_t i = 1; i < recording.bodies.size(); ++i)
        if (recording.latest[i].position.y() > recording.latest[top].position.y()) top = i;
    const Position expected = world->Bodies().GetPose(world->watched.back()).position;
    EXPECT_LT((recording.latest[top].position.cast<double>() - expected).norm(), 1e-5);
    EXPECT_FALSE(recording.frames[10].contacts.empty());
}

TEST(Recorder, KeepsEveryTriangleOfAMesh) {
    const auto world = Build("convex_on_mesh");
    ASSERT_TRUE(world);
    const Recorder recorder(*world, 1, 1.0 / 60);
    const RecordedShape& mesh = recorder.recording.shapes[0];
    EXPECT_EQ(mesh.name, "triangle mesh");
    ASSERT_EQ(mesh.triangles.size(), 20000u);
    EXPECT_EQ(mesh.vertices.size(), 101u * 101u);
    // Seen from above 300 m x 300 m, once, with the front upwards.
    double area = 0;
    for (const auto& t : mesh.triangles) {
        const Vector3 u = mesh.vertices[t[1]] - mesh.vertices[t[0]], v = mesh.vertices[t[2]] - mesh.vertices[t[0]];
        const double up = 0.5 * double(Cross<float>(u, v).y());
        EXPECT_GT(up, 0);
        area += up;
    }
    EXPECT_NEAR(area, 300 * 300, 1);
}

TEST(Recorder, ShortStepsShareAFrame) {
    const auto world = Build("tower");
    ASSERT_TRUE(world);
    Recorder recorder(*world, 9, 1.0 / 240);
    ASSERT_TRUE(Simulate(*world, 0, 9, 1.0 / 240, 1, [&] { recorder.AfterStep(); }));
    EXPECT_EQ(recorder.recording.frames.size(), 4u);  // after 0, 4, 8 and, as the last, 9 steps
}

// The presences of a body, which must be in the recording.
std::vector<RecordedPresence> PresencesOf(const Recording& recording, uint32_t body) {
    std::vector<RecordedPresence> own;
    for (const RecordedPresence& one : PresencesOf(recording))
        if (one.body == body) own.push_back(one);
    EXPECT_FALSE(own.empty()) << "body " << body;
    return own.empty() ? std::vector<RecordedPresence>(1) : own;
}

TEST(Recorder, ARemovedBodyIsThereUntilItsFrame) {
    const auto world = Build("trap_door");
    ASSERT_TRUE(world);
    const uint32_t pillar = world->watched[0].index;
    Recorder recorder(*world, 200, 1.0 / 60);
    size_t goneAt = 0;
    ASSERT_TRUE(Simulate(*world, 0, 200, 1.0 / 60, 1, [&] {
        recorder.AfterStep();
        if (goneAt == 0 && !world->Bodies().Exists(world->watched[0])) goneAt = recorder.recording.frames.size() - 1;
    }));
    const auto presences = PresencesOf(recorder.recording, pillar);
    ASSERT_EQ(presences.size(), 1u);
    EXPECT_EQ(presences[0].from, 0u);
    EXPECT_GT(goneAt, 0u);
    EXPECT_EQ(presences[0].until, goneAt);
    EXPECT_FALSE(recorder.recording.latest[pillar].isThere);
}

TEST(Recorder, ABodyAddedLaterIsThereFromItsFrame) {
    const auto world = Build("tower");
    ASSERT_TRUE(world);
    Recorder recorder(*world, 4, 1.0 / 60);
    const auto step = [&] {
        ASSERT_TRUE(world->Step(1.0 / 60));
        recorder.AfterStep();
    };
    step();
    ASSERT_TRUE(world->Bodies().Remove(world->watched.back()));
    step();  // forgets it, so that the next body is given its index
    const BodyId late = world->Add({.shape = world->SphereOf(0.2f), .position = {5, 3, 0}});
    EXPECT_EQ(late.index, world->watched.back().index);
    step();
    const auto presences = PresencesOf(recorder.recording, 21);
    EXPECT_EQ(presences[0].from, 3u);
    EXPECT_EQ(presences[0].until, 4u);
    EXPECT_EQ(recorder.recording.shapes[presences[0].shape].kind, RecordedShapeKind::Sphere);
    EXPECT_NEAR(recorder.recording.latest[21].position.x(), 5, 1e-6);
    EXPECT_EQ(PresencesOf(recorder.recording, world->watched.back().index)[0].until, 2u);
}

TEST(Recorder, AnEditedHeightFieldIsRecordedAnew) {
    const auto world = Build("terrain_with_holes");
    ASSERT_TRUE(world);
    Recorder recorder(*world, 310, 1.0 / 60);
    ASSERT_TRUE(Simulate(*world, 0, 310, 1.0 / 60, 1, [&] { recorder.AfterStep(); }));
    const auto presences = PresencesOf(recorder.recording, world->watched[0].index);
    ASSERT_EQ(presences.size(), 2u);
    EXPECT_EQ(presences[1].from, 301u);  // after 5 s
    const size_t before = recorder.recording.shapes[presences[0].shape].triangles.size();
    const size_t after = recorder.recording.shapes[presences[1].shape].triangles.size();
    // A square of 8 x 8 cells opens, of two triangles each.
    EXPECT_EQ(before - after, 128u);
}

TEST(Recorder, AnExchangedShapeIsDrawnFromItsFrameOn) {
    const auto world = Build("tower");
    ASSERT_TRUE(world);
    Recorder recorder(*world, 2, 1.0 / 60);
    ASSERT_TRUE(world->Step(1.0 / 60));
    recorder.AfterStep();
    ASSERT_TRUE(world->Bodies().SetShape(world->watched[0], world->SphereOf(0.4f)));
    ASSERT_TRUE(world->Step(1.0 / 60));
    recorder.AfterStep();
    const auto presences = PresencesOf(recorder.recording, world->watched[0].index);
    ASSERT_EQ(presences.size(), 2u);
    EXPECT_EQ(presences[0].until, 2u);
    EXPECT_EQ(recorder.recording.shapes[presences[0].shape].kind, RecordedShapeKind::Box);
    EXPECT_EQ(recorder.recording.shapes[presences[1].shape].kind, RecordedShapeKind::Sphere);
}

TEST(Recorder, SaysWhichBodiesAreSensors) {
    const auto world = Build("sensors");
    ASSERT_TRUE(world);
    const Recorder recorder(*world, 1, 1.0 / 60);
    for (uint32_t i = 0; i < recorder.recording.bodies.size(); ++i)
        EXPECT_EQ(recorder.recording.bodies[i].isSensor, i >= 1 && i <= 4) << i;  // after the floor
}

TEST(Recorder, ChildrenThatComeAndGoAreBodiesOfTheirOwn) {
    const auto world = Build("compound_city");
    ASSERT_TRUE(world);
    Recorder recorder(*world, 130, 1.0 / 60);
    // After the floor and 24 districts: the tower's 153 pieces, of which the first four are lost after 120 to 129
    // steps.
    ASSERT_GT(recorder.recording.latest.size(), 178u);
    const Vector3 first = recorder.recording.latest[25].position, fifth = recorder.recording.latest[29].position;
    EXPECT_LT(Length(first - Vector3(-2, 8.1f, -2)), 1e-5f);
    ASSERT_TRUE(Simulate(*world, 0, 130, 1.0 / 60, 1, [&] { recorder.AfterStep(); }));
    for (size_t i = 25; i < 29; ++i) EXPECT_FALSE(recorder.recording.latest[i].isThere) << i;
    EXPECT_EQ(recorder.recording.latest[29].position, fifth);
}

TEST(Recorder, PlacesTheChildrenOfACompoundWhereTheirOwnFrameIs) {
    const auto world = Build("gyroscope");
    ASSERT_TRUE(world);
    const Recorder recorder(*world, 1, 1.0 / 60);
    const auto handle =
        std::find_if(recorder.recording.shapes.begin(), recorder.recording.shapes.end(),
                     [](const RecordedShape& shape) { return shape.kind == RecordedShapeKind::Compound; });
    ASSERT_NE(handle, recorder.recording.shapes.end());
    ASSERT_EQ(handle->children.size(), 2u);
    EXPECT_LT(Length(handle->children[0].pose.position), 1e-6f);
    EXPECT_LT(Length(handle->children[1].pose.position - Vector3(0, -0.35f, 0)), 1e-6f);
}

}  // namespace
}  // namespace fulcrum
