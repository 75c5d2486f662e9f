// Height fields that are edited under bodies, in one world or in several: nothing needs to be told to the worlds.
// Sleepers at the changed part wake, others do not; kept manifolds, trees and bounds follow; hashes and snapshots are
// of the content, not of how it came about.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/ShapeHash.h>
#include <Fulcrum/Physics/Snapshot.h>

namespace fulcrum::testing {
namespace {

using FieldPtr = std::shared_ptr<HeightField>;
constexpr uint32_t kSide = 41;  // samples, 1 m apart, about the origin

FieldPtr FlatField(float height = 0, HeightPrecision precision = HeightPrecision::Float) {
    const std::vector<float> heights(kSide * kSide, height);
    return HeightField::Create({.sampleCountX = kSide,
                                .sampleCountZ = kSide,
                                .heights = heights,
                                .origin = {-20, 0, -20},
                                .precision = precision,
                                .lowestHeight = -4,
                                .highestHeight = 4})
        .Value();
}

// Sets the samples within 2 m of (x, z), a square.
Bounds Level(HeightField& field, int x, int z, float height) {
    const std::vector<float> heights(25, height);
    return field.SetHeights(static_cast<uint32_t>(x + 18), static_cast<uint32_t>(z + 18), 5, 5, heights).Value();
}
void Cut(HeightField& field, int x, int z, uint8_t cell = kHoleCell) {
    const std::vector<uint8_t> cells(16, cell);
    ASSERT_TRUE(field.SetCells(static_cast<uint32_t>(x + 18), static_cast<uint32_t>(z + 18), 4, 4, cells));
}

// Cubes of 1 m asleep on a field, at x = -10 and 10.
struct Terrain {
    explicit Terrain(MotionType motion = MotionType::Static, const Position& at = Position::Zero(),
                     const Quaternion& rotation = {}, FieldPtr shared = FlatField())
        : field(std::move(shared)) {
        ground = world.Add({.shape = field, .motion = motion, .position = at, .rotation = rotation});
        for (const float x : {-10.0f, 10.0f})
            cubes.push_back(world.Add({.shape = CubeOf(0.5f),
                                       .position = at + Rotate(rotation, Vector3(x, 0.5f, 0)).cast<double>(),
                                       .rotation = rotation}));
        world.Run(2);
        for (const BodyId cube : cubes) EXPECT_FALSE(world.Bodies().IsAwake(cube));
    }
    double Y(int cube) { return world.PositionOf(cubes[static_cast<size_t>(cube)]).y(); }
    bool IsAwake(int cube) { return world.Bodies().IsAwake(cubes[static_cast<size_t>(cube)]); }

    TestWorld world;
    FieldPtr field;
    BodyId ground;
    std::vector<BodyId> cubes;
};

constexpr double kRest = 0.01;  // m, that a cube at rest may be off

TEST(ShapeEdits, WakeWhatLiesOnTheChangedPartAlone) {
    for (const MotionType motion : {MotionType::Static, MotionType::Kinematic}) {
        Terrain terrain(motion);
        Level(*terrain.field, -10, 0, -1);
        terrain.world.Step();
        EXPECT_TRUE(terrain.IsAwake(0));
        EXPECT_FALSE(terrain.IsAwake(1));
        terrain.world.Run(1.5);
        EXPECT_NEAR(terrain.Y(0), -0.5, kRest);
        Level(*terrain.field, 10, 0, 0.3f);
        terrain.world.Run(1.5);
        EXPECT_NEAR(terrain.Y(1), 0.8, kRest);
        EXPECT_NEAR(terrain.Y(0), -0.5, kRest);
        Cut(*terrain.field, 10, 0);
        terrain.world.Run(1);
        EXPECT_LT(terrain.Y(1), -2);
    }
}

// Far from the origin, and turned by a right angle.
TEST(ShapeEdits, FollowThePoseOfTheBody) {
    Terrain terrain(MotionType::Static, {1e6, 5, 0}, RotationAbout(Vector3(0, 1, 0), kPi / 2));
    Level(*terrain.field, -10, 0, -1);
    terrain.world.Step();
    EXPECT_TRUE(terrain.IsAwake(0));
    EXPECT_FALSE(terrain.IsAwake(1));
    terrain.world.Run(1.5);
    EXPECT_NEAR(terrain.Y(0), 4.5, kRest);
}

// What does not sleep, and hardly moves, keeps no manifold of what was there: one cube sinks, one is lifted.
TEST(ShapeEdits, AreHeededByKeptManifolds) {
    TestWorld world(NoSleep());
    const FieldPtr field = FlatField();
    world.Add({.shape = field, .motion = MotionType::Static});
    const BodyId sinks = world.Add({.shape = CubeOf(0.5f), .position = {-10, 0.5, 0}}),
                 rises = world.Add({.shape = CubeOf(0.5f), .position = {10, 0.5, 0}});
    world.Run(1);
    Level(*field, -10, 0, -0.5f);
    Level(*field, 10, 0, 0.2f);
    world.Run(1);
    EXPECT_NEAR(world.PositionOf(sinks).y(), 0, kRest);
    EXPECT_NEAR(world.PositionOf(rises).y(), 0.7, kRest);
}

// A hill raised far above the old bounds lifts what hovers there, and rays see it before the next step.
TEST(ShapeEdits, AreHeededByBoundsAndTrees) {
    TestWorld world(NoGravity());
    const FieldPtr field = FlatField();
    const BodyId ground = world.Add({.shape = field, .motion = MotionType::Static});
    const BodyId low = world.Add({.shape = CubeOf(0.5f), .position = {10, 3.2, 0}});
    world.Run(1);
    const auto heightAt = [&](double x) {
        WorldRayHit hit;
        EXPECT_TRUE(world.System().Queries().CastRay({{x, 50, 0}, {0, -100, 0}}, hit, {}, {.ignore = {&low, 1}}));
        return hit.position.y();
    };
    EXPECT_NEAR(heightAt(10), 0, 1e-4);
    Level(*field, 10, 0, 3);
    EXPECT_NEAR(heightAt(10), 3, 1e-4);
    EXPECT_NEAR(world.Bodies().GetBounds(ground).upper.y(), 3, 1e-3);
    world.Step();
    EXPECT_NEAR(heightAt(10), 3, 1e-4);
    world.Run(1);
    EXPECT_GT(world.PositionOf(low).y(), 3.4);
    Level(*field, 10, 0, -6);
    EXPECT_NEAR(heightAt(10), -6, 1e-4);
    world.Step();
    EXPECT_NEAR(heightAt(10), -6, 1e-4);
}

// An edit that changes nothing wakes nobody, and has no version of its own.
TEST(ShapeEdits, ThatChangeNothingAreNone) {
    Terrain terrain;
    const uint64_t version = terrain.field->Version();
    EXPECT_TRUE(Level(*terrain.field, -10, 0, 0).IsEmpty());
    Cut(*terrain.field, -10, 0, 0);
    EXPECT_EQ(terrain.field->Version(), version);
    terrain.world.Step();
    EXPECT_FALSE(terrain.IsAwake(0));
    Level(*terrain.field, -10, 0, -1);
    EXPECT_GT(terrain.field->Version(), version);
    EXPECT_EQ(LatestShapeVersion(), terrain.field->Version());
}

// Worlds and bodies that share a field all heed its edits, each when it steps next; a world without it heeds none.
TEST(ShapeEdits, ReachAllWhoShareTheField) {
    const FieldPtr field = FlatField();
    Terrain first(MotionType::Static, Position::Zero(), {}, field), second(MotionType::Static, {0, 7, 0}, {}, field),
        other;
    const BodyId twin = second.world.Add({.shape = field, .motion = MotionType::Static, .position = {0, 0, 100}});
    const BodyId onTwin = second.world.Add({.shape = CubeOf(0.5f), .position = {-10, 0.5, 100}});
    second.world.Run(2);
    ASSERT_FALSE(second.world.Bodies().IsAwake(onTwin));
    Level(*field, -10, 0, -1);
    first.world.Run(1.5);
    second.world.Run(1.5);
    other.world.Step();
    EXPECT_NEAR(first.Y(0), -0.5, kRest);
    EXPECT_NEAR(second.Y(0), 6.5, kRest);
    EXPECT_NEAR(second.world.PositionOf(onTwin).y(), -0.5, kRest);
    EXPECT_FALSE(other.IsAwake(0));
    ASSERT_TRUE(second.world.Bodies().Remove(twin));
    Level(*field, -10, 0, -0.7f);
    second.world.Run(1);
    EXPECT_NEAR(second.Y(0), 6.8, kRest);
}

// More edits at once than are told apart still reach every part that they changed.
TEST(ShapeEdits, OfAnyNumberAreHeededTogether) {
    Terrain terrain;
    Level(*terrain.field, -10, 0, -1);
    for (int i = 0; i < 200; ++i) Level(*terrain.field, i % 5, 12, static_cast<float>(i + 1) * 0.01f);
    Level(*terrain.field, 10, 0, -1);
    terrain.world.Run(1.5);
    EXPECT_NEAR(terrain.Y(0), -0.5, kRest);
    EXPECT_NEAR(terrain.Y(1), -0.5, kRest);
}

// A field that is a sensor holds nothing; what is in it changes with it.
TEST(ShapeEdits, OfASensorWakeNobody) {
    TestWorld world(NoGravity());
    const FieldPtr field = FlatField();
    const BodyId sensor = world.Add({.shape = field, .motion = MotionType::Static, .isSensor = true});
    const BodyId cube = world.Add({.shape = CubeOf(0.5f), .position = {-10, 2, 0}, .startAsleep = true});
    world.Step();
    EXPECT_TRUE(world.System().BodiesInside(sensor).empty());
    Level(*field, -10, 0, 2);
    world.Step();
    EXPECT_FALSE(world.Bodies().IsAwake(cube));
    EXPECT_EQ(world.System().BodiesInside(sensor).size(), 1u);
}

// ---- Hashes and snapshots

TEST(ShapeEdits, HashesAreOfTheContent) {
    for (const HeightPrecision precision : {HeightPrecision::Float, HeightPrecision::Steps16}) {
        const FieldPtr field = FlatField(0, precision);
        const uint64_t flat = ContentHash(*field);
        Level(*field, 3, -5, 1);
        const uint64_t raised = ContentHash(*field);
        EXPECT_NE(raised, flat);
        const auto loaded = LoadShape(SaveShape(*field).Value());
        EXPECT_EQ(ContentHash(*loaded.Value()), raised);
        Cut(*field, 9, 9);
        EXPECT_NE(ContentHash(*field), raised);
        Cut(*field, 9, 9, 0);
        EXPECT_EQ(ContentHash(*field), raised);
        Level(*field, 3, -5, 0);
        EXPECT_EQ(ContentHash(*field), flat);
        EXPECT_EQ(SaveShape(*field).Value(), SaveShape(*FlatField(0, precision)).Value());
    }
    const CompoundShape::ChildSettings children[]{{.shape = CubeOf(1)}, {.shape = CubeOf(1), .position = {3, 0, 0}}};
    const auto compound = MutableCompound::Create(children).Value();
    EXPECT_EQ(compound->Version(), 0u);
    const uint64_t before = ContentHash(*compound);
    ASSERT_TRUE(compound->Move(compound->IdOf(0), {0, 1, 0}, {}));
    EXPECT_NE(ContentHash(*compound), before);
    EXPECT_NE(compound->Version(), 0u);
}

// One peer edits, the other is given the heights as they are.
TEST(ShapeEdits, GiveTheStateThatTheSameHeightsGive) {
    TestWorld edits, loads;
    const FieldPtr field = FlatField(), loaded = FlatField();
    Level(*loaded, -10, 0, 1.5f);
    const auto fill = [](TestWorld& world, const ShapePtr& ground) {
        world.Add({.shape = ground, .motion = MotionType::Static});
        world.Add({.shape = CubeOf(0.5f), .position = {-10, 2.5, 0}});
    };
    fill(edits, field);
    fill(loads, loaded);
    EXPECT_NE(edits.System().HashState(), loads.System().HashState());
    Level(*field, -10, 0, 1.5f);
    // Until the next step the edited one is listed to be searched for pairs again.
    for (int step = 0; step < 60; ++step) {
        edits.Step();
        loads.Step();
        ASSERT_EQ(edits.System().HashState(), loads.System().HashState()) << step;
    }
}

TEST(ShapeEdits, ASnapshotFromBeforeIsRefusedUntilItsHeightsAreThere) {
    Terrain terrain;
    std::vector<std::byte> before;
    ASSERT_TRUE(terrain.world.System().SaveSnapshot(before));
    const uint64_t hash = terrain.world.System().HashState();
    Level(*terrain.field, -10, 0, -1);
    const Status refused = terrain.world.System().RestoreSnapshot(before);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.GetError().code, ErrorCode::UnknownId);
    const ShapePtr flat = FlatField();
    {
        Terrain copy;
        Level(*copy.field, -10, 0, -1);
        ASSERT_TRUE(copy.world.System().RestoreSnapshot(before, {.shapes = {&flat, 1}}));
        EXPECT_EQ(copy.world.System().HashState(), hash);
    }
    Level(*terrain.field, -10, 0, 0);
    ASSERT_TRUE(terrain.world.System().RestoreSnapshot(before));
    EXPECT_EQ(terrain.world.System().HashState(), hash);
    terrain.world.Step();
    EXPECT_FALSE(terrain.IsAwake(0));
}

// An edit that no step has heeded yet is part of what is saved, also as a delta.
TEST(ShapeEdits, ASnapshotBetweenAnEditAndTheNextStepHasBoth) {
    Terrain terrain;
    std::vector<std::byte> before, after, delta, rebuilt;
    ASSERT_TRUE(terrain.world.System().SaveSnapshot(before));
    Level(*terrain.field, -10, 0, -1);
    ASSERT_TRUE(terrain.world.System().SaveSnapshot(after));
    ASSERT_TRUE(MakeSnapshotDelta(before, after, delta));
    ASSERT_TRUE(ApplySnapshotDelta(before, delta, rebuilt));
    ASSERT_EQ(rebuilt, after);
    TestWorld peer;
    const ShapePtr shapes[]{terrain.field, CubeOf(0.5f)};
    ASSERT_TRUE(peer.System().RestoreSnapshot(rebuilt, {.shapes = shapes}));
    EXPECT_EQ(peer.System().HashState(), terrain.world.System().HashState());
    for (int step = 0; step < 90; ++step) {
        terrain.world.Step();
        peer.Step();
    }
    EXPECT_EQ(peer.System().HashState(), terrain.world.System().HashState());
    EXPECT_NEAR(terrain.Y(0), -0.5, kRest);
}

TEST(ShapeEdits, BodiesSavedBeforeAreRefused) {
    Terrain terrain;
    std::vector<std::byte> bytes;
    ASSERT_TRUE(terrain.world.System().SaveBodies({&terrain.ground, 1}, bytes));
    ASSERT_TRUE(terrain.world.System().RestoreBodies(bytes));
    Level(*terrain.field, -10, 0, -1);
    EXPECT_FALSE(terrain.world.System().RestoreBodies(bytes));
}

}  // namespace
}  // namespace fulcrum::testing
