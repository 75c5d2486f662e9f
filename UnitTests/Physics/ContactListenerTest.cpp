// What a contact listener is asked, and what its answers do.
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/MixedScene.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>

namespace fulcrum::testing {
namespace {

// A listener of two functions.
class Asking final : public ContactListener {
public:
    std::function<bool(BodyId, BodyId)> should = [](BodyId, BodyId) { return true; };
    std::function<void(const ContactView&, ContactChange&)> modify = [](const ContactView&, ContactChange&) {};
    bool ShouldCollide(BodyId a, BodyId b) const override { return should(a, b); }
    void ModifyContact(const ContactView& contact, ContactChange& change) const override { modify(contact, change); }
};

TEST(ShouldCollide, IsAskedOnceForTwoBodiesThatStayTogether) {
    Asking listener;
    TestWorld world(NoSleep());
    std::atomic<int> asked = 0;
    listener.should = [&](BodyId a, BodyId b) {
        EXPECT_LT(a.index, b.index);
        ++asked;
        return true;
    };
    world.System().SetContactListener(&listener);
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Steps(100);
    EXPECT_EQ(asked, 1);
    EXPECT_EQ(world.Report().contacts, 1u);
}

TEST(ShouldCollide, KeepsBodiesApartFromTheirFirstStepOn) {
    Asking listener;
    TestWorld world;
    const BodyId floor = world.AddFloor();
    BodyId ghost{};
    listener.should = [&](BodyId a, BodyId b) { return !(a == floor && b == ghost); };
    world.System().SetContactListener(&listener);
    ghost = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    const BodyId other = world.Add({.shape = CubeOf(0.5f), .position = {3, 0.5, 0}});
    world.Run(1);
    // Free flight is exact but for the float that keeps the speed.
    EXPECT_NEAR(world.PositionOf(ghost).y(), 0.5 - 0.5 * kGravity, 1e-4);
    EXPECT_NEAR(world.PositionOf(other).y(), 0.5, 1e-3);
}

TEST(ShouldCollide, AnotherListenerEndsContactsAndWakesTheirBodies) {
    Asking forbids, allows;
    forbids.should = [](BodyId, BodyId) { return false; };
    TestWorld world;
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    world.System().SetContactListener(&allows);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    world.System().SetContactListener(&forbids);
    EXPECT_TRUE(world.Bodies().IsAwake(box));
    world.Steps(6);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5 - 0.5 * kGravity * 0.01, 1e-3);
    world.System().SetContactListener(nullptr);
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.5, 2e-3);
}

TEST(ModifyContact, IsAskedInEveryStepAboutKeptManifoldsToo) {
    Asking listener;
    TestWorld world(NoSleep());
    const BodyId floor = world.AddFloor();
    const BodyId box = world.Add(
        {.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .material = {.friction = 0.8f, .restitution = 0.25f}});
    int asked = 0;
    listener.modify = [&](const ContactView& contact, ContactChange& change) {
        ++asked;
        EXPECT_EQ(contact.bodyA, box);
        EXPECT_EQ(contact.bodyB, floor);
        EXPECT_NEAR(contact.normal.y(), -1, 1e-6);
        EXPECT_EQ(contact.points.size(), 4u);
        for (const ContactView::Point& point : contact.points) {
            EXPECT_NEAR(point.position.y(), 0, 1e-3);
            EXPECT_NEAR(std::fabs(point.position.x()), 0.5, 1e-3);
            EXPECT_NEAR(point.separation, 0, 1e-3);
        }
        EXPECT_LT((contact.Center() - Position(0, 0, 0)).norm(), 1e-3);
        EXPECT_EQ(change.friction, std::sqrt(0.8f * 0.5f));
        EXPECT_EQ(change.restitution, 0.25f);
        change.friction = 0.1f;  // forgotten by the next step
        change.restitution = 0;
    };
    world.System().SetContactListener(&listener);
    world.Steps(50);
    EXPECT_EQ(asked, 50);
    EXPECT_EQ(world.Report().keptManifolds, 1u);
}

TEST(ModifyContact, KnowsThePiecesOfCompounds) {
    Asking listener;
    TestWorld world(NoSleep());
    world.AddFloor();
    world.Add({.shape = CompoundOf({{.shape = SphereOf(0.2f), .position = {0, 2, 0}}, {.shape = CubeOf(0.5f)}}),
               .position = {0, 0.5, 0}});
    int asked = 0;
    listener.modify = [&](const ContactView& contact, ContactChange&) {
        ++asked;
        EXPECT_EQ(contact.childA, 1u);
        EXPECT_EQ(contact.childB, 0u);
    };
    world.System().SetContactListener(&listener);
    world.Step();
    EXPECT_EQ(asked, 1);
}

TEST(ModifyContact, StopsASlidingBoxWhereTheNewFrictionSays) {
    Asking listener;
    listener.modify = [](const ContactView&, ContactChange& change) { change.friction = 0.25f; };
    TestWorld world(NoSleep());
    world.AddFloor({.friction = 0.9f});
    const BodyId box = world.Add(
        {.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .linearVelocity = {5, 0, 0}, .material = {.friction = 0.9f}});
    world.System().SetContactListener(&listener);
    world.Run(3);
    // v^2 / (2 mu g), less v h / 2 of the substep h; 1e-3 for the way in which the contact settles.
    const double expected = 5 * 5 / (2 * 0.25 * kGravity) - 0.5 * 5 * kStep / 4;
    EXPECT_NEAR(world.PositionOf(box).x(), expected, 1.5e-3 * expected);
    EXPECT_LT(world.VelocityOf(box).norm(), 1e-3f);

    // Without the listener the materials' friction is back, also for the contact that exists.
    ASSERT_TRUE(world.Bodies().SetVelocity(box, {5, 0, 0}, {0, 0, 0}));
    world.System().SetContactListener(nullptr);
    world.Step();
    EXPECT_NEAR(world.VelocityOf(box).x(), 5 - 0.9 * kGravity * kStep, 1e-2);
}

TEST(ModifyContact, MakesABallBounce) {
    Asking listener;
    listener.modify = [](const ContactView&, ContactChange& change) { change.restitution = 0.5f; };
    TestWorld world(NoSleep());
    world.AddFloor();
    const BodyId ball = world.Add({.shape = SphereOf(0.5f), .position = {0, 2.5, 0}});
    world.System().SetContactListener(&listener);
    double highest = 0;
    bool hit = false;
    for (int i = 0; i < 120; ++i) {
        world.Step(1.0 / 120);
        hit |= world.VelocityOf(ball).y() > 0;
        if (hit) highest = std::max(highest, world.PositionOf(ball).y() - 0.5);
    }
    EXPECT_NEAR(highest, 0.25 * 2, 0.01 * 2);  // e^2 h
}

// Solid from above: what is below the top, or on its way up, passes.
void OneWay(const ContactView& contact, ContactChange& change, const BodyInterface& bodies, BodyId platform) {
    if (contact.bodyB != platform) return;
    const bool below = bodies.GetPose(contact.bodyA).position.y() < bodies.GetPose(platform).position.y() + 0.1;
    change.ignore = below || bodies.GetLinearVelocity(contact.bodyA).y() > 0.1f;
}

TEST(ModifyContact, MakesAPlatformSolidFromAboveAlone) {
    Asking listener;
    TestWorld world(NoSleep());
    const BodyId platform =
        world.Add({.shape = BoxOf(5, 0.1f, 5), .motion = MotionType::Static, .position = {0, 2, 0}});
    listener.modify = [&](const ContactView& contact, ContactChange& change) {
        OneWay(contact, change, world.Bodies(), platform);
    };
    world.System().SetContactListener(&listener);
    const BodyId ball = world.Add({.shape = SphereOf(0.25f), .linearVelocity = {0, 9, 0}});
    double highest = 0;
    for (int i = 0; i < 60; ++i) {
        world.Step();
        highest = std::max(highest, world.PositionOf(ball).y());
    }
    // The apex of free flight, v^2 / 2 g: exact at each step, of which the one closest to it is at most half a step
    // away.
    EXPECT_NEAR(highest, 9 * 9 / (2 * kGravity), 0.5 * kGravity * 0.25 * kStep * kStep + 1e-4);
    world.Run(2);
    EXPECT_NEAR(world.PositionOf(ball).y(), 2 + 0.1 + 0.25, 2e-3);
    EXPECT_EQ(world.Report().contacts, 1u);
}

TEST(ModifyContact, IgnoredContactsWakeNobodyAndAreNotReported) {
    Asking listener;
    listener.modify = [](const ContactView& contact, ContactChange& change) {
        change.ignore = contact.bodyB.index + contact.bodyA.index > 1;
    };
    TestWorld world;
    world.AddFloor();
    const BodyId sleeper = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(sleeper));
    world.System().SetContactListener(&listener);
    const BodyId ball = world.Add({.shape = SphereOf(0.2f), .position = {0, 3, 0}});
    world.Steps(60);
    EXPECT_FALSE(world.Bodies().IsAwake(sleeper));
    EXPECT_NEAR(world.PositionOf(ball).y(), 3 - 0.5 * kGravity, 1e-4);
    EXPECT_EQ(world.Report().contacts, 0u);
    // Once it counts, it wakes and pushes.
    listener.modify = [](const ContactView&, ContactChange&) {};
    ASSERT_TRUE(world.Bodies().SetPose(ball, {0, 1.25, 0}, {}));
    ASSERT_TRUE(world.Bodies().Sleep(sleeper));
    world.Steps(10);
    EXPECT_TRUE(world.Bodies().IsAwake(sleeper));
    EXPECT_GT(world.ImpulseBetween(ball, sleeper), 0);
}

TEST(ModifyContact, IgnoresValuesOutOfRange) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
    const auto slide = [](const ContactChange* wrong) {
        Asking listener;
        listener.modify = [&](const ContactView&, ContactChange& change) { change = *wrong; };
        TestWorld world(NoSleep());
        world.AddFloor({.restitution = 0.5f});
        world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}, .linearVelocity = {3, 0, 0}});
        if (wrong) world.System().SetContactListener(&listener);
        world.Run(1);
        EXPECT_TRUE(world.AllFinite());
        return world.System().HashPoses();
    };
    const uint64_t expected = slide(nullptr);
    for (float friction : {-1.0f, nan, infinite})
        for (float restitution : {-0.1f, 1.1f, nan})
            for (float surface : {nan, infinite}) {
                ContactChange wrong{friction, restitution};
                wrong.surfaceVelocity = Vector3(surface, 0, 0);
                wrong.surfaceAngularVelocity = Vector3(0, surface, 0);
                EXPECT_EQ(slide(&wrong), expected) << friction << " " << restitution;
            }
}

uint64_t HashOfMixed(const ContactListener* listener, uint32_t threads) {
    TestWorld world({}, threads);
    MixedScene scene(world);
    world.System().SetContactListener(listener);
    for (int step = 0; step < 150; ++step) {
        scene.BeforeStep(step);
        world.Step();
    }
    return world.System().HashPoses();
}

TEST(ListenerDeterminism, OneThatChangesNothingChangesNoBit) {
    const Asking listener;
    EXPECT_EQ(HashOfMixed(&listener, 2), HashOfMixed(nullptr, 1));
}

// All that an answer can be, from the ids and the place.
void AnswerByIds(const ContactView& contact, ContactChange& change) {
    const uint32_t sum = contact.bodyA.index + contact.bodyB.index;
    const Vector3 place = contact.Center().cast<float>();
    if (sum % 3 == 0) change.friction = 0.1f * static_cast<float>(sum % 7);
    if (sum % 5 == 0) change.restitution = 0.3f;
    if (sum % 2 == 0) change.MoveSurface(contact, contact.bodyB, {0.5f, 0, 0.1f * place.x()});
    if (sum % 11 == 0) change.RotateSurface(contact, contact.bodyA, Position::Zero(), {0, 0.4f, 0});
    change.ignore = sum % 13 == 0 && place.y() > 0.5f;
}

TEST(ListenerDeterminism, TheSameBitsForAnyNumberOfThreads) {
    Asking listener;
    listener.should = [](BodyId a, BodyId b) { return a.index == 0 || (a.index + b.index) % 9 != 0; };
    listener.modify = AnswerByIds;
    const uint64_t one = HashOfMixed(&listener, 1);
    EXPECT_NE(one, HashOfMixed(nullptr, 1));
    for (uint32_t threads : {1u, 2u, 3u, 4u}) EXPECT_EQ(HashOfMixed(&listener, threads), one) << threads;
}

TEST(ListenerCost, ASettledStepAllocatesNothing) {
    for (uint32_t threads : {1u, 2u}) {
        Asking listener;
        TestWorld world(NoSleep(), threads);
        const BodyId floor = world.AddFloor();
        // No farther out than 5 m: the jerk at the start throws a column over that begins at 1.2 m/s.
        for (int i = 0; i < 11; ++i)
            for (int row = 0; row < 3; ++row)
                world.Add({.shape = CubeOf(0.25f), .position = {i - 5.0, 0.25 + 0.5 * row, 0}});
        // A turntable: all boxes circle for ever.
        listener.modify = [&](const ContactView& contact, ContactChange& change) {
            change.friction = 0.9f;
            if (contact.bodyB == floor) change.RotateSurface(contact, floor, Position::Zero(), {0, 0.2f, 0});
        };
        world.System().SetContactListener(&listener);
        world.Steps(300);
        const uint64_t before = AllocationCount();
        for (int i = 0; i < 100; ++i) {
            const Status status = world.System().Update(kStep);
            if (!status) ADD_FAILURE();
        }
        EXPECT_EQ(AllocationCount() - before, 0u) << threads << " threads";
        EXPECT_EQ(world.Report().contacts, 33u);
    }
}

}  // namespace
}  // namespace fulcrum::testing
