// AccuracyTarget: targets of single bodies and joints, joints that disagree, and what accuracy for one structure costs
// among many bodies that need none.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace fulcrum::testing {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

SystemSettings WithoutTargets() {
    SystemSettings settings = NoSleep();
    settings.accuracy.penetration = kInfinity;
    return settings;
}

// A cube of 1 m and one of 40 times its mass on it. Returns the lower one.
BodyId AddLoaded(TestWorld& world, double x, float target) {
    const BodyId lower =
        world.Add({.shape = CubeOf(0.5f), .position = {x, 0.5, 0}, .mass = 1000, .penetrationTarget = target});
    world.Add({.shape = CubeOf(0.5f), .position = {x, 1.5, 0}, .mass = 40'000});
    return lower;
}

std::vector<IslandEffortReport> EffortsOf(TestWorld& world) {
    std::vector<IslandEffortReport> efforts;
    world.System().VisitEfforts([&](const IslandEffortReport& effort) { efforts.push_back(effort); });
    return efforts;
}

// Three alike; because of the target of one its island alone is solved directly.
TEST(AccuracyTarget, OfABodyIsItsOwn) {
    TestWorld world(WithoutTargets());
    world.AddFloor();
    AddLoaded(world, 0, 0);
    const float target = 0.001f;  // of half an edge: 0.5 mm
    const BodyId exact = AddLoaded(world, 10, target), loose = AddLoaded(world, 20, 0);
    world.Run(5);
    const auto sinkOf = [&](BodyId id) { return 0.5 - world.PositionOf(id).y(); };
    const std::vector<IslandEffortReport> efforts = EffortsOf(world);
    ASSERT_EQ(efforts.size(), 1u);
    EXPECT_EQ(efforts[0].culprit, exact);
    EXPECT_EQ(efforts[0].bodies, 2u);
    EXPECT_TRUE(efforts[0].isDirect);
    EXPECT_EQ(efforts[0].substeps, SolverSettings{}.substeps);
    EXPECT_LT(sinkOf(exact), 0.5 * target);
    EXPECT_GT(sinkOf(loose), 2 * 0.5 * target);
    // Taken away, it is solved as the others are.
    ASSERT_TRUE(world.Bodies().SetPenetrationTarget(exact, 0));
    EXPECT_EQ(world.Bodies().GetPenetrationTarget(exact), 0);
    world.Run(5);
    EXPECT_TRUE(EffortsOf(world).empty());
    EXPECT_LT(sinkOf(exact), sinkOf(loose) + 1e-5);
}

// A body that may sink deeper than the world's target costs less than the others.
TEST(AccuracyTarget, OfABodyMayBeLooserThanTheWorlds) {
    SystemSettings settings = NoSleep();
    settings.accuracy.penetration = 0.001f;
    TestWorld world(settings);
    world.AddFloor();
    AddLoaded(world, 0, 0.1f);
    const BodyId usual = AddLoaded(world, 10, 0);
    world.Run(5);
    const std::vector<IslandEffortReport> efforts = EffortsOf(world);
    ASSERT_EQ(efforts.size(), 1u);
    EXPECT_EQ(efforts[0].culprit, usual);
}

// A target that changes takes no effort away from what is loaded: with the system's alone, the cube would sink by 4 mm
// in a few steps.
TEST(AccuracyTarget, ChangesWithoutAJolt) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId loaded = AddLoaded(world, 0, 0), other = AddLoaded(world, 10, 0);
    world.Run(3);
    const auto sinkOf = [&](BodyId id) { return 0.5 - world.PositionOf(id).y(); };
    ASSERT_TRUE(world.System().Report().mostEffort[0].isDirect);
    const double sink = sinkOf(loaded);
    EXPECT_LT(sink, 1e-5);
    const auto deepestSinkIn = [&](int steps) {
        double deepest = 0;
        for (int i = 0; i < steps; ++i) {
            world.Step();
            deepest = std::max(deepest, sinkOf(loaded));
        }
        return deepest;
    };
    // That of another body is none of its business.
    ASSERT_TRUE(world.Bodies().SetPenetrationTarget(other, 0.002f));
    EXPECT_LT(deepestSinkIn(60), sink + 1e-6);
    // The same in other words changes nothing, a tighter one raises it.
    ASSERT_TRUE(world.Bodies().SetPenetrationTarget(loaded, SystemSettings{}.accuracy.penetration));
    EXPECT_LT(deepestSinkIn(60), sink + 1e-6);
    SystemSettings settings = world.System().Settings();
    settings.accuracy.penetration = 0.001f;
    ASSERT_TRUE(world.System().SetSettings(settings));
    EXPECT_LT(deepestSinkIn(60), sink + 1e-6) << "its own target holds";
    ASSERT_TRUE(world.Bodies().SetPenetrationTarget(loaded, 0));
    EXPECT_LT(deepestSinkIn(1), sink + 1e-6);
    EXPECT_LT(deepestSinkIn(180), sink + 1e-6);
    EXPECT_LT(sinkOf(loaded), 0.5 * 0.001);
    // A looser one, with which it is iterated, leaves it where it is.
    settings.accuracy.penetration = 0.02f;
    ASSERT_TRUE(world.System().SetSettings(settings));
    EXPECT_LT(deepestSinkIn(300), sink + 1e-6);
    EXPECT_EQ(EffortsOf(world).size(), 1u) << "that with the other, which keeps its own target";
}

TEST(AccuracyTarget, BadOnesAreRefused) {
    TestWorld world;
    const BodyId body = world.Add({.shape = CubeOf(0.5f)}),
                 other = world.Add({.shape = CubeOf(0.5f), .position = {3, 0, 0}});
    PointJointSettings joint = Of<PointJointSettings>(Between(body, other, {1.5, 0, 0}));
    const JointId id = Join(world, joint);
    for (const float bad : {-1.0f, -kInfinity, std::numeric_limits<float>::quiet_NaN()}) {
        EXPECT_FALSE(world.System().Bodies().Create({.shape = CubeOf(0.5f), .penetrationTarget = bad}));
        EXPECT_FALSE(world.Bodies().SetPenetrationTarget(body, bad));
        joint.errorTarget = bad;
        EXPECT_FALSE(JointsOf(world).Create(joint));
        EXPECT_FALSE(JointsOf(world).SetErrorTarget(id, bad));
        SystemSettings settings;
        settings.accuracy.jointError = bad;
        EXPECT_FALSE(world.System().SetSettings(settings));
    }
    EXPECT_FALSE(world.Bodies().SetPenetrationTarget({77, 0}, 0.1f));
    EXPECT_FALSE(JointsOf(world).SetErrorTarget({77, 0}, 0.1f));
    EXPECT_EQ(world.Bodies().GetPenetrationTarget(body), 0);
    EXPECT_EQ(JointsOf(world).GetErrorTarget(id), 0);
}

// Eight balls on ball joints that swing from a hook, 60 degrees to each side. Returns the joints.
std::vector<JointId> AddRope(TestWorld& world, double z) {
    std::vector<JointId> joints;
    const Position hook(0, 8, z), along(std::sin(1.0), -std::cos(1.0), 0);
    BodyId last = AddHook(world, hook);
    for (int i = 0; i < 8; ++i) {
        const BodyId ball = world.Add({.shape = SphereOf(0.2f), .position = hook + along * (0.5 + i), .mass = 10});
        joints.push_back(Join(world, Of<PointJointSettings>(Between(last, ball, hook + along * double(i)))));
        last = ball;
    }
    return joints;
}

double LargestGap(TestWorld& world, const std::vector<JointId>& joints) {
    double largest = 0;
    for (const JointId id : joints) largest = std::max(largest, double{JointsOf(world).GetError(id).distance});
    return largest;
}

// Two alike; that with a target is solved directly from then on, until the target is taken away.
TEST(AccuracyTarget, OfAJointIsItsOwn) {
    TestWorld world(WithoutTargets());
    const std::vector<JointId> usual = AddRope(world, 0), exact = AddRope(world, 5);
    const auto swing = [&] {
        double gap = 0, gapOfExact = 0;
        for (int step = 0; step < 300; ++step) {
            world.Step();
            gap = std::max(gap, LargestGap(world, usual));
            gapOfExact = std::max(gapOfExact, LargestGap(world, exact));
        }
        return gapOfExact / gap;
    };
    EXPECT_NEAR(swing(), 1, 1e-6);
    ASSERT_TRUE(JointsOf(world).SetErrorTarget(exact[3], 1e-5f));
    world.Run(1);
    EXPECT_LT(swing(), 0.1);
    EXPECT_TRUE(EffortsOf(world).empty()) << "it takes no more substeps";
    ASSERT_TRUE(JointsOf(world).SetErrorTarget(exact[3], 0));
    world.Run(1);
    EXPECT_GT(swing(), 0.3);
}

// Taken before the joint has exceeded its target for long enough, meanwhile, and when it is solved directly.
TEST(AccuracyTarget, SnapshotsHaveThem) {
    SystemSettings settings = WithoutTargets();
    settings.measuresErrors = true;
    for (const int steps : {4, 20, 60}) {
        TestWorld world(settings);
        world.AddFloor();
        const BodyId loaded = AddLoaded(world, 10, 0.001f);
        const std::vector<JointId> rope = AddRope(world, 0);
        ASSERT_TRUE(JointsOf(world).SetErrorTarget(rope[3], 2e-5f));
        world.Steps(steps);
        std::vector<std::byte> bytes;
        ASSERT_TRUE(world.System().SaveSnapshot(bytes));
        world.Steps(60);
        const uint64_t hash = world.System().HashState();
        ASSERT_TRUE(world.Bodies().SetPenetrationTarget(loaded, 0));
        ASSERT_TRUE(JointsOf(world).SetErrorTarget(rope[3], 0));
        world.Steps(10);
        ASSERT_TRUE(world.System().RestoreSnapshot(bytes));
        EXPECT_EQ(world.Bodies().GetPenetrationTarget(loaded), 0.001f);
        EXPECT_EQ(JointsOf(world).GetErrorTarget(rope[3]), 2e-5f);
        world.Steps(60);
        EXPECT_EQ(world.System().HashState(), hash) << steps;
        EXPECT_TRUE(world.Report().errors.areMeasured);
    }
}

// Of joints that want a box half a meter apart the one with priority wins, whatever the target.
TEST(AccuracyTarget, JointsThatDisagreeStayAsTheyAre) {
    SystemSettings settings = WithoutTargets();
    settings.accuracy.jointError = 0.001f;
    TestWorld world(settings);
    const BodyId hook = AddHook(world, {0, 2, 0}), box = world.Add({.shape = CubeOf(0.5f), .position = {1, 2, 0}});
    std::vector<JointId> joints;
    for (const double x : {1.0, 1.5}) {
        FixedJointSettings joint = Of<FixedJointSettings>(Between(hook, box, {x, 2, 0}));
        joint.anchorB = JointAnchor{.point = {1, 2, 0}};
        joint.priority = x == 1.0 ? JointPriority::High : JointPriority::Normal;
        joints.push_back(Join(world, joint));
    }
    world.Run(2);
    for (int step = 0; step < 300; ++step) {
        world.Step();
        ASSERT_LT(LargestGap(world, {joints[0]}), 0.001);
        ASSERT_NEAR(LargestGap(world, {joints[1]}), 0.5, 0.001);
        ASSERT_LT(Length(world.VelocityOf(box)), 1e-3f);
    }
}

// ---- One structure among 1000 boxes

struct Among {
    Among(const SystemSettings& settings, const std::function<void(Among&)>& addStructure, uint32_t threads = 1)
        : world(settings, threads) {
        world.AddFloor();
        for (int i = 0; i < 500; ++i) {
            const double x = -40 + 2.5 * (i % 25), z = 10 + 2.5 * (i / 25);
            world.Add({.shape = CubeOf(0.5f), .position = {x, 0.5, z}});
            world.Add({.shape = CubeOf(0.5f), .position = {x, 1.5, z}});
        }
        addStructure(*this);
    }
    // m
    double Error() {
        double error = LargestGap(world, joints);
        if (!bricks.empty()) {
            // How much too low the top is, by layer.
            double lowest = std::numeric_limits<double>::infinity();
            for (const BodyId id : bricks) lowest = std::min(lowest, world.PositionOf(id).y());
            error = std::max(error, (top - lowest) / layers);
        }
        return error;
    }
    // Substeps times bodies that take them, of a step.
    double Work() {
        const StepReport& report = world.Report();
        const int substeps = world.System().Settings().solver.substeps;
        double work = double(report.awakeBodies) * substeps;
        for (const IslandEffortReport& effort : EffortsOf(world))
            work += double(effort.bodies) * (effort.substeps - substeps);
        return work;
    }
    TestWorld world;
    std::vector<JointId> joints;
    std::vector<BodyId> bricks;  // of the top layer
    double top = 0;
    int layers = 1;
};

// 16 links of 1 kg and a ball of 100 kg, swung from the horizontal.
void AddHeavyChain(Among& to) {
    BodyId last = AddHook(to.world, {0, 12, 0});
    for (int i = 0; i < 17; ++i) {
        const bool isBall = i == 16;
        const BodyId link = to.world.Add({.shape = SphereOf(isBall ? 0.25f : 0.1f),
                                          .position = {0.25 + 0.5 * i, 12, 0},
                                          .mass = isBall ? 100.0f : 1.0f});
        to.joints.push_back(Join(to.world, Of<PointJointSettings>(Between(last, link, {0.5 * i, 12, 0}))));
        last = link;
    }
}

// Ten layers of five bricks of 0.5 x 0.25 x 0.25 m, in a running bond of a quarter of their length.
void AddWall(Among& to) {
    to.layers = 10;
    for (int layer = 0; layer < to.layers; ++layer)
        for (int i = 0; i < 5; ++i) {
            const BodyId brick = to.world.Add({.shape = BoxOf(0.25f, 0.125f, 0.125f),
                                               .position = {0.5 * i + 0.125 * (layer % 2), 0.125 + 0.25 * layer, 0},
                                               .density = 2000});
            if (layer + 1 == to.layers) to.bricks.push_back(brick);
        }
    to.top = 0.125 + 0.25 * (to.layers - 1);
}

SystemSettings Fast(bool isTargeted) {
    SystemSettings settings = WithoutTargets();
    settings.solver = SolverSettings::Fast();
    if (isTargeted) {
        settings.accuracy.penetration = 0.004f;  // of half an edge of 0.31 m, a brick's by its mass: 0.6 mm
        settings.accuracy.jointError = 0.001f;
    } else {
        settings.exactJointLoad = kInfinity;
    }
    return settings;
}

// The error of the structure over 2 s after 2 s, at 1.2 times the work without it; efforts do not come and go.
// `islands` of them get more effort.
void ExpectOneAmongMany(const std::function<void(Among&)>& add, size_t islands) {
    Among plain(Fast(false), add), targeted(Fast(true), add), two(Fast(true), add, 2);
    double without = 0, error = 0, least = 1e9, most = 0, work = 0;
    for (int step = 0; step < 240; ++step) {
        for (Among* world : {&plain, &targeted, &two}) world->world.Step();
        ASSERT_EQ(targeted.world.System().HashPoses(), two.world.System().HashPoses()) << step;
        work += targeted.Work() / plain.Work() / 240;
        if (step < 120) continue;
        without = std::max(without, plain.Error());
        error = std::max(error, targeted.Error());
        const std::vector<IslandEffortReport> efforts = EffortsOf(targeted.world);
        ASSERT_EQ(efforts.size(), islands) << step;
        if (islands == 0) continue;
        least = std::min<double>(least, efforts[0].substeps);
        most = std::max<double>(most, efforts[0].substeps);
    }
    EXPECT_GT(without, 0.001);
    EXPECT_LT(error, 0.001);
    EXPECT_EQ(islands == 0 ? most : least, most) << "efforts come and go";
    EXPECT_LT(work, 1.2);
}

// Which is solved directly.
TEST(AccuracyTarget, AHeavyChainAmongAThousandBoxesMeetsAMillimeter) { ExpectOneAmongMany(AddHeavyChain, 0); }
TEST(AccuracyTarget, AWallAmongAThousandBoxesMeetsAMillimeter) { ExpectOneAmongMany(AddWall, 1); }

}  // namespace
}  // namespace fulcrum::testing
