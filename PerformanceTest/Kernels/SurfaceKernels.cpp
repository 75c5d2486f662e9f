// Contacts of one shape with a surface, in nanoseconds a pair: bodies at rest anywhere on the terrain of the scene
// convex_on_mesh, turned at random, as a triangle mesh and as a height field.
#include <Fulcrum/Collision/NarrowPhase/SurfaceContact.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

namespace fulcrum {
namespace {

constexpr uint32_t kCells = 100;
constexpr float kCell = 3, kHalf = 0.5f * kCell * kCells;

float HeightAt(uint32_t x, uint32_t z) {
    return static_cast<float>(5 + 5 * std::sin(50.0 * x / kCells) * std::cos(50.0 * z / kCells));
}

std::shared_ptr<const SurfaceShape> MakeSurface(bool isField) {
    std::vector<Vector3> vertices;
    std::vector<float> heights;
    std::vector<uint32_t> indices;
    for (uint32_t z = 0; z <= kCells; ++z)
        for (uint32_t x = 0; x <= kCells; ++x) {
            heights.push_back(HeightAt(x, z));
            vertices.push_back(
                Vector3(kCell * static_cast<float>(x) - kHalf, heights.back(), kCell * static_cast<float>(z) - kHalf));
        }
    if (isField)
        return HeightField::Create({.sampleCountX = kCells + 1,
                                    .sampleCountZ = kCells + 1,
                                    .heights = heights,
                                    .cellSizeX = kCell,
                                    .cellSizeZ = kCell,
                                    .origin = Vector3(-kHalf, 0, -kHalf)})
            .Value();
    for (uint32_t z = 0; z < kCells; ++z)
        for (uint32_t x = 0; x < kCells; ++x) {
            const uint32_t a = z * (kCells + 1) + x, c = a + kCells + 1;
            indices.insert(indices.end(), {a, c, a + 1, a + 1, c, c + 1});
        }
    return TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value();
}

// At the height at which it touches the ground.
std::vector<RelativePose> RestingPoses(const ConvexShape& shape, const SurfaceShape& surface) {
    testing::RandomPoses random(1);
    std::vector<RelativePose> poses;
    while (poses.size() < 1000) {
        const float x = random.Between(-140, 140), z = random.Between(-140, 140);
        const Quaternion rotation = random.Rotation();
        SurfaceHit hit;
        if (!surface.CastRay({Vector3(x, 60, z), Vector3(0, -120, 0)}, hit)) continue;
        const Vector3 down = InverseRotate(rotation, Vector3(-hit.normal));
        const float height = Dot(down, shape.Support(down));
        const Vector3 place = Vector3(x, 60 - 120 * hit.fraction, z) + hit.normal * height;
        poses.push_back(Inverse(RelativePose{place, rotation}));
    }
    return poses;
}

void ShapeOnSurface(benchmark::State& state, const std::shared_ptr<const ConvexShape>& shape, bool isField) {
    const auto surface = MakeSurface(isField);
    const std::vector<RelativePose> poses = RestingPoses(*shape, *surface);
    SurfaceContacts contacts;
    CollideSettings settings;
    size_t i = 0, found = 0;
    for (auto _ : state) {
        CollideSurface(*shape, *surface, poses[i], settings, {}, contacts);
        found += contacts.Manifolds().size();
        i = i + 1 == poses.size() ? 0 : i + 1;
    }
    state.counters["manifolds"] = static_cast<double>(found) / static_cast<double>(state.iterations());
}

// The four bodies of the scene, and one that is curved.
void Sphere05(benchmark::State& state, bool isField) { ShapeOnSurface(state, Sphere::Create(0.5f).Value(), isField); }
void Capsule05(benchmark::State& state, bool isField) {
    ShapeOnSurface(state, Capsule::Create(0.75f, 0.5f).Value(), isField);
}
void BoxOf4(benchmark::State& state, bool isField) {
    ShapeOnSurface(state, Box::Create(Vector3(0.5f, 0.75f, 1)).Value(), isField);
}
void Pyramid(benchmark::State& state, bool isField) {
    const std::vector<Vector3> points{Vector3(0, 1, 0), Vector3(1, 0, 0), Vector3(-1, 0, 0), Vector3(0, 0, 1),
                                      Vector3(0, 0, -1)};
    ShapeOnSurface(state, ConvexHull::Create(points).Value(), isField);
}
void Cylinder05(benchmark::State& state, bool isField) {
    ShapeOnSurface(state, Cylinder::Create(0.75f, 0.5f).Value(), isField);
}

BENCHMARK_CAPTURE(Sphere05, mesh, false)->Name("Surface/sphere/mesh");
BENCHMARK_CAPTURE(Sphere05, field, true)->Name("Surface/sphere/heightField");
BENCHMARK_CAPTURE(Capsule05, mesh, false)->Name("Surface/capsule/mesh");
BENCHMARK_CAPTURE(Capsule05, field, true)->Name("Surface/capsule/heightField");
BENCHMARK_CAPTURE(BoxOf4, mesh, false)->Name("Surface/box/mesh");
BENCHMARK_CAPTURE(BoxOf4, field, true)->Name("Surface/box/heightField");
BENCHMARK_CAPTURE(Pyramid, mesh, false)->Name("Surface/hull/mesh");
BENCHMARK_CAPTURE(Pyramid, field, true)->Name("Surface/hull/heightField");
BENCHMARK_CAPTURE(Cylinder05, mesh, false)->Name("Surface/cylinder/mesh");
BENCHMARK_CAPTURE(Cylinder05, field, true)->Name("Surface/cylinder/heightField");

}  // namespace
}  // namespace fulcrum
