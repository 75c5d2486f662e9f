// Continuous collision moves a body back to where it hit. Its velocities must be those of that time, and hits must take
// the rotation into account: otherwise every hit adds energy.
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/Drops.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

constexpr ContinuousCollision kKinds[] = {ContinuousCollision::Off, ContinuousCollision::Linear,
                                          ContinuousCollision::LinearAndAngular};
constexpr int kDrops = kIsSanitized ? 4 : 24;

struct Case {
    ShapePtr shape;
    double least;  // m, of the center above the ground
};

std::vector<Case> Cases() {
    return {
        {BoxOf(0.05f, 4, 0.05f), 0.05},
        {BoxOf(0.02f, 1, 0.02f), 0.02},
        {BoxOf(0.02f, 0.2f, 0.04f), 0.02},
        {BoxOf(0.1f, 0.2f, 0.3f), 0.1},
        {HullOf({{0.4f, -0.2f, 0}, {-0.3f, -0.2f, 0.3f}, {-0.3f, -0.2f, -0.3f}, {0, 0.4f, 0}}), 0},
        {HullOf({{0.5f, 0, 0}, {-0.5f, 0, 0.1f}, {0, 0, 0.6f}, {0, 0.04f, -0.5f}, {0.1f, -0.05f, 0}}), 0},
    };
}

double EnergyOf(TestWorld& world, BodyId id, double least) {
    const BodyInterface& bodies = world.Bodies();
    return bodies.GetKineticEnergy(id) +
           double{bodies.GetMass(id)} * kGravity * (bodies.GetCenterOfMass(id).y() - least);
}

BodySettings Thrown(RandomPoses& random, const ShapePtr& shape, const Position& at, ContinuousCollision kind) {
    const Quaternion rotation = random.Rotation();
    const Vector3 velocity = random.InBox(5), axis = random.InCube();
    const float spin = random.Chance(0.5f) ? random.Between(0, 20) : 0.0f;
    return {.shape = shape,
            .position = at,
            .rotation = rotation,
            .linearVelocity = velocity,
            .angularVelocity = axis * spin,
            .layer = 1,
            .continuous = kind};
}

// The largest part of its first energy that a body ever has of all that are dropped onto the ground, each by itself.
double MostEnergy(const ShapePtr& ground, const Case& dropped, ContinuousCollision kind) {
    SystemSettings settings;
    settings.layerCollides[1] &= ~2u;
    TestWorld world(settings);
    world.Add({.shape = ground, .motion = MotionType::Static});
    RandomPoses random(11);
    std::vector<BodyId> bodies;
    std::vector<double> first;
    for (int i = 0; i < kDrops; ++i) {
        const float height = random.Between(1.5f, 6);
        const Position at(4.0 * (i % 5) - 8, double{dropped.shape->OuterRadius() + height}, 4.0 * (i / 5) - 8);
        bodies.push_back(world.Add(Thrown(random, dropped.shape, at, kind)));
        first.push_back(EnergyOf(world, bodies.back(), dropped.least));
    }
    double most = 0;
    for (int step = 0; step < 180; ++step) {
        world.Step();
        for (size_t i = 0; i < bodies.size(); ++i)
            most = std::max(most, EnergyOf(world, bodies[i], dropped.least) / first[i]);
    }
    return most;
}

TEST(ContinuousEnergy, NothingDroppedGainsAny) {
    const ShapePtr grounds[] = {BoxOf(100, 1, 100), Plane::Create(Vector3(0, 1, 0), 0).Value(), HillyGround(0),
                                HillyGround(0.5f)};
    for (const ShapePtr& ground : grounds)
        for (const Case& dropped : Cases()) {
            // The box has its top at 1 m, so that all there is is above the reference.
            for (const ContinuousCollision kind : kKinds)
                EXPECT_LE(MostEnergy(ground, dropped, kind), 1.01)
                    << ShapeTypeName(ground->Type()) << " " << dropped.shape->OuterRadius() << " " << int(kind);
        }
}

TEST(ContinuousEnergy, NothingDroppedOntoEachOtherGainsAny) {
    constexpr int kPiles = kIsSanitized ? 1 : 4, kBodies = 16;
    for (const ContinuousCollision kind : kKinds)
        for (int pile = 0; pile < kPiles; ++pile) {
            TestWorld world;
            world.AddFloor();
            RandomPoses random(static_cast<uint32_t>(pile));
            const std::vector<Case> cases = Cases();
            std::vector<BodyId> bodies;
            for (int i = 0; i < kBodies; ++i) {
                const Case& dropped = cases[static_cast<size_t>(i) % cases.size()];
                BodySettings settings =
                    Thrown(random, dropped.shape, {0.5 * (i % 3), 4.5 + 2.5 * i, 0.5 * (i % 2)}, kind);
                settings.rotation = i % 6 == 0 ? RotationAbout({0, 0, 1}, 1.4 + 0.02 * i)
                                               : settings.rotation;  // long rods lie, or they would overlap
                settings.linearVelocity = Vector3(0, -10, 0);
                bodies.push_back(world.Add(settings));
            }
            const auto energy = [&] {
                double sum = 0;
                for (const BodyId id : bodies) sum += EnergyOf(world, id, 0);
                return sum;
            };
            const double first = energy();
            double last = first;
            for (int step = 0; step < 300; ++step) {
                world.Step();
                const double now = energy();
                EXPECT_LE(now, 1.01 * first) << int(kind) << " pile " << pile << " step " << step;
                EXPECT_LE(now, last + 0.01 * first) << int(kind) << " pile " << pile << " step " << step;
                last = now;
            }
        }
}

// Thin rods that spin about all their axes, without friction and loss: a hit turns one kind of energy into the other.
// What would spin faster than bodies may loses it.
TEST(ContinuousEnergy, AHitOfASpinningRodKeepsIt) {
    const Material bouncy{.friction = 0, .restitution = 1};
    constexpr float kFastest = 5000;  // rad/s
    for (const ContinuousCollision kind : {ContinuousCollision::Linear, ContinuousCollision::LinearAndAngular}) {
        RandomPoses random(5);
        int hits = 0, kept = 0;
        for (int i = 0; i < 50; ++i) {
            TestWorld world(NoGravity());
            world.Add(
                {.shape = BoxOf(1, 20, 20), .motion = MotionType::Static, .position = {10, 0, 0}, .material = bouncy});
            const BodyId rod = world.Add({.shape = BoxOf(0.03f, 1, 0.04f),
                                          .position = {double{random.Between(7.6f, 7.9f)}, 0, 0},
                                          .rotation = random.Rotation(),
                                          .linearVelocity = {40, 0, 0},
                                          .angularVelocity = random.InBox(12),
                                          .material = bouncy,
                                          .maxAngularSpeed = kFastest,
                                          .continuous = kind});
            const double first = world.Bodies().GetKineticEnergy(rod);
            world.Step();
            hits += static_cast<int>(world.Report().sweptHits);
            const double now = world.Bodies().GetKineticEnergy(rod);
            EXPECT_LE(now, 1.0001 * first) << int(kind) << " " << i;
            if (world.Report().sweptHits != 1 || Length(world.Bodies().GetAngularVelocity(rod)) > 0.99f * kFastest)
                continue;
            EXPECT_GE(now, 0.9999 * first) << int(kind) << " " << i;
            ++kept;
        }
        EXPECT_GT(hits, 15);
        EXPECT_GT(kept, 10);
    }
}

// Where an axis is locked gravity gives no speed along it, and a push along it moves nothing: a normal that was off it
// by 3e-7 had all of the approach taken along the other axes, and threw a body of 1.2 t at 95 m/s off at 1000 m/s.
TEST(ContinuousEnergy, AHitAcrossLockedAxesThrowsNothing) {
    const ShapePtr shapes[] = {
        CubeOf(0.3f), CapsuleOf(0.4f, 0.2f),
        CompoundOf({{BoxOf(0.2f, 0.6f, 0.2f), {0.4f, 0.1f, 0}}, {CubeOf(0.25f), {-0.3f, -0.2f, 0.2f}}})};
    constexpr int kThrows = kIsSanitized ? 1 : 6;
    for (const ContinuousCollision kind : {ContinuousCollision::Linear, ContinuousCollision::LinearAndAngular}) {
        SystemSettings settings;
        settings.layerCollides[1] &= ~2u;
        TestWorld world(settings);
        world.Add({.shape = BoxOf(500, 1, 500), .motion = MotionType::Static, .position = {0, -1, 0}});
        RandomPoses random(7);
        std::vector<BodyId> bodies;
        std::vector<double> first;
        for (int locked = 0; locked < 64; ++locked)
            for (const ShapePtr& shape : shapes)
                for (int i = 0; i < kThrows; ++i) {
                    BodySettings thrown = Thrown(random, shape, Position(0, double{random.Between(0.2f, 2)}, 0), kind);
                    thrown.linearVelocity = Vector3(48, -56, 59) + random.InBox(10);
                    thrown.lockedAxes = static_cast<LockedAxes>(locked);
                    bodies.push_back(world.Add(thrown));
                    first.push_back(EnergyOf(world, bodies.back(), -1));
                }
        double most = 0;
        for (int step = 0; step < 30; ++step) {
            world.Step();
            for (size_t i = 0; i < bodies.size(); ++i) most = std::max(most, EnergyOf(world, bodies[i], -1) / first[i]);
        }
        EXPECT_LE(most, 1.01) << int(kind);
    }
}

// Standing on its end, tilted: it hits the floor with nothing that moves, and falls as one that is not cast does.
TEST(ContinuousEnergy, ARodThatTopplesFallsAsWithoutIt) {
    const auto tiltAfterASecond = [](ContinuousCollision kind) {
        TestWorld world;
        world.AddFloor({.friction = 1});
        const double tilt = 0.3, c = std::cos(tilt), s = std::sin(tilt);
        const BodyId rod = world.Add({.shape = BoxOf(0.05f, 4, 0.05f),
                                      .position = {0, 4 * c + 0.05 * s + 0.001, 0},
                                      .rotation = RotationAbout({0, 0, 1}, tilt),
                                      .material = {.friction = 1},
                                      .continuous = kind});
        world.Steps(75);
        return Rotate(world.Bodies().GetPose(rod).rotation, Vector3(0, 1, 0)).y();
    };
    const float off = tiltAfterASecond(ContinuousCollision::Off);
    EXPECT_LT(off, 0.85f);
    EXPECT_NEAR(tiltAfterASecond(ContinuousCollision::Linear), off, 0.02);
    EXPECT_NEAR(tiltAfterASecond(ContinuousCollision::LinearAndAngular), off, 0.02);
}

// Hit at 0.5 of the step without restitution: both move on at m v / (m + M) for the other half, whatever the box has
// asked for.
TEST(ContinuousEnergy, WhatABulletHitsMovesOnInTheSameStep) {
    for (const ContinuousCollision kind : kKinds)
        for (const bool asleep : {false, true}) {
            TestWorld world(NoGravity());
            const Material dull{.friction = 0, .restitution = 0};
            const BodyId box = world.Add({.shape = CubeOf(0.5f),
                                          .position = {0, 0, 0},
                                          .mass = 30,
                                          .material = dull,
                                          .startAsleep = asleep,
                                          .continuous = kind});
            const BodyId bullet = world.Add({.shape = SphereOf(0.05f),
                                             .position = {-0.55 - 5, 0, 0},
                                             .linearVelocity = {600, 0, 0},
                                             .mass = 1,
                                             .material = dull,
                                             .continuous = ContinuousCollision::Linear});
            world.Step();
            const double v = 600 / 31.0;
            EXPECT_NEAR(world.VelocityOf(box).x(), v, 0.01) << int(kind);
            EXPECT_NEAR(world.PositionOf(box).x(), v * 0.5 * kStep, 2e-3) << int(kind);
            EXPECT_NEAR(world.PositionOf(bullet).x(), -0.55 + v * 0.5 * kStep, 4e-3) << int(kind);
        }
}

// Of a stack that sleeps, too: the one in the middle is gone from between the others, which friction has not moved yet.
TEST(ContinuousEnergy, WhatABulletHitsInAStackMovesOnInTheSameStep) {
    for (const ContinuousCollision kind : kKinds) {
        TestWorld world;
        world.AddFloor();
        const Material dull{.friction = 0.5f, .restitution = 0};
        std::vector<BodyId> stack;
        for (int i = 0; i < 3; ++i)
            stack.push_back(world.Add({.shape = CubeOf(0.5f),
                                       .position = {0, 0.5 + i, 0},
                                       .mass = 30,
                                       .material = dull,
                                       .startAsleep = true,
                                       .continuous = kind}));
        world.Add({.shape = SphereOf(0.05f),
                   .position = {-0.55 - 5, 1.5, 0},
                   .linearVelocity = {600, 0, 0},
                   .mass = 1,
                   .material = dull,
                   .gravityFactor = 0,
                   .continuous = ContinuousCollision::Linear});
        world.Step();
        const double v = 600 / 31.0;
        EXPECT_NEAR(world.VelocityOf(stack[1]).x(), v, 0.02 * v) << int(kind);
        EXPECT_NEAR(world.PositionOf(stack[1]).x(), v * 0.5 * kStep, 0.02 * v * 0.5 * kStep) << int(kind);
        for (const int i : {0, 2})
            EXPECT_NEAR(world.PositionOf(stack[static_cast<size_t>(i)]).x(), 0, 1e-3) << int(kind);
        world.Run(2);
        for (const BodyId id : stack) EXPECT_GT(world.PositionOf(id).y(), 0.4) << int(kind);
    }
}

// But not into what stands behind it.
TEST(ContinuousEnergy, WhatABulletHitsStopsAtItsNeighbor) {
    TestWorld world;
    world.AddFloor();
    std::vector<BodyId> row;
    for (int i = 0; i < 5; ++i)
        row.push_back(world.Add({.shape = CubeOf(0.25f), .position = {0.501 * i, 0.25, 0}, .mass = 10}));
    world.Add({.shape = SphereOf(0.05f),
               .position = {-8, 0.25, 0},
               .linearVelocity = {900, 0, 0},
               .mass = 0.2f,
               .gravityFactor = 0,
               .continuous = ContinuousCollision::Linear});
    for (int step = 0; step < 60; ++step) {
        world.Step();
        EXPECT_LT(world.Report().largestPenetration, 0.03f) << step;
    }
    EXPECT_GT(world.PositionOf(row.back()).x(), 2.02);
}

}  // namespace
}  // namespace fulcrum::testing
