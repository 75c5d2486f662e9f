// Which bodies sensors see; changes between steps; sleeping bodies; costs.
#include <Fulcrum/UnitTests/Physics/SensorTest.h>

#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

using enum SensorSees;

TEST(SensorSees, TheKindsOfMotionThatItIsTold) {
    const std::pair<SensorSees, std::vector<size_t>> cases[] = {
        {Nothing, {}},
        {Dynamic, {0}},
        {Dynamic | Sleeping, {0, 1}},
        {Kinematic, {2}},
        {Static, {3}},
        {Sensors, {}},
        {SensorSees::Default, {0, 1, 2}},
        {Kinematic | Sensors, {2, 4}},
        {SensorSees::All, {0, 1, 2, 3, 4}},
    };
    for (const auto& [sees, expected] : cases) {
        TestWorld world(NoGravity());
        const std::vector<BodyId> bodies = {
            world.Add({.shape = CubeOf(0.1f), .position = {-1, 0, 0}}),
            world.Add({.shape = CubeOf(0.1f), .position = {-0.5, 0, 0}, .startAsleep = true}),
            world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Kinematic, .position = {0, 0, 0}}),
            world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Static, .position = {0.5, 0, 0}}),
            world.Add(SensorOf(CubeOf(0.1f), {1, 0, 0}, MotionType::Kinematic)),
        };
        BodySettings settings = SensorOf(CubeOf(1.5f));
        settings.sensorSees = sees;
        const BodyId sensor = world.Add(settings);
        for (int step = 0; step < 3; ++step) {
            world.Step();
            std::vector<BodyId> inside;
            for (size_t i : expected) inside.push_back(bodies[i]);
            EXPECT_EQ(InsideOf(world, sensor), inside) << static_cast<int>(sees);
            const std::vector<SensorEvent> events = EventsOf(world);
            ASSERT_EQ(events.size(), expected.size());
            for (const SensorEvent& e : events) EXPECT_EQ(e.kind, step == 0 ? kBegin : kStay);
        }
    }
}

TEST(SensorSees, OnlyLayersThatCollideWithItsOwn) {
    SystemSettings settings = NoGravity();
    settings.layerCollides[1] &= ~(1u << 2);
    settings.layerCollides[2] &= ~(1u << 1);
    TestWorld world(settings);
    BodySettings sensor = SensorOf(CubeOf(1));
    sensor.layer = 1;
    const BodyId id = world.Add(sensor);
    const BodyId seen = world.Add({.shape = CubeOf(0.1f), .position = {0.5, 0, 0}, .layer = 1});
    const BodyId unseen = world.Add({.shape = CubeOf(0.1f), .position = {-0.5, 0, 0}, .layer = 2});
    world.Step();
    EXPECT_EQ(InsideOf(world, id), std::vector<BodyId>{seen});
    // The layers change: one comes, one goes.
    settings.layerCollides = SystemSettings::AllLayers();
    settings.layerCollides[1] &= ~(1u << 1);
    ASSERT_TRUE(world.System().SetSettings(settings));
    world.Step();
    ExpectKinds(world, {kEnd, kBegin});
    EXPECT_EQ(InsideOf(world, id), std::vector<BodyId>{unseen});
}

TEST(SensorSees, WhatItIsToldLater) {
    TestWorld world(NoGravity());
    const BodyId sensor = world.Add(SensorOf(CubeOf(1)));
    const BodyId wall = world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Static, .position = {0.5, 0, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.1f), .position = {-0.5, 0, 0}});
    world.Step();
    EXPECT_EQ(InsideOf(world, sensor), std::vector<BodyId>{box});
    ASSERT_TRUE(world.Bodies().SetSensorSees(sensor, Static));
    world.Step();
    EXPECT_EQ(InsideOf(world, sensor), std::vector<BodyId>{wall});
    ExpectKinds(world, {kBegin, kEnd});  // both at the beginning, the wall's index is lower
    ASSERT_TRUE(world.Bodies().SetSensorReportsStay(sensor, false));
    world.Step();
    ExpectKinds(world, {});
    EXPECT_EQ(InsideOf(world, sensor), std::vector<BodyId>{wall});
}

TEST(SensorSees, OnlyWhatItsFiltersLetItMeet) {
    TestWorld world(NoGravity());
    BodySettings settings = SensorOf(CubeOf(1));
    settings.mask = ~uint64_t(2);
    const BodyId sensor = world.Add(settings);
    BodySettings box{.shape = CubeOf(0.1f), .startAsleep = true};
    box.category = 2;
    const BodyId id = world.Add(box);
    world.Step();
    EXPECT_TRUE(InsideOf(world, sensor).empty());
    ASSERT_TRUE(world.Bodies().SetCategoryAndMask(id, 1, ~uint64_t(0)));
    world.Step();
    ExpectKinds(world, {kBegin});
    ASSERT_TRUE(world.Bodies().SetCategoryAndMask(sensor, 1, 0));
    world.Step();
    ExpectKinds(world, {kEnd});
}

TEST(SensorSees, NotTheBodyThatAJointKeepsFromTouchingIt) {
    TestWorld world(NoGravity());
    const BodyId carrier = world.Add({.shape = CubeOf(0.5f)});
    const BodyId other = world.Add({.shape = CubeOf(0.1f), .position = {0.9, 0, 0}});
    const BodyId sensor = world.Add(SensorOf(CubeOf(1), {0, 0, 0}, MotionType::Dynamic));
    FixedJointSettings joint;
    joint.bodyA = carrier;
    joint.bodyB = sensor;
    ASSERT_TRUE(world.System().Joints().Create(joint));
    world.Step();
    EXPECT_EQ(InsideOf(world, sensor), std::vector<BodyId>{other});
}

TEST(Sensor, EndsForBodiesThatFallAsleepIfItDoesNotSeeSleepers) {
    for (const bool seesSleepers : {false, true}) {
        TestWorld world;
        world.AddFloor();
        BodySettings settings = SensorOf(CubeOf(1));
        settings.sensorSees = seesSleepers ? Dynamic | Sleeping : Dynamic;
        const BodyId sensor = world.Add(settings);
        const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
        world.Run(2);
        ASSERT_FALSE(world.Bodies().IsAwake(box));
        EXPECT_EQ(InsideOf(world, sensor).size(), seesSleepers ? 1u : 0u);
        ASSERT_TRUE(world.Bodies().Wake(box));
        world.Step();
        ExpectKinds(world, {seesSleepers ? kStay : kBegin});
    }
}

TEST(Sensor, CostsNothingForWhatSleepsInIt) {
    TestWorld world;
    world.AddFloor();
    for (int i = 0; i < 50; ++i)
        world.Add({.shape = CubeOf(0.4f), .position = {i % 10 * 1.0, 0.4, i / 10 * 1.0}, .startAsleep = true});
    const BodyId sensor = world.Add(SensorOf(BoxOf(20, 2, 20)));
    world.Step();
    EXPECT_EQ(world.Report().sensorTests, 50u);
    world.Step();
    EXPECT_EQ(world.Report().sensorTests, 0u);
    EXPECT_EQ(world.Report().sensorEvents, 50u);
    EXPECT_EQ(InsideOf(world, sensor).size(), 50u);
    // One that wakes is looked at, the others not.
    world.Add({.shape = CubeOf(0.2f), .position = {30, 5, 0}});
    ASSERT_TRUE(world.Bodies().AddImpulse(InsideOf(world, sensor)[7], {0, 100, 0}));
    world.Step();
    EXPECT_EQ(world.Report().sensorTests, 1u);
}

TEST(Sensor, ThatMovesOverSleepersReportsThemAndLetsThemSleep) {
    TestWorld world(NoGravity());
    std::vector<BodyId> sleepers;
    for (int i = 0; i < 10; ++i)
        sleepers.push_back(world.Add({.shape = CubeOf(0.25f), .position = {2.0 * i, 0, 0}, .startAsleep = true}));
    BodySettings settings = SensorOf(CubeOf(0.5f), {-2, 0, 0}, MotionType::Kinematic);
    settings.linearVelocity = {6, 0, 0};
    settings.sensorReportsStay = false;
    const BodyId sensor = world.Add(settings);
    std::vector<SensorEvent> events;
    for (int step = 0; step < 240; ++step) {
        world.Step();
        for (const SensorEvent& e : world.System().SensorEvents()) {
            // The faces meet where the middles are 0.75 m apart. Both are sums of up to 240 rounded steps.
            const double time = (step + double{e.time}) * kStep, x = -2 + 6 * time;
            EXPECT_NEAR(x - world.PositionOf(e.body).x(), e.kind == kBegin ? -0.75 : 0.75, 1e-4);
            events.push_back(e);
        }
    }
    ASSERT_EQ(events.size(), 20u);
    for (size_t i = 0; i < 10; ++i) {
        EXPECT_EQ(events[2 * i].body, sleepers[i]);
        EXPECT_EQ(events[2 * i + 1].kind, kEnd);
        EXPECT_FALSE(world.Bodies().IsAwake(sleepers[i]));
    }
    EXPECT_TRUE(InsideOf(world, sensor).empty());
}

TEST(Sensor, ReportsTheEndOfWhatIsRemovedOrTeleported) {
    TestWorld world(NoGravity());
    const BodyId sensor = world.Add(SensorOf(CubeOf(1)));
    std::vector<BodyId> boxes;
    for (int i = 0; i < 4; ++i)
        boxes.push_back(
            world.Add({.shape = CubeOf(0.1f), .position = {0.4 * i - 0.6, 0, 0}, .startAsleep = i % 2 == 0}));
    world.Step();
    ExpectKinds(world, {kBegin, kBegin, kBegin, kBegin});
    ASSERT_TRUE(world.Bodies().Remove(boxes[0]));
    ASSERT_TRUE(world.Bodies().Remove(boxes[1]));
    ASSERT_TRUE(world.Bodies().SetPose(boxes[2], {50, 0, 0}, {}));
    ASSERT_TRUE(world.Bodies().SetPose(boxes[3], {0, 0.5, 0.5}, {}));  // within
    world.Step();
    ExpectKinds(world, {kEnd, kEnd, kEnd, kStay});
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(EventsOf(world)[i].body, boxes[i]);
        EXPECT_EQ(EventsOf(world)[i].time, 0);
    }
    // Another body gets an old index, and is another body.
    const BodyId heir = world.Add({.shape = CubeOf(0.1f), .position = {0.5, 0, 0}});
    EXPECT_TRUE(heir.index == boxes[0].index || heir.index == boxes[1].index);
    ASSERT_TRUE(world.Bodies().SetPose(boxes[2], {0, -0.5, 0}, {}));
    world.Step();
    ExpectKinds(world, {kBegin, kBegin, kStay});
    // The sensor goes, and all that is in it leaves.
    ASSERT_TRUE(world.Bodies().Remove(sensor));
    EXPECT_TRUE(InsideOf(world, sensor).empty());
    world.Step();
    ExpectKinds(world, {kEnd, kEnd, kEnd});
    EXPECT_EQ(EventsOf(world)[0].sensor, sensor);
    world.Step();
    ExpectKinds(world, {});
}

TEST(Sensor, TeleportedElsewhereSeesWhatIsThere) {
    TestWorld world(NoGravity());
    BodySettings settings = SensorOf(CubeOf(0.5f));
    settings.sensorSees = SensorSees::All;
    const BodyId sensor = world.Add(settings);
    const BodyId here = world.Add({.shape = CubeOf(0.2f), .motion = MotionType::Static});
    const BodyId there = world.Add({.shape = CubeOf(0.2f), .position = {10, 0, 0}, .startAsleep = true});
    world.Step();
    EXPECT_EQ(InsideOf(world, sensor), std::vector<BodyId>{here});
    ASSERT_TRUE(world.Bodies().SetPose(sensor, {10, 0, 0}, {}));
    world.Step();
    EXPECT_EQ(InsideOf(world, sensor), std::vector<BodyId>{there});
    EXPECT_FALSE(world.Bodies().IsAwake(there));
    ASSERT_TRUE(world.Bodies().SetPose(here, {10, 0.3, 0}, {}));  // a static body is brought to it
    world.Step();
    EXPECT_EQ(InsideOf(world, sensor), (std::vector<BodyId>{here, there}));
}

TEST(Sensor, ABodyMayBecomeOneAndCeaseToBe) {
    TestWorld world;
    world.AddFloor();
    const BodyId table = world.Add({.shape = BoxOf(1, 0.5f, 1), .motion = MotionType::Static, .position = {0, 2, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.25f), .position = {0, 2.75, 0}});
    world.Run(2);
    EXPECT_FALSE(world.Bodies().IsAwake(box));
    EXPECT_FALSE(world.Bodies().IsSensor(table));
    ASSERT_TRUE(world.Bodies().SetSensor(table, true));
    EXPECT_TRUE(world.Bodies().IsSensor(table));
    world.Run(0.2);  // the box falls into it, by 0.2 m
    EXPECT_NEAR(world.PositionOf(box).y(), 2.75 - 0.5 * kGravity * 0.04, 0.01);
    EXPECT_EQ(InsideOf(world, table), std::vector<BodyId>{box});
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(box).y(), 0.25, 0.005);
    EXPECT_TRUE(InsideOf(world, table).empty());
    ASSERT_TRUE(world.Bodies().SetSensor(table, false));
    ASSERT_TRUE(world.Bodies().SetPose(box, {0, 3, 0}, {}));
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(box).y(), 2.75, 0.005);
    ExpectKinds(world, {});
}

TEST(Sensor, SeesChildrenThatComeAndGo) {
    TestWorld world(NoGravity());
    const CompoundShape::ChildSettings here{SphereOf(0.2f), {0, 0, 0}}, there{SphereOf(0.2f), {5, 0, 0}};
    const CompoundShape::ChildSettings both[] = {here, there};
    BodySettings settings = SensorOf(CubeOf(0.5f), {5, 0, 0});
    settings.sensorSees = SensorSees::All;
    world.Add(settings);
    const BodyId wall = world.Add({.shape = MutableCompound::Create(both).Value(), .motion = MotionType::Static});
    world.Step();
    ExpectKinds(world, {kBegin});
    ASSERT_TRUE(world.Bodies().RemoveChild(wall, world.Bodies().GetChildren(wall)->IdOf(1)));
    world.Step();
    ExpectKinds(world, {kEnd});
    ASSERT_TRUE(world.Bodies().AddChild(wall, there));
    world.Step();
    ExpectKinds(world, {kBegin});
}

TEST(Sensor, ErrorsSayWhatIsWrong) {
    TestWorld world;
    BodySettings settings = SensorOf(CubeOf(1), {0, 0, 0}, MotionType::Dynamic);
    settings.continuous = ContinuousCollision::Linear;
    EXPECT_EQ(world.Bodies().Create(settings).GetError().code, ErrorCode::Unsupported);
    settings.continuous = ContinuousCollision::Off;
    settings.sensorSees = static_cast<SensorSees>(32);
    EXPECT_EQ(world.Bodies().Create(settings).GetError().code, ErrorCode::OutOfRange);
    const BodyId box = world.Add({.shape = CubeOf(1), .continuous = ContinuousCollision::Linear}),
                 sensor = world.Add(SensorOf(CubeOf(1)));
    EXPECT_EQ(world.Bodies().SetSensor(box, true).GetError().code, ErrorCode::Unsupported);
    EXPECT_EQ(world.Bodies().SetSensorSees(box, Dynamic).GetError().code, ErrorCode::Unsupported);
    EXPECT_EQ(world.Bodies().SetContinuous(sensor, ContinuousCollision::Linear).GetError().code,
              ErrorCode::Unsupported);
    EXPECT_EQ(world.Bodies().SetSensorSees({7, 7}, Dynamic).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(world.Bodies().SetSensorSees(sensor, static_cast<SensorSees>(64)).GetError().code, ErrorCode::OutOfRange);
    EXPECT_TRUE(world.System().BodiesInside(box).empty());
}

TEST(Sensor, IsSeenByQueriesThatAskForIt) {
    TestWorld world(NoGravity());
    BodySettings settings = SensorOf(CubeOf(0.5f), {5, 0, 0}, MotionType::Kinematic);
    settings.linearVelocity = {600, 0, 0};
    const BodyId sensor = world.Add(settings);
    const BodyId wall = world.Add({.shape = BoxOf(0.5f, 5, 5), .motion = MotionType::Static, .position = {50, 0, 0}});
    world.Step();  // to x = 15
    const Ray ray{{0, 0, 0}, {100, 0, 0}};
    WorldRayHit hit;
    ASSERT_TRUE(world.System().Queries().CastRay(ray, hit));
    EXPECT_EQ(hit.body, wall);
    ASSERT_TRUE(world.System().Queries().CastRay(ray, hit, {}, {.sensors = true}));
    EXPECT_EQ(hit.body, sensor);
    EXPECT_NEAR(hit.fraction, 0.145, 1e-6);
}

// Bodies fall, bounce and roll through sensors of many kinds.
struct Playground {
    explicit Playground(uint32_t threads) : world({}, threads) {
        RandomPoses random(7);
        world.AddFloor({.friction = 0.5f, .restitution = 0.5f});
        for (int i = 0; i < 12; ++i) {
            const Vector3 at = random.InCube() * 4.0f;
            BodySettings settings = SensorOf(i % 3 ? CubeOf(1) : SphereOf(1.2f), {at.x(), 2 + 0.5 * at.y(), at.z()},
                                             i % 4 ? MotionType::Static : MotionType::Kinematic);
            settings.rotation = random.Rotation();
            settings.sensorSees = i % 2 ? SensorSees::All : SensorSees::Default;
            sensors.push_back(world.Add(settings));
            if (i % 4) continue;
            EXPECT_TRUE(world.Bodies().SetVelocity(sensors.back(), {0.5f, 0, 0.25f}, random.InCube() * 3.0f));
        }
        const ShapePtr ball = SphereOf(0.15f);
        const ShapePtr shapes[] = {CubeOf(0.2f), ball, CapsuleOf(0.2f, 0.1f),
                                   CompoundOf({{ball, {-0.2f, 0, 0}}, {ball, {0.2f, 0, 0}}})};
        for (int i = 0; i < 80; ++i) {
            const Vector3 at = random.InCube() * 4.0f;
            BodySettings settings{.shape = shapes[i % 4], .position = {at.x(), 4 + at.y(), at.z()}};
            settings.linearVelocity = random.InCube() * (i % 8 ? 5.0f : 300.0f);
            settings.angularVelocity = random.InCube() * 10.0f;
            if (i % 16 == 0) settings.continuous = ContinuousCollision::LinearAndAngular;
            world.Add(settings);
        }
    }
    TestWorld world;
    std::vector<BodyId> sensors;
};

TEST(Sensor, ReportsTheSameWithAnyNumberOfThreads) {
    const auto run = [](uint32_t threads) {
        Playground play(threads);
        std::vector<SensorEvent> all;
        for (int step = 0; step < 90; ++step) {
            play.world.Step();
            const std::span<const SensorEvent> events = play.world.System().SensorEvents();
            all.insert(all.end(), events.begin(), events.end());
        }
        return all;
    };
    const std::vector<SensorEvent> one = run(1);
    EXPECT_GT(one.size(), 1000u);
    for (uint32_t threads : {2u, 3u, 4u}) EXPECT_EQ(run(threads), one) << threads << " threads";
}

TEST(Sensor, ContentsMatchOverlapsAndEvents) {
    Playground play(1);
    std::vector<std::vector<BodyId>> tracked(play.sensors.size());
    for (int step = 0; step < 180; ++step) {
        play.world.Step();
        for (const SensorEvent& e : play.world.System().SensorEvents()) {
            const auto at = std::find(play.sensors.begin(), play.sensors.end(), e.sensor);
            std::vector<BodyId>& list = tracked[static_cast<size_t>(at - play.sensors.begin())];
            const auto found = std::find(list.begin(), list.end(), e.body);
            ASSERT_EQ(found != list.end(), e.kind != kBegin) << e << " in step " << step;
            if (e.kind == kBegin) list.push_back(e.body);
            if (e.kind == kEnd) list.erase(found);
        }
        for (size_t i = 0; i < play.sensors.size(); ++i) {
            const BodyId sensor = play.sensors[i];
            std::sort(tracked[i].begin(), tracked[i].end());
            EXPECT_EQ(tracked[i], InsideOf(play.world, sensor));
            const ShapePtr shape = play.world.Bodies().GetShape(sensor);
            const auto wanted = [&](BodyId id) {
                if (id == sensor) return false;
                return i % 2 || (play.world.Bodies().GetMotionType(id) != MotionType::Static &&
                                 !play.world.Bodies().IsSensor(id));
            };
            std::vector<OverlapHit> hits;
            play.world.System().Queries().FindOverlaps({shape.get(), play.world.Bodies().GetPose(sensor)}, hits,
                                                       {.sensors = true, .accepts = wanted});
            std::vector<BodyId> overlapping;
            for (const OverlapHit& hit : hits)
                if (overlapping.empty() || overlapping.back() != hit.body) overlapping.push_back(hit.body);
            ASSERT_EQ(tracked[i], overlapping) << "sensor " << i << " in step " << step;
        }
    }
}

TEST(Sensor, AllocatesNothingInASettledWorld) {
    for (uint32_t threads : {1u, 2u}) {
        TestWorld world(NoSleep(), threads);
        world.AddFloor();
        for (int i = 0; i < 64; ++i) world.Add({.shape = CubeOf(0.4f), .position = {i % 8 * 1.0, 0.4, i / 8 * 1.0}});
        for (int i = 0; i < 8; ++i) world.Add(SensorOf(CubeOf(1.5f), {i * 1.0, 1, i * 1.0}));
        BodySettings blade = SensorOf(BoxOf(0.1f, 1, 10), {3, 0.5, 3}, MotionType::Kinematic);
        blade.angularVelocity = {0, 2, 0};
        world.Add(blade);
        world.Steps(400);
        const uint64_t before = AllocationCount();
        for (int i = 0; i < 200; ++i) EXPECT_TRUE(world.System().Update(kStep));
        EXPECT_EQ(AllocationCount() - before, 0u) << threads << " threads";
        EXPECT_GT(world.Report().sensorEvents, 0u);
    }
}

}  // namespace
}  // namespace fulcrum::testing
