// Height fields that are raised through bodies: what was above the ground is above it afterwards, however far it rises,
// with what lies on it and what is joined to it; what was below stays there.
#include <Fulcrum/UnitTests/Support/FailingMemory.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/HeightField.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

using FieldPtr = std::shared_ptr<HeightField>;
constexpr uint32_t kSide = 41;  // samples, 1 m apart, about the origin
constexpr double kRest = 0.01;  // m, that a body at rest may be off

FieldPtr FlatField(bool isTwoSided = false) {
    const std::vector<float> heights(kSide * kSide, 0.0f);
    return HeightField::Create({.sampleCountX = kSide,
                                .sampleCountZ = kSide,
                                .heights = heights,
                                .origin = {-20, 0, -20},
                                .isTwoSided = isTwoSided})
        .Value();
}
void Raise(HeightField& field, float height) {
    const std::vector<float> heights(kSide * kSide, height);
    ASSERT_TRUE(field.SetHeights(0, 0, kSide, kSide, heights));
}
// The samples within so many meters of (x, z), a square.
void RaiseAround(HeightField& field, int x, int z, int reach, float height) {
    const auto side = static_cast<uint32_t>(2 * reach + 1);
    const std::vector<float> heights(size_t{side} * side, height);
    ASSERT_TRUE(field.SetHeights(static_cast<uint32_t>(x + 20 - reach), static_cast<uint32_t>(z + 20 - reach), side,
                                 side, heights));
}
void SetCellsAround(HeightField& field, int x, int z, int reach, uint8_t cell) {
    const auto side = static_cast<uint32_t>(2 * reach);
    const std::vector<uint8_t> cells(size_t{side} * side, cell);
    ASSERT_TRUE(field.SetCells(static_cast<uint32_t>(x + 20 - reach), static_cast<uint32_t>(z + 20 - reach), side, side,
                               cells));
}

// A field in a world, and bodies given in the field's frame.
struct Ground {
    explicit Ground(const SystemSettings& settings = {}, MotionType motion = MotionType::Static,
                    const Position& itsAt = Position::Zero(), const Quaternion& itsRotation = {})
        : world(settings), at(itsAt), rotation(itsRotation) {
        body = world.Add({.shape = field, .motion = motion, .position = at, .rotation = rotation});
    }
    BodyId Add(const ShapePtr& shape, const Position& place) { return Add({.shape = shape, .position = place}); }
    BodyId Add(BodySettings settings) {
        settings.position = at + Rotate(rotation, settings.position.cast<float>()).cast<double>();
        settings.rotation = rotation * settings.rotation;
        return world.Add(settings);
    }
    Vector3 PlaceOf(BodyId id) {
        return Rotate(rotation.Conjugate(), Vector3((world.PositionOf(id) - at).cast<float>()));
    }
    // And not beyond its edge.
    bool IsOver(BodyId id) {
        const Vector3 place = PlaceOf(id);
        return std::fabs(place.x()) < 19.5f && std::fabs(place.z()) < 19.5f;
    }
    double Y(BodyId id) { return double{PlaceOf(id).y()}; }

    TestWorld world;
    FieldPtr field = FlatField();
    Position at;
    Quaternion rotation;
    BodyId body;
};

// Cubes of 1 m, awake or asleep, on a static or kinematic body, raised by little or much.
TEST(RisingGround, LiftsWhatLiesOnIt) {
    for (const MotionType motion : {MotionType::Static, MotionType::Kinematic}) {
        for (const float rise : {0.01f, 0.3f, 0.5f, 0.6f, 1.0f, 1.3f, 30.0f, 1000.0f}) {
            for (const bool maySleep : {true, false}) {
                Ground ground(maySleep ? SystemSettings() : NoSleep(), motion);
                const BodyId cube = ground.Add(CubeOf(0.5f), {0.3, 0.5, -0.2});
                ground.world.Run(2);
                EXPECT_EQ(ground.world.Bodies().IsAwake(cube), !maySleep);
                Raise(*ground.field, rise);
                ground.world.Step();
                EXPECT_NEAR(ground.Y(cube), double{rise} + 0.5, kRest) << rise;
                EXPECT_LT(Length(ground.world.VelocityOf(cube)), 0.2f) << rise;
                ground.world.Run(3);
                EXPECT_NEAR(ground.Y(cube), double{rise} + 0.5, kRest) << rise;
                EXPECT_NEAR(ground.PlaceOf(cube).x(), 0.3, kRest) << rise;
            }
        }
    }
}

TEST(RisingGround, LiftsEveryShape) {
    const std::pair<ShapePtr, double> shapes[]{
        {SphereOf(0.3f), 0.3},
        {CapsuleOf(0.4f, 0.2f), 0.6},
        {BoxOf(1, 0.005f, 1), 0.005},
        {HullOf({{-1, -0.2f, -1}, {1, -0.2f, -1}, {0, -0.2f, 1}, {0, 0.6f, 0}}), 0.0},
        {CompoundOf({{.shape = CubeOf(0.2f), .position = {-1, 0, 0}}, {.shape = CubeOf(0.2f), .position = {1, 0, 0}}}),
         0.2}};
    for (const auto& [shape, height] : shapes) {
        Ground ground;
        const BodyId body =
            ground.Add({.shape = shape, .position = {0, height > 0 ? height : 0.2, 0}, .angularDamping = 1});
        ground.world.Run(1);
        const double before = ground.Y(body);
        Raise(*ground.field, 2.5f);
        ground.world.Run(1);
        EXPECT_NEAR(ground.Y(body), before + 2.5, 0.02) << ShapeTypeName(shape->Type());
    }
}

// Of a compound, whose center is elsewhere, a child is on the part that rises.
TEST(RisingGround, LiftsByAnyChild) {
    Ground ground;
    const BodyId body = ground.Add(CompoundOf({{.shape = CubeOf(0.5f), .position = {-5, 0, 0}},
                                               {.shape = CubeOf(0.5f), .position = {5, 0, 0}},
                                               {.shape = BoxOf(5, 0.1f, 0.1f), .position = {0, 0.3f, 0}}}),
                                   {0, 0.5, 0});
    ground.world.Run(1);
    RaiseAround(*ground.field, -5, 0, 2, 2);
    ground.world.Run(4);
    const Quaternion rotation = ground.world.Bodies().GetPose(body).rotation;
    EXPECT_GT(ground.Y(body) + double{Rotate(rotation, Vector3(-5, 0, 0)).y()}, 2.2);
    EXPECT_GT(ground.Y(body) + double{Rotate(rotation, Vector3(5, 0, 0)).y()}, 0.2);
}

// The field's up axis is that of its body.
TEST(RisingGround, FollowsThePoseOfTheField) {
    for (const auto& [at, rotation] :
         {std::pair{Position(1e6, 5, -3), RotationAbout(Vector3(0, 1, 0), kPi / 3)},
          std::pair{Position(0, 0, 0), RotationAbout(Vector3(0, 0, 1), 0.4)},
          std::pair{Position(4, -7, 2), RotationAbout(Normalized(Vector3(1, 0, 1)), 0.3)}}) {
        Ground ground({}, MotionType::Static, at, rotation);
        const BodyId cube = ground.Add({.shape = CubeOf(0.5f), .position = {3, 0.5, 2}, .material = {.friction = 2}});
        ASSERT_TRUE(ground.world.Bodies().SetMaterial(ground.body, {.friction = 2}));
        ground.world.Run(1);
        const Vector3 before = ground.PlaceOf(cube);
        Raise(*ground.field, 2);
        ground.world.Run(1);
        EXPECT_NEAR(ground.Y(cube), double{before.y()} + 2, 0.02);
        EXPECT_NEAR(ground.PlaceOf(cube).x(), before.x(), 0.05f);
        EXPECT_NEAR(ground.PlaceOf(cube).z(), before.z(), 0.05f);
    }
    // A ceiling that comes down.
    Ground ceiling(NoGravity(), MotionType::Static, {0, 10, 0}, RotationAbout(Vector3(0, 0, 1), kPi));
    const BodyId cube = ceiling.Add(CubeOf(0.5f), {0, 0.6, 0});
    ceiling.world.Step();
    Raise(*ceiling.field, 4);
    ceiling.world.Run(1);
    EXPECT_NEAR(ceiling.world.PositionOf(cube).y(), 5.5, 0.05);
}

// A slope of 30 degrees that rises without a change of its shape, and one that becomes a slope.
TEST(RisingGround, LiftsOnSlopes) {
    Ground ground;
    std::vector<float> heights(kSide * kSide);
    const auto set = [&](float slope, float height) {
        for (uint32_t z = 0; z < kSide; ++z)
            for (uint32_t x = 0; x < kSide; ++x) heights[z * kSide + x] = height + slope * (static_cast<float>(x) - 20);
        ASSERT_TRUE(ground.field->SetHeights(0, 0, kSide, kSide, heights));
    };
    const float slope = 0.577f;
    set(slope, 0);
    ASSERT_TRUE(ground.world.Bodies().SetMaterial(ground.body, {.friction = 2}));
    const BodyId cube = ground.Add({.shape = CubeOf(0.5f),
                                    .position = {0, 0.5774, 0},
                                    .rotation = RotationAbout(Vector3(0, 0, 1), kPi / 6),
                                    .material = {.friction = 2}});
    ground.world.Run(1);
    const double before = ground.Y(cube);
    set(slope, 2);
    ground.world.Run(1);
    EXPECT_NEAR(ground.Y(cube), before + 2, 0.02);
    set(-slope, 5);
    ground.world.Run(1);
    const Vector3 place = ground.PlaceOf(cube);
    EXPECT_GT(place.y(), 5 - slope * place.x() + 0.3f);
    EXPECT_LT(ground.Y(cube), 5.8);
}

// What is in the air is not moved but where the ground reaches it, and then no farther than it must.
TEST(RisingGround, LiftsFromTheAirByWhatItMust) {
    Ground ground(NoGravity());
    const BodyId low = ground.Add(CubeOf(0.5f), {0, 1.5, 0}), high = ground.Add(CubeOf(0.5f), {5, 9, 0});
    ASSERT_TRUE(ground.world.Bodies().SetVelocity(low, {0.01f, 0, 0}, Vector3::Zero()));
    ground.world.Step();
    Raise(*ground.field, 2.5f);
    ground.world.Step();
    EXPECT_NEAR(ground.Y(low), 3, 0.02);
    EXPECT_NEAR(ground.Y(high), 9, 1e-6);
    EXPECT_NEAR(ground.world.VelocityOf(low).x(), 0.01f, 1e-3f);
}

// A hill under a stack, and under a heap of which it lifts the middle.
TEST(RisingGround, LiftsWhatIsStacked) {
    for (const float rise : {0.4f, 1.3f, 7.0f}) {
        Ground ground;
        std::vector<BodyId> stack;
        for (int i = 0; i < 8; ++i) stack.push_back(ground.Add(CubeOf(0.5f), {0, 0.5 + i, 0}));
        ground.world.Run(2);
        RaiseAround(*ground.field, 0, 0, 3, rise);
        float fastest = 0;
        for (int step = 0; step < 120; ++step) {
            ground.world.Step();
            for (const BodyId id : stack) fastest = std::max(fastest, Length(ground.world.VelocityOf(id)));
        }
        for (int i = 0; i < 8; ++i)
            EXPECT_NEAR(ground.Y(stack[static_cast<size_t>(i)]), double{rise} + 0.5 + i, 0.02) << rise;
        EXPECT_LT(fastest, 0.2f) << rise;
    }
    Ground ground;
    std::vector<BodyId> heap;
    for (int i = 0; i < 150; ++i)
        heap.push_back(ground.Add(i % 2 ? SphereOf(0.4f) : CubeOf(0.35f),
                                  {0.9 * (i % 5) - 1.8, 0.5 + 0.9 * (i / 25), 0.9 * (i / 5 % 5) - 1.8}));
    ground.world.Run(3);
    std::vector<float> hill(21 * 21);
    for (uint32_t z = 0; z < 21; ++z)
        for (uint32_t x = 0; x < 21; ++x) {
            const float dx = static_cast<float>(x) - 10, dz = static_cast<float>(z) - 10;
            hill[z * 21 + x] = 4 * std::exp(-(dx * dx + dz * dz) / 12);
        }
    ASSERT_TRUE(ground.field->SetHeights(10, 10, 21, 21, hill));
    float fastest = 0;
    for (int step = 0; step < 300; ++step) {
        ground.world.Step();
        for (const BodyId id : heap)
            if (ground.IsOver(id)) fastest = std::max(fastest, Length(ground.world.VelocityOf(id)));
    }
    EXPECT_LT(fastest, 12.0f);
    int count = 0;
    for (const BodyId id : heap) {
        if (!ground.IsOver(id)) continue;
        ++count;
        WorldRayHit hit;
        const Position place = ground.world.PositionOf(id);
        ASSERT_TRUE(ground.world.System().Queries().CastRay({{place.x(), 50, place.z()}, {0, -100, 0}}, hit, {},
                                                            {.accepts = [&](BodyId b) { return b == ground.body; }}));
        EXPECT_GT(place.y(), hit.position.y());
    }
    EXPECT_GT(count, 100);
}

// A part alone: what is beside it stays, asleep and to the bit.
TEST(RisingGround, OfAPartMovesNothingElse) {
    Ground ground;
    const BodyId on = ground.Add(CubeOf(0.5f), {-10, 0.5, 0}), off = ground.Add(CubeOf(0.5f), {10, 0.5, 0});
    ground.world.Run(2);
    const BodyBits before = BitsOf(ground.world, off);
    RaiseAround(*ground.field, -10, 0, 3, 3);
    ground.world.Run(2);
    EXPECT_NEAR(ground.Y(on), 3.5, kRest);
    EXPECT_EQ(BitsOf(ground.world, off), before);
    EXPECT_FALSE(ground.world.Bodies().IsAwake(off));
}

// Of any number between two steps: by parts, by little each, with others between them, sample by sample; and whether
// the state is hashed between them or not.
TEST(RisingGround, OfManyEditsIsThatOfAll) {
    for (const bool isHashed : {false, true}) {
        const auto hash = [&](Ground& ground) {
            if (isHashed) (void)ground.world.System().HashState();
        };
        Ground steps, parts, samples;
        for (Ground* ground : {&steps, &parts, &samples}) {
            ground->Add(CubeOf(0.5f), {0.3, 0.5, 0.3});
            ground->world.Run(2);
        }
        const auto y = [&](Ground& ground) {
            ground.world.Run(1);
            double height = 0;
            ground.world.System().VisitBodies([&](BodyId id) {
                if (!(id == ground.body)) height = ground.Y(id);
            });
            return height;
        };
        for (int i = 1; i <= 13; ++i) {
            Raise(*steps.field, 0.1f * static_cast<float>(i));
            hash(steps);
        }
        EXPECT_NEAR(y(steps), 1.8, kRest);
        for (int i = -3; i <= 3; ++i) {
            RaiseAround(*parts.field, i, 0, 4, 2);
            RaiseAround(*parts.field, 12, 12, 1, static_cast<float>(i));
            hash(parts);
        }
        EXPECT_NEAR(y(parts), 2.5, kRest);
        for (uint32_t z = 12; z < 29; ++z)
            for (uint32_t x = 12; x < 29; ++x) ASSERT_TRUE(samples.field->SetHeights(x, z, 1, 1, std::vector{1.3f}));
        EXPECT_NEAR(y(samples), 1.8, kRest);
    }
}

// The same, to the bit, whether the state is hashed or saved between edits.
TEST(RisingGround, IsTheSameWhoeverLooks) {
    Ground looked, other;
    for (Ground* ground : {&looked, &other}) {
        for (int i = 0; i < 5; ++i) ground->Add(CubeOf(0.5f), {0.2 * i, 0.5 + i, 0});
        ground->world.Run(0.5);
    }
    const auto look = [&] {
        std::vector<std::byte> bytes;
        EXPECT_TRUE(looked.world.System().SaveSnapshot(bytes));
    };
    for (const float height : {1.3f, 0.2f, 0.4f, -3.0f, 2.0f}) {
        for (Ground* ground : {&looked, &other}) RaiseAround(*ground->field, 1, 1, 5, height);
        look();
    }
    for (Ground* ground : {&looked, &other}) SetCellsAround(*ground->field, 0, 0, 3, kHoleCell);
    look();
    for (Ground* ground : {&looked, &other}) Raise(*ground->field, 4);
    look();
    for (Ground* ground : {&looked, &other}) SetCellsAround(*ground->field, 0, 0, 3, 0);
    for (int step = 0; step < 60; ++step) {
        looked.world.Step();
        other.world.Step();
        ASSERT_EQ(looked.world.System().HashState(), other.world.System().HashState()) << step;
    }
}

// A snapshot between an edit and the step has bodies where the edit puts them.
TEST(RisingGround, IsPartOfASnapshot) {
    Ground ground;
    const BodyId cube = ground.Add(CubeOf(0.5f), {0, 0.5, 0});
    ground.world.Run(2);
    Raise(*ground.field, 1.3f);
    std::vector<std::byte> bytes;
    ASSERT_TRUE(ground.world.System().SaveSnapshot(bytes));
    TestWorld peer;
    const ShapePtr shapes[]{ground.field, CubeOf(0.5f)};
    ASSERT_TRUE(peer.System().RestoreSnapshot(bytes, {.shapes = shapes}));
    for (int step = 0; step < 60; ++step) {
        ground.world.Step();
        peer.Step();
    }
    EXPECT_EQ(peer.System().HashState(), ground.world.System().HashState());
    EXPECT_NEAR(peer.PositionOf(cube).y(), 1.8, kRest);
}

// Ground that rises in every step carries what lies on it.
TEST(RisingGround, MayRiseInEveryStep) {
    Ground ground;
    std::vector<BodyId> stack;
    for (int i = 0; i < 3; ++i) stack.push_back(ground.Add(CubeOf(0.5f), {0, 0.5 + i, 0}));
    ground.world.Run(1);
    for (int step = 1; step <= 200; ++step) {
        Raise(*ground.field, 0.05f * static_cast<float>(step));
        ground.world.Step();
    }
    ground.world.Run(1);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(ground.Y(stack[static_cast<size_t>(i)]), 10.5 + i, 0.03);
}

// Bodies that joints hold together move together, also if only some are on the part that rises.
TEST(RisingGround, LiftsMechanismsWhole) {
    Ground ground;
    std::vector<BodyId> parts;
    std::vector<JointId> joints;
    for (int i = 0; i < 6; ++i) parts.push_back(ground.Add(BoxOf(0.4f, 0.15f, 0.2f), {0.9 * i, 0.15, 0}));
    for (size_t i = 0; i < 5; ++i) {
        PointJointSettings joint;
        joint.bodyA = parts[i];
        joint.bodyB = parts[i + 1];
        joint.anchorA.point = {0.9 * static_cast<double>(i) + 0.45, 0.15, 0};
        joints.push_back(ground.world.System().Joints().Create(joint).Value());
    }
    ground.world.Run(2);
    RaiseAround(*ground.field, 0, 0, 2, 1.5f);
    ground.world.Step();
    for (const JointId id : joints) EXPECT_LT(ground.world.System().Joints().GetError(id).distance, 0.01f);
    for (const BodyId id : parts) EXPECT_GT(ground.Y(id), 1.4);
    ground.world.Run(4);
    for (const JointId id : joints) EXPECT_LT(ground.world.System().Joints().GetError(id).distance, 0.01f);
    EXPECT_NEAR(ground.Y(parts[0]), 1.65, 0.05);
    for (const BodyId id : parts) EXPECT_GT(ground.Y(id), 0.1);
}

// What a joint holds at a point of the world stays, with what hangs from it.
TEST(RisingGround, LeavesWhatTheWorldHolds) {
    Ground ground;
    const BodyId post = ground.Add(BoxOf(0.1f, 0.5f, 0.1f), {0, 0.6, 0});
    FixedJointSettings joint;
    joint.bodyA = kWorldBody;
    joint.bodyB = post;
    joint.anchorA.point = {0, 0.6, 0};
    joint.breakForce = 1e5f;
    const JointId id = ground.world.System().Joints().Create(joint).Value();
    ground.world.Run(1);
    Raise(*ground.field, 2);
    ground.world.Run(2);
    EXPECT_NEAR(ground.Y(post), 0.6, kRest);
    EXPECT_TRUE(ground.world.System().Joints().IsEnabled(id));
}

// Below the surface, in a hole, without collisions, kinematic, or in a sensor.
TEST(RisingGround, LeavesWhatIsNotOnIt) {
    Ground ground;
    SetCellsAround(*ground.field, 10, 10, 3, kHoleCell);
    ground.world.Add({.shape = BoxOf(30, 0.5f, 30), .motion = MotionType::Static, .position = {0, -3.5, 0}});
    ground.world.Add({.shape = BoxOf(1, 0.5f, 1), .motion = MotionType::Static, .position = {10, -0.9, 10}});
    const BodyId below = ground.Add(CubeOf(0.5f), {0, -2.5, 0}), fell = ground.Add(CubeOf(0.5f), {12, 1, 12}),
                 inHole = ground.Add(CubeOf(0.5f), {10, 0.1, 10}),
                 ghost = ground.Add({.shape = CubeOf(0.5f), .position = {-5, 0.5, 0}, .gravityFactor = 0, .mask = 0}),
                 kinematic =
                     ground.Add({.shape = CubeOf(0.5f), .motion = MotionType::Kinematic, .position = {5, 0.5, 0}});
    ground.world.Run(3);
    EXPECT_NEAR(ground.Y(fell), -2.5, kRest);
    Raise(*ground.field, 1.3f);
    ground.world.Run(1);
    EXPECT_NEAR(ground.Y(below), -2.5, kRest);
    EXPECT_NEAR(ground.Y(fell), -2.5, kRest);
    EXPECT_NEAR(ground.Y(inHole), 0.1, kRest);
    EXPECT_NEAR(ground.Y(ghost), 0.5, kRest);
    EXPECT_EQ(ground.world.PositionOf(kinematic), Position(5, 0.5, 0));
    SetCellsAround(*ground.field, 10, 10, 3, 0);
    ground.world.Run(1);
    EXPECT_NEAR(ground.Y(fell), -2.5, kRest);
    Raise(*ground.field, 3);  // what is below for its hole was filled stays below
    ground.world.Run(1);
    EXPECT_NEAR(ground.Y(fell), -2.5, kRest);

    TestWorld world(NoGravity());
    const FieldPtr field = FlatField();
    world.Add({.shape = field, .motion = MotionType::Static, .isSensor = true});
    const BodyId cube = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}});
    world.Step();
    Raise(*field, 1.3f);
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(cube).y(), 0.5, 1e-6);
}

// A hole that is smaller than the body above it.
TEST(RisingGround, LiftsOverSmallHoles) {
    Ground ground;
    SetCellsAround(*ground.field, 0, 0, 1, kHoleCell);
    const BodyId plate = ground.Add(BoxOf(2, 0.2f, 2), {0, 0.2, 0});
    ground.world.Run(2);
    Raise(*ground.field, 1.3f);
    ground.world.Run(1);
    EXPECT_NEAR(ground.Y(plate), 1.5, kRest);
}

// An edit that runs out of memory when the world heeds it is heeded by the next call.
TEST(RisingGround, IsHeededOnceThereIsMemory) {
    for (int64_t failing = 1;; ++failing) {
        FailingMemory memory;
        const FieldPtr field = FlatField();
        const auto system = PhysicsSystem::Create({}, nullptr, &memory).Value();
        (void)system->Bodies().Create({.shape = field, .motion = MotionType::Static}).Value();
        std::vector<BodyId> stack;
        for (int i = 0; i < 4; ++i)
            stack.push_back(system->Bodies().Create({.shape = CubeOf(0.5f), .position = {0, 0.5 + i, 0}}).Value());
        for (int i = 0; i < 60; ++i) ASSERT_TRUE(system->Update(kStep));
        Raise(*field, 1.3f);
        memory.FailAt(failing);
        bool hasThrown = false;
        try {
            (void)system->HashState();
        } catch (const std::bad_alloc&) {
            hasThrown = true;
        }
        memory.FailAt(0);
        // All or none: it may be what follows that fails.
        const auto y = [&](size_t i) { return system->Bodies().GetPose(stack[i]).position.y(); };
        const double lifted = y(0) > 1 ? 1.3 : 0;
        if (!hasThrown) {
            EXPECT_EQ(lifted, 1.3);
        }
        for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(y(i), 0.5 + static_cast<double>(i) + lifted, kRest);
        ASSERT_TRUE(system->Update(kStep));
        for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(y(i), 1.8 + static_cast<double>(i), kRest);
        if (!hasThrown) break;
    }
}

}  // namespace
}  // namespace fulcrum::testing
