// When contacts begin, stay and end, and what events say of who touches.
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/ContactEvents.h>

#include <cmath>
#include <string>

namespace fulcrum::testing {
namespace {

using Kind = ContactEvent::Kind;

// B, S, E, H of the events of the last step, in their order.
std::string KindsOf(TestWorld& world) {
    std::string kinds;
    for (const ContactEvent& event : world.System().Events().contacts) kinds += "BSEH"[static_cast<int>(event.kind)];
    return kinds;
}

TEST(ContactEvents, AreNoneUnlessAskedFor) {
    TestWorld world;
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Steps(3);
    EXPECT_TRUE(world.System().Events().contacts.empty());
    EXPECT_TRUE(world.System().Events().awake.empty());
    EXPECT_TRUE(world.System().Events().moved.empty());
    EXPECT_EQ(world.Report().contacts, 1u);
}

// Comes at 6 m/s, 10 cm a step, and is seen two steps ahead: it begins in the step that ends where it has come there,
// or will within a substep, at which its speed is taken.
TEST(ContactEvents, BeginInTheStepInWhichTheBodiesTouch) {
    for (const int substeps : {1, 4, 16}) {
        SystemSettings settings = WithContactEvents();
        settings.gravity = Vector3::Zero();
        settings.solver.substeps = substeps;
        TestWorld world(settings);
        world.AddFloor();
        const BodyId ball =
            world.Add({.shape = SphereOf(0.5f), .position = {0, 0.5 + 0.315, 0}, .linearVelocity = {0, -6, 0}});
        const double substep = 0.1 / substeps;  // m
        bool wasAhead = false;
        double gap = 0.315 - 0.1;  // m, as the step ends
        for (; gap > substep; gap -= 0.1) {
            world.Step();
            EXPECT_EQ(KindsOf(world), "") << substeps << " substeps, " << gap << " m";
            wasAhead |= world.Report().contacts > 0;
        }
        EXPECT_EQ(wasAhead, substeps == 16);
        world.Step();
        ASSERT_EQ(KindsOf(world), "B") << substeps;
        const ContactEvent& event = world.System().Events().contacts[0];
        EXPECT_EQ(event.bodyA, ball);
        EXPECT_NEAR(event.approachSpeed, 6, 1e-5);
        EXPECT_EQ(event.time, 1);
        ASSERT_EQ(event.manifolds.size(), 1u);
        ASSERT_EQ(event.manifolds[0].pointCount, 1u);
        const ContactEvent::Point& point = event.manifolds[0].Points()[0];
        EXPECT_LT(point.position.norm(), substep);
        EXPECT_NEAR(point.separation, std::max(gap, 0.0), 1e-3);
        EXPECT_NEAR(point.position.y(), 0.5 * double{point.separation}, 1e-5);
        EXPECT_GT(point.impulse, 0);
        EXPECT_NEAR(event.manifolds[0].normal.y(), -1, 1e-6);
        world.Steps(2);
        EXPECT_EQ(KindsOf(world), "S");
        EXPECT_NEAR(world.System().Events().contacts[0].approachSpeed, 0, 1e-5);
    }
}

// What passes at a small distance, never touches.
TEST(ContactEvents, AreNotOfWhatIsOnlyNear) {
    SystemSettings settings = WithContactEvents();
    settings.gravity = Vector3::Zero();
    TestWorld world(settings);
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.501, 0}, .linearVelocity = {1, 0, 0}});
    for (int step = 0; step < 10; ++step) {
        world.Step();
        EXPECT_EQ(world.Report().contacts, 1u);
        EXPECT_EQ(KindsOf(world), "");
    }
}

// A quarter of the speculative distance of 2 cm; of a ball of 2 cm, whose quarter of the radius is less, 1.25 mm.
TEST(ContactEvents, EndWhereTheBodiesAreAQuarterOfTheSpeculativeDistanceApart) {
    for (const float radius : {0.5f, 0.02f}) {
        SystemSettings settings = WithContactEvents();
        settings.gravity = Vector3::Zero();
        TestWorld world(settings);
        world.AddFloor();
        const double radius64 = double{radius}, end = 0.25 * std::min(0.02, 0.25 * radius64);
        const BodyId ball = world.Add({.shape = SphereOf(radius), .position = {0, radius64, 0}});
        ASSERT_TRUE(world.Bodies().SetVelocity(ball, {0, -0.01f, 0}, {0, 0, 0}));
        world.Step();
        ASSERT_EQ(KindsOf(world), "B");
        const float speed = static_cast<float>(end / 10.5 / kStep);
        ASSERT_TRUE(world.Bodies().SetVelocity(ball, {0, speed, 0}, {0, 0, 0}));
        for (int step = 1; step <= 12; ++step) {
            world.Step();
            EXPECT_EQ(KindsOf(world), step <= 10 ? "S" : step == 11 ? "E" : "") << radius << " m, step " << step;
        }
    }
}

TEST(ContactEvents, StaysAreLeftOutOnRequest) {
    SystemSettings settings = WithContactEvents(NoSleep());
    settings.events.stays = false;
    TestWorld world(settings);
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    std::string kinds;
    for (int step = 0; step < 30; ++step) {
        world.Step();
        kinds += KindsOf(world);
    }
    EXPECT_EQ(kinds, "B");
    ASSERT_TRUE(world.Bodies().SetShape(box, BoxOf(0.4f, 0.5f, 0.4f)));
    world.Step();
    EXPECT_EQ(KindsOf(world), "");
    ASSERT_TRUE(world.Bodies().SetPose(box, {0, 5, 0}, {}));
    world.Step();
    EXPECT_EQ(KindsOf(world), "E");
}

// A box that falls asleep, sleeps, and is woken by a touch: no end, and no second begin.
TEST(ContactEvents, SleepIsNoEnd) {
    TestWorld world(WithContactEvents());
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Add({.shape = CubeOf(0.25f), .position = {0, 1.25, 0}});
    std::string kinds;
    int steps = 0;
    for (; steps < 200 && world.Bodies().IsAwake(box); ++steps) {
        world.Step();
        kinds += KindsOf(world);
    }
    ASSERT_FALSE(world.Bodies().IsAwake(box));
    EXPECT_EQ(kinds, "BB" + std::string(2 * static_cast<size_t>(steps) - 2, 'S'));
    for (int step = 0; step < 5; ++step) {
        world.Step();
        EXPECT_EQ(KindsOf(world), "");
    }
    ASSERT_TRUE(world.Bodies().Wake(box));
    world.Step();
    EXPECT_EQ(KindsOf(world), "SS");
}

TEST(ContactEvents, EndWhereAChangeTakesTheBodiesApart) {
    const auto nothing = [](TestWorld&, BodyId, BodyId) {};
    const struct {
        const char* what;
        std::function<void(TestWorld&, BodyId floor, BodyId box)> change;
        std::string kinds;
    } cases[] = {
        {"nothing", nothing, "S"},
        {"removed", [](TestWorld& w, BodyId, BodyId box) { EXPECT_TRUE(w.Bodies().Remove(box)); }, "E"},
        {"floor removed", [](TestWorld& w, BodyId floor, BodyId) { EXPECT_TRUE(w.Bodies().Remove(floor)); }, "E"},
        {"teleported",
         [](TestWorld& w, BodyId, BodyId box) {
             EXPECT_TRUE(w.Bodies().SetPose(box, {0, 9, 0}, {}));
         },
         "E"},
        {"teleported along the floor",
         [](TestWorld& w, BodyId, BodyId box) {
             EXPECT_TRUE(w.Bodies().SetPose(box, {9, 0.5, 0}, {}));
         },
         "S"},
        {"floor teleported",
         [](TestWorld& w, BodyId floor, BodyId) {
             EXPECT_TRUE(w.Bodies().SetPose(floor, {0, -9, 0}, {}));
         },
         "E"},
        {"filtered", [](TestWorld& w, BodyId, BodyId box) { EXPECT_TRUE(w.Bodies().SetCategoryAndMask(box, 1, 0)); },
         "E"},
        {"layers",
         [](TestWorld& w, BodyId, BodyId) {
             SystemSettings settings = w.System().Settings();
             settings.layerCollides[0] = 0xFFFFFFFEu;
             EXPECT_TRUE(w.System().SetSettings(settings));
         },
         "E"},
        {"made a sensor", [](TestWorld& w, BodyId, BodyId box) { EXPECT_TRUE(w.Bodies().SetSensor(box, true)); }, "E"},
        {"another shape",
         [](TestWorld& w, BodyId, BodyId box) { EXPECT_TRUE(w.Bodies().SetShape(box, BoxOf(0.4f, 0.5f, 0.4f))); }, "S"},
        {"a small shape", [](TestWorld& w, BodyId, BodyId box) { EXPECT_TRUE(w.Bodies().SetShape(box, CubeOf(0.1f))); },
         "E"},
        {"thrown up",
         [](TestWorld& w, BodyId, BodyId box) {
             EXPECT_TRUE(w.Bodies().SetVelocity(box, {0, 5, 0}, {0, 0, 0}));
         },
         "E"},
        {"not reported",
         [](TestWorld& w, BodyId floor, BodyId box) {
             EXPECT_TRUE(w.Bodies().SetReportsContacts(floor, false));
             EXPECT_FALSE(w.Bodies().ReportsContacts(floor));
             EXPECT_TRUE(w.Bodies().SetReportsContacts(box, false));
             EXPECT_TRUE(w.Bodies().Wake(box));
         },
         "E"},
    };
    for (const bool sleeps : {false, true})
        for (const auto& test : cases) {
            TestWorld world(WithContactEvents());
            const BodyId floor = world.AddFloor();
            const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
            world.Steps(sleeps ? 100 : 10);
            ASSERT_EQ(world.Bodies().IsAwake(box), !sleeps);
            test.change(world, floor, box);
            world.Step();
            if (sleeps && test.change.target_type() == typeid(nothing)) {
                EXPECT_EQ(KindsOf(world), "") << test.what;
                continue;
            }
            ASSERT_EQ(KindsOf(world), test.kinds) << test.what << (sleeps ? ", asleep" : "");
            const ContactEvent& event = world.System().Events().contacts[0];
            EXPECT_EQ(event.bodyA, box);
            EXPECT_EQ(event.bodyB, floor);
            EXPECT_EQ(event.manifolds.empty(), test.kinds == "E");
            world.Step();
            EXPECT_EQ(CountEvents(world, Kind::End), 0) << test.what;
        }
}

// Sleepers of which one is carried off by a teleport, and the other wakes with it.
TEST(ContactEvents, EndBetweenBodiesThatSlept) {
    TestWorld world(WithContactEvents());
    world.AddFloor();
    const BodyId lower = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    const BodyId upper = world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}});
    world.Steps(100);
    ASSERT_FALSE(world.Bodies().IsAwake(upper));
    ASSERT_TRUE(world.Bodies().SetPose(upper, {0, 30, 0}, {}));
    world.Step();
    EXPECT_EQ(KindsOf(world), "SE");
    const ContactEvent& event = world.System().Events().contacts[1];
    EXPECT_EQ(event.bodyA, lower);
    EXPECT_EQ(event.bodyB, upper);
}

TEST(ContactEvents, OfBodiesThatReportNoneAreLeftOut) {
    TestWorld world(WithContactEvents(NoSleep()));
    const BodyId floor = world.AddFloor();
    ASSERT_TRUE(world.Bodies().SetReportsContacts(floor, false));
    const BodyId speaks = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Add({.shape = CubeOf(0.5f), .position = {5, 0.5, 0}, .reportsContacts = false});
    world.Step();
    ASSERT_EQ(KindsOf(world), "B");
    EXPECT_EQ(world.System().Events().contacts[0].bodyA, speaks);
    EXPECT_FALSE(world.Bodies().SetReportsContacts({77, 0}, true));
}

// By A, B, child, kind; A is dynamic, of two dynamic bodies the one with the lower index, and normals point to B.
TEST(ContactEvents, AreSortedAndPointFromAToB) {
    TestWorld world(WithContactEvents(NoSleep()));
    std::vector<BodyId> boxes;
    for (int i = 0; i < 3; ++i) boxes.push_back(world.Add({.shape = CubeOf(0.5f), .position = {0, 2.5 - i, 0}}));
    const BodyId floor = world.AddFloor();
    const BodyId dumbbell = world.Add({.shape = CompoundOf({{.shape = SphereOf(0.3f), .position = {-1, 0, 0}},
                                                            {.shape = SphereOf(0.2f), .position = {5, 5, 5}},
                                                            {.shape = SphereOf(0.3f), .position = {1, 0, 0}}}),
                                       .position = {5, 0.3, 0},
                                       .lockedAxes = LockedAxes::Rotation});
    world.Steps(3);
    const auto events = world.System().Events().contacts;
    ASSERT_EQ(events.size(), 5u);
    const BodyId expected[5][2] = {
        {boxes[0], boxes[1]}, {boxes[1], boxes[2]}, {boxes[2], floor}, {dumbbell, floor}, {dumbbell, floor}};
    for (size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(events[i].bodyA, expected[i][0]) << i;
        EXPECT_EQ(events[i].bodyB, expected[i][1]) << i;
        ASSERT_EQ(events[i].manifolds.size(), 1u);
        EXPECT_NEAR(events[i].manifolds[0].normal.y(), -1, 1e-4);
        EXPECT_LT(events[i].Impulse().y(), 0);
    }
    EXPECT_EQ(events[3].childA, 0u);
    EXPECT_EQ(events[4].childA, 2u);
    EXPECT_NEAR(events[4].manifolds[0].Points()[0].position.x(), 6, 0.05);
}

// Another shape of the body with the lower index, of more pieces, comes after that of the other among the colliders.
TEST(ContactEvents, PointFromAToBWhateverTheColliders) {
    TestWorld world(WithContactEvents(NoSleep()));
    world.AddFloor();
    const BodyId upper = world.Add({.shape = CubeOf(0.5f), .position = {0, 1.5, 0}, .mass = 3});
    const BodyId lower = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 3});
    world.Steps(30);
    for (const bool isAnother : {false, true}) {
        if (isAnother) {
            const ShapePtr hat =
                CompoundOf({{.shape = CubeOf(0.5f)}, {.shape = CubeOf(0.1f), .position = {0, 0.6f, 0}, .density = 1}});
            ASSERT_TRUE(world.Bodies().SetShape(upper, hat, MassUpdate::Keep));
            world.Steps(30);
        }
        const auto events = world.System().Events().contacts;
        ASSERT_EQ(events.size(), 2u);
        EXPECT_EQ(events[0].bodyA, upper);
        EXPECT_EQ(events[0].bodyB, lower);
        EXPECT_NEAR(events[0].manifolds[0].normal.y(), -1, 1e-4);
        EXPECT_NEAR(events[0].Impulse().y(), -3 * kGravity * kStep, 1e-2);
        EXPECT_NEAR(events[0].manifolds[0].Points()[0].position.y(), 1, 2e-3);
    }
}

// A ball that lies in the valley of two triangles of different materials has two manifolds.
TEST(ContactEvents, NameTrianglesAndMaterialsOfASurface) {
    const Vector3 corners[] = {{-4, 4, -4}, {-4, 4, 4}, {0, 0, -4}, {0, 0, 4}, {4, 4, -4}, {4, 4, 4}};
    const uint32_t indices[] = {0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5};
    const uint8_t ofTriangles[] = {0, 0, 1, 1};
    const SurfaceMaterial palette[] = {{.friction = 0.2f}, {.friction = 0.9f}};
    const ShapePtr valley =
        TriangleMesh::Create(
            {.vertices = corners, .indices = indices, .triangleMaterials = ofTriangles, .materials = palette})
            .Value();
    TestWorld world(WithContactEvents(NoSleep()));
    world.Add({.shape = valley, .motion = MotionType::Static});
    const double height = std::sqrt(2.0);
    world.Add({.shape = SphereOf(1), .position = {0, height, 1.5}, .mass = 3, .material = {.friction = 0}});
    world.Steps(20);
    const auto events = world.System().Events().contacts;
    ASSERT_EQ(events.size(), 1u);
    ASSERT_EQ(events[0].manifolds.size(), 2u);
    double sum = 0;
    for (const ContactEvent::Manifold& manifold : events[0].manifolds) {
        const bool isLeft = manifold.normal.x() < 0;
        EXPECT_NEAR(std::fabs(manifold.normal.x()), std::sqrt(0.5), 1e-3);
        EXPECT_EQ(manifold.material, isLeft ? 0u : 1u);
        EXPECT_EQ(manifold.triangle / 2, isLeft ? 0u : 1u);
        sum += double{manifold.Points()[0].impulse} * std::sqrt(0.5);
    }
    EXPECT_NEAR(sum, 3 * kGravity * kStep, 1e-3);
    EXPECT_NEAR(events[0].Impulse().y(), -3 * kGravity * kStep, 1e-3);
}

// A step that is too short to be one leaves what ended to the next.
TEST(ContactEvents, WaitForAStepThatIsOne) {
    TestWorld world(WithContactEvents());
    world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Steps(5);
    ASSERT_TRUE(world.Bodies().Remove(box));
    world.Step(0);
    EXPECT_EQ(KindsOf(world), "");
    world.Step();
    EXPECT_EQ(KindsOf(world), "E");
    EXPECT_EQ(world.System().Events().contacts[0].bodyA, box);
}

TEST(ContactEvents, BeginAnewWhereTheyWereSwitchedOff) {
    TestWorld world(WithContactEvents(NoSleep()));
    world.AddFloor();
    world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Steps(5);
    SystemSettings settings = world.System().Settings();
    settings.events.contacts = false;
    ASSERT_TRUE(world.System().SetSettings(settings));
    world.Step();
    EXPECT_EQ(KindsOf(world), "");
    settings.events.contacts = true;
    ASSERT_TRUE(world.System().SetSettings(settings));
    world.Step();
    EXPECT_EQ(KindsOf(world), "B");
}

}  // namespace
}  // namespace fulcrum::testing
