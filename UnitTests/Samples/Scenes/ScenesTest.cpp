// Every scene can be built and stepped; the performance scenes are exactly those that other engines are measured on.
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <string>

namespace fulcrum {
namespace {

std::unique_ptr<SceneWorld> Build(const Scene& scene, const SceneInput& input = {}) {
    auto world = SceneWorld::Create(scene, input);
    if (!world) {
        ADD_FAILURE() << scene.name << ": " << world.GetError().message;
        return nullptr;
    }
    return std::move(world.Value());
}

std::unique_ptr<SceneWorld> Build(const char* name) {
    const Scene* scene = FindScene(name);
    if (!scene) {
        ADD_FAILURE() << "no scene " << name;
        return nullptr;
    }
    return Build(*scene);
}

// Positions and masses of the dynamic bodies, in the order of their creation.
struct Placed {
    Position position;
    float mass;
};
std::vector<Placed> DynamicBodies(const SceneWorld& world) {
    std::vector<Placed> placed;
    world.System().VisitBodies([&](BodyId id) {
        if (world.Bodies().GetMotionType(id) == MotionType::Dynamic)
            placed.push_back({world.Bodies().GetPose(id).position, world.Bodies().GetMass(id)});
    });
    return placed;
}

// Positions are given in double and may pass through the center of mass and back: 1e-6 m is generous for boxes and
// balls, whose center is their origin, and for a hull whose center is a few millimeters off it.
void ExpectBodies(const std::vector<Placed>& placed, const std::vector<Position>& expected, double mass) {
    ASSERT_EQ(placed.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
        ASSERT_LT((placed[i].position - expected[i]).norm(), 1e-6) << "body " << i;
        ASSERT_NEAR(placed[i].mass, mass, 1e-5 * mass) << "body " << i;
    }
}

class EveryScene : public ::testing::TestWithParam<const Scene*> {};

TEST_P(EveryScene, StepsWithFinitePoses) {
    const Scene& scene = *GetParam();
    const auto world = Build(scene);
    ASSERT_TRUE(world);
    for (int step = 0; step < 3; ++step) ASSERT_TRUE(world->Step(1.0 / 60));
    EXPECT_EQ(world->NonFiniteBodies(), 0);
    EXPECT_EQ(world->StepCount(), 3);
    ASSERT_TRUE(scene.accuracy);
    EXPECT_TRUE(std::isfinite(scene.accuracy(*world)));
}

TEST_P(EveryScene, IsDescribedInOneLine) {
    const std::string name = GetParam()->name, description = GetParam()->description;
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string::npos) << name;
    EXPECT_FALSE(description.empty());
    EXPECT_EQ(description.find('\n'), std::string::npos);
    EXPECT_LE(description.size(), 110u) << name;
    EXPECT_FALSE(std::string(GetParam()->accuracyMeaning).empty());
    // Wall clock alone has no threshold.
    EXPECT_EQ(GetParam()->accuracyRange.has_value(), std::string(GetParam()->accuracyUnit) != "ms") << name;
    EXPECT_GT(GetParam()->steps, 0);
}

INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, ::testing::ValuesIn(AllScenes().begin(), AllScenes().end()),
                         [](const auto& scene) { return std::string(scene.param->name); });

TEST(Scenes, HaveNamesOfTheirOwn) {
    std::set<std::string> names;
    for (const Scene* scene : AllScenes()) EXPECT_TRUE(names.insert(scene->name).second) << scene->name;
    EXPECT_EQ(FindScene("no_such_scene"), nullptr);
}

TEST(Scenes, AreAllInTheTable) {
    size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(FULCRUM_SOURCE_DIR "/Samples/Scenes"))
        if (entry.path().extension() == ".cpp") ++files;
    // Scenes.cpp, SceneWorld.cpp, Drawing.cpp, Humanoid.cpp, PenetrationMeter.cpp, QueryGround.cpp, RestMeters.cpp,
    // SpringEnergy.cpp and WavyGround.cpp define none, and those of Drop.cpp and DropOnto.cpp need shapes from outside.
    EXPECT_EQ(AllScenes().size(), files - 11);
}

TEST(Scenes, AnotherSeedMakesAnotherWorldWhereASceneUsesIt) {
    for (const Scene* scene : AllScenes()) {
        if (scene->kind == SceneKind::Performance) {
            EXPECT_FALSE(scene->usesSeed) << scene->name;
            continue;
        }
        SceneInput other;
        other.seed = 2;
        const auto first = Build(*scene), again = Build(*scene), second = Build(*scene, other);
        ASSERT_TRUE(first && again && second);
        EXPECT_EQ(first->System().HashPoses(), again->System().HashPoses()) << scene->name;
        EXPECT_EQ(first->System().HashPoses() != second->System().HashPoses(), scene->usesSeed) << scene->name;
    }
}

TEST(PerformanceScenes, PyramidHas1240CubesOf2mHalfAMeterApart) {
    const auto world = Build("pyramid");
    ASSERT_TRUE(world);
    std::vector<Position> expected;
    for (int i = 0; i < 15; ++i)
        for (int j = i / 2; j < 15 - (i + 1) / 2; ++j)
            for (int k = i / 2; k < 15 - (i + 1) / 2; ++k)
                expected.push_back({-15.0 + 2 * j + (i % 2), 1 + 2.5 * i, -15.0 + 2 * k + (i % 2)});
    EXPECT_EQ(expected.size(), 1240u);
    ExpectBodies(DynamicBodies(*world), expected, 8000);
    EXPECT_FALSE(world->System().Settings().sleep.enabled);
}

TEST(PerformanceScenes, LargePyramidHas5050CubesOf1m) {
    const auto world = Build("large_pyramid");
    ASSERT_TRUE(world);
    std::vector<Position> expected;
    for (int i = 0; i < 100; ++i)
        for (int j = i; j < 100; ++j) expected.push_back({0.5 * (i + 1) + (j - i) - 50, i + 0.5, 0});
    EXPECT_EQ(expected.size(), 5050u);
    ExpectBodies(DynamicBodies(*world), expected, 1000);
    EXPECT_NEAR(world->Definition().accuracy(*world), 0, 1e-9);
}

TEST(PerformanceScenes, ManyPyramidsAre196OnAGrid) {
    const auto world = Build("many_pyramids");
    ASSERT_TRUE(world);
    std::vector<Position> expected;
    for (int row = 0; row < 14; ++row)
        for (int column = 0; column < 14; ++column)
            for (int i = 0; i < 10; ++i)
                for (int j = i; j < 10; ++j)
                    expected.push_back({0.5 * (i + 1) + (j - i) - 5 + 12 * (column - 6.5), i + 0.5, 10 * (row - 6.5)});
    EXPECT_EQ(expected.size(), 10780u);
    ExpectBodies(DynamicBodies(*world), expected, 1000);
    EXPECT_NEAR(world->Definition().accuracy(*world), 0, 1e-9);
}

TEST(PerformanceScenes, HullPileHas2560HullsOf32Points) {
    const auto world = Build("hull_pile");
    ASSERT_TRUE(world);
    std::vector<Position> expected;
    for (int layer = 0; layer < 40; ++layer)
        for (int x = 0; x < 8; ++x)
            for (int z = 0; z < 8; ++z) expected.push_back({4.0 * (x - 4), 2.0 + 4 * layer, 4.0 * (z - 4)});
    const std::vector<Placed> placed = DynamicBodies(*world);
    ExpectBodies(placed, expected, placed.at(0).mass);
    // Inside the ball of radius 2 m, and with 32 points not far from it.
    const double ball = 1000 * 4.0 / 3 * kPi * 8;
    EXPECT_LT(placed[0].mass, ball);
    EXPECT_GT(placed[0].mass, 0.75 * ball);
    world->System().VisitBodies([&](BodyId id) {
        if (const auto* hull = dynamic_cast<const ConvexHull*>(world->Bodies().GetShape(id).get())) {
            ASSERT_EQ(hull->Vertices().size(), 32u);
        }
    });
}

TEST(PerformanceScenes, DrumTurnsAt25DegreesASecondAbout8000Cubes) {
    const auto world = Build("drum");
    ASSERT_TRUE(world);
    std::vector<Position> expected;
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j)
            for (int k = 0; k < 20; ++k) expected.push_back({0.8 * (i - 9.5), 21 + 0.8 * (j - 9.5), 0.8 * (k - 9.5)});
    ExpectBodies(DynamicBodies(*world), expected, 64);
    world->System().VisitBodies([&](BodyId id) {
        if (world->Bodies().GetMotionType(id) != MotionType::Kinematic) return;
        EXPECT_LT((world->Bodies().GetPose(id).position - Position(0, 21, 0)).norm(), 1e-5);
        EXPECT_NEAR(world->Bodies().GetAngularVelocity(id).z(), 25 * kPi / 180, 1e-6);
        const auto drum = std::dynamic_pointer_cast<const Compound>(world->Bodies().GetShape(id));
        ASSERT_TRUE(drum);
        EXPECT_EQ(drum->Children().size(), 40u);
        // The ring's corners are at 18 m; the paddles' mass moves the center nowhere, since four of them balance.
        EXPECT_NEAR(drum->LocalBounds().upper.x(), 18, 1e-3);
        EXPECT_NEAR(drum->LocalBounds().upper.z(), 10, 1e-4);
    });
    EXPECT_EQ(world->Definition().accuracy(*world), 0);
}

TEST(PerformanceScenes, MostlyAsleepHas100000SleepersAnd100Balls) {
    const auto world = Build("mostly_asleep");
    ASSERT_TRUE(world);
    const std::vector<Placed> placed = DynamicBodies(*world);
    ASSERT_EQ(placed.size(), 100'100u);
    EXPECT_LT((placed[0].position - Position(-299.25, 0.25, -186.75)).norm(), 1e-9);
    EXPECT_LT((placed[99'999].position - Position(299.25, 0.25, 186.75)).norm(), 1e-9);
    EXPECT_LT((placed[100'000].position - Position(-90, 10, -90)).norm(), 1e-9);
    EXPECT_NEAR(placed[0].mass, 125, 1e-3);
    EXPECT_NEAR(placed[100'000].mass, 1000 * kPi / 6, 1e-2);
    size_t awake = 0;
    world->System().VisitBodies([&](BodyId id) {
        awake += world->Bodies().GetMotionType(id) == MotionType::Dynamic && world->Bodies().IsAwake(id);
    });
    EXPECT_EQ(awake, 100u);
    EXPECT_TRUE(world->System().Settings().sleep.enabled);
}

TEST(PerformanceScenes, RaysHitTheSameSinglyAndInABatch) {
    const auto world = Build("rays");
    ASSERT_TRUE(world);
    for (int step = 0; step < 30; ++step) ASSERT_TRUE(world->Step(1.0 / 60));
    const Scene& scene = world->Definition();
    scene.query(*world);
    const std::vector<WorldRayHit> batch = world->rayHits;
    scene.querySingly(*world);
    size_t different = 0;
    for (size_t i = 0; i < batch.size(); ++i)
        different += batch[i].body != world->rayHits[i].body || batch[i].fraction != world->rayHits[i].fraction;
    EXPECT_EQ(different, 0u);
    EXPECT_EQ(scene.accuracy(*world), 0);
}

TEST(PerformanceScenes, SayWhatIsMeasuredOfThem) {
    std::set<std::string> standing, driven;
    for (const Scene* scene : AllScenes()) {
        if (scene->kind != SceneKind::Performance) continue;
        if (scene->isBuiltToStand) standing.insert(scene->name);
        if (!scene->isClosed) driven.insert(scene->name);
    }
    EXPECT_EQ(standing, (std::set<std::string>{"pyramid", "large_pyramid", "many_pyramids"}));
    EXPECT_EQ(driven, (std::set<std::string>{"drum"}));
}

TEST(PerformanceScenes, RaysAre100000StraightDownOntoTheMesh) {
    const auto world = Build("rays");
    ASSERT_TRUE(world);
    EXPECT_EQ(DynamicBodies(*world).size(), 1764u);
    ASSERT_EQ(world->rays.size(), 100'000u);
    // The first number of SplitMix64 seeded with 1 is 0x910A2DEC89025CC1: its top 24 bits are 9505325.
    EXPECT_DOUBLE_EQ(world->rays[0].origin.x(), -150 + 300 * 9505325.0 / 16777216);
    for (const Ray& ray : world->rays) {
        ASSERT_EQ(ray.origin.y(), 60);
        ASSERT_EQ(ray.displacement, Vector3(0, -120, 0));
        ASSERT_LE(std::max(std::fabs(ray.origin.x()), std::fabs(ray.origin.z())), 150);
    }
    EXPECT_EQ(world->Definition().accuracy(*world), 100'000);
    world->Definition().query(*world);
    EXPECT_EQ(world->Definition().accuracy(*world), 0);
    EXPECT_EQ(world->Definition().queryCount, 100'000);
}

// The figures of the sample scenes, after their whole duration.
void ExpectFigure(const char* name) {
    const auto world = Build(name);
    ASSERT_TRUE(world);
    for (int step = 0; step < world->Definition().steps; ++step) ASSERT_TRUE(world->Step(1.0 / 60));
    const double figure = world->Definition().accuracy(*world);
    ASSERT_TRUE(world->Definition().accuracyRange);
    EXPECT_GE(figure, world->Definition().accuracyRange->lowest) << world->Definition().accuracyMeaning;
    EXPECT_LE(figure, world->Definition().accuracyRange->highest) << world->Definition().accuracyMeaning;
    // Bodies that roll off the floor fall forever, and the recording's camera follows them.
    if (world->System().Settings().gravity.y() < 0) {
        EXPECT_EQ(BodiesBelowTheFloor(*world), 0);
    }
}

TEST(SampleScenes, TheTowerStands) { ExpectFigure("tower"); }
TEST(SampleScenes, ConvexShapesStayOnTheFloor) { ExpectFigure("convex_shapes"); }
TEST(SampleScenes, AllDominoesFall) { ExpectFigure("dominoes"); }
TEST(SampleScenes, TheCardHouseStands) { ExpectFigure("card_house"); }
TEST(SampleScenes, NothingFallsThroughTheFloorOfTheWreckedPile) { ExpectFigure("wrecking_pile"); }
TEST(SampleScenes, BoxesStickOnARampByTheirOwnFriction) { ExpectFigure("friction_ramp"); }
TEST(SampleScenes, ABallOfRestitution1KeepsItsEnergy) { ExpectFigure("restitution_row"); }
TEST(SampleScenes, TheHandleKeepsItsAngularMomentum) { ExpectFigure("gyroscope"); }
TEST(SampleScenes, BallsRollDownAPlaneByTheFormula) { ExpectFigure("endless_slope"); }
TEST(SampleScenes, BallsStayInTheirBowls) { ExpectFigure("bowls"); }
TEST(SampleScenes, FreeBallsFallByTheFormula) { ExpectFigure("gravity_factors"); }
TEST(SampleScenes, BodiesOfThePlaneStayInIt) { ExpectFigure("flat_land"); }
TEST(SampleScenes, CratesFloatAndTheBargeRightsItself) { ExpectFigure("harbor"); }
TEST(SampleScenes, PlatformsCarryWhatStandsOnThem) { ExpectFigure("moving_platforms"); }
TEST(SampleScenes, BeltsCarryAllGoodsRoundTheLoop) { ExpectFigure("conveyor_belt"); }
TEST(SampleScenes, AStackHeavierBelowCarriesAHeavyLoad) { ExpectFigure("heavy_on_light"); }
TEST(SampleScenes, StructuresStandUnderTheirLoads) { ExpectFigure("structures"); }
TEST(SampleScenes, LayersPassOrCatch) { ExpectFigure("layers"); }
TEST(SampleScenes, BodiesFallThroughTheHolesOfTheTerrainAlone) { ExpectFigure("terrain_with_holes"); }
TEST(SampleScenes, RaysAgree) { ExpectFigure("query_rays"); }
TEST(SampleScenes, CastsEndAtATouch) { ExpectFigure("query_casts"); }
TEST(SampleScenes, OverlapsAgreeWithDistances) { ExpectFigure("query_overlaps"); }
TEST(SampleScenes, ClosestIsWhatAllBodiesOneByOneGive) { ExpectFigure("query_closest"); }
TEST(SampleScenes, TheBroadPhaseNamesAllThatIsHit) { ExpectFigure("query_bounds"); }
TEST(SampleScenes, ARemovedPillarWakesItsStackAlone) { ExpectFigure("trap_door"); }
TEST(SampleScenes, SensorsSeeAndScenesReact) { ExpectFigure("sensors"); }
TEST(SampleScenes, GlassBreaksAtItsStrength) { ExpectFigure("breaking_glass"); }

TEST(SampleScenes, ACoordinateThatWrapsPutsNoGearOutOfStep) { ExpectFigure("gears"); }
TEST(SampleScenes, ARackIsWhereItsPinionPutIt) { ExpectFigure("rack_and_pinion"); }
TEST(SampleScenes, TheCradleGoesOn) { ExpectFigure("newtons_cradle"); }

TEST(SampleScenes, ATowerLosesItsPiecesInACityOfCompounds) { ExpectFigure("compound_city"); }

}  // namespace
}  // namespace fulcrum
