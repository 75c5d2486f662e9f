// Which bodies are awake, moved, woke and fell asleep; joints that broke.
#include <Fulcrum/Physics/Joints/PointJoint.h>
#include <Fulcrum/UnitTests/Support/ContactEvents.h>

#include <algorithm>
#include <set>

namespace fulcrum::testing {
namespace {

std::vector<BodyId> Copy(std::span<const BodyId> ids) { return {ids.begin(), ids.end()}; }
using Ids = std::vector<BodyId>;

SystemSettings WithBodyEvents(SystemSettings settings = {}) {
    settings.events.bodies = true;
    return settings;
}

TEST(BodyEvents, ListWhatIsAwakeAndWhatMoved) {
    SystemSettings settings = WithBodyEvents(NoSleep());
    settings.gravity = Vector3::Zero();
    TestWorld world(settings);
    world.AddFloor();
    const BodyId rests = world.Add({.shape = CubeOf(0.5f), .position = {0, 3, 0}});
    const BodyId sleeps = world.Add({.shape = CubeOf(0.5f), .position = {4, 3, 0}, .startAsleep = true});
    const BodyId flies = world.Add({.shape = CubeOf(0.5f), .position = {8, 3, 0}, .linearVelocity = {0, 1, 0}});
    const BodyId turns = world.Add({.shape = CubeOf(0.5f), .position = {12, 3, 0}, .angularVelocity = {0, 1, 0}});
    const BodyId kinematic = world.Add(
        {.shape = CubeOf(0.5f), .motion = MotionType::Kinematic, .position = {16, 3, 0}, .linearVelocity = {0, 0, 1}});
    world.Step();
    const StepEvents& events = world.System().Events();
    EXPECT_EQ(Copy(events.awake), (Ids{rests, flies, turns, kinematic}));
    EXPECT_EQ(Copy(events.moved), (Ids{rests, flies, turns, kinematic})) << "new ones are among them";
    EXPECT_TRUE(events.woke.empty());
    EXPECT_TRUE(events.fellAsleep.empty());
    world.Step();
    EXPECT_EQ(Copy(events.awake), (Ids{rests, flies, turns, kinematic}));
    EXPECT_EQ(Copy(events.moved), (Ids{flies, turns, kinematic}));

    ASSERT_TRUE(world.Bodies().SetPose(rests, {0, 4, 0}, {}));
    ASSERT_TRUE(world.Bodies().Wake(sleeps));
    ASSERT_TRUE(world.Bodies().SetVelocity(flies, {0, 0, 0}, {0, 0, 0}));
    ASSERT_TRUE(world.Bodies().SetVelocity(kinematic, {0, 0, 0}, {0, 0, 0}));
    world.Step();
    EXPECT_EQ(Copy(events.awake), (Ids{rests, sleeps, flies, turns}));
    EXPECT_EQ(Copy(events.moved), (Ids{rests, turns}));
    EXPECT_EQ(Copy(events.woke), (Ids{sleeps}));
    EXPECT_EQ(Copy(events.fellAsleep), (Ids{kinematic}));
    world.Step(0);
    EXPECT_TRUE(events.awake.empty());
    EXPECT_TRUE(events.woke.empty());
}

// What the lists say, step by step, is what IsAwake says.
TEST(BodyEvents, KeepUpWithASetOfTheAwake) {
    TestWorld world(WithBodyEvents(), 2);
    world.AddFloor();
    std::vector<BodyId> bodies;
    for (int i = 0; i < 40; ++i)
        bodies.push_back(world.Add({.shape = i % 2 ? SphereOf(0.3f) : CubeOf(0.3f),
                                    .position = {i % 8 * 1.5, 0.3 + i / 8 * 0.7, i % 3 * 0.1},
                                    .startAsleep = i == 3}));
    std::set<BodyId> awake;
    for (const BodyId body : bodies)
        if (world.Bodies().IsAwake(body)) awake.insert(body);
    size_t woke = 0, fellAsleep = 0;
    for (int step = 0; step < 400; ++step) {
        if (step == 150) {
            const BodyId fresh = world.Add({.shape = CubeOf(0.3f), .position = {3, 5, 0}});
            bodies.push_back(fresh);
            awake.insert(fresh);
        }
        if (step == 200) {
            ASSERT_TRUE(world.Bodies().Remove(bodies[5]));
            awake.erase(bodies[5]);
            bodies.erase(bodies.begin() + 5);
        }
        // Wakes and sleeps again between two steps: nobody hears of it.
        if (step == 380) {
            ASSERT_TRUE(world.Bodies().Wake(bodies[0]));
            ASSERT_TRUE(world.Bodies().Sleep(bodies[0]));
        }
        world.Step();
        const StepEvents& events = world.System().Events();
        for (const BodyId body : events.woke) EXPECT_TRUE(awake.insert(body).second);
        for (const BodyId body : events.fellAsleep) EXPECT_EQ(awake.erase(body), 1u);
        woke += events.woke.size();
        fellAsleep += events.fellAsleep.size();
        ASSERT_TRUE(std::ranges::is_sorted(events.awake));
        ASSERT_TRUE(std::ranges::is_sorted(events.moved));
        ASSERT_EQ(Copy(events.awake), Ids(awake.begin(), awake.end())) << "step " << step;
        for (const BodyId body : bodies)
            ASSERT_EQ(world.Bodies().IsAwake(body), std::ranges::binary_search(events.awake, body));
    }
    EXPECT_GT(woke, 5u);
    EXPECT_GT(fellAsleep, 20u);
}

// A copy of all poses that is brought up to date by the lists alone.
TEST(BodyEvents, MovedIsAllThatARendererNeeds) {
    TestWorld world(WithBodyEvents());
    world.AddFloor();
    std::vector<BodyId> bodies;
    for (int i = 0; i < 30; ++i)
        bodies.push_back(world.Add({.shape = CubeOf(0.3f),
                                    .position = {i % 5 * 1.0, 0.3 + i / 5 * 0.65, 0},
                                    .linearVelocity = {i % 7 == 0 ? 2.0f : 0.0f, 0, 0},
                                    .continuous = i % 2 ? ContinuousCollision::Linear : ContinuousCollision::Off}));
    std::vector<Pose> poses(bodies.size());
    size_t lists = 0;
    for (int step = 0; step < 500; ++step) {
        // One that sleeps is carried off, and does not wake.
        if (step == 180) {
            const auto sleeper =
                std::ranges::find_if(bodies, [&](BodyId body) { return !world.Bodies().IsAwake(body); });
            ASSERT_NE(sleeper, bodies.end());
            ASSERT_TRUE(world.Bodies().SetPose(*sleeper, {0, 20, 9}, {}));
            ASSERT_TRUE(world.Bodies().Sleep(*sleeper));
        }
        EXPECT_TRUE(step != 190 || world.Bodies().SetPose(bodies[7], {0, 9, 9}, {}));
        world.Step();
        for (const BodyId body : world.System().Events().moved)
            poses[body.index - bodies[0].index] = world.Bodies().GetPose(body);
        lists += world.System().Events().moved.size();
        for (size_t i = 0; i < bodies.size(); ++i) {
            const Pose pose = world.Bodies().GetPose(bodies[i]);
            ASSERT_EQ(poses[i].position, pose.position) << step;
            ASSERT_EQ(poses[i].rotation.y, pose.rotation.y) << step;
        }
    }
    EXPECT_LT(lists, 400u * bodies.size()) << "sleepers are not among them";
}

TEST(BodyEvents, MayBeSwitchedOnLater) {
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Steps(100);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    EXPECT_TRUE(world.System().Events().fellAsleep.empty());
    ASSERT_TRUE(world.System().SetSettings(WithBodyEvents()));
    ASSERT_TRUE(world.Bodies().Wake(box));
    world.Step();
    EXPECT_EQ(Copy(world.System().Events().woke), (Ids{box}));
    ASSERT_TRUE(world.System().SetSettings({}));
    world.Step();
    EXPECT_TRUE(world.System().Events().awake.empty());
}

// 10 kg and a blow of 2 N s in a sixtieth of a second: 218 N.
TEST(BodyEvents, AJointThatBrokeComesWithItsForce) {
    TestWorld world(NoSleep());
    const BodyId hook = world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Static});
    const BodyId load = world.Add({.shape = CubeOf(0.2f), .position = {0, -1, 0}, .mass = 10});
    PointJointSettings settings;
    settings.bodyA = hook;
    settings.bodyB = load;
    settings.anchorA.point = {0, -1, 0};
    settings.breakForce = 150;
    const JointId joint = world.System().Joints().Create(settings).Value();
    world.Steps(10);
    EXPECT_TRUE(world.System().Events().brokenJoints.empty());
    ASSERT_TRUE(world.Bodies().AddImpulse(load, {0, -2, 0}));
    world.Step();
    const auto broken = world.System().Events().brokenJoints;
    ASSERT_EQ(broken.size(), 1u);
    EXPECT_EQ(broken[0].id, joint);
    EXPECT_NEAR(broken[0].force.y(), 10 * kGravity + 2 / kStep, 3);
    EXPECT_LT(Length(broken[0].torque), 1);
    world.Step();
    EXPECT_TRUE(world.System().Events().brokenJoints.empty());
}

}  // namespace
}  // namespace fulcrum::testing
