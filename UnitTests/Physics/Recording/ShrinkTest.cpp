// Of a long program that fails what is needed for it is left.
#include <Fulcrum/Physics/Recording/Shrink.h>
#include <Fulcrum/UnitTests/Physics/Recording/RecordedProgram.h>

#include <atomic>

namespace fulcrum::testing {
namespace {

constexpr int kBodies = 200;

// 200 bodies that fall onto a floor, some joined, some pushed, created one by one or in a batch; one is hit so hard at
// step 40 that it flies.
Bytes LongProgram(bool inABatch) {
    TestWorld world;
    return RecordingOf(world.System(), [&] {
        world.AddFloor();
        std::vector<BodySettings> settings;
        for (int i = 0; i < kBodies; ++i)
            settings.push_back({.shape = i % 2 ? CubeOf(0.2f) : SphereOf(0.2f),
                                .position = {0.6 * (i % 20), 0.3 + 0.5 * (i % 3), 0.6 * (i / 20)}});
        std::vector<BodyId> bodies;
        if (inABatch) bodies = world.Bodies().Commit(BodyBatch::Prepare(settings).Value()).Value().bodies;
        for (const BodySettings& one : settings)
            if (!inABatch) bodies.push_back(world.Add(one));
        for (size_t i = 0; i + 1 < bodies.size(); i += 10) {
            PointJointSettings joint;
            joint.bodyA = bodies[i];
            joint.bodyB = bodies[i + 1];
            joint.anchorA.point = world.PositionOf(bodies[i]);
            ASSERT_TRUE(world.System().Joints().Create(joint));
        }
        for (int step = 0; step < 80; ++step) {
            ASSERT_TRUE(world.Bodies().AddImpulse(bodies[static_cast<size_t>(3 * step % kBodies)], {0, 5, 0}));
            if (step == 40) {
                ASSERT_TRUE(world.Bodies().AddImpulse(bodies[117], {0, 64 * 60, 0}));
            }
            world.Step();
        }
    });
}

void ExpectSmall(const ShrinkReport& report, size_t bodies, size_t steps, size_t calls) {
    EXPECT_EQ(report.before.bodies, kBodies + 1u);
    EXPECT_EQ(report.before.steps, 80u);
    EXPECT_LE(report.after.bodies, bodies);
    EXPECT_LE(report.after.steps, steps);
    EXPECT_LE(report.after.calls, calls);
    EXPECT_GE(report.after.bodies, 1u);
}

// 64 kg of water in a cube of 0.4 m: the impulse makes 60 m/s.
TEST(Shrink, FindsTheBodyThatIsTooFast) {
    for (const bool inABatch : {false, true}) {
        const CallRecording recording = Parsed(LongProgram(inABatch));
        const Result<ShrinkReport> report = Shrink(recording, FailureOfSpeed(50));
        ASSERT_TRUE(report) << report.GetError().message;
        // Create, AddImpulse, Update.
        ExpectSmall(report.Value(), 1, 1, 3);
        EXPECT_LT(report.Value().replays, 200u);
        // What is left is a recording, too, and fails.
        const CallRecording small = Parsed(report.Value().recording);
        EXPECT_EQ(small.Calls(), report.Value().after.calls);
        double fastest = 0;
        const Result<ReplayReport> replay =
            Replay(small, {.afterStep = [&](PhysicsSystem& system) {
                       system.VisitBodies([&](BodyId id) {
                           fastest = std::max(fastest, double{Length(system.Bodies().GetLinearVelocity(id))});
                       });
                       return true;
                   }});
        ASSERT_TRUE(replay);
        EXPECT_FALSE(replay.Value().divergence);
        EXPECT_GT(fastest, 50);
    }
}

// Of a batch of pairs, one of them joined to a body outside of it, what breaks is left: its two bodies and its joint.
TEST(Shrink, FindsTheJointOfABatch) {
    constexpr uint32_t kPairs = 20, kWeak = 13;
    TestWorld world;
    const Bytes bytes = RecordingOf(world.System(), [&] {
        const BodyId hook = world.Add({.shape = SphereOf(0.2f), .motion = MotionType::Static, .position = {0, 9, 0}});
        std::vector<BodySettings> bodies;
        std::vector<BodyBatch::Joint> joints;
        for (uint32_t i = 0; i < kPairs; ++i) {
            for (int k = 0; k < 2; ++k) bodies.push_back({.shape = SphereOf(0.2f), .position = {2.0 * i, 5.0 + k, 0}});
            FixedJointSettings joint;
            joint.bodyA = i == 0 ? hook : BodyBatch::Body(2 * i);
            joint.bodyB = BodyBatch::Body(2 * i + 1);
            joint.breakForce = i == kWeak ? 100 : 1e6f;
            joints.emplace_back(joint);
        }
        const BatchIds ids = world.Bodies().Commit(BodyBatch::Prepare(bodies, joints).Value()).Value();
        world.Steps(5);
        for (const BodyId id : ids.bodies)
            ASSERT_TRUE(world.Bodies().AddImpulse(id, {0, id.index % 2 ? -20.f : 20.f, 0}));
        world.Steps(20);
    });
    const FailureCheck broken = [](std::span<PhysicsSystem* const> worlds) {
        bool found = false;
        const JointInterface& joints = worlds[0]->Joints();
        joints.Visit([&](JointId id) { found |= !joints.IsEnabled(id); });
        return found;
    };
    const Result<ShrinkReport> report = Shrink(Parsed(bytes), broken);
    ASSERT_TRUE(report) << report.GetError().message;
    EXPECT_EQ(report.Value().before.bodies, 2 * kPairs + 1u);
    EXPECT_EQ(report.Value().after.bodies, 2u);
    EXPECT_EQ(report.Value().after.steps, 1u);
    EXPECT_LE(report.Value().after.calls, 5u);  // and a joint, a push or two, the step
}

// Falling to -2 m from 0.3 .. 1.3 m takes time, and no floor: bodies and steps go, but for those of the fall.
TEST(Shrink, KeepsTheStepsThatAFailureTakes) {
    TestWorld world;
    const Bytes bytes = RecordingOf(world.System(), [&] {
        world.AddFloor();
        for (int i = 0; i < 30; ++i) world.Add({.shape = SphereOf(0.2f), .position = {1.0 * i, 0.3, 0}});
        world.Add({.shape = SphereOf(0.2f), .position = {500, 0.3, 0}});
        world.Steps(60);
    });
    const Result<ShrinkReport> report = Shrink(Parsed(bytes), FailureOfHeight(-2));
    ASSERT_TRUE(report) << report.GetError().message;
    EXPECT_EQ(report.Value().after.bodies, 1u);
    // h = g t^2 / 2: 2.3 m take 0.685 s, 41 steps of 1/60 s.
    EXPECT_GE(report.Value().after.steps, 41u);
    EXPECT_LE(report.Value().after.steps, 42u);
}

TEST(Shrink, FindsTheBodyThatIsFrozen) {
    TestWorld world;
    const Bytes bytes = RecordingOf(world.System(), [&] {
        world.AddFloor();
        std::vector<BodyId> bodies;
        for (int i = 0; i < 50; ++i)
            bodies.push_back(world.Add({.shape = SphereOf(0.2f), .position = {1.0 * i, 0.3, 0}}));
        world.Steps(10);
        // Their sum is not finite.
        for (int i = 0; i < 2; ++i) ASSERT_TRUE(world.Bodies().AddForce(bodies[20], {3e38f, 0, 0}));
        world.Steps(10);
    });
    const Result<ShrinkReport> report = Shrink(Parsed(bytes), FailureOfFrozenBody());
    ASSERT_TRUE(report) << report.GetError().message;
    EXPECT_EQ(report.Value().after.bodies, 1u);
    EXPECT_EQ(report.Value().after.steps, 1u);
    EXPECT_EQ(report.Value().after.calls, 4u);
}

// A listener that makes a difference between threads, as a program's error would: contacts of body 17 alone.
class Unsteady final : public ContactListener {
public:
    void ModifyContact(const ContactView& contact, ContactChange& change) const override {
        if (contact.bodyA.generation + contact.bodyB.generation != 0) return;
        const float here = contact.points.empty() ? 0.0f : static_cast<float>(contact.points[0].position.x());
        if (here > 16.5f && here < 17.5f) change.friction = 0.5f + 1e-3f * static_cast<float>(++calls_ % 7);
    }

private:
    mutable std::atomic<int> calls_{0};
};

TEST(Shrink, FindsTheBodyWhoseBitsDependOnTheThreads) {
    TestWorld world;
    const Unsteady unsteady;
    const Bytes bytes = RecordingOf(world.System(), [&] {
        world.System().SetContactListener(&unsteady);
        world.AddFloor();
        for (int i = 0; i < 40; ++i)
            world.Add({.shape = CubeOf(0.2f), .position = {1.0 * i, 0.2, 0}, .linearVelocity = {0, 0, 1}});
        world.Steps(20);
    });
    ThreadPool two(2);
    const ContactListener* const listeners[] = {&unsteady};
    const Result<ShrinkReport> report =
        Shrink(Parsed(bytes), FailureOfDifference(),
               {.jobs = {nullptr, &two}, .sources = {.contactListeners = listeners}, .mostReplays = 500});
    ASSERT_TRUE(report) << report.GetError().message;
    EXPECT_EQ(report.Value().after.bodies, 2u);  // and the floor
    EXPECT_LE(report.Value().after.steps, 4u);
}

TEST(Shrink, SaysIfNothingFails) {
    const CallRecording recording = Parsed(LongProgram(false));
    const Result<ShrinkReport> report = Shrink(recording, FailureOfSpeed(1000));
    ASSERT_FALSE(report);
    EXPECT_EQ(report.GetError().code, ErrorCode::Unsupported);
    EXPECT_NE(report.GetError().message.find("does not fail"), std::string::npos);
    EXPECT_FALSE(Shrink(recording, nullptr));
    EXPECT_FALSE(Shrink(recording, FailureOfSpeed(50), {.jobs = {}}));
}

}  // namespace
}  // namespace fulcrum::testing
