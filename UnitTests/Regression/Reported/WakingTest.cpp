// What changes under, in or around a sleeping body wakes it, whichever call changes it. Each row of the table has a
// cube of 1 m asleep on a slab, changes something, and says where the cube must be then. The bounds are what closed
// forms of fall and push give, with margins for the friction of tilted cubes.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Physics/BodyBatch.h>
#include <Fulcrum/Physics/ContactListener.h>

#include <array>
#include <functional>

namespace fulcrum::testing {
namespace {

constexpr float kHalf = 0.5f;  // m, of the cube
constexpr double kAny = 1e9;

Quaternion Tilted(double angle) { return RotationAbout(Vector3(0, 0, 1), angle); }

// A cube asleep on a slab whose top passes the origin, 3 m above a plane.
struct Resting {
    explicit Resting(double tilt = 0, MotionType motion = MotionType::Static, const SystemSettings& settings = {})
        : world(settings) {
        world.Add({.shape = Plane::Create().Value(), .motion = MotionType::Static, .position = {0, -3.5, 0}});
        const Vector3 up = Rotate(Tilted(tilt), Vector3(0, 1, 0));
        slab = world.Add({.shape = BoxOf(3, kHalf, 3),
                          .motion = motion,
                          .position = (up * -kHalf).cast<double>(),
                          .rotation = Tilted(tilt),
                          .material = {.friction = 0.8f}});
        cube = world.Add({.shape = CubeOf(kHalf),
                          .position = (up * kHalf).cast<double>(),
                          .rotation = Tilted(tilt),
                          .material = {.friction = 0.8f}});
        world.Run(2);
        EXPECT_FALSE(world.Bodies().IsAwake(cube));
    }
    double X() { return world.PositionOf(cube).x(); }
    double Y() { return world.PositionOf(cube).y(); }

    TestWorld world;
    BodyId slab, cube;
};

struct Change {
    const char* name;
    std::function<void(Resting&)> act;
    double lowX, highX, lowY, highY;  // where the cube is then, m
    double seconds = 1;
    double tilt = 0;  // of the slab, rad
    MotionType motion = MotionType::Static;
};

class WakingBy : public ::testing::TestWithParam<Change> {};

TEST_P(WakingBy, MovesTheCube) {
    const Change& change = GetParam();
    Resting resting(change.tilt, change.motion);
    change.act(resting);
    resting.world.Run(change.seconds);
    EXPECT_GE(resting.X(), change.lowX);
    EXPECT_LE(resting.X(), change.highX);
    EXPECT_GE(resting.Y(), change.lowY);
    EXPECT_LE(resting.Y(), change.highY);
}

template <class Edit>
auto WithSettings(const Edit& edit) {
    return [edit](Resting& r) {
        SystemSettings settings = r.world.System().Settings();
        edit(settings);
        EXPECT_TRUE(r.world.System().SetSettings(settings));
    };
}

const Change kFieldsOfForce[] = {
    {"GravityReversed", WithSettings([](SystemSettings& s) {
         s.gravity = {0, 9.81f, 0};
     }),
     -1, 1, 4, 6},
    {"GravityTurned", WithSettings([](SystemSettings& s) {
         s.gravity = {20, -9.81f, 0};
     }),
     1, 9, -kAny, kAny},
    {"GravityWeaker", WithSettings([](SystemSettings& s) {
         s.gravity = {1, 1, 0};
     }),
     0.3, 0.7, 0.8, 1.2},
    {"GravityFactor", [](Resting& r) { (void)r.world.Bodies().SetGravityFactor(r.cube, -1); }, -1, 1, 4, 6},
    {"OwnGravity", [](Resting& r) { (void)r.world.Bodies().SetGravity(r.cube, Vector3(0, 9.81f, 0)); }, -1, 1, 4, 6},
};
INSTANTIATE_TEST_SUITE_P(Forces, WakingBy, ::testing::ValuesIn(kFieldsOfForce),
                         [](const auto& of) { return of.param.name; });

const Change kGround[] = {
    {"Removed", [](Resting& r) { (void)r.world.Bodies().Remove(r.slab); }, -1, 1, -3.1, -2.9},
    {"Moved",
     [](Resting& r) {
         (void)r.world.Bodies().SetPose(r.slab, {20, 0, 0}, {});
     },
     -1, 1, -3.1, -2.9},
    {"Shrunk", [](Resting& r) { (void)r.world.Bodies().SetShape(r.slab, CubeOf(0.1f)); }, -2, 2, -4, 0.3},
    {"WithoutShape", [](Resting& r) { (void)r.world.Bodies().SetShape(r.slab, EmptyShape::Create()); }, -1, 1, -3.1,
     -2.9},
    {"MadeASensor", [](Resting& r) { (void)r.world.Bodies().SetSensor(r.slab, true); }, -1, 1, -3.1, -2.9},
    {"MaskedOut", [](Resting& r) { (void)r.world.Bodies().SetCategoryAndMask(r.slab, 0, 0); }, -1, 1, -3.1, -2.9},
    {"Dynamic", [](Resting& r) { (void)r.world.Bodies().SetMotionType(r.slab, MotionType::Dynamic); }, -1, 1, -3.1,
     -1.9},
    {"LayerApart",
     [](Resting& r) {
         (void)r.world.Bodies().SetLayer(r.slab, 1);
         WithSettings([](SystemSettings& s) {
             s.layerCollides[0] &= ~2u;
             s.layerCollides[1] &= ~1u;
         })(r);
     },
     -1, 1, -3.1, -2.9},
    {"Slippery", [](Resting& r) { (void)r.world.Bodies().SetMaterial(r.slab, {.friction = 0}); }, -9, -1, -4, 0, 1,
     0.4},
    {"SlipperyCube", [](Resting& r) { (void)r.world.Bodies().SetMaterial(r.cube, {.friction = 0}); }, -9, -1, -4, 0, 1,
     0.4},
    {"Rises",
     [](Resting& r) {
         (void)r.world.Bodies().SetVelocity(r.slab, {0, 0.1f, 0}, Vector3::Zero());
     },
     -0.1, 0.1, 0.55, 0.65, 1, 0, MotionType::Kinematic},
    {"Sinks",
     [](Resting& r) {
         (void)r.world.Bodies().SetVelocity(r.slab, {0, -0.1f, 0}, Vector3::Zero());
     },
     -0.1, 0.1, 0.35, 0.45, 1, 0, MotionType::Kinematic},
    {"Slides",
     [](Resting& r) {
         (void)r.world.Bodies().SetVelocity(r.slab, {0.1f, 0, 0}, Vector3::Zero());
     },
     0.05, 0.15, 0.4, 0.6, 1, 0, MotionType::Kinematic},
};
INSTANTIATE_TEST_SUITE_P(Ground, WakingBy, ::testing::ValuesIn(kGround), [](const auto& of) { return of.param.name; });

// What is put into the cube from its left, 0.1 m deep, pushes it to the right until they are apart.
constexpr double kPushedX = 0.07, kMostPushed = 0.4;
const Position kInside(-0.9, 0.7, 0);
BodySettings Intruder(MotionType motion) { return {.shape = CubeOf(kHalf), .motion = motion, .position = kInside}; }

ShapePtr WallMesh() {
    const std::vector<Vector3> corners{{0, -2, -2}, {0, 2, -2}, {0, 2, 2}, {0, -2, 2}};
    const std::vector<uint32_t> indices{0, 1, 2, 0, 2, 3};
    return TriangleMesh::Create({.vertices = corners, .indices = indices}).Value();
}
ShapePtr StepField(float height) {
    const std::vector<float> heights(4, height);
    return HeightField::Create({.sampleCountX = 2,
                                .sampleCountZ = 2,
                                .heights = heights,
                                .cellSizeX = 4,
                                .cellSizeZ = 4,
                                .origin = {-2, 0, -2}})
        .Value();
}

const Change kIntruders[] = {
    {"Static", [](Resting& r) { r.world.Add(Intruder(MotionType::Static)); }, kPushedX, kMostPushed, 0.4, 0.6},
    {"Kinematic", [](Resting& r) { r.world.Add(Intruder(MotionType::Kinematic)); }, kPushedX, kMostPushed, 0.4, 0.6},
    {"MovingKinematic",
     [](Resting& r) {
         BodySettings wall = Intruder(MotionType::Kinematic);
         wall.position.x() = -1.05;
         wall.linearVelocity = {0.2f, 0, 0};
         r.world.Add(wall);
     },
     0.1, 0.2, 0.4, 0.6},
    {"Mesh",
     [](Resting& r) {
         r.world.Add({.shape = WallMesh(), .motion = MotionType::Static, .position = {-0.4, 0, 0}});
     },
     kPushedX, kMostPushed, 0.4, 0.6},
    {"HeightField", [](Resting& r) { r.world.Add({.shape = StepField(0.1f), .motion = MotionType::Static}); }, -0.1,
     0.1, 0.58, 0.62},
    {"Plane",
     [](Resting& r) {
         r.world.Add({.shape = Plane::Create().Value(), .motion = MotionType::Static, .position = {0, 0.1, 0}});
     },
     -0.1, 0.1, 0.58, 0.62},
    {"Compound",
     [](Resting& r) {
         BodySettings two = Intruder(MotionType::Static);
         two.shape = CompoundOf({{.shape = CubeOf(kHalf)}, {.shape = CubeOf(kHalf), .position = {-3, 0, 0}}});
         r.world.Add(two);
     },
     kPushedX, kMostPushed, 0.4, 0.6},
    {"Batch",
     [](Resting& r) {
         const auto batch = BodyBatch::Prepare({Intruder(MotionType::Static), Intruder(MotionType::Static)});
         EXPECT_TRUE(r.world.Bodies().Commit(batch.Value()));
     },
     kPushedX, kMostPushed, 0.4, 0.6},
    {"SensorMadeSolid",
     [](Resting& r) {
         BodySettings sensor = Intruder(MotionType::Static);
         sensor.isSensor = true;
         const BodyId id = r.world.Add(sensor);
         r.world.Step();
         EXPECT_FALSE(r.world.Bodies().IsAwake(r.cube));
         (void)r.world.Bodies().SetSensor(id, false);
     },
     kPushedX, kMostPushed, 0.4, 0.6},
    {"Unmasked",
     [](Resting& r) {
         BodySettings masked = Intruder(MotionType::Static);
         masked.mask = 0;
         const BodyId id = r.world.Add(masked);
         r.world.Step();
         EXPECT_FALSE(r.world.Bodies().IsAwake(r.cube));
         (void)r.world.Bodies().SetCategoryAndMask(id, 1, ~uint64_t{0});
     },
     kPushedX, kMostPushed, 0.4, 0.6},
    {"GivenAShape",
     [](Resting& r) {
         BodySettings empty = Intruder(MotionType::Static);
         empty.shape = EmptyShape::Create();
         (void)r.world.Bodies().SetShape(r.world.Add(empty), CubeOf(kHalf));
     },
     kPushedX, kMostPushed, 0.4, 0.6},
    {"ChildAdded",
     [](Resting& r) {
         const CompoundShape::ChildSettings far{.shape = CubeOf(kHalf), .position = {-9, 0, 0}};
         const BodyId id = r.world.Add(
             {.shape = MutableCompound::Create({&far, 1}).Value(), .motion = MotionType::Static, .position = kInside});
         r.world.Step();
         EXPECT_TRUE(r.world.Bodies().AddChild(id, {.shape = CubeOf(kHalf)}));
     },
     kPushedX, kMostPushed, 0.4, 0.6},
    {"ChildMoved",
     [](Resting& r) {
         const CompoundShape::ChildSettings children[]{{.shape = CubeOf(kHalf), .position = {-9, 0, 0}},
                                                       {.shape = CubeOf(kHalf), .position = {-12, 0, 0}}};
         const BodyId id = r.world.Add(
             {.shape = MutableCompound::Create(children).Value(), .motion = MotionType::Static, .position = kInside});
         r.world.Step();
         EXPECT_TRUE(r.world.Bodies().MoveChild(id, r.world.Bodies().GetChildren(id)->IdOf(0), Vector3::Zero(), {}));
     },
     kPushedX, kMostPushed, 0.4, 0.6},
    {"RestoredFromASnapshot",
     [](Resting& r) {
         r.world.Add(Intruder(MotionType::Static));
         std::vector<std::byte> bytes;
         ASSERT_TRUE(r.world.System().SaveSnapshot(bytes));
         r.world.Step();
         ASSERT_TRUE(r.world.System().RestoreSnapshot(bytes));
         EXPECT_FALSE(r.world.Bodies().IsAwake(r.cube));
     },
     kPushedX, kMostPushed, 0.4, 0.6},
};
INSTANTIATE_TEST_SUITE_P(Intruder, WakingBy, ::testing::ValuesIn(kIntruders),
                         [](const auto& of) { return of.param.name; });

// Bodies that were created asleep, and others at the edge of what is created, are left alone: a level may be loaded in
// any order, and a tile laid beside a pile does not wake it.
TEST(Waking, WhatIsCreatedFlushLeavesSleepersAlone) {
    Resting resting;
    resting.world.Add({.shape = CubeOf(kHalf), .motion = MotionType::Static, .position = {-1, 0.5, 0}});
    resting.world.Add({.shape = BoxOf(3, kHalf, 3), .motion = MotionType::Static, .position = {0, -0.5, 0}});
    resting.world.Add({.shape = StepField(0), .motion = MotionType::Static});
    const BodyId later = resting.world.Add({.shape = CubeOf(kHalf), .position = {2, 0.5, 0}, .startAsleep = true});
    resting.world.Add({.shape = WallMesh(), .motion = MotionType::Static, .position = {-0.5, 0, 0}});
    resting.world.Step();
    EXPECT_FALSE(resting.world.Bodies().IsAwake(resting.cube));
    EXPECT_FALSE(resting.world.Bodies().IsAwake(later));
    // Nor does what cannot touch it.
    BodySettings masked = Intruder(MotionType::Static);
    masked.category = 2;
    masked.mask = 2;
    resting.world.Add(masked);
    BodySettings sensor = Intruder(MotionType::Static);
    sensor.isSensor = true;
    resting.world.Add(sensor);
    resting.world.Step();
    EXPECT_FALSE(resting.world.Bodies().IsAwake(resting.cube));
}

// The depth that counts is what bodies may have at rest: half of it wakes nothing, twice as much does.
TEST(Waking, ByAnIntruderDependsOnTheDepthAtRest) {
    const double atRest = double{AccuracyTarget().penetration * kHalf};  // m
    for (const double factor : {0.5, 2.0}) {
        Resting resting;
        resting.world.Add({.shape = CubeOf(kHalf),
                           .motion = MotionType::Static,
                           .position = {resting.X() - 1 + factor * atRest, 0.5, 0}});
        resting.world.Step();
        EXPECT_EQ(resting.world.Bodies().IsAwake(resting.cube), factor > 1);
    }
}

// With any number of threads the same bits.
TEST(Waking, ByManyIntrudersDependsNotOnTheThreads) {
    uint64_t first = 0;
    for (const uint32_t threads : {1u, 4u}) {
        TestWorld world({}, threads);
        world.AddFloor();
        for (int i = 0; i < 64; ++i)
            world.Add({.shape = CubeOf(kHalf), .position = {2.0 * (i % 8), 0.5, 2.0 * (i / 8)}, .startAsleep = true});
        world.Step();
        for (int i = 63; i >= 0; --i)
            world.Add({.shape = CubeOf(0.1f),
                       .motion = MotionType::Static,
                       .position = {2.0 * (i % 8) - 0.55, 0.5, 2.0 * (i / 8)}});
        world.Step();
        EXPECT_EQ(world.Report().awakeBodies, 64u);
        world.Run(0.5);
        if (threads == 1) first = world.System().HashState();
        else EXPECT_EQ(world.System().HashState(), first);
    }
}

class Glue final : public ContactListener {
public:
    void ModifyContact(const ContactView&, ContactChange& change) const override { change.friction = 2; }
};
class Ghosts final : public ContactListener {
public:
    bool ShouldCollide(BodyId, BodyId) const override { return false; }
};

// A cube that only a listener's friction holds on a slope slides when it goes, and falls when one comes that lets it
// through.
TEST(Waking, ByAnotherContactListener) {
    for (const bool isGhost : {false, true}) {
        const Glue glue;
        const Ghosts ghosts;
        TestWorld world;
        world.System().SetContactListener(&glue);
        constexpr double kTilt = 0.4;  // rad; tan 0.42
        world.Add({.shape = BoxOf(9, kHalf, 9),
                   .motion = MotionType::Static,
                   .rotation = Tilted(kTilt),
                   .material = {.friction = 0.1f}});
        const Vector3 up = Rotate(Tilted(kTilt), Vector3(0, 1, 0));
        const BodyId cube = world.Add({.shape = CubeOf(kHalf),
                                       .position = up.cast<double>(),
                                       .rotation = Tilted(kTilt),
                                       .material = {.friction = 0.1f}});
        world.Run(2);
        ASSERT_FALSE(world.Bodies().IsAwake(cube));
        const double before = world.PositionOf(cube).y();
        world.System().SetContactListener(isGhost ? static_cast<const ContactListener*>(&ghosts) : nullptr);
        world.Run(1);
        // Slides by t^2/2 g (sin - 0.1 cos) = 1.46 m along the slope, 0.57 m down; falls 4.9 m.
        EXPECT_NEAR(before - world.PositionOf(cube).y(), isGhost ? 4.9 : 0.57, isGhost ? 0.2 : 0.1);
        world.System().SetContactListener(nullptr);
    }
}

// What holds a body in the air without a contact: locked axes, damping, a speed limit, and sleep itself.
TEST(Waking, OfBodiesInTheAir) {
    struct Held {
        std::function<void(BodySettings&)> hold;
        std::function<Status(TestWorld&, BodyId)> release;
    };
    const std::array<Held, 4> all{{
        {[](BodySettings& s) { s.lockedAxes = LockedAxes::TranslationY; },
         [](TestWorld& w, BodyId id) { return w.Bodies().SetLockedAxes(id, LockedAxes::None); }},
        {[](BodySettings& s) { s.linearDamping = 1e5f; },
         [](TestWorld& w, BodyId id) { return w.Bodies().SetDamping(id, 0, 0); }},
        {[](BodySettings& s) { s.maxLinearSpeed = 1e-4f; },
         [](TestWorld& w, BodyId id) { return w.Bodies().SetMaxSpeeds(id, 100, 100); }},
        {[](BodySettings& s) { s.startAsleep = true; },
         [](TestWorld& w, BodyId) {
             SystemSettings settings = w.System().Settings();
             settings.sleep.enabled = false;
             return w.System().SetSettings(settings);
         }},
    }};
    for (size_t i = 0; i < all.size(); ++i) {
        TestWorld world;
        BodySettings settings;
        settings.shape = CubeOf(kHalf);
        settings.position = {0, 10, 0};
        all[i].hold(settings);
        const BodyId cube = world.Add(settings);
        world.Run(1);
        ASSERT_TRUE(world.Bodies().Sleep(cube));
        world.Step();
        const double before = world.PositionOf(cube).y();
        ASSERT_TRUE(all[i].release(world, cube));
        world.Run(1);
        EXPECT_NEAR(before - world.PositionOf(cube).y(), 4.9, 0.2) << i;
    }
}

// Settings that are set again, and those without a say in what holds a body, leave it asleep.
TEST(Waking, ByNothingThatChangesNothing) {
    Resting resting;
    WithSettings([](SystemSettings& s) { s.solver.substeps = 8; })(resting);
    (void)resting.world.Bodies().SetDamping(resting.cube, 0, 0);
    (void)resting.world.Bodies().SetMaxSpeeds(resting.cube, 1000, 300);
    (void)resting.world.Bodies().SetUserData(resting.cube, 7);
    resting.world.Step();
    EXPECT_FALSE(resting.world.Bodies().IsAwake(resting.cube));
}

// A kinematic body pulls what hangs from it, however it is moved: SetVelocity, MoveKinematic, SetPose.
TEST(Waking, ByAJointToAKinematicBody) {
    for (int way = 0; way < 3; ++way) {
        TestWorld world;
        const BodyId hook =
            world.Add({.shape = SphereOf(0.1f), .motion = MotionType::Kinematic, .position = {0, 3, 0}});
        const BodyId load = world.Add({.shape = CubeOf(0.2f), .position = {0, 2, 0}});
        PointJointSettings joint;
        joint.bodyA = hook;
        joint.bodyB = load;
        joint.anchorA.point = {0, 3, 0};
        ASSERT_TRUE(world.System().Joints().Create(joint));
        world.Run(2);
        ASSERT_FALSE(world.Bodies().IsAwake(load));
        if (way == 0) (void)world.Bodies().SetVelocity(hook, {1, 0, 0}, Vector3::Zero());
        if (way == 2) (void)world.Bodies().SetPose(hook, {2, 3, 0}, {});
        for (int step = 0; step < 120; ++step) {
            const Position next = world.PositionOf(hook) + Position(kStep, 0, 0);
            if (way == 1) (void)world.Bodies().MoveKinematic(hook, next, {}, static_cast<float>(kStep));
            world.Step();
        }
        // It swings on an arm of 1 m about where the hook is, at 2 m.
        EXPECT_NEAR(world.PositionOf(load).x(), 2, 0.8) << way;
    }
}

}  // namespace
}  // namespace fulcrum::testing
