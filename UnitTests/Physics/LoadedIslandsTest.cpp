// Islands under load, which are solved directly with their contacts: forces and motion in closed form.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <numbers>

namespace fulcrum::testing {
namespace {

bool IsSolvedDirectly(TestWorld& world) { return world.Report().mostEffort[0].isDirect; }

// A column of ten cubes under a hundred times their mass: each interface carries what is above it, and the column is as
// high as its cubes, with few substeps and with many.
TEST(LoadedIslands, EachInterfaceOfAColumnCarriesWhatIsAboveIt) {
    for (const int substeps : {1, 4, 16}) {
        SystemSettings settings = NoSleep();
        settings.solver.substeps = substeps;
        TestWorld world(settings);
        BodyId below = world.AddFloor();
        std::vector<BodyId> bodies{below};
        for (int i = 0; i < 10; ++i)
            bodies.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}, .mass = 100}));
        bodies.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 10.5, 0}, .mass = 1e5f}));
        world.Run(3);
        ASSERT_TRUE(IsSolvedDirectly(world));
        for (int i = 0; i + 1 < static_cast<int>(bodies.size()); ++i) {
            const double above = (1e5 + 100 * (10 - i)) * kGravity;
            const double force = world.ForceBetween(bodies[static_cast<size_t>(i)], bodies[static_cast<size_t>(i) + 1]);
            EXPECT_NEAR(force / above, 1, 1e-4) << substeps << " interface " << i;
        }
        EXPECT_NEAR(world.PositionOf(bodies.back()).y(), 10.5, 1e-5) << substeps;
    }
}

// What rests takes one substep a step, however many it is set to, and does not move, not within a minute either. What
// hits it is solved with all of them.
TEST(LoadedIslands, WhatRestsDoesNotMove) {
    SystemSettings settings = NoSleep();
    TestWorld world(settings);
    world.AddFloor();
    std::vector<BodyId> column;
    for (int i = 0; i < 20; ++i) column.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}}));
    world.Run(2);
    ASSERT_TRUE(IsSolvedDirectly(world));
    const Position before = world.PositionOf(column.back());
    for (int second = 0; second < 60; ++second) {
        world.Run(1);
        for (const BodyId id : column) EXPECT_LT(Length(world.Bodies().GetLinearVelocity(id)), 1e-7f) << second;
    }
    EXPECT_NEAR(world.PositionOf(column.back()).y(), before.y(), 1e-6);
    EXPECT_NEAR(world.PositionOf(column.back()).x(), before.x(), 1e-6);
    // The inelastic hit of a ball at 10 m/s leaves the top cube its part of the momentum, less what friction of 0.5
    // takes in two steps.
    const BodyId ball = world.Add({.shape = SphereOf(0.25f), .position = {-0.8, 19.5, 0}, .mass = 100});
    ASSERT_TRUE(world.Bodies().SetVelocity(ball, {10, 0, 0}, {0, 0, 0}));
    world.Steps(2);
    const double hit = 10 * 100.0 / 1100;
    EXPECT_LT(world.Bodies().GetLinearVelocity(column.back()).x(), hit);
    EXPECT_GT(world.Bodies().GetLinearVelocity(column.back()).x(), hit - 0.5 * kGravity / 30);
}

// A structure that begins at rest is loaded in its first step: twenty books neither slide nor sink while impulses build
// up.
TEST(LoadedIslands, AStructureIsLoadedFromTheStart) {
    for (const int substeps : {1, 4, 16}) {
        SystemSettings settings = NoSleep();
        settings.solver.substeps = substeps;
        TestWorld world(settings);
        world.AddFloor();
        std::vector<BodyId> books;
        for (int i = 0; i < 20; ++i)
            books.push_back(world.Add({.shape = BoxOf(0.1f, 0.015f, 0.15f),
                                       .position = {0.003 * (i * 7 % 5 - 2), 0.015 + 0.03 * i, 0.002 * (i % 3)},
                                       .mass = 0.8f}));
        std::vector<Position> before;
        for (const BodyId id : books) before.push_back(world.PositionOf(id));
        world.Step();
        EXPECT_TRUE(IsSolvedDirectly(world)) << substeps;
        for (int step = 0; step < 60; ++step) {
            world.Step();
            for (size_t i = 0; i < books.size(); ++i)
                for (int k = 0; k < 3; ++k)
                    EXPECT_NEAR(world.PositionOf(books[i])[k], before[i][k], 1e-5) << substeps << " book " << i;
        }
    }
}

// A light plank on two piers, with a load of 200 times its mass at a quarter of the span: the piers carry 3/4 and 1/4
// of the load, and a half of the plank each.
TEST(LoadedIslands, ABeamSharesItsLoadByTheLever) {
    TestWorld world(NoSleep());
    world.AddFloor();
    const auto pier = [&](double x) {
        return world.Add({.shape = BoxOf(0.1f, 0.5f, 0.5f), .position = {x, 0.5, 0}, .mass = 50});
    };
    const BodyId left = pier(-2), right = pier(2);
    const BodyId plank = world.Add({.shape = BoxOf(2.1f, 0.1f, 0.5f), .position = {0, 1.1, 0}, .mass = 20});
    world.Add({.shape = BoxOf(0.2f, 0.2f, 0.2f), .position = {-1, 1.4, 0}, .mass = 4000});
    world.Run(3);
    ASSERT_TRUE(IsSolvedDirectly(world));
    const double onLeft = world.ForceBetween(left, plank), onRight = world.ForceBetween(right, plank);
    EXPECT_NEAR((onLeft + onRight) / (4020 * kGravity), 1, 1e-4);
    // The piers' tops are 20 cm wide: the reaction's place is uncertain by 10 cm of 4 m.
    EXPECT_NEAR(onLeft / (3010 * kGravity), 1, 0.03);
    EXPECT_NEAR(world.PositionOf(plank).y(), 1.1, 1e-4);
}

// Light cubes under heavy ones on slopes: what friction holds does not creep, what it does not hold slides as Coulomb's
// law says.
TEST(LoadedIslands, FrictionHoldsOnASlopeOrSlidesByCoulombsLaw) {
    for (const float friction : {0.6f, 0.3f}) {
        const double angle = std::numbers::pi / 8;
        TestWorld world(NoSleep());
        const Quaternion tilt = RotationAbout(Vector3(0, 0, 1), angle);
        const Material material{.friction = friction};
        world.Add({.shape = BoxOf(60, 1, 5), .motion = MotionType::Static, .rotation = tilt, .material = material});
        const Vector3 up = Rotate(tilt, Vector3(0, 1, 0)), along = Rotate(tilt, Vector3(-1, 0, 0));
        const auto add = [&](float height, float mass) {
            return world.Add({.shape = BoxOf(0.5f, 0.1f, 0.5f),
                              .position = Vector3(up * height - along * 30.0f).cast<double>(),
                              .rotation = tilt,
                              .mass = mass,
                              .material = material});
        };
        const BodyId light = add(1.1f, 10), heavy = add(1.3f, 1000);
        world.Run(0.5);
        ASSERT_TRUE(IsSolvedDirectly(world)) << friction;
        const auto placeOf = [&](BodyId id) { return Dot<double>(world.PositionOf(id), along.cast<double>()); };
        const auto speedOf = [&](BodyId id) {
            return Dot<double>(world.VelocityOf(id).cast<double>(), along.cast<double>());
        };
        const double place = placeOf(light), speed = speedOf(light);
        world.Run(2);
        const double acceleration = std::max(kGravity * (std::sin(angle) - double{friction} * std::cos(angle)), 0.0);
        EXPECT_NEAR(speedOf(light), speed + 2 * acceleration, 0.005 * (speed + 2 * acceleration) + 1e-5) << friction;
        EXPECT_NEAR(placeOf(heavy) - placeOf(light), 0, 1e-3) << friction;
        if (acceleration == 0) {
            EXPECT_NEAR(placeOf(light), place, 1e-5);
        }
    }
}

// A loaded plate on a belt gets the belt's speed, with friction's acceleration until then.
TEST(LoadedIslands, ABeltCarriesALoad) {
    struct Belt final : ContactListener {
        BodyId belt;
        float speed = 2;
        void ModifyContact(const ContactView& contact, ContactChange& change) const override {
            if (contact.bodyB == belt) change.MoveSurface(contact, belt, {speed, 0, 0});
        }
    } belt;
    const Material material{.friction = 0.5f};
    TestWorld world(NoSleep());
    belt.belt = world.AddFloor(material);
    const BodyId light =
        world.Add({.shape = BoxOf(0.5f, 0.1f, 0.5f), .position = {0, 0.1, 0}, .mass = 10, .material = material});
    world.Add({.shape = BoxOf(0.5f, 0.1f, 0.5f), .position = {0, 0.3, 0}, .mass = 1000, .material = material});
    world.Steps(30);
    world.System().SetContactListener(&belt);
    world.Run(0.2);
    ASSERT_TRUE(IsSolvedDirectly(world));
    EXPECT_NEAR(world.VelocityOf(light).x(), 0.5 * kGravity * 0.2, 0.01);
    world.Run(1);
    EXPECT_NEAR(world.VelocityOf(light).x(), 2, 1e-4);
}

// A load that slides at 3 m/s along a plank, faster than after a fall of 0.13 s, is iterated until it is calm, though
// no contact begins or ends then; a world restored meanwhile does the same. It stops after v^2 / (2 mu g), within
// a hundredth, which is lost while the plank yields at first.
TEST(LoadedIslands, ALoadThatSlidesIsSolvedDirectlyOnceItIsCalm) {
    TestWorld world(NoSleep());
    world.AddFloor();
    for (const double x : {-1.5, 1.5}) world.Add({.shape = CubeOf(0.25f), .position = {x, 0.25, 0}, .mass = 100});
    const BodyId plank = world.Add({.shape = BoxOf(2, 0.1f, 0.25f), .position = {0, 0.6, 0}, .mass = 100});
    const float v = 3, friction = 0.2f;
    const BodyId load = world.Add({.shape = CubeOf(0.2f),
                                   .position = {-1, 0.9, 0},
                                   .linearVelocity = {v, 0, 0},
                                   .mass = 20'000,
                                   .material = {.friction = friction, .frictionRule = CombineRule::Minimum}});
    std::vector<std::byte> bytes;
    std::vector<uint64_t> hashes;
    for (int step = 0; step < 120; ++step) {
        world.Step();
        const double speed = double{Length(world.VelocityOf(load))};
        if (step > 20 && std::abs(speed - 1.25) > 0.05) {
            EXPECT_EQ(IsSolvedDirectly(world), speed < 1.25) << step;
        }
        if (step == 30) {
            ASSERT_TRUE(world.System().SaveSnapshot(bytes));
        }
        hashes.push_back(world.System().HashState());
    }
    const double way = double{v * v} / (2 * double{friction} * kGravity);
    EXPECT_NEAR(world.PositionOf(load).x(), -1 + way, 0.01 * way);
    EXPECT_NEAR(world.PositionOf(plank).y(), 0.6, 1e-4);
    ASSERT_TRUE(world.System().RestoreSnapshot(bytes));
    for (int step = 31; step < 120; ++step) {
        world.Step();
        ASSERT_EQ(world.System().HashState(), hashes[static_cast<size_t>(step)]) << step;
    }
}

// The same bits after a snapshot as without, and for one thread and two.
TEST(LoadedIslands, ASnapshotGoesOnWithTheSameBits) {
    const auto add = [](TestWorld& world) {
        world.AddFloor();
        for (int i = 0; i < 6; ++i)
            world.Add({.shape = CubeOf(0.5f), .position = {0.02 * (i % 2), 0.5 + i, 0.01 * (i % 3)}, .mass = 100});
        world.Add({.shape = CubeOf(0.5f), .position = {0.1, 6.5, 0}, .mass = 5e4f});
    };
    TestWorld world(NoSleep()), two(NoSleep(), 2);
    add(world);
    add(two);
    world.Steps(100);
    two.Steps(100);
    ASSERT_TRUE(IsSolvedDirectly(world));
    std::vector<std::byte> bytes;
    ASSERT_TRUE(world.System().SaveSnapshot(bytes));
    std::vector<uint64_t> hashes;
    for (int step = 0; step < 60; ++step) {
        world.Step();
        two.Step();
        hashes.push_back(world.System().HashState());
        ASSERT_EQ(two.System().HashState(), hashes.back()) << step;
    }
    ASSERT_TRUE(world.System().RestoreSnapshot(bytes));
    for (int step = 0; step < 60; ++step) {
        world.Step();
        ASSERT_EQ(world.System().HashState(), hashes[static_cast<size_t>(step)]) << step;
    }
    EXPECT_TRUE(IsSolvedDirectly(world));
}

}  // namespace
}  // namespace fulcrum::testing
