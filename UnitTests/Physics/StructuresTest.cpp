// What statics says stands: columns, loads, small bodies at the defaults, structures at the edge of falling at full
// effort. Islands under load get the substeps and passes that they ask for (AccuracyTarget).
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace fulcrum::testing {
namespace {

// Bodies and where they stand.
class Structure {
public:
    explicit Structure(const SystemSettings& settings = NoSleep()) : world(settings) { world.AddFloor(); }

    BodyId Add(const BodySettings& settings) {
        const BodyId id = world.Add(settings);
        bodies_.push_back(id);
        starts_.push_back(world.PositionOf(id));
        return id;
    }
    // m, of any body: how far it moved sideways, and down.
    double Drift() {
        double drift = 0;
        for (size_t i = 0; i < bodies_.size(); ++i) {
            const Position moved = world.PositionOf(bodies_[i]) - starts_[i];
            drift = std::max(drift, std::hypot(moved.x(), moved.z()));
        }
        return drift;
    }
    double Fall() {
        double fall = 0;
        for (size_t i = 0; i < bodies_.size(); ++i)
            fall = std::max(fall, starts_[i].y() - world.PositionOf(bodies_[i]).y());
        return fall;
    }
    // Whether no body falls by `most` m for so many seconds.
    bool Stands(double seconds, double most) {
        for (double t = 0; t < seconds; ++t) {
            world.Run(1);
            if (Fall() > most) return false;
        }
        return true;
    }
    // m/s, of any body's center over a second.
    double Fastest(double dt = kStep) {
        std::vector<Position> before;
        double fastest = 0;
        for (double t = 0; t < 1; t += dt) {
            before.clear();
            for (const BodyId id : bodies_) before.push_back(world.PositionOf(id));
            world.Step(dt);
            for (size_t i = 0; i < bodies_.size(); ++i)
                fastest = std::max(fastest, (world.PositionOf(bodies_[i]) - before[i]).norm() / dt);
        }
        return fastest;
    }
    BodyId Last() const { return bodies_.back(); }

    TestWorld world;

private:
    std::vector<BodyId> bodies_;
    std::vector<Position> starts_;
};

// Boxes of 1 m, up to 1 cm out of line. As an elastic column it buckles at n = (7.84 k / m g)^(1/3): with four substeps
// at 24.
TEST(Structures, ColumnsOfAHundredStandAtTheDefaults) {
    for (const int boxes : {10, 25, 50, 100}) {
        if (kIsSanitized && boxes > 25) continue;
        for (const uint32_t seed : {1u, 2u}) {
            RandomPoses random(seed);
            Structure column;
            for (int i = 0; i < boxes; ++i) {
                const Vector3 aside = random.InBox(0.01f);
                column.Add({.shape = CubeOf(0.5f), .position = {aside.x(), 0.5 + i, aside.z()}});
            }
            EXPECT_TRUE(column.Stands(5, 0.02)) << boxes << " seed " << seed;
            EXPECT_LT(column.Fastest(), 1.5e-4) << boxes << " seed " << seed;
            EXPECT_TRUE(column.Stands(kIsSanitized ? 4 : 54, 0.02)) << boxes << " seed " << seed;
            EXPECT_LT(column.Drift(), 0.005) << boxes << " seed " << seed;
            // What floats of separations leave: 3 micrometers a step at a hundred meters.
            EXPECT_LT(column.Fastest(), 1e-4) << boxes << " seed " << seed;
        }
    }
}

// Contacts sink by F / (m w^2) with (w h)^2 = 0.88 passes: 10, 100, 1000 mm and more at the four substeps of the
// defaults.
TEST(Structures, ALoadSinksLittleAtTheDefaultsAndNothingJumpsWhenItIsTaken) {
    for (const float ratio : {10.0f, 100.0f, 1000.0f, 1e4f})
        for (const double height : {0.0, 0.01}) {
            Structure loaded;
            const BodyId cube = loaded.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 1000});
            const BodyId load =
                loaded.Add({.shape = CubeOf(0.5f), .position = {0, 1.5 + height, 0}, .mass = 1000 * ratio});
            loaded.world.Run(8);
            const double sunk = 0.5 - loaded.world.PositionOf(cube).y();
            EXPECT_LT(loaded.world.Report().largestPenetration, 0.005f) << ratio << " from " << height;
            EXPECT_LT(loaded.Drift(), ratio < 2000 ? 0.03 : 0.06) << ratio << " from " << height;
            EXPECT_TRUE(loaded.world.Bodies().Remove(load));
            double rise = 0;
            for (int step = 0; step < 120; ++step) {
                loaded.world.Step();
                rise = std::max(rise, loaded.world.PositionOf(cube).y() - 0.5);
            }
            EXPECT_LT(rise, ratio < 2000 ? 1e-4 : 0.001) << ratio << " from " << height << ", had sunk by " << sunk;
            if (ratio == 100) {
                EXPECT_LT(rise + sunk, 0.001) << ratio << " from " << height;
            }
        }
}

// With the stiffest springs, which damp what is slow hardly at all, 10^4 times the weight jumped at 0.5 m/s for ever at
// steps of 1/240 s.
TEST(Structures, LoadsComeToRestAtEveryTimeStepAndEffort) {
    for (const double dt : {1.0 / 30, kStep, 1.0 / 240})
        for (const auto& [ratio, substeps] : {std::pair(10.0f, 4),
                                              {100.0f, 4},
                                              {1000.0f, 4},
                                              {1e4f, 4},
                                              {100.0f, 16},
                                              {1000.0f, 16},
                                              {1000.0f, 64},
                                              {1e4f, 64}}) {
            SystemSettings settings = NoSleep();
            settings.solver.substeps = substeps;
            Structure loaded(settings);
            loaded.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 1000});
            loaded.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}, .mass = 1000 * ratio});
            loaded.world.Run(5, dt);
            const std::string what =
                std::to_string(ratio) + " at " + std::to_string(dt) + " of " + std::to_string(substeps);
            EXPECT_LT(loaded.world.Report().largestPenetration, 0.005f) << what;
            EXPECT_LT(loaded.Fastest(dt), 1e-4) << what;
            EXPECT_LT(loaded.Drift(), ratio < 2000 ? 1e-3 : 3e-3) << what;
        }
}

// Efforts that follow a bouncing load within its period pump it: springs that stiffen while it rises.
TEST(Structures, LoadsThatFallAtShortStepsComeToRest) {
    for (const float ratio : {1000.0f, 1e4f}) {
        Structure loaded;
        loaded.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 1000});
        loaded.Add({.shape = CubeOf(0.5f), .position = {0, 1.51, 0}, .mass = 1000 * ratio});
        loaded.world.Run(kIsSanitized ? 2 : 10, 1.0 / 240);
        EXPECT_LT(loaded.Fastest(1.0 / 240), kIsSanitized ? 0.3 : 1e-4) << ratio;
        EXPECT_LT(loaded.Drift(), 0.02) << ratio;
    }
}

// Legs of 8 kg under a top of 100 kg and what stands on one of them: the others are hardly pressed. With springs as
// stiff as 16 and more substeps allow, and with more relax iterations, they rattled and walked.
TEST(Structures, TablesWithALoadAtACornerStandStillAtEveryEffort) {
    for (const float load : {1.0f, 100.0f, 300.0f, 1000.0f, 3000.0f})
        for (const int substeps : {4, 16, 64, 128}) {
            SystemSettings settings = NoSleep();
            settings.solver.substeps = substeps;
            Structure table(settings);
            for (int i = 0; i < 4; ++i)
                table.Add({.shape = BoxOf(0.05f, 0.4f, 0.05f),
                           .position = {(i & 1) ? 0.75 : -0.75, 0.4, (i & 2) ? 0.45 : -0.45}});
            table.Add({.shape = BoxOf(0.9f, 0.03f, 0.6f), .position = {0, 0.83, 0}, .mass = 100});
            table.Add({.shape = CubeOf(0.05f), .position = {0.75, 0.91, 0.45}, .mass = load});
            table.world.Run(5);
            EXPECT_LT(table.Fastest(), 1e-4) << load << " at " << substeps;
            EXPECT_LT(table.Drift(), 0.001) << load << " at " << substeps;
        }
}

// A slab on more boxes than there are colors.
TEST(Structures, ASlabOnAHundredBoxesSinksLittle) {
    Structure slab;
    for (int i = 0; i < 100; ++i)
        slab.Add({.shape = CubeOf(0.5f), .position = {1.2 * (i % 10), 0.5, 1.2 * (i / 10)}, .mass = 1000});
    slab.Add({.shape = BoxOf(7, 0.5f, 7), .position = {5.4, 1.5, 5.4}, .mass = 1e7f});
    slab.world.Run(3);
    EXPECT_GT(slab.world.Report().overflowConstraints, 0u);
    EXPECT_LT(slab.world.Report().largestPenetration, 0.002f);
    EXPECT_LT(slab.Fall(), 0.004);
}

// Likewise when it falls onto them, faster than what is calm: then it is solved directly once it has come to rest.
TEST(Structures, ASlabThatFallsOnAHundredBoxesSinksLittle) {
    Structure slab;
    for (int i = 0; i < 100; ++i)
        slab.Add({.shape = CubeOf(0.5f), .position = {1.2 * (i % 10), 0.5, 1.2 * (i / 10)}, .mass = 1000});
    slab.Add({.shape = BoxOf(7, 0.5f, 7), .position = {5.4, 1.7, 5.4}, .mass = 1e5f});
    slab.world.Run(3);
    EXPECT_GT(slab.world.Report().overflowConstraints, 0u);
    EXPECT_TRUE(slab.world.Report().mostEffort[0].isDirect);
    EXPECT_LT(slab.world.Report().largestPenetration, 1e-4f);
}

TEST(Structures, SmallBoxesStandAsLargeOnes) {
    for (const float edge : {1.0f, 0.05f, 0.01f, 0.001f}) {
        const double e = double{edge};
        // A wall that tapers to one, and square layers: the latter's contacts make a large island.
        for (const bool isFlat : {true, false}) {
            const int layers = isFlat ? 10 : 8;
            Structure pyramid;
            for (int i = 0; i < layers; ++i)
                for (int j = 0; j < layers - i; ++j)
                    for (int k = 0; k < (isFlat ? 1 : layers - i); ++k)
                        pyramid.Add({.shape = CubeOf(0.5f * edge),
                                     .position = {e * (j + 0.5 * i), e * (0.5 + i), isFlat ? 0 : e * (k + 0.5 * i)}});
            pyramid.world.Run(kIsSanitized ? 1 : 5);
            EXPECT_LT(pyramid.Fall() / e, 0.01) << edge << " " << isFlat;
            EXPECT_LT(pyramid.Drift() / e, 0.05) << edge << " " << isFlat;
        }
    }
}

TEST(Structures, SmallBoxesFallAsleep) {
    for (const float edge : {0.05f, 0.01f, 0.001f}) {
        Structure stack(SystemSettings{});
        for (int i = 0; i < 5; ++i)
            stack.Add({.shape = CubeOf(0.5f * edge), .position = {0, double{edge} * (0.5 + i), 0}});
        stack.world.Run(3);
        EXPECT_EQ(stack.world.Report().awakeBodies, 0u) << edge;
    }
}

SystemSettings FullEffort() {
    SystemSettings settings = NoSleep();
    settings.solver = SolverSettings::Reference();
    return settings;
}

// Each stands where statics says so by 3 %, and falls where it says so by 3 %. `part`: of the moment that topples it.
using Build = void (*)(Structure& structure, double part);

// n boxes, each by d farther aside: what stands on the first has its center of mass at n d / 2 from its center.
template <int kBoxes>
void BuildLeaningColumn(Structure& structure, double part) {
    for (int i = 0; i < kBoxes; ++i)
        structure.Add({.shape = CubeOf(0.5f), .position = {part / kBoxes * i, 0.5 + i, 0}});
}

// Planks of 2 m at the edge of a table: the k-th from the top overhangs the one below it by 1 m / k.
template <int kPlanks>
void BuildHarmonicStack(Structure& structure, double part) {
    structure.world.Add({.shape = BoxOf(1, 1, 0.5f), .motion = MotionType::Static, .position = {-1, 1, 0}});
    double aside = -1;
    for (int i = 0; i < kPlanks; ++i) {
        aside += part / (kPlanks - i);
        structure.Add({.shape = BoxOf(1, 0.1f, 0.5f), .position = {aside, 2.1 + 0.2 * i, 0}});
    }
}

// A plank of 4 m and 800 kg overhangs by 3 m, held by a counterweight at 0.75 m behind the edge.
void BuildCantilever(Structure& structure, double part) {
    structure.world.Add({.shape = BoxOf(1, 1, 0.5f), .motion = MotionType::Static, .position = {-1, 1, 0}});
    structure.Add({.shape = BoxOf(2, 0.1f, 0.5f), .position = {1, 2.1, 0}, .mass = 800});
    structure.Add(
        {.shape = CubeOf(0.25f), .position = {-0.75, 2.45, 0}, .mass = static_cast<float>(800 / 0.75 / part)});
}

// A table whose load, beyond its legs, brings the common center of mass to `part` of their outer edge.
void BuildTable(Structure& structure, double part) {
    for (int i = 0; i < 4; ++i)
        structure.Add(
            {.shape = BoxOf(0.05f, 0.4f, 0.05f), .position = {(i & 1) ? 0.75 : -0.75, 0.4, (i & 2) ? 0.45 : -0.45}});
    structure.Add({.shape = BoxOf(1.2f, 0.03f, 0.6f), .position = {0, 0.83, 0}, .mass = 100});
    structure.Add({.shape = CubeOf(0.05f), .position = {0.8 * part * 1.5, 0.91, 0}, .mass = 200});
}

// Bricks of 1 m, each by d farther aside: as the leaning column, with thinner bodies.
template <int kBricks>
void BuildCorbelledWall(Structure& structure, double part) {
    for (int i = 0; i < kBricks; ++i)
        structure.Add({.shape = BoxOf(0.5f, 0.15f, 0.25f), .position = {part / kBricks * i, 0.15 + 0.3 * i, 0}});
}

// Two of these, of bricks of 2 m, lean towards each other and meet at the top.
void BuildOpening(Structure& structure, double part) {
    constexpr int kBricks = 8;
    const double step = 2 * part / kBricks;
    for (const int side : {-1, 1})
        for (int i = 0; i < kBricks; ++i)
            structure.Add({.shape = BoxOf(1, 0.15f, 0.25f),
                           .position = {side * ((kBricks - i) * step + 1.001), 0.15 + 0.3 * i, 0}});
}

// A lintel of 5 m and a ton on two posts, whose load beyond one of them brings `part` of what lifts it off the other.
void BuildLintel(Structure& structure, double part) {
    for (const double x : {-1.5, 1.5}) structure.Add({.shape = BoxOf(0.25f, 1, 0.25f), .position = {x, 1, 0}});
    structure.Add({.shape = BoxOf(2.5f, 0.2f, 0.25f), .position = {0, 2.2, 0}, .mass = 1000});
    constexpr double kEdge = 1.75, kLoad = 2.3;
    structure.Add({.shape = CubeOf(0.2f),
                   .position = {kLoad, 2.6, 0},
                   .mass = static_cast<float>(part * 1000 * kEdge / (kLoad - kEdge))});
}

struct Case {
    const char* name;
    Build build;
};
class Statics : public ::testing::TestWithParam<Case> {};

TEST_P(Statics, StandsAndFallsWithinThreePercent) {
    if (kIsSanitized) GTEST_SKIP() << "minutes";
    Structure stands(FullEffort()), falls(FullEffort());
    GetParam().build(stands, 0.97);
    GetParam().build(falls, 1.03);
    EXPECT_TRUE(stands.Stands(5, 0.1));
    EXPECT_LT(stands.Fastest(), 5e-4);  // so near to the limit what bends does so slowly
    EXPECT_TRUE(stands.Stands(54, 0.1));
    EXPECT_LT(stands.Fastest(), 3e-4);
    EXPECT_LT(stands.Drift(), 0.005);
    EXPECT_FALSE(falls.Stands(20, 0.1));
}

INSTANTIATE_TEST_SUITE_P(Of, Statics,
                         ::testing::Values(Case{"LeaningColumnOf5", BuildLeaningColumn<5>},
                                           Case{"LeaningColumnOf10", BuildLeaningColumn<10>},
                                           Case{"LeaningColumnOf20", BuildLeaningColumn<20>},
                                           Case{"HarmonicStackOf4", BuildHarmonicStack<4>},
                                           Case{"HarmonicStackOf8", BuildHarmonicStack<8>},
                                           Case{"HarmonicStackOf16", BuildHarmonicStack<16>},
                                           Case{"Cantilever", BuildCantilever}, Case{"Table", BuildTable},
                                           Case{"CorbelledWallOf8", BuildCorbelledWall<8>},
                                           Case{"CorbelledWallOf16", BuildCorbelledWall<16>},
                                           Case{"Opening", BuildOpening}, Case{"Lintel", BuildLintel}),
                         [](const auto& of) { return of.param.name; });

}  // namespace
}  // namespace fulcrum::testing
