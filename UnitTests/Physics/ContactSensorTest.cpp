// Contacts that a listener makes sensors of: events without impulses.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

// Of what the body named touches.
class SenseOf final : public ContactListener {
public:
    void ModifyContact(const ContactView& contact, ContactChange& change) const override {
        change.isSensor = contact.bodyA == body || contact.bodyB == body;
    }
    BodyId body;
};

SystemSettings WithEvents() {
    SystemSettings settings;
    settings.events.contacts = true;
    return settings;
}

// A ball falls through a slab of 1 m: one begin, one end, between them a stay in each step, and nothing that slows it.
TEST(ContactSensor, ABallFallsThroughAndIsReported) {
    TestWorld world(WithEvents());
    const BodyId slab = world.Add({.shape = BoxOf(5, 0.5f, 5), .motion = MotionType::Static, .position = {0, -3, 0}});
    const BodyId ball = world.Add({.shape = SphereOf(0.25f)});
    const BodyId other = world.Add({.shape = SphereOf(0.25f), .position = {3, 0, 0}});
    SenseOf listener;
    listener.body = ball;
    world.System().SetContactListener(&listener);
    int begins = 0, stays = 0, ends = 0;
    double from = 0, to = 0;
    for (int i = 0; i < 90; ++i) {
        world.Step();
        for (const ContactEvent& event : world.System().Events().contacts) {
            if (event.bodyA != ball) continue;
            EXPECT_EQ(event.bodyB, slab);
            EXPECT_EQ(event.NormalImpulse(), 0);
            begins += event.kind == ContactEvent::Kind::Begin;
            stays += event.kind == ContactEvent::Kind::Stay;
            ends += event.kind == ContactEvent::Kind::End;
            if (event.kind == ContactEvent::Kind::Begin) from = world.PositionOf(ball).y();
            if (event.kind == ContactEvent::Kind::End) to = world.PositionOf(ball).y();
            EXPECT_TRUE(event.kind == ContactEvent::Kind::End || event.manifolds[0].pointCount > 0);
        }
    }
    EXPECT_EQ(begins, 1);
    EXPECT_EQ(ends, 1);
    EXPECT_GT(stays, 3);
    // It overlaps from -2.25 to -3.75; a step at 7 and 9 m/s is 0.12 and 0.15 m.
    EXPECT_LE(from, -2.25 + 1e-3);
    EXPECT_GE(from, -2.25 - 0.12);
    EXPECT_LE(to, -3.75);
    EXPECT_GE(to, -3.75 - 0.16);
    const double time = 90 * kStep;
    EXPECT_NEAR(world.PositionOf(ball).y(), -0.5 * kGravity * time * time, 1e-4);
    EXPECT_NEAR(world.PositionOf(other).y(), -2.25, 0.01);
    // Without the listener the contacts act again.
    ASSERT_TRUE(world.Bodies().SetPose(ball, {0, -2, 0}, {}));
    ASSERT_TRUE(world.Bodies().SetVelocity(ball, {0, 0, 0}, {0, 0, 0}));
    world.System().SetContactListener(nullptr);
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(ball).y(), -2.25, 0.01);
}

TEST(ContactSensor, ABulletPasses) {
    TestWorld world(WithEvents());
    world.Add({.shape = BoxOf(0.05f, 5, 5), .motion = MotionType::Static, .position = {3, 0, 0}});
    const BodyId bullet = world.Add({.shape = SphereOf(0.05f),
                                     .linearVelocity = {300, 0, 0},
                                     .gravityFactor = 0,
                                     .continuous = ContinuousCollision::Linear});
    SenseOf listener;
    listener.body = bullet;
    world.System().SetContactListener(&listener);
    world.Steps(6);
    EXPECT_NEAR(world.PositionOf(bullet).x(), 30, 1e-3);
}

}  // namespace
}  // namespace fulcrum::testing
