// Events of bodies that pass through sensors: times in closed form, for all speeds, shapes and motions.
#include <Fulcrum/UnitTests/Physics/SensorTest.h>

#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

// A step's fraction is a float of times that were found to 1e-6 of the shapes' sizes; those are meters, and so are the
// ways.
constexpr double kTimeError = 1e-5;

TEST(Sensor, ReportsABallThatFliesThroughWithTheTimesOfItsFlight) {
    // v = 3 m/s along x from -2: the ball of radius 0.25 meets the box of half width 0.5 at x = -0.75 and leaves it at
    // 0.75.
    TestWorld world(NoGravity());
    const BodyId sensor = world.Add(SensorOf(CubeOf(0.5f)));
    const BodyId ball = world.Add({.shape = SphereOf(0.25f), .position = {-2, 0, 0}, .linearVelocity = {3, 0, 0}});
    double begin = -1, end = -1;
    int stays = 0;
    for (int step = 0; step < 90; ++step) {
        world.Step();
        for (const SensorEvent& e : world.System().SensorEvents()) {
            EXPECT_EQ(e.sensor, sensor);
            EXPECT_EQ(e.body, ball);
            const double time = (step + double{e.time}) * kStep;
            if (e.kind == kBegin) begin = time;
            if (e.kind == kEnd) end = time;
            stays += e.kind == kStay;
        }
        const bool isInside = begin >= 0 && end < 0;
        EXPECT_EQ(InsideOf(world, sensor).size(), isInside ? 1u : 0u) << "step " << step;
    }
    EXPECT_NEAR(begin, 1.25 / 3, kTimeError * kStep * 10);  // positions are sums of up to 90 rounded steps
    EXPECT_NEAR(end, 2.75 / 3, kTimeError * kStep * 10);
    // Begun in step 25 (1.25 / 3 s is exactly 25 steps), ended in step 55: it stayed in the steps in between.
    EXPECT_NEAR(stays, 29, 1);
}

TEST(Sensor, TouchesNothingAndChangesNothing) {
    const auto run = [](bool hasSensor) {
        TestWorld world;
        world.AddFloor();
        for (int i = 0; i < 5; ++i) world.Add({.shape = CubeOf(0.5f), .position = {0.1 * i, 0.6 + 1.1 * i, 0}});
        if (hasSensor) {
            world.Add(SensorOf(CubeOf(3), {0, 2, 0}));
            world.Add(SensorOf(SphereOf(1), {0.5, 1, 0}, MotionType::Dynamic));
        }
        world.Steps(120);
        std::vector<Position> positions;
        for (uint32_t i = 1; i < 6; ++i) positions.push_back(world.PositionOf({i, 0}));
        return positions;
    };
    EXPECT_EQ(run(true), run(false));
}

// 1000 m/s are 16.7 m a step: eight sensors 1 cm thick and 2 m apart are passed in one step.
void ExpectBulletThroughRow(ContinuousCollision continuous) {
    TestWorld world(NoGravity());
    std::vector<BodyId> sensors;
    for (int i = 0; i < 8; ++i) sensors.push_back(world.Add(SensorOf(BoxOf(0.005f, 1, 1), {1 + 2.0 * i, 0, 0})));
    BodySettings settings{.shape = SphereOf(0.01f), .position = {0, 0, 0}, .linearVelocity = {1000, 0, 0}};
    settings.continuous = continuous;
    const BodyId bullet = world.Add(settings);
    world.Step();
    const std::vector<SensorEvent> events = EventsOf(world);
    ASSERT_EQ(events.size(), 16u);
    const double length = 1000 * kStep;
    for (size_t i = 0; i < 8; ++i) {
        const double middle = 1 + 2.0 * static_cast<double>(i);
        EXPECT_EQ(events[2 * i].sensor, sensors[i]);
        EXPECT_EQ(events[2 * i].body, bullet);
        EXPECT_EQ(events[2 * i].kind, kBegin);
        EXPECT_EQ(events[2 * i + 1].kind, kEnd);
        EXPECT_NEAR(events[2 * i].time, (middle - 0.015) / length, 1e-6);
        EXPECT_NEAR(events[2 * i + 1].time, (middle + 0.015) / length, 1e-6);
        EXPECT_TRUE(InsideOf(world, sensors[i]).empty());
    }
    world.Step();
    EXPECT_TRUE(EventsOf(world).empty());
}
TEST(Sensor, ReportsABulletThroughARowOfThinSensorsInOneStep) { ExpectBulletThroughRow(ContinuousCollision::Off); }
TEST(Sensor, ReportsABulletOfContinuousCollisionLikewise) { ExpectBulletThroughRow(ContinuousCollision::Linear); }

TEST(Sensor, SortsEventsByTimeThenBody) {
    TestWorld world(NoGravity());
    world.Add(SensorOf(BoxOf(0.005f, 5, 5), {10, 0, 0}));
    std::vector<BodyId> bullets;
    for (int i = 0; i < 10; ++i)
        bullets.push_back(world.Add(
            {.shape = SphereOf(0.01f), .position = {0.5 * (i % 5), 0.3 * i, 0}, .linearVelocity = {1000, 0, 0}}));
    world.Step();
    const std::vector<SensorEvent> events = EventsOf(world);
    ASSERT_EQ(events.size(), 20u);
    for (size_t i = 0; i + 1 < events.size(); ++i)
        EXPECT_LE(std::tie(events[i].time, events[i].body), std::tie(events[i + 1].time, events[i + 1].body));
    EXPECT_EQ(events[0].body, bullets[4]);
    EXPECT_EQ(events[1].body, bullets[9]);
}

TEST(Sensor, ThatMovesReportsWhatItPasses) {
    // A kinematic blade at 300 m/s, 5 m a step, over a ball at rest: from 2.5 - 0.1 - 0.02 to 2.5 + 0.12 m of its way.
    TestWorld world(NoGravity());
    BodySettings blade = SensorOf(BoxOf(0.02f, 1, 1), {0, 0, 0}, MotionType::Kinematic);
    blade.linearVelocity = {300, 0, 0};
    world.Add(blade);
    world.Add({.shape = SphereOf(0.1f), .position = {2.5, 0, 0}, .startAsleep = true});
    world.Step();
    ExpectKinds(world, {kBegin, kEnd});
    const std::vector<SensorEvent> events = EventsOf(world);
    EXPECT_NEAR(events[0].time, 2.38 / 5, 1e-6);
    EXPECT_NEAR(events[1].time, 2.62 / 5, 1e-6);
    EXPECT_FALSE(world.Bodies().IsAwake(events[0].body));
}

TEST(Sensor, AndABodyThatBothMoveMeetAtTheirRelativeSpeed) {
    TestWorld world(NoGravity());
    BodySettings sensor = SensorOf(CubeOf(0.5f), {4, 0, 0}, MotionType::Kinematic);
    sensor.linearVelocity = {-150, 0, 0};
    world.Add(sensor);
    world.Add({.shape = SphereOf(0.5f), .position = {-4, 0, 0}, .linearVelocity = {450, 0, 0}});
    world.Step();  // 10 m nearer: they touch after 7 m and part after 9
    ExpectKinds(world, {kBegin, kEnd});
    EXPECT_NEAR(EventsOf(world)[0].time, 0.7, 1e-6);
    EXPECT_NEAR(EventsOf(world)[1].time, 0.9, 1e-6);
}

TEST(Sensor, ThatTurnsSweepsWhatIsInItsWay) {
    // A rod of 2 m and 2 cm thick turns by a quarter in the step; the ball is at 30 degrees, 0.8 m out. The rod's side,
    // 1 cm from its middle line, meets the ball when the line is asin((0.01 + 0.05) / 0.8) before it, and leaves it as
    // long after it.
    TestWorld world(NoGravity());
    BodySettings rod = SensorOf(BoxOf(1, 0.01f, 0.01f), {0, 0, 0}, MotionType::Kinematic);
    rod.angularVelocity = {0, 0, static_cast<float>(kPi / 2 / kStep)};
    world.Add(rod);
    world.Add({.shape = SphereOf(0.05f), .position = {0.8 * Cos(kPi / 6), 0.8 * Sin(kPi / 6), 0}, .startAsleep = true});
    world.Step();
    ExpectKinds(world, {kBegin, kEnd});
    const double before = std::asin(0.06 / 0.8);
    // A cast of a turning shape ends up to 20 roundings of its size away: 2e-5 m at 1.26 m a step.
    EXPECT_NEAR(EventsOf(world)[0].time, (kPi / 6 - before) / (kPi / 2), 4e-5);
    EXPECT_NEAR(EventsOf(world)[1].time, (kPi / 6 + before) / (kPi / 2), 4e-5);
}

TEST(Sensor, SeesARodThatSpinsThroughIt) {
    // Neither the rod's bounds at the beginning nor those at the end reach the sensor at 45 degrees.
    TestWorld world(NoGravity());
    world.Add(SensorOf(SphereOf(0.05f), {0.7, 0.7, 0}));
    BodySettings rod{.shape = BoxOf(1.2f, 0.02f, 0.02f),
                     .angularVelocity = {0, 0, static_cast<float>(kPi / 2 / kStep)}};
    rod.gyroscopicTorque = false;
    world.Add(rod);
    world.Step();
    ExpectKinds(world, {kBegin, kEnd});
    const std::vector<SensorEvent> events = EventsOf(world);
    EXPECT_NEAR(0.5 * (double{events[0].time} + double{events[1].time}), 0.5, 1e-4);
    const double before = std::asin(0.07 / std::sqrt(0.98)) / (kPi / 2);
    EXPECT_NEAR(events[0].time, 0.5 - before, 1e-4);
}

TEST(Sensor, SeesABulletThatBouncesBackThroughIt) {
    // The wall's face at x = 10, the sensor from 7.9 to 8.1, the bullet of 0.05 m at 900 m/s, 15 m a step, from x = 0:
    // it enters at 7.85, leaves at 8.15, bounces at 9.95, enters at 8.15 on its way back, leaves at 7.85.
    TestWorld world(NoGravity());
    const Material elastic{.friction = 0, .restitution = 1};
    world.Add(
        {.shape = BoxOf(0.5f, 5, 5), .motion = MotionType::Static, .position = {10.5, 0, 0}, .material = elastic});
    const BodyId sensor = world.Add(SensorOf(BoxOf(0.1f, 5, 5), {8, 0, 0}));
    world.Add({.shape = SphereOf(0.05f),
               .position = {0, 0, 0},
               .linearVelocity = {900, 0, 0},
               .material = elastic,
               .continuous = ContinuousCollision::Linear});
    world.Step();
    ExpectKinds(world, {kBegin, kEnd, kBegin, kEnd});
    const std::vector<SensorEvent> events = EventsOf(world);
    // A hit is found with a tolerance of 2 % of the thickness, 1 mm: the way back begins up to that much early.
    EXPECT_NEAR(events[0].time, 7.85 / 15, 1e-6);
    EXPECT_NEAR(events[1].time, 8.15 / 15, 1e-6);
    EXPECT_NEAR(events[2].time, (9.95 + 1.8) / 15, 2 * 0.001 / 15);
    EXPECT_NEAR(events[3].time, (9.95 + 2.1) / 15, 2 * 0.001 / 15);
    EXPECT_TRUE(InsideOf(world, sensor).empty());
    world.Step();
    EXPECT_TRUE(EventsOf(world).empty());
}

TEST(Sensor, SeesABulletThatBouncesInsideAndStays) {
    TestWorld world(NoGravity());
    const Material elastic{.friction = 0, .restitution = 1};
    world.Add(
        {.shape = BoxOf(0.5f, 5, 5), .motion = MotionType::Static, .position = {10.5, 0, 0}, .material = elastic});
    const BodyId sensor = world.Add(SensorOf(BoxOf(4, 5, 5), {6, 0, 0}));
    const BodyId bullet = world.Add({.shape = SphereOf(0.05f),
                                     .position = {0, 0, 0},
                                     .linearVelocity = {900, 0, 0},
                                     .material = elastic,
                                     .continuous = ContinuousCollision::Linear});
    world.Step();
    ExpectKinds(world, {kBegin});
    EXPECT_EQ(InsideOf(world, sensor), std::vector<BodyId>{bullet});
    world.Step();  // 4.9 m at the beginning, out at 1.95 - 0.05
    ExpectKinds(world, {kEnd});
    EXPECT_NEAR(EventsOf(world)[0].time, (4.9 - 1.95) / 15, 2 * 0.001 / 15);
}

TEST(Sensor, SeesABodyOfSeveralPiecesOnce) {
    TestWorld world(NoGravity());
    const BodyId sensor = world.Add(SensorOf(CubeOf(0.5f)));
    // Three balls in a row, 0.4 m apart, of 0.25 m: as long as any of them is inside, the body is.
    const ShapePtr ball = SphereOf(0.25f);
    const ShapePtr row = CompoundOf({{ball, {-0.4f, 0, 0}}, {ball, {0, 0, 0}}, {ball, {0.4f, 0, 0}}});
    world.Add({.shape = row, .position = {-10, 0, 0}, .linearVelocity = {1200, 0, 0}, .maxLinearSpeed = 2000});  // 20 m
    world.Step();
    ExpectKinds(world, {kBegin, kEnd});
    EXPECT_NEAR(EventsOf(world)[0].time, (10 - 0.5 - 0.65) / 20, 1e-6);
    EXPECT_NEAR(EventsOf(world)[1].time, (10 + 0.5 + 0.65) / 20, 1e-6);
    EXPECT_TRUE(InsideOf(world, sensor).empty());
}

TEST(Sensor, SeesABodyWithAGapTwice) {
    TestWorld world(NoGravity());
    world.Add(SensorOf(BoxOf(0.1f, 1, 1)));
    const ShapePtr ball = SphereOf(0.25f);
    world.Add({.shape = CompoundOf({{ball, {-1, 0, 0}}, {ball, {1, 0, 0}}}),
               .position = {-10, 0, 0},
               .linearVelocity = {1200, 0, 0},
               .maxLinearSpeed = 2000});
    world.Step();
    ExpectKinds(world, {kBegin, kEnd, kBegin, kEnd});
    const double at[] = {10 - 1 - 0.35, 10 - 1 + 0.35, 10 + 1 - 0.35, 10 + 1 + 0.35};
    for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(EventsOf(world)[i].time, at[i] / 20, 1e-6);
}

TEST(Sensor, MayBeACompoundAPlaneOrAMesh) {
    const ShapePtr ball = SphereOf(0.5f);
    TestWorld world(NoGravity());
    const BodyId compound = world.Add(SensorOf(CompoundOf({{ball, {0, 0, -0.3f}}, {ball, {0, 0, 0.3f}}})));
    const BodyId plane = world.Add(SensorOf(Plane::Create({1, 0, 0}, -5).Value()));  // x <= -5 is inside
    const Vector3 corners[] = {{5, -9, -9}, {5, 9, -9}, {5, 9, 9}, {5, -9, 9}};
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    const BodyId mesh = world.Add(SensorOf(TriangleMesh::Create({.vertices = corners, .indices = triangles}).Value()));
    const BodyId there = world.Add(
        {.shape = SphereOf(0.1f), .position = {-10, 0, 0}, .linearVelocity = {1200, 0, 0}, .maxLinearSpeed = 2000});
    world.Step();
    std::vector<SensorEvent> events = EventsOf(world);
    ASSERT_EQ(events.size(), 6u) << ::testing::PrintToString(events);
    const double height = std::sqrt(0.6 * 0.6 - 0.3 * 0.3);
    EXPECT_EQ(events[0].sensor, compound);
    EXPECT_NEAR(events[0].time, (10 - height) / 20, 1e-6);
    EXPECT_NEAR(events[1].time, (10 + height) / 20, 1e-6);
    EXPECT_EQ(events[2].sensor, plane);
    EXPECT_EQ(events[2].kind, kBegin);
    EXPECT_EQ(events[2].time, 0);
    EXPECT_NEAR(events[3].time, (5 + 0.1) / 20, 1e-6);
    EXPECT_EQ(events[4].sensor, mesh);
    EXPECT_NEAR(events[4].time, (15 - 0.1) / 20, 1e-6);
    EXPECT_NEAR(events[5].time, (15 + 0.1) / 20, 1e-6);
    // The mesh from its other side.
    ASSERT_TRUE(world.Bodies().SetPose(there, {10, 0, 0}, {}));
    ASSERT_TRUE(world.Bodies().SetVelocity(there, {-1200, 0, 0}, {0, 0, 0}));
    world.Step();
    events = EventsOf(world);
    ASSERT_EQ(events.size(), 5u) << ::testing::PrintToString(events);
    EXPECT_EQ(events[3].sensor, mesh);
    EXPECT_NEAR(events[3].time, (5 - 0.1) / 20, 1e-6);
}

// The first and the last of many times of the step at which two shapes on their ways overlap; first > last: none.
struct Sampled {
    double first = 2, last = -1;
};
Sampled SampleOverlaps(const BodySettings& a, const BodySettings& b, int samples) {
    Sampled result;
    for (int i = 0; i <= samples; ++i) {
        const double time = static_cast<double>(i) / samples;
        const auto poseOf = [&](const BodySettings& s) {
            const Quaternion turn = RotationFromVector(Vector3(s.angularVelocity * static_cast<float>(time * kStep)));
            const Position center = s.position + Rotate(s.rotation, s.shape->Mass().centerOfMass).cast<double>();
            return Pose{center + s.linearVelocity.cast<double>() * (time * kStep), Normalized(turn * s.rotation)};
        };
        if (!Overlap(*a.shape, *b.shape, Relative(poseOf(a), poseOf(b)))) continue;
        result.first = std::min(result.first, time);
        result.last = time;
    }
    return result;
}

TEST(Sensor, AgreesWithSamplesOfWhatTumblesThroughIt) {
    constexpr int kSamples = 1000;
    const ShapePtr shapes[] = {BoxOf(0.6f, 0.2f, 0.1f), CapsuleOf(0.5f, 0.1f),
                               HullOf({{0.5f, 0, 0}, {-0.3f, 0.4f, 0}, {-0.3f, -0.4f, 0.1f}, {0, 0, -0.5f}})};
    RandomPoses random(3);
    int passed = 0;
    for (int i = 0; i < 200; ++i) {
        BodySettings sensor = SensorOf(shapes[i / 3 % 3], {0, 0, 0}, MotionType::Kinematic);
        sensor.rotation = random.Rotation();
        BodySettings body{.shape = shapes[i % 3], .gyroscopicTorque = false};
        body.rotation = random.Rotation();
        const Vector3 offset = random.InCube() * 2.0f, aim = random.InCube() * 0.7f;
        body.position = offset.cast<double>();
        (i % 2 ? sensor : body).linearVelocity =
            Vector3(aim - offset) * (i % 2 ? -90.0f : 90.0f);                   // 1.5 times the distance
        (i % 4 < 2 ? sensor : body).angularVelocity = random.InCube() * 60.0f;  // up to a radian
        const Sampled expected = SampleOverlaps(sensor, body, kSamples);
        TestWorld world(NoGravity());
        world.Add(sensor);
        world.Add(body);
        world.Step();
        const std::vector<SensorEvent> events = EventsOf(world);
        // One sample beside the true times; a cast ends 2e-5 m early, at speeds of some meters a step.
        constexpr double kNear = 2.0 / kSamples;
        if (expected.last - expected.first < kNear) continue;  // hardly touched, or not at all
        ASSERT_FALSE(events.empty()) << "case " << i;
        EXPECT_EQ(events[0].kind, kBegin);
        EXPECT_NEAR(events[0].time, expected.first, kNear) << "case " << i;
        const bool isInside = expected.last == 1;
        ASSERT_EQ(events.size(), isInside ? 1u : 2u) << "case " << i;
        if (!isInside) {
            EXPECT_NEAR(events[1].time, expected.last, kNear) << "case " << i;
        }
        ++passed;
    }
    EXPECT_GT(passed, 60);
}

}  // namespace
}  // namespace fulcrum::testing
