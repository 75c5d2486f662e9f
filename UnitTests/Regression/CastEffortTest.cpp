// What a cast of continuous collision finds, and what it costs, follows from what is near the body: not from how far
// the body turns or how large it is, from how many triangles it overlaps as the step begins, or from the order in which
// trees find what is in its way. Each of these took seconds a step, or other bits after a restored snapshot.
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Physics/Snapshots/SnapshotTesting.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>
#include <ctime>

namespace fulcrum::testing {
namespace {

// A wavy grid of cells x cells squares of two triangles, `half` m from its center to its sides.
ShapePtr WavesOf(int cells, float half) {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    const float edge = 2 * half / static_cast<float>(cells);
    for (int z = 0; z <= cells; ++z)
        for (int x = 0; x <= cells; ++x) {
            const float u = static_cast<float>(x) * edge - half, v = static_cast<float>(z) * edge - half;
            vertices.push_back(Vector3(u, 0.05f * half * std::sin(9 * u / half) * std::sin(7 * v / half), v));
        }
    for (int z = 0; z < cells; ++z)
        for (int x = 0; x < cells; ++x) {
            const uint32_t at = static_cast<uint32_t>(z * (cells + 1) + x),
                           below = at + static_cast<uint32_t>(cells) + 1;
            indices.insert(indices.end(), {at, below, at + 1, at + 1, below, below + 1});
        }
    return TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value();
}

double ProcessorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// s of processor time of the slowest of ten steps of a body with continuous collision that overlaps a whole mesh.
double SlowestStep(const ShapePtr& shape, float spin) {
    TestWorld world;
    world.Add({.shape = WavesOf(70, 1), .motion = MotionType::Static});
    world.Add({.shape = shape,
               .position = {0.03, 0.3, 0.02},
               .linearVelocity = {40, -30, 10},
               .angularVelocity = Vector3(0.6f, 0.5f, 0.62f) * spin,
               .maxAngularSpeed = 1e6f,
               .continuous = ContinuousCollision::LinearAndAngular});
    double slowest = 0;
    for (int step = 0; step < 10; ++step) {
        const double begin = ProcessorSeconds();
        world.Step();
        slowest = std::max(slowest, ProcessorSeconds() - begin);
    }
    EXPECT_TRUE(world.AllFinite());
    return slowest;
}

TEST(CastEffort, IsBoundedHoweverFastABodyTurnsAmongTriangles) {
    const ShapePtr rods = CompoundOf(
        {{.shape = Cylinder::Create(1, 0.1f).Value()}, {.shape = CapsuleOf(1, 0.1f), .position = {0.3f, 0.2f, 0}}});
    for (const ShapePtr& shape : {rods, CubeOf(1), SphereOf(1)})
        for (const float spin : {0.0f, 10.0f, 100.0f, 1e3f, 3e4f, 1e6f})
            EXPECT_LT(SlowestStep(shape, spin), (kIsSanitized ? 20 : 1) * 0.6)
                << ShapeTypeName(shape->Type()) << " at " << spin << " rad/s";
}

// Whose far ends move by kilometers in a step, while its middle lies on a mesh and touches it in all steps: all
// iterations were spent at each triangle, and 64 rounds on the same undecided cast.
TEST(CastEffort, IsBoundedHoweverLargeABodyTurnsOnAMesh) {
    const ShapePtr waves = WavesOf(8, 4);
    for (uint32_t seed = 0; seed < static_cast<uint32_t>(Cases(40)); ++seed) {
        RandomPoses random(seed);
        const float size = std::pow(10.0f, random.Between(0, 5)), thin = std::pow(10.0f, random.Between(-2, 2));
        const ShapePtr large = seed % 3 == 0   ? BoxOf(size, thin, 0.7f * size)
                               : seed % 3 == 1 ? Cylinder::Create(size, thin).Value()
                                               : CapsuleOf(size, thin);
        TestWorld world;
        world.Add({.shape = waves, .motion = MotionType::Static});
        world.Add({.shape = BoxOf(10, 0.5f, 10), .motion = MotionType::Static, .position = {0, -0.5, 0}});
        const Vector3 at = random.InBox(random.Between(1, 30));
        world.Add({.shape = CompoundOf({{.shape = large, .position = {0.3f, 0.2f, 0}}, {.shape = CubeOf(0.5f)}}),
                   .position = at.cast<double>(),
                   .rotation = random.Rotation(),
                   .linearVelocity = random.InBox(std::pow(10.0f, random.Between(0, 3))),
                   .angularVelocity = random.InBox(std::pow(10.0f, random.Between(0, 3))),
                   .maxAngularSpeed = 1e4f,
                   .continuous = ContinuousCollision::LinearAndAngular});
        for (int step = 0; step < 6; ++step) {
            const double begin = ProcessorSeconds();
            world.Step();
            EXPECT_LT(ProcessorSeconds() - begin, (kIsSanitized ? 20 : 1) * 0.6) << "seed " << seed;
        }
        EXPECT_TRUE(world.AllFinite());
    }
}

// Fast bodies wedged among many others: a world that was restored builds its trees anew, in another order.
TEST(CastEffort, FindsTheSameInARestoredWorld) {
    for (uint32_t seed = 0; seed < static_cast<uint32_t>(Cases(120)); ++seed) {
        RandomPoses random(seed);
        const float speedOf = random.Between(1, 100), spinOf = random.Between(10, 400);
        TestWorld world, restored;
        for (int i = 0; i < 60; ++i) {
            const Vector3 at = random.InBox(1);
            world.Add({.shape = i % 3 ? CubeOf(0.2f) : CapsuleOf(0.3f, 0.1f),
                       .motion = i % 4 ? MotionType::Static : MotionType::Dynamic,
                       .position = at.cast<double>(),
                       .rotation = random.Rotation()});
        }
        const ShapePtr arms = CompoundOf({{.shape = BoxOf(0.8f, 0.02f, 0.02f)}, {.shape = BoxOf(0.02f, 0.8f, 0.02f)}});
        for (int i = 0; i < 3; ++i) {
            const Vector3 at = random.InBox(1), velocity = random.InBox(speedOf), spin = random.InBox(spinOf);
            world.Add({.shape = arms,
                       .position = at.cast<double>(),
                       .rotation = random.Rotation(),
                       .linearVelocity = velocity,
                       .angularVelocity = spin,
                       .maxAngularSpeed = 1e4f,
                       .continuous = ContinuousCollision::LinearAndAngular});
        }
        for (int step = 0; step < 12; ++step) {
            const Assets assets(world.System());
            ASSERT_TRUE(restored.System().RestoreSnapshot(SnapshotOf(world.System()), assets.All()));
            world.Step();
            restored.Step();
            ASSERT_EQ(world.System().HashState(), restored.System().HashState()) << "seed " << seed << " step " << step;
        }
    }
}

}  // namespace
}  // namespace fulcrum::testing
