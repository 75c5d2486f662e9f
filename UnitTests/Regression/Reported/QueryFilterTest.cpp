// Structs of settings that name callables and lists keep those of temporaries, which are gone when the settings are
// used. What dangles shows in builds with the address sanitizer.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Physics/Drawing/WorldDrawing.h>
#include <Fulcrum/Physics/Recording/ReplaySources.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <vector>

namespace fulcrum::testing {
namespace {

// Overwrites the stack on which the temporaries were.
void Overwrite() {
    volatile char room[4096];
    for (volatile char& byte : room) byte = 85;
}

QueryFilter AllBut(BodyId skipped) {
    QueryFilter filter{.ignore = {skipped}, .accepts = [skipped](BodyId id) { return !(id == skipped); }};
    Overwrite();
    return filter;
}

const Ray kDown{{0, 10, 0}, {0, -20, 0}};

struct Pile {
    TestWorld world;
    BodyId boxes[3];
    Pile() {
        for (int i = 0; i < 3; ++i)
            boxes[i] = world.Add({.shape = CubeOf(0.5f), .motion = MotionType::Static, .position = {0, 1.0 * i, 0}});
    }
    BodyId First(const QueryFilter& filter) {
        WorldRayHit hit;
        return world.System().Queries().CastRay(kDown, hit, {}, filter) ? hit.body : BodyId{};
    }
};

TEST(QueryFilter, OwnsPredicatesGivenWhereItIsDeclared) {
    Pile pile;
    const BodyId top = pile.boxes[2], middle = pile.boxes[1], lowest = pile.boxes[0];
    const QueryFilter notTop{.accepts = [&](BodyId id) { return !(id == top); }};
    const QueryFilter lowestAlone{
        .acceptsChild = [wanted = std::make_unique<BodyId>(lowest)](BodyId id, uint32_t) { return id == *wanted; }};
    Overwrite();
    EXPECT_EQ(pile.First(notTop), middle);
    EXPECT_EQ(pile.First(lowestAlone), lowest);
    EXPECT_EQ(pile.First(AllBut(top)), middle);
    QueryFilter changed;
    changed.accepts = [middle](BodyId id) { return id == middle; };
    Overwrite();
    EXPECT_EQ(pile.First(changed), middle);
    changed.accepts = nullptr;
    EXPECT_EQ(pile.First(changed), top);
}

TEST(QueryFilter, OwnsAListGivenWhereItIsDeclared) {
    Pile pile;
    const BodyId top = pile.boxes[2], middle = pile.boxes[1], lowest = pile.boxes[0];
    const QueryFilter inBraces{.ignore = {top, middle}}, array{.ignore = std::array{top}},
        vector{.ignore = std::vector<BodyId>(1000, top)}, address{.ignore = {&top, 1}}, container{.ignore = pile.boxes};
    const QueryFilter copy = vector;
    Overwrite();
    EXPECT_EQ(pile.First(inBraces), lowest);
    EXPECT_EQ(pile.First(array), middle);
    EXPECT_EQ(pile.First(vector), middle);
    EXPECT_EQ(pile.First(copy), middle);
    EXPECT_EQ(pile.First(address), middle);
    EXPECT_FALSE(pile.First(container) == lowest);
}

// A character's query in each frame.
TEST(QueryFilter, TakesNoMemoryForWhatIsSmall) {
    Pile pile;
    const BodyId top = pile.boxes[2];
    const uint64_t before = AllocationCount();
    for (int i = 0; i < 10; ++i) {
        const QueryFilter filter{.ignore = {top},
                                 .accepts = [&pile, top](BodyId id) { return id == pile.boxes[0] || id == top; }};
        EXPECT_EQ(pile.First(filter), pile.boxes[0]);
    }
    EXPECT_EQ(AllocationCount(), before);
}

TEST(SurfaceSettings, OwnWhatIsGivenWhereTheyAreDeclared) {
    const HeightFieldSettings field{.sampleCountX = 3,
                                    .sampleCountZ = 3,
                                    .heights = std::vector<float>(9, 2.5f),
                                    .cells = {0, 1, 0, kHoleCell},
                                    .materials = {SurfaceMaterial{0.1f, 0}, SurfaceMaterial{0.9f, 0.5f}}};
    const TriangleMeshSettings mesh{.vertices = std::vector<Vector3>{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}},
                                    .indices = std::array<uint32_t, 3>{0, 1, 2}};
    Overwrite();
    const auto created = HeightField::Create(field);
    ASSERT_TRUE(created);
    EXPECT_EQ(created.Value()->Height(2, 2), 2.5f);
    EXPECT_TRUE(created.Value()->IsHole(1, 1));
    EXPECT_EQ(created.Value()->Materials()[1].restitution, 0.5f);
    const auto triangle = TriangleMesh::Create(mesh);
    ASSERT_TRUE(triangle);
    EXPECT_EQ(triangle.Value()->TriangleCount(), 1u);
}

TEST(SnapshotSources, OwnWhatIsGivenWhereTheyAreDeclared) {
    TestWorld world, other;
    const ShapePtr shape = CubeOf(1);
    world.Add({.shape = shape});
    std::vector<std::byte> snapshot;
    ASSERT_TRUE(world.System().SaveSnapshot(snapshot));
    const SnapshotSources sources{.shapes = std::vector<ShapePtr>{SphereOf(2), shape}};
    const ReplaySources replay{.shapes = {shape},
                               .customShapes = {{std::string("a name of its ") + "own", nullptr, nullptr}}};
    Overwrite();
    EXPECT_TRUE(other.System().RestoreSnapshot(snapshot, sources));
    EXPECT_EQ(replay.shapes[0], shape);
    EXPECT_EQ(replay.customShapes[0].name, "a name of its own");
}

TEST(DrawingSettings, OwnThePredicate) {
    struct Counter final : DrawingTarget {
        int triangles = 0;
        void Line(const Position&, const Position&, DrawingColor) override {}
        void Triangle(const Position&, const Position&, const Position&, DrawingColor) override { ++triangles; }
    };
    Pile pile;
    const BodyId top = pile.boxes[2];
    const DrawingSettings one{.accepts = [top](BodyId id) { return id == top; }};
    Overwrite();
    Counter counter;
    Draw(pile.world.System(), counter, one);
    EXPECT_EQ(counter.triangles, 12);  // of a box
}

}  // namespace
}  // namespace fulcrum::testing
