// Impulses of contact events are those of the whole step: what a body's momentum changes by, together with gravity.
#include <Fulcrum/UnitTests/Support/ContactEvents.h>

#include <cmath>
#include <map>
#include <string>

namespace fulcrum::testing {
namespace {

SystemSettings WithSubsteps(int substeps) {
    SystemSettings settings = WithContactEvents(NoSleep());
    settings.solver.substeps = substeps;
    settings.sleep.seconds = 1000;  // what rests for so long is damped, which changes its momentum, too
    return settings;
}

// Follows a body for some steps, and expects that its momentum changes by gravity and the impulses of its events, N s.
void ExpectMomentum(TestWorld& world, BodyId body, int steps, double tolerance, const std::string& what) {
    const double mass = double{world.Bodies().GetMass(body)};
    for (int step = 0; step < steps; ++step) {
        const Vector3 before = world.VelocityOf(body);
        world.Step();
        const Position change = (world.VelocityOf(body) - before).cast<double>() * mass;
        const Position impulse =
            ImpulseOn(world, body).cast<double>() + world.System().Settings().gravity.cast<double>() * (mass * kStep);
        for (int k = 0; k < 3; ++k)
            ASSERT_NEAR(impulse[k], change[k], tolerance) << what << ", step " << step << ", axis " << k;
    }
}

// 5 kg that hit the floor at 8 m/s, sliding at 3 m/s: 40 N s and more.
TEST(ContactImpulses, AreTheChangeOfMomentumOfABallThatHits) {
    for (const int substeps : {1, 4, 16})
        for (const float restitution : {0.0f, 0.6f, 1.0f})
            for (const float friction : {0.0f, 0.5f}) {
                TestWorld world(WithSubsteps(substeps));
                world.AddFloor({.friction = friction});
                const BodyId ball = world.Add({.shape = SphereOf(0.5f),
                                               .position = {0, 1.3, 0},
                                               .linearVelocity = {3, -7, 0},
                                               .mass = 5,
                                               .material = {.friction = friction, .restitution = restitution}});
                ExpectMomentum(world, ball, 120, 1e-4,
                               std::to_string(substeps) + " substeps, restitution " + std::to_string(restitution) +
                                   ", friction " + std::to_string(friction));
            }
}

// Between two bodies that move, neither of which is where the step began; off their centers.
TEST(ContactImpulses, AreTheSameForBothBodies) {
    for (const int substeps : {1, 4, 16})
        for (const float restitution : {0.0f, 0.8f}) {
            SystemSettings settings = WithSubsteps(substeps);
            settings.gravity = Vector3::Zero();
            TestWorld world(settings);
            const Material material{.friction = 0.4f, .restitution = restitution};
            const BodyId first = world.Add({.shape = CubeOf(0.5f),
                                            .position = {0, 0.3, 0.2},
                                            .rotation = RotationAbout({0.6f, 0, 0.8f}, 0.7),
                                            .linearVelocity = {6, 0, 0},
                                            .mass = 3,
                                            .material = material});
            const BodyId second = world.Add({.shape = CapsuleOf(0.5f, 0.4f),
                                             .position = {2, 0, 0},
                                             .linearVelocity = {-2, 0.5f, 0},
                                             .mass = 8,
                                             .material = material});
            Position sums[2] = {Position::Zero(), Position::Zero()};
            const Vector3 before[2] = {world.VelocityOf(first), world.VelocityOf(second)};
            for (int step = 0; step < 60; ++step) {
                world.Step();
                sums[0] += ImpulseOn(world, first).cast<double>();
                sums[1] += ImpulseOn(world, second).cast<double>();
            }
            EXPECT_LT((sums[0] + sums[1]).norm(), 1e-6);
            EXPECT_GT(sums[0].norm(), 10);
            const Position changes[2] = {(world.VelocityOf(first) - before[0]).cast<double>() * 3.0,
                                         (world.VelocityOf(second) - before[1]).cast<double>() * 8.0};
            for (int i = 0; i < 2; ++i) EXPECT_LT((sums[i] - changes[i]).norm(), 1e-4) << substeps << " substeps";
        }
}

// m g dt in each step, whatever the number of substeps; shared by four points.
TEST(ContactImpulses, OfABoxAtRestAreItsWeight) {
    for (const int substeps : {1, 4, 16}) {
        TestWorld world(WithSubsteps(substeps));
        world.AddFloor();
        const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 12});
        world.Steps(60);
        for (int step = 0; step < 10; ++step) {
            world.Step();
            const auto events = world.System().Events().contacts;
            ASSERT_EQ(events.size(), 1u);
            EXPECT_EQ(events[0].kind, ContactEvent::Kind::Stay);
            EXPECT_NEAR(events[0].NormalImpulse(), 12 * kGravity * kStep, 1e-4);
            EXPECT_NEAR(ImpulseOn(world, box).y(), 12 * kGravity * kStep, 1e-4);
            ASSERT_EQ(events[0].manifolds.size(), 1u);
            ASSERT_EQ(events[0].manifolds[0].pointCount, 4u);
            for (const ContactEvent::Point& point : events[0].manifolds[0].Points())
                EXPECT_NEAR(point.impulse, 3 * kGravity * kStep, 1e-3);
        }
    }
}

// Steps, and expects that the momentum of each body, of 2 kg, changes by gravity and the impulses of all its contacts.
void ExpectMomenta(TestWorld& world, std::span<const BodyId> bodies, const std::string& what) {
    std::vector<Vector3> change;
    for (const BodyId body : bodies) change.push_back(-world.VelocityOf(body) * 2.0f);
    world.Step();
    std::map<BodyId, Vector3> impulses;
    const auto add = [&](BodyId body, const Vector3& impulse) {
        impulses.try_emplace(body, Vector3::Zero()).first->second += impulse;
    };
    for (const ContactEvent& event : world.System().Events().contacts) {
        add(event.bodyB, event.Impulse());
        add(event.bodyA, -event.Impulse());
    }
    const Vector3 weight = world.System().Settings().gravity * static_cast<float>(2 * kStep);
    for (size_t i = 0; i < bodies.size(); ++i) {
        add(bodies[i], weight);
        change[i] += world.VelocityOf(bodies[i]) * 2.0f;
        ASSERT_LT(Length(Vector3(change[i] - impulses.at(bodies[i]))), 1e-4f) << what << ", body " << i;
    }
}

// Also where islands have more substeps than the settings', and where constraints fit no color.
TEST(ContactImpulses, AreAllOfTheImpulsesOfAHeap) {
    SystemSettings settings = WithSubsteps(2);
    settings.accuracy.penetration = 0.0005f;
    TestWorld world(settings, 2);
    world.AddFloor();
    world.Add({.shape = BoxOf(4, 0.2f, 4), .position = {0, 0.21, 0}, .mass = 500});
    std::vector<BodyId> bodies;
    for (int i = 0; i < 90; ++i)
        bodies.push_back(world.Add({.shape = i % 2 ? SphereOf(0.3f) : CubeOf(0.3f),
                                    .position = {i % 9 * 0.8 - 3.2, 0.9 + i / 81 * 0.7, i / 9 % 9 * 0.8 - 3.2},
                                    .mass = 2,
                                    .material = {.restitution = i % 5 ? 0.0f : 0.7f}}));
    bool overflowed = false, hadEffort = false;
    for (int step = 0; step < 90; ++step) {
        ExpectMomenta(world, bodies, "step " + std::to_string(step));
        overflowed |= world.Report().overflowConstraints > 0;
        hadEffort |= world.Report().islandsWithMoreEffort > 0;
    }
    EXPECT_TRUE(overflowed);
    EXPECT_TRUE(hadEffort);
}

// An island of more than 768 contacts, which all workers solve together, as it falls together.
TEST(ContactImpulses, AreAllOfTheImpulsesOfALargeIsland) {
    TestWorld world(WithSubsteps(4), 2);
    world.AddFloor();
    std::vector<BodyId> bodies;
    for (int row = 0; row < 30; ++row)
        for (int i = 0; i < 30 - row; ++i)
            bodies.push_back(world.Add({.shape = CubeOf(0.5f),
                                        .position = {1.02 * i + 0.51 * row, 0.52 + 1.01 * row, 0},
                                        .mass = 2,
                                        .material = {.restitution = i % 3 ? 0.0f : 0.5f}}));
    for (int step = 0; step < 40; ++step) ExpectMomenta(world, bodies, "step " + std::to_string(step));
    EXPECT_GT(world.Report().contacts, 800u);
}

// In a row of boxes on each other, of which one alone reports its contacts: those above and below it.
TEST(ContactImpulses, OfOneThatReportsAmongOthers) {
    TestWorld world(WithSubsteps(4));
    ASSERT_TRUE(world.Bodies().SetReportsContacts(world.AddFloor(), false));
    BodyId middle;
    for (int i = 0; i < 40; ++i) {
        const BodyId box = world.Add(
            {.shape = CubeOf(0.5f), .position = {i / 5 * 3.0, 0.5 + i % 5, 0}, .mass = 2, .reportsContacts = i == 17});
        if (i == 17) middle = box;
    }
    world.Steps(120);
    const auto events = world.System().Events().contacts;
    ASSERT_EQ(events.size(), 2u);
    EXPECT_EQ(events[0].bodyB, middle);
    EXPECT_EQ(events[1].bodyA, middle);
    EXPECT_NEAR(events[0].NormalImpulse(), 3 * 2 * kGravity * kStep, 1e-2);
    EXPECT_NEAR(events[1].NormalImpulse(), 2 * 2 * kGravity * kStep, 1e-2);
    EXPECT_NEAR(ImpulseOn(world, middle).y(), 2 * kGravity * kStep, 1e-3);
}

// A ball that bounces: m (1 + e) v, with v the speed of a fall from its height, and no more events of it.
TEST(ContactImpulses, OfABounceAreThoseOfNewtonsLaw) {
    for (const int substeps : {1, 4, 16}) {
        TestWorld world(WithSubsteps(substeps));
        world.AddFloor();
        const BodyId ball = world.Add(
            {.shape = SphereOf(0.25f), .position = {0, 3.25, 0}, .mass = 2, .material = {.restitution = 0.5f}});
        const double speed = std::sqrt(2 * kGravity * 3);
        int begins = 0, ends = 0;
        for (int step = 0; step < 90 && ends == 0; ++step) {
            world.Step();
            for (const ContactEvent& event : world.System().Events().contacts) {
                EXPECT_EQ(event.bodyA, ball);
                if (event.kind == ContactEvent::Kind::End) {
                    ++ends;
                    EXPECT_TRUE(event.manifolds.empty());
                    continue;
                }
                EXPECT_EQ(event.kind, ContactEvent::Kind::Begin);
                ++begins;
                EXPECT_NEAR(event.NormalImpulse(), 2 * 1.5 * speed, 2 * 1.5 * speed * 5e-3) << substeps;
                EXPECT_NEAR(event.approachSpeed, speed, 1e-3 * speed);
                ASSERT_EQ(event.manifolds.size(), 1u);
                EXPECT_NEAR(event.manifolds[0].normal.y(), -1, 1e-6);
                ASSERT_EQ(event.manifolds[0].pointCount, 1u);
            }
        }
        EXPECT_EQ(begins, 1);
        EXPECT_EQ(ends, 1);
    }
}

// Baumgarte, and no position passes: the substep ends otherwise.
TEST(ContactImpulses, AreThereForAllKindsOfPasses) {
    for (const PositionCorrection correction : {PositionCorrection::SoftRelax, PositionCorrection::Baumgarte})
        for (const int positionIterations : {0, 1, 3}) {
            SystemSettings settings = WithSubsteps(4);
            settings.solver.positionCorrection = correction;
            settings.solver.positionIterations = positionIterations;
            settings.solver.velocityIterations = 2;
            TestWorld world(settings);
            world.AddFloor();
            const BodyId box =
                world.Add({.shape = CubeOf(0.5f), .position = {0, 0.8, 0}, .linearVelocity = {2, -3, 0}, .mass = 4});
            ExpectMomentum(world, box, 60, 1e-4, std::to_string(positionIterations) + " position iterations");
        }
}

}  // namespace
}  // namespace fulcrum::testing
