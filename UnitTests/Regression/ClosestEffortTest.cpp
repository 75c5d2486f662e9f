// The closest points of two shapes of many pieces take time in proportion to their pieces, not to the pairs of them:
// two fields of 32 by 32 cells took 0.8 s, of 64 by 64 12 s. Nor does each pair of pieces that overlap take a
// millisecond where EPA fails: a compound of four children at a mesh of 128 triangles took 0.4 s.
#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>
#include <cmath>
#include <ctime>

namespace fulcrum::testing {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

double ProcessorSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

using SurfacePtr = std::shared_ptr<const SurfaceShape>;

std::vector<float> RandomHeights(RandomPoses& random, int cells) {
    std::vector<float> heights;
    for (int i = 0; i < (cells + 1) * (cells + 1); ++i) heights.push_back(random.Between(0, 0.5f));
    return heights;
}

// cells x cells squares of 1 m, about the origin.
SurfacePtr FieldOf(const std::vector<float>& heights, int cells, bool isMesh) {
    const float first = -0.5f * static_cast<float>(cells);
    const auto samples = static_cast<uint32_t>(cells + 1);
    if (!isMesh)
        return HeightField::Create({.sampleCountX = samples,
                                    .sampleCountZ = samples,
                                    .heights = heights,
                                    .origin = Vector3(first, 0, first),
                                    .isTwoSided = true})
            .Value();
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    for (uint32_t z = 0; z < samples; ++z)
        for (uint32_t x = 0; x < samples; ++x) {
            const uint32_t at = z * samples + x;
            vertices.push_back(Vector3(first + static_cast<float>(x), heights[at], first + static_cast<float>(z)));
            if (x + 1 < samples && z + 1 < samples)
                for (const uint32_t corner : {at, at + samples, at + 1, at + 1, at + samples, at + samples + 1})
                    indices.push_back(corner);
        }
    return TriangleMesh::Create({.vertices = vertices, .indices = indices, .isTwoSided = true}).Value();
}

TEST(ClosestEffort, OfFieldsFollowsTheirTriangles) {
    constexpr int kCells = 64;
    const RelativePose poses[] = {
        {Vector3(0.3f, 5, 0.1f), {}},
        {Vector3(0.3f, 50, 0.1f), {}},
        {Vector3(kCells + 20, 0, 0), {}},
        {Vector3(0, 0.8f * kCells, 0), RotationFromVector(Vector3(0, 0, 0.8f))},
        {Vector3(0, 0.02f, 0), {}},  // in each other
        {Vector3(0.2f, 0, 0), RotationFromVector(Vector3(0.8f, 0, 0))},
    };
    for (const bool isMesh : {false, true}) {
        RandomPoses random(1);
        const SurfacePtr a = FieldOf(RandomHeights(random, kCells), kCells, isMesh),
                         b = FieldOf(RandomHeights(random, kCells), kCells, isMesh);
        for (const RelativePose& pose : poses) {
            const double begin = ProcessorSeconds();
            ClosestPoints closest;
            EXPECT_TRUE(FindClosestPoints(*a, *b, pose, kInfinity, closest));
            (void)Overlap(*a, *b, pose);
            EXPECT_LT(ProcessorSeconds() - begin, kIsSanitized ? 20 : 0.6) << pose.position.y();
        }
    }
}

// Spikes up to 10^12 m: most triangles overlap, within the rounding of their corners.
TEST(ClosestEffort, OfFieldsWithSpikesIsBounded) {
    RandomPoses random(2);
    constexpr int kCells = 8;
    for (int i = 0; i < Cases(40); ++i) {
        SurfacePtr fields[2];
        for (SurfacePtr& field : fields) {
            std::vector<float> heights = RandomHeights(random, kCells);
            const bool isMesh = i % 2 == 0;  // of longer spikes nothing is left by its repair
            const float spike = std::pow(10.0f, random.Between(3, isMesh ? 6 : 12)), chance = random.Between(0.05f, 1);
            for (float& height : heights)
                if (random.Chance(chance)) height = random.Between(-spike, spike);
            field = FieldOf(heights, kCells, isMesh);
        }
        const RelativePose pose{random.InBox(2), random.Rotation()};
        const double begin = ProcessorSeconds();
        ClosestPoints closest;
        EXPECT_TRUE(FindClosestPoints(*fields[0], *fields[1], pose, kInfinity, closest)) << i;
        EXPECT_TRUE(std::isfinite(closest.distance) && IsFinite(closest.normal)) << i;
        EXPECT_LT(ProcessorSeconds() - begin, kIsSanitized ? 10 : 0.3) << i;
    }
}

// Children so far from each other that the rounding of their places is hundreds of meters: to them all triangles of a
// mesh are at one place, and overlap where one does. EPA fails for most of these pairs.
TEST(ClosestEffort, OfFarChildrenIsBounded) {
    RandomPoses random(4);
    constexpr float kFar = 4.5e9f;
    const CompoundShape::ChildSettings children[] = {
        {.shape = Cylinder::Create(0.3f, 0.45f).Value(), .position = Vector3(0.1f, 0.7f, -kFar)},
        {.shape = TaperedCapsule::Create(0.5f, 0.3f, 0.35f).Value(), .position = Vector3(0.1f, -0.3f, -kFar)},
        {.shape = SphereOf(0.2f), .position = Vector3(-0.8f, 0.6f, -kFar)},
        {.shape = Cylinder::CreateTapered(0.3f, 0.2f, 0.45f).Value(), .position = Vector3(0, 0.2f, 2 * kFar)}};
    const auto compound = Compound::Create(children).Value();
    const Vector3 first = compound->PoseOf(compound->ChildAt(0)).position;
    double seconds = 0;
    for (int i = 0; i < Cases(60); ++i) {
        const SurfacePtr field = FieldOf(RandomHeights(random, 8), 8, i % 2 == 0);
        const Quaternion rotation = random.Rotation();
        const Vector3 there = -Rotate(rotation, first);
        const double begin = ProcessorSeconds();
        ClosestPoints closest;
        EXPECT_TRUE(FindClosestPoints(*field, *compound, {there, rotation}, kInfinity, closest)) << i;
        EXPECT_TRUE(std::isfinite(closest.distance) && IsFinite(closest.normal)) << i;
        seconds += ProcessorSeconds() - begin;
    }
    EXPECT_LT(seconds, kIsSanitized ? 60 : 4);
}

// Whatever is left out is farther away: each triangle of one against the other shape alone finds nothing closer.
TEST(ClosestEffort, FindsWhatAllPairsFind) {
    RandomPoses random(3);
    for (int i = 0; i < Cases(200); ++i) {
        constexpr int kCells = 7;
        const std::vector<float> heights = RandomHeights(random, kCells);
        const SurfacePtr field = FieldOf(heights, kCells, i % 2 == 0);
        const SurfacePtr second = FieldOf(RandomHeights(random, kCells), kCells, i % 4 < 2);
        std::vector<CompoundShape::ChildSettings> children;
        for (int k = 0; k < 12; ++k)
            children.push_back({.shape = k % 2 ? CapsuleOf(0.4f, 0.1f) : BoxOf(0.2f, 0.1f, 0.3f),
                                .position = random.InBox(3),
                                .rotation = random.Rotation()});
        const ShapePtr compound = Compound::Create(children).Value();
        const Shape& other = i % 3 == 0 ? *compound : *second;
        const RelativePose pose{random.InBox(random.Chance(0.5f) ? 2 : 12), random.Rotation()};
        float least = kInfinity;
        for (uint32_t id = 0; id < field->TriangleIdEnd(); ++id) {
            const TriangleView view = field->GetTriangle(id);
            const uint32_t indices[] = {0, 1, 2};
            const auto alone =
                TriangleMesh::Create({.vertices = view.vertices, .indices = indices, .isTwoSided = true}).Value();
            ClosestPoints closest;
            if (FindClosestPoints(*alone, other, pose, kInfinity, closest)) least = std::min(least, closest.distance);
        }
        const RelativePose back = Inverse(pose);
        ClosestPoints closest, swapped;
        ASSERT_TRUE(FindClosestPoints(*field, other, pose, kInfinity, closest));
        ASSERT_TRUE(FindClosestPoints(other, *field, back, kInfinity, swapped));
        // Of sizes of 10 m: 1e-6 of them apart, 3e-5 where they overlap.
        const float tolerance = least > 0 ? 3e-5f : 6e-4f;
        EXPECT_NEAR(closest.distance, least, tolerance) << i;
        EXPECT_NEAR(swapped.distance, least, tolerance) << i;
        if (std::fabs(least) > tolerance) {
            EXPECT_EQ(Overlap(*field, other, pose), least < 0) << i;
            EXPECT_EQ(Overlap(other, *field, back), least < 0) << i;
        }
        ClosestPoints near;
        EXPECT_EQ(FindClosestPoints(*field, other, pose, std::max(least, 0.0f) + 0.01f, near), true) << i;
        EXPECT_EQ(near.distance, closest.distance) << i;
        if (least > 0.1f) {
            EXPECT_FALSE(FindClosestPoints(*field, other, pose, least - 0.01f, near)) << i;
        }
    }
}

}  // namespace
}  // namespace fulcrum::testing
