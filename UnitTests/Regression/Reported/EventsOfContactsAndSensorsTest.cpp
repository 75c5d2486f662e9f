// Reported of events elsewhere: the first touch of a sleeping body is missed, begins and ends do not match, a body that
// sleeps in a sensor leaves it, fast bodies enter and do not leave.
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <set>
#include <utility>

namespace fulcrum::testing {
namespace {

SystemSettings WithContacts() {
    SystemSettings settings;
    settings.events.contacts = true;
    settings.events.stays = false;
    return settings;
}

// A ball of 20 m/s hits a box that sleeps. Without restitution both go on with one speed along the normal: the impulse
// is v ma mb / (ma + mb), less what the box turns away, since it is not hit in its center: within 30 %.
TEST(ReportedEvents, TheFirstTouchOfASleepingBodyIsOne) {
    TestWorld world(WithContacts());
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.3f), .position = {0, 0.3, 0}});
    world.Run(2);
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    const BodyId ball = world.Add(
        {.shape = SphereOf(0.1f), .position = {-3, 0.3, 0}, .linearVelocity = {20, 0, 0}, .gravityFactor = 0});
    int begun = 0;
    double impulse = 0;
    for (int step = 0; step < 30; ++step) {
        world.Step();
        for (const ContactEvent& event : world.System().Events().contacts) {
            const bool isTheirs = std::minmax(event.bodyA, event.bodyB) == std::minmax(box, ball);
            if (!isTheirs || event.kind != ContactEvent::Kind::Begin) continue;
            ++begun;
            impulse = event.NormalImpulse();
        }
    }
    EXPECT_EQ(begun, 1);
    const double a = world.Bodies().GetMass(box), b = world.Bodies().GetMass(ball);
    EXPECT_NEAR(impulse / (20 * a * b / (a + b)), 1, 0.3);
}

// Bodies that are added, removed and teleported at random.
TEST(ReportedEvents, BeginsAndEndsMatch) {
    for (const uint32_t threads : {1u, 2u}) {
        RandomPoses random(8);
        TestWorld world(WithContacts(), threads);
        world.AddFloor();
        std::vector<BodyId> bodies;
        std::set<std::pair<BodyId, BodyId>> open;
        const auto heed = [&] {
            for (const ContactEvent& event : world.System().Events().contacts) {
                const std::pair pair(event.bodyA, event.bodyB);
                if (event.kind == ContactEvent::Kind::Begin) {
                    EXPECT_TRUE(open.insert(pair).second) << "began twice";
                }
                if (event.kind == ContactEvent::Kind::End) {
                    EXPECT_EQ(open.erase(pair), 1u) << "ended twice";
                }
            }
        };
        const auto any = [&] { return random.Below(static_cast<uint32_t>(bodies.size())); };
        for (int step = 0; step < 360; ++step) {
            if (step % 4 == 0 && bodies.size() < 60) {
                const Vector3 at = random.InBox(1.5f);
                bodies.push_back(world.Add({.shape = step % 8 ? SphereOf(0.3f) : BoxOf(0.3f, 0.2f, 0.4f),
                                            .position = {at.x(), 3.5 + at.y(), at.z()}}));
            }
            if (step % 11 == 0 && bodies.size() > 20) {
                const uint32_t removed = any();
                ASSERT_TRUE(world.Bodies().Remove(bodies[removed]));
                bodies.erase(bodies.begin() + removed);
            }
            if (step % 17 == 0) {
                const Vector3 to = random.InBox(2);
                ASSERT_TRUE(world.Bodies().SetPose(bodies[any()], {to.x(), 4, to.z()}, {}));
            }
            world.Step();
            heed();
        }
        EXPECT_FALSE(open.empty());
        for (const BodyId body : bodies) ASSERT_TRUE(world.Bodies().Remove(body));
        world.Step();
        heed();
        EXPECT_TRUE(open.empty()) << open.size() << " contacts of no body have not ended";
    }
}

// A compound of three cubes falls into a sensor and sleeps in it; others come and go, and a child that is inside is
// removed: the body stays inside until it is moved away.
TEST(ReportedEvents, ABodyThatSleepsInASensorStaysInIt) {
    TestWorld world;
    world.AddFloor();
    const BodyId sensor = world.Add({.shape = CubeOf(1),
                                     .motion = MotionType::Static,
                                     .position = {0, 1, 0},
                                     .isSensor = true,
                                     .sensorReportsStay = false});
    std::vector<CompoundShape::ChildSettings> cubes;
    for (const float height : {0.0f, 0.7f, 1.4f}) cubes.push_back({.shape = CubeOf(0.3f), .position = {0, height, 0}});
    const BodyId body = world.Add({.shape = MutableCompound::Create(cubes).Value(), .position = {0, 4, 0}});
    int entered = 0, left = 0, others = 0;
    const auto run = [&](double seconds) {
        for (int step = 0; step < std::lround(seconds / kStep); ++step) {
            world.Step();
            for (const SensorEvent& event : world.System().SensorEvents()) {
                others += event.body != body;
                entered += event.body == body && event.kind == SensorEvent::Kind::Begin;
                left += event.body == body && event.kind == SensorEvent::Kind::End;
            }
        }
    };
    run(4);
    EXPECT_FALSE(world.Bodies().IsAwake(body));
    world.Add({.shape = SphereOf(0.3f), .position = {9, 3, 0}});
    run(2);
    EXPECT_EQ(entered, 1);
    EXPECT_EQ(left, 0);
    ASSERT_TRUE(world.Bodies().RemoveChild(body, world.Bodies().GetChildren(body)->IdOf(0)));
    run(1);
    EXPECT_EQ(left, 0);
    EXPECT_EQ(world.System().BodiesInside(sensor).size(), 1u);
    ASSERT_TRUE(world.Bodies().SetPose(body, {9, 9, 0}, {}));
    run(0.2);
    EXPECT_EQ(left, 1);
    ASSERT_TRUE(world.Bodies().SetPose(body, {0, 1, 0}, {}));
    run(0.2);
    ASSERT_TRUE(world.Bodies().Remove(body));
    run(0.2);
    EXPECT_EQ(entered, 2);
    EXPECT_EQ(left, 2);
    EXPECT_EQ(others, 0);
}

// Through a wall of 1 m at 1 to 500 m/s, which is up to eight walls a step: each enters once and leaves once, later.
TEST(ReportedEvents, WhatIsFastEntersAndLeaves) {
    enum class Kind : uint8_t { SensorThroughStatic, SensorThroughKinematic, BulletThroughSensor };
    for (const Kind kind : {Kind::SensorThroughStatic, Kind::SensorThroughKinematic, Kind::BulletThroughSensor}) {
        RandomPoses random(4);
        for (int i = 0; i < 40; ++i) {
            TestWorld world(NoGravity());
            const bool isBullet = kind == Kind::BulletThroughSensor;
            const float speed = std::pow(10.0f, random.Between(0.8f, 2.7f)), slant = random.Between(-0.3f, 0.3f);
            world.Add({.shape = BoxOf(0.5f, 10, 10),
                       .motion = kind == Kind::SensorThroughKinematic ? MotionType::Kinematic : MotionType::Static,
                       .position = {1.5, 11, 0},
                       .isSensor = isBullet,
                       .sensorSees = SensorSees::All});
            world.Add({.shape = SphereOf(0.1f),
                       .position = {random.Between(3, 8), 4, 0},
                       .linearVelocity = {-speed, slant * speed, 0},
                       .continuous = isBullet ? ContinuousCollision::Linear : ContinuousCollision::Off,
                       .isSensor = !isBullet,
                       .sensorSees = SensorSees::All});
            int entered = 0, left = 0;
            double enteredAt = 0, leftAt = 0;  // steps
            for (int step = 0; step < 9 / speed / kStep + 4; ++step) {
                world.Step();
                for (const SensorEvent& event : world.System().SensorEvents()) {
                    const bool isBegin = event.kind == SensorEvent::Kind::Begin,
                               isEnd = event.kind == SensorEvent::Kind::End;
                    entered += isBegin;
                    left += isEnd;
                    if (isBegin) enteredAt = step + double{event.time};
                    if (isEnd) leftAt = step + double{event.time};
                }
            }
            EXPECT_EQ(entered, 1) << "kind " << static_cast<int>(kind) << ", " << speed << " m/s";
            EXPECT_EQ(left, 1) << "kind " << static_cast<int>(kind) << ", " << speed << " m/s";
            EXPECT_GE(leftAt, enteredAt) << "kind " << static_cast<int>(kind) << ", " << speed << " m/s";
        }
    }
}

}  // namespace
}  // namespace fulcrum::testing
