// Hits of continuous collision are events: where, when and how hard, in the middle of the step.
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/ContactEvents.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

using Kind = ContactEvent::Kind;

std::vector<ContactEvent> HitsOf(TestWorld& world) {
    std::vector<ContactEvent> hits;
    for (const ContactEvent& event : world.System().Events().contacts)
        if (event.kind == Kind::Hit) hits.push_back(event);
    return hits;
}

SystemSettings Flying() { return WithContactEvents(NoGravity()); }

BodySettings Bullet(float restitution = 0.5f) {
    return {.shape = SphereOf(0.1f),
            .position = {0, 0, 0},
            .linearVelocity = {300, 0, 0},
            .mass = 0.5f,
            .material = {.friction = 0, .restitution = restitution},
            .continuous = ContinuousCollision::Linear};
}

// A wall at 3 m: reached after 2.9 m of the 5 m of the step.
TEST(HitEvents, SayWhenWhereAndHowHard) {
    for (const float restitution : {0.0f, 0.5f, 1.0f}) {
        TestWorld world(Flying());
        const BodyId wall =
            world.Add({.shape = BoxOf(0.05f, 5, 5), .motion = MotionType::Static, .position = {3.05, 0, 0}});
        const BodyId bullet = world.Add(Bullet(restitution));
        world.Step();
        const std::vector<ContactEvent> hits = HitsOf(world);
        ASSERT_EQ(hits.size(), 1u);
        EXPECT_EQ(hits[0].bodyA, bullet);
        EXPECT_EQ(hits[0].bodyB, wall);
        EXPECT_NEAR(hits[0].time, 2.9 / 5, 1e-3);
        EXPECT_NEAR(hits[0].approachSpeed, 300, 1e-3);
        EXPECT_NEAR(hits[0].NormalImpulse(), 0.5 * 300 * (1 + double{restitution}), 0.01);
        ASSERT_EQ(hits[0].manifolds.size(), 1u);
        EXPECT_NEAR(hits[0].manifolds[0].normal.x(), 1, 1e-6);
        ASSERT_EQ(hits[0].manifolds[0].pointCount, 1u);
        const ContactEvent::Point& point = hits[0].manifolds[0].Points()[0];
        EXPECT_LT((point.position - Position(3, 0, 0)).norm(), 0.01);
        EXPECT_NEAR(world.VelocityOf(bullet).x(), -300 * restitution, 0.01);
    }
}

// Impulses of hits and of contacts are those of different instants: their sum is what the momentum changes by.
TEST(HitEvents, AndContactsTogetherAreTheChangeOfMomentum) {
    TestWorld world(WithContactEvents(NoSleep()));
    world.AddFloor({.friction = 0.4f, .restitution = 0.9f});
    world.Add({.shape = BoxOf(0.05f, 5, 5), .motion = MotionType::Static, .position = {1, 0, 0}});
    world.Add({.shape = BoxOf(0.05f, 5, 5), .motion = MotionType::Static, .position = {-1, 0, 0}});
    const BodyId ball = world.Add({.shape = SphereOf(0.1f),
                                   .position = {0, 0.5, 0},
                                   .linearVelocity = {400, -6, 1},
                                   .mass = 2,
                                   .material = {.friction = 0.4f, .restitution = 0.7f},
                                   .continuous = ContinuousCollision::Linear});
    size_t hits = 0, most = 0;
    for (int step = 0; step < 90; ++step) {
        const Vector3 before = world.VelocityOf(ball);
        world.Step();
        hits += HitsOf(world).size();
        most = std::max(most, HitsOf(world).size());
        const Position change = (world.VelocityOf(ball) - before).cast<double>() * 2.0;
        const Position expected = ImpulseOn(world, ball).cast<double>() + Position(0, -2 * kGravity * kStep, 0);
        EXPECT_LT((change - expected).norm(), 1e-4 * 2 * 800) << "step " << step;
    }
    EXPECT_GT(hits, 5u);
    EXPECT_GT(most, 1u);
}

// Off the center of a body that moves, with a child of a compound and a triangle of a mesh.
TEST(HitEvents, NameThePiecesAndActOnBothBodies) {
    TestWorld world(Flying());
    const BodyId target = world.Add({.shape = CompoundOf({{.shape = CubeOf(0.5f), .position = {0, 2, 0}},
                                                          {.shape = CubeOf(0.5f), .position = {0, 0, 0}},
                                                          {.shape = CubeOf(0.5f), .position = {0, -2, 0}}}),
                                     .position = {3, 2, 0},
                                     .mass = 4,
                                     .material = {.friction = 0.3f}});
    const BodyId bullet = world.Add(Bullet());
    const Vector3 start = world.VelocityOf(bullet);
    world.Step();
    const std::vector<ContactEvent> hits = HitsOf(world);
    ASSERT_EQ(hits.size(), 1u);
    EXPECT_EQ(hits[0].bodyA, target);  // the lower index
    EXPECT_EQ(hits[0].bodyB, bullet);
    EXPECT_EQ(hits[0].childA, 2u);
    EXPECT_NEAR(hits[0].manifolds[0].normal.x(), -1, 1e-4);
    EXPECT_LT((hits[0].Impulse() - (world.VelocityOf(bullet) - start) * 0.5f).norm(), 0.02f);
    EXPECT_LT((ImpulseOn(world, target) - world.VelocityOf(target) * 4.0f).norm(), 0.02f);
}

TEST(HitEvents, NameTheTriangle) {
    const Vector3 corners[] = {{3, -5, -5}, {3, 5, -5}, {3, -5, 5}, {3, 5, 5}};
    const uint32_t indices[] = {0, 2, 1, 1, 2, 3};
    const uint8_t materials[] = {0, 1};
    const SurfaceMaterial palette[] = {{.restitution = 0}, {.restitution = 1}};
    const ShapePtr sheet =
        TriangleMesh::Create(
            {.vertices = corners, .indices = indices, .triangleMaterials = materials, .materials = palette})
            .Value();
    for (const bool isFirst : {true, false}) {
        TestWorld world(Flying());
        world.Add({.shape = sheet, .motion = MotionType::Static});
        BodySettings settings = Bullet(0);
        settings.position = isFirst ? Position(0, -1, -1) : Position(0, 1, 1);
        world.Add(settings);
        world.Step();
        const std::vector<ContactEvent> hits = HitsOf(world);
        ASSERT_EQ(hits.size(), 1u);
        EXPECT_EQ(hits[0].manifolds[0].material, isFirst ? 0u : 1u);
        EXPECT_EQ(hits[0].manifolds[0].triangle, isFirst ? 0u : 1u);
        EXPECT_NEAR(hits[0].NormalImpulse(), isFirst ? 150 : 300, 0.1);
    }
}

// A ball that continuous collision stops at a wall, where it stays: a hit, then a contact that began without approach.
TEST(HitEvents, AreFollowedByTheContactOfWhatStays) {
    SystemSettings settings = WithContactEvents(NoSleep());
    settings.gravity = Vector3(50, 0, 0);
    TestWorld world(settings);
    world.Add({.shape = BoxOf(0.05f, 5, 5), .motion = MotionType::Static, .position = {3.05, 0, 0}});
    world.Add(Bullet(0));
    world.Step();
    EXPECT_EQ(HitsOf(world).size(), 1u);
    EXPECT_EQ(CountEvents(world, Kind::Begin), 0);
    world.Steps(2);
    EXPECT_EQ(HitsOf(world).size(), 0u);
    EXPECT_EQ(CountEvents(world, Kind::Begin) + CountEvents(world, Kind::Stay), 1);
    EXPECT_LT(world.System().Events().contacts[0].approachSpeed, 1);
}

TEST(HitEvents, OfBodiesThatReportNoneAreLeftOut) {
    TestWorld world(Flying());
    world.Add({.shape = BoxOf(0.05f, 5, 5),
               .motion = MotionType::Static,
               .position = {3.05, 0, 0},
               .reportsContacts = false});
    BodySettings bullet = Bullet();
    bullet.reportsContacts = false;
    world.Add(bullet);
    world.Step();
    EXPECT_EQ(world.Report().sweptHits, 1u);
    EXPECT_TRUE(world.System().Events().contacts.empty());
}

}  // namespace
}  // namespace fulcrum::testing
