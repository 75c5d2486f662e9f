// Joints come and go: enabled, removed, broken; what they hold together sleeps, wakes and collides as it should.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <algorithm>
#include <functional>

namespace fulcrum::testing {
namespace {

// A box that hangs from a hook by a joint of a kind.
template <class Settings = PointJointSettings>
struct Hanging {
    explicit Hanging(const SystemSettings& settings = NoSleep(), uint32_t threads = 1)
        : world(settings, threads), hook(AddHook(world)) {
        box = world.Add({.shape = CubeOf(0.1f), .position = {0, -0.5, 0}, .mass = 10});
    }
    JointId Hang(const std::function<void(Settings&)>& change = {}) {
        Settings settings{Between(hook, box, {0, 0, 0})};
        if (change) change(settings);
        return Join(world, settings);
    }
    JointInterface& Joints() { return JointsOf(world); }

    TestWorld world;
    BodyId hook, box;
};

int CountJoints(TestWorld& world) {
    int count = 0;
    JointsOf(world).Visit([&](JointId) { ++count; });
    return count;
}

TEST(JointLife, ADisabledJointDoesNothingUntilItIsEnabled) {
    Hanging<> hanging;
    const JointId joint = hanging.Hang();
    hanging.world.Run(0.5);
    EXPECT_NEAR(hanging.world.PositionOf(hanging.box).y(), -0.5, 1e-3);
    ASSERT_TRUE(hanging.Joints().SetEnabled(joint, false));
    EXPECT_FALSE(hanging.Joints().IsEnabled(joint));
    hanging.world.Run(0.5);
    EXPECT_NEAR(hanging.world.VelocityOf(hanging.box).y(), -0.5 * kGravity, 1e-3);
    EXPECT_EQ(hanging.Joints().GetForce(joint), Vector3(0, 0, 0));
    ASSERT_TRUE(hanging.Joints().SetEnabled(joint, true));
    hanging.world.Run(4);
    EXPECT_LT(hanging.Joints().GetError(joint).distance, 1e-3f);
}

TEST(JointLife, OneThatIsMadeDisabledHoldsNothing) {
    Hanging<> hanging;
    const JointId joint = hanging.Hang([](PointJointSettings& s) { s.enabled = false; });
    hanging.world.Run(0.5);
    EXPECT_TRUE(hanging.Joints().Exists(joint));
    EXPECT_NEAR(hanging.world.VelocityOf(hanging.box).y(), -0.5 * kGravity, 1e-3);
}

TEST(JointLife, ARemovedJointLetsGoAndItsIdIsNeverValidAgain) {
    Hanging<> hanging;
    const JointId joint = hanging.Hang();
    hanging.world.Run(0.5);
    ASSERT_TRUE(hanging.Joints().Remove(joint));
    EXPECT_FALSE(hanging.Joints().Exists(joint));
    EXPECT_FALSE(hanging.Joints().Remove(joint));
    hanging.world.Run(0.5);
    EXPECT_NEAR(hanging.world.VelocityOf(hanging.box).y(), -0.5 * kGravity, 1e-3);
    const JointId another = hanging.Hang();
    EXPECT_NE(another, joint);
    EXPECT_FALSE(hanging.Joints().Exists(joint));
    EXPECT_EQ(hanging.Joints().SetEnabled(joint, true).GetError().code, ErrorCode::UnknownId);
}

TEST(JointLife, RemovingABodyRemovesItsJoints) {
    TestWorld world;
    const BodyId hook = AddHook(world), a = world.Add({.shape = CubeOf(0.1f), .position = {0, -1, 0}});
    const BodyId b = world.Add({.shape = CubeOf(0.1f), .position = {0, -2, 0}}),
                 c = world.Add({.shape = CubeOf(0.1f), .position = {0, -3, 0}});
    const JointId first = Join(world, PointJointSettings{Between(hook, a, {0, 0, 0})});
    const JointId second = Join(world, PointJointSettings{Between(a, b, {0, -1, 0})}),
                  third = Join(world, HingeJointSettings{Between(b, c, {0, -2, 0})});
    world.Run(1);
    int count = 0;
    JointsOf(world).VisitOf(b, [&](JointId id) { EXPECT_EQ(id, count++ == 0 ? third : second); });
    EXPECT_EQ(count, 2);
    ASSERT_TRUE(world.Bodies().Remove(b));
    EXPECT_TRUE(JointsOf(world).Exists(first));
    EXPECT_FALSE(JointsOf(world).Exists(second));
    EXPECT_FALSE(JointsOf(world).Exists(third));
    EXPECT_EQ(CountJoints(world), 1);
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(a).y(), -1, 1e-3);
    EXPECT_NEAR(world.VelocityOf(c).y(), -kGravity, 1e-3);
}

TEST(JointLife, RemovingTheHookWakesWhatHung) {
    Hanging<> hanging{SystemSettings{}};
    hanging.Hang();
    hanging.world.Run(3);
    ASSERT_FALSE(hanging.world.Bodies().IsAwake(hanging.box));
    ASSERT_TRUE(hanging.world.Bodies().Remove(hanging.hook));
    EXPECT_EQ(CountJoints(hanging.world), 0);
    hanging.world.Run(1);
    EXPECT_NEAR(hanging.world.VelocityOf(hanging.box).y(), -kGravity, 1e-3);
}

TEST(JointSleep, AChainSleepsAndWakesAsOne) {
    TestWorld world;
    std::vector<BodyId> links{AddHook(world)};
    for (int i = 0; i < 5; ++i) {
        links.push_back(world.Add({.shape = CubeOf(0.1f), .position = {0, -0.5 - i, 0}}));
        Join(world, PointJointSettings{Between(links[i], links[i + 1], {0, -1.0 * i, 0})});
    }
    world.Run(3);
    for (int i = 1; i <= 5; ++i) EXPECT_FALSE(world.Bodies().IsAwake(links[i]));
    EXPECT_EQ(world.Report().joints, 0u);
    const BodyBits before = BitsOf(world, links[2]);
    world.Run(1);
    EXPECT_EQ(BitsOf(world, links[2]), before);
    ASSERT_TRUE(world.Bodies().AddImpulse(links[5], {5, 0, 0}));
    world.Step();
    for (int i = 1; i <= 5; ++i) EXPECT_TRUE(world.Bodies().IsAwake(links[i])) << i;
    EXPECT_EQ(world.Report().joints, 5u);
}

TEST(JointSleep, AMotorThatRunsKeepsItsBodyAwake) {
    TestWorld world(NoGravity());
    const BodyId fan = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.1f)}),
                 slow = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.1f), .position = {0, 0, 3}});
    HingeJointSettings settings{Between(AddHook(world), fan, {0, 0, 0}, {0, 0, 1})};
    settings.angle.motor = SpeedMotor(5);
    Join(world, settings);
    HingeJointSettings idle{Between(AddHook(world), slow, {0, 0, 3}, {0, 0, 1})};
    Join(world, idle);
    world.Run(3);
    EXPECT_TRUE(world.Bodies().IsAwake(fan));
    EXPECT_FALSE(world.Bodies().IsAwake(slow));
}

TEST(JointSleep, EveryChangeOfAJointWakesItsBodies) {
    Hanging<HingeJointSettings> hanging{SystemSettings{}};
    const JointId joint = hanging.Hang();
    const auto sleeps = [&] {
        hanging.world.Run(20);
        return !hanging.world.Bodies().IsAwake(hanging.box);
    };
    ASSERT_TRUE(sleeps());
    ASSERT_TRUE(hanging.Joints().SetLimits(joint, JointAxis::AngularX, JointLimits{-1, 1, {}}));
    EXPECT_TRUE(hanging.world.Bodies().IsAwake(hanging.box));
    ASSERT_TRUE(sleeps());
    ASSERT_TRUE(hanging.Joints().SetFriction(joint, JointAxis::AngularX, 5));
    EXPECT_TRUE(hanging.world.Bodies().IsAwake(hanging.box));
    ASSERT_TRUE(sleeps());
    ASSERT_TRUE(hanging.Joints().SetMotor(joint, JointAxis::AngularX, PositionMotor(0.5, FrequencySpring(2, 1))));
    EXPECT_TRUE(hanging.world.Bodies().IsAwake(hanging.box));
    hanging.world.Run(3);
    EXPECT_GT(hanging.Joints().GetCoordinate(joint, JointAxis::AngularX), 0.3);
    ASSERT_TRUE(sleeps());
    ASSERT_TRUE(hanging.Joints().SetEffort(joint, {16, 1, 1}));
    EXPECT_TRUE(hanging.world.Bodies().IsAwake(hanging.box));
    ASSERT_TRUE(sleeps());
    ASSERT_TRUE(hanging.Joints().SetEnabled(joint, false));
    EXPECT_TRUE(hanging.world.Bodies().IsAwake(hanging.box));
}

TEST(JointSleep, AKinematicBaseThatMovesKeepsItsLoadAwake) {
    TestWorld world;
    const BodyId base = world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Kinematic});
    const BodyId load = world.Add({.shape = CubeOf(0.1f), .position = {0, -1, 0}});
    Join(world, PointJointSettings{Between(base, load, {0, 0, 0})});
    world.Run(3);
    EXPECT_FALSE(world.Bodies().IsAwake(load));
    ASSERT_TRUE(world.Bodies().SetVelocity(base, {0.5f, 0, 0}, {0, 0, 0}));
    world.Run(3);
    EXPECT_TRUE(world.Bodies().IsAwake(load));
    EXPECT_NEAR(world.PositionOf(load).x(), 1.5, 0.3);
}

TEST(JointCollision, JoinedBodiesPassThroughEachOtherUnlessTheyAreAskedToCollide) {
    for (const bool collide : {false, true}) {
        // A rope on one side: the ball falls past the shelf that it is tied to, or rests on it.
        TestWorld world(NoSleep());
        const BodyId shelf = world.Add({.shape = BoxOf(1, 0.1f, 1), .motion = MotionType::Static});
        const BodyId ball = world.Add({.shape = SphereOf(0.2f), .position = {0, 1, 0}});
        DistanceJointSettings settings{Between(shelf, ball, {0, 0, 0})};
        settings.anchorB = AnchorAt({0, 1, 0});
        settings.maxDistance = 3.0f;
        settings.collideConnected = collide;
        const JointId rope = Join(world, settings);
        world.Run(3);
        if (collide) EXPECT_NEAR(world.PositionOf(ball).y(), 0.3, 5e-3);
        else EXPECT_LT(world.PositionOf(ball).y(), -1);
        if (collide) continue;
        // Without the joint they collide.
        ASSERT_TRUE(JointsOf(world).Remove(rope));
        ASSERT_TRUE(world.Bodies().SetPose(ball, {0, 1, 0}, {}));
        ASSERT_TRUE(world.Bodies().SetVelocity(ball, {0, 0, 0}, {0, 0, 0}));
        world.Run(2);
        EXPECT_NEAR(world.PositionOf(ball).y(), 0.3, 5e-3);
    }
}

TEST(JointCollision, BodiesInTouchLetGoWhenTheyAreJoined) {
    TestWorld world(NoSleep());
    const BodyId floor = world.AddFloor(), box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Run(0.5);
    EXPECT_EQ(world.Report().contacts, 1u);
    const JointId slider = Join(world, SliderJointSettings{Between(floor, box, {0, 0.5, 0}, {0, 1, 0})});
    world.Run(0.5);
    EXPECT_EQ(world.Report().contacts, 0u);
    EXPECT_LT(world.PositionOf(box).y(), 0);
    // Enabled or not decides as well. The box is back where it stood.
    ASSERT_TRUE(world.Bodies().SetPose(box, {0, 0.5, 0}, {}));
    ASSERT_TRUE(world.Bodies().SetVelocity(box, {0, 0, 0}, {0, 0, 0}));
    ASSERT_TRUE(JointsOf(world).SetEnabled(slider, false));
    world.Run(0.5);
    EXPECT_EQ(world.Report().contacts, 1u);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 5e-3);
}

TEST(JointBreak, HoldsBelowItsStrengthAndBreaksAboveIt) {
    // 98.1 N.
    for (const float strength : {99.0f, 97.0f}) {
        Hanging<> hanging;
        const JointId joint = hanging.Hang([&](PointJointSettings& s) { s.breakForce = strength; });
        int events = 0, step = -1;
        for (int i = 0; i < 60; ++i) {
            hanging.world.Step();
            for (const BrokenJoint& broken : hanging.world.System().Events().brokenJoints) {
                EXPECT_EQ(broken.id, joint);
                EXPECT_GT(Length(broken.force), strength);
                ++events;
                step = i;
            }
        }
        if (strength > 98.1f) {
            EXPECT_EQ(events, 0);
            EXPECT_NEAR(hanging.world.PositionOf(hanging.box).y(), -0.5, 1e-3);
            EXPECT_TRUE(hanging.Joints().IsEnabled(joint));
        } else {
            EXPECT_EQ(events, 1);
            EXPECT_LE(step, 1);
            EXPECT_FALSE(hanging.Joints().IsEnabled(joint));
            EXPECT_TRUE(hanging.Joints().Exists(joint));
            EXPECT_LT(hanging.world.PositionOf(hanging.box).y(), -2);
        }
    }
}

TEST(JointBreak, AtATorque) {
    // m g l = 10 * 9.81 * 0.5 = 49.05 N m.
    for (const float strength : {50.0f, 48.0f}) {
        TestWorld world(NoSleep());
        const BodyId arm = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0.5, 0, 0}, .mass = 10});
        FixedJointSettings settings{Between(AddHook(world), arm, {0, 0, 0})};
        settings.breakTorque = strength;
        const JointId joint = Join(world, settings);
        world.Run(1);
        EXPECT_EQ(JointsOf(world).IsEnabled(joint), strength > 49.05f);
    }
}

TEST(JointBreak, ABlowCountsOverTheWholeStep) {
    // 2 N s in a sixtieth of a second and the weight: 218.1 N, whatever the number of substeps. What the pull on the
    // anchor takes back later in the step is below a hundredth.
    for (const int substeps : {1, 4, 16})
        for (const float strength : {216.0f, 221.0f}) {
            SystemSettings settings = NoSleep();
            settings.solver.substeps = substeps;
            Hanging<> hanging{settings};
            const JointId joint = hanging.Hang([&](PointJointSettings& s) { s.breakForce = strength; });
            hanging.world.Run(0.5);
            ASSERT_TRUE(hanging.Joints().IsEnabled(joint));
            ASSERT_TRUE(hanging.world.Bodies().AddImpulse(hanging.box, {0, -2, 0}));
            hanging.world.Step();
            EXPECT_EQ(hanging.Joints().IsEnabled(joint), strength > 218.1f) << substeps << " substeps";
            if (strength < 218.1f) continue;
            EXPECT_NEAR(hanging.Joints().GetForce(joint).y(), 10 * kGravity + 2 / kStep, 2.181)
                << substeps << " substeps";
        }
}

TEST(JointBreak, OneThatIsEnabledAgainHoldsAgain) {
    Hanging<> hanging;
    const JointId joint = hanging.Hang([](PointJointSettings& s) { s.breakForce = 300; });
    hanging.world.Run(0.2);
    // A blow of 100 N s in a sixtieth of a second is 6000 N.
    ASSERT_TRUE(hanging.world.Bodies().AddImpulse(hanging.box, {0, -100, 0}));
    hanging.world.Step();
    EXPECT_EQ(hanging.world.System().Events().brokenJoints.size(), 1u);
    EXPECT_EQ(hanging.Joints().GetForce(joint), Vector3(0, 0, 0));
    hanging.world.Step();
    EXPECT_EQ(hanging.world.System().Events().brokenJoints.size(), 0u);
    ASSERT_TRUE(hanging.world.Bodies().SetPose(hanging.box, {0, -0.5, 0}, {}));
    ASSERT_TRUE(hanging.world.Bodies().SetVelocity(hanging.box, {0, 0, 0}, {0, 0, 0}));
    ASSERT_TRUE(hanging.Joints().SetEnabled(joint, true));
    hanging.world.Run(1);
    EXPECT_TRUE(hanging.Joints().IsEnabled(joint));
    EXPECT_NEAR(hanging.world.PositionOf(hanging.box).y(), -0.5, 2e-3);
}

TEST(JointBreak, HappensOnceInTheSameStepForAnyNumberOfThreads) {
    // Loads that swing down break where they pull the most.
    std::vector<std::vector<std::pair<int, uint32_t>>> logs;
    for (const uint32_t threads : {1u, 2u, 4u}) {
        TestWorld world(NoSleep(), threads);
        std::vector<BodyId> links;
        for (int chain = 0; chain < 20; ++chain) {
            BodyId last = AddHook(world, {0, 0, 2.0 * chain});
            for (int i = 0; i < 6; ++i) {
                const BodyId next = world.Add({.shape = CubeOf(0.2f), .position = {i + 0.5, 0, 2.0 * chain}});
                PointJointSettings settings{Between(last, next, {1.0 * i, 0, 2.0 * chain})};
                settings.breakForce = 2000.0f + 300.0f * static_cast<float>(chain);
                Join(world, settings);
                last = next;
            }
        }
        std::vector<std::pair<int, uint32_t>>& log = logs.emplace_back();
        for (int step = 0; step < 180; ++step) {
            world.Step();
            for (const BrokenJoint& joint : world.System().Events().brokenJoints) log.push_back({step, joint.id.index});
        }
        std::vector<uint32_t> broken;
        for (const auto& [step, index] : log) broken.push_back(index);
        std::sort(broken.begin(), broken.end());
        EXPECT_EQ(std::adjacent_find(broken.begin(), broken.end()), broken.end());
        EXPECT_GT(log.size(), 5u);
        EXPECT_LT(log.size(), 120u);
    }
    EXPECT_EQ(logs[1], logs[0]);
    EXPECT_EQ(logs[2], logs[0]);
}

}  // namespace
}  // namespace fulcrum::testing
