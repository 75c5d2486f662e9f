// Triangle meshes and height fields: time and memory of a build, nanoseconds of a box query, of reading a triangle and
// of a ray, beside brute force. The terrain is that of the scene convex_on_mesh, 20,000 triangles.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/RayTriangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

namespace fulcrum {
namespace {

constexpr float kCell = 3;

float HeightAt(uint32_t x, uint32_t z, uint32_t n) {
    return static_cast<float>(5 + 5 * std::sin(50.0 * x / n) * std::cos(50.0 * z / n));
}

struct Terrain {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    explicit Terrain(uint32_t n) {
        const float half = 0.5f * kCell * static_cast<float>(n);
        for (uint32_t z = 0; z <= n; ++z)
            for (uint32_t x = 0; x <= n; ++x)
                vertices.push_back(Vector3(kCell * static_cast<float>(x) - half, HeightAt(x, z, n),
                                           kCell * static_cast<float>(z) - half));
        for (uint32_t z = 0; z < n; ++z) {
            for (uint32_t x = 0; x < n; ++x) {
                const uint32_t a = z * (n + 1) + x, c = a + n + 1;
                indices.insert(indices.end(), {a, c, a + 1, a + 1, c, c + 1});
            }
        }
    }
    TriangleMeshSettings Settings() const { return {.vertices = vertices, .indices = indices}; }
};

std::shared_ptr<const SurfaceShape> MakeMesh(uint32_t n) { return TriangleMesh::Create(Terrain(n).Settings()).Value(); }

std::shared_ptr<const SurfaceShape> MakeField(uint32_t n) {
    std::vector<float> heights;
    for (uint32_t z = 0; z <= n; ++z)
        for (uint32_t x = 0; x <= n; ++x) heights.push_back(HeightAt(x, z, n));
    HeightFieldSettings settings;
    settings.sampleCountX = settings.sampleCountZ = n + 1;
    settings.heights = heights;
    settings.cellSizeX = settings.cellSizeZ = kCell;
    settings.origin = Vector3(-0.5f * kCell * static_cast<float>(n), 0, -0.5f * kCell * static_cast<float>(n));
    return HeightField::Create(settings).Value();
}

template <auto Make>
const SurfaceShape& Shared() {
    static const std::shared_ptr<const SurfaceShape> shape = Make(100);
    return *shape;
}

// Boxes of the scene's bodies, resting anywhere on the terrain.
std::vector<Bounds> RestingBoxes(const SurfaceShape& shape) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> place(-140, 140);
    std::vector<Bounds> boxes;
    while (boxes.size() < 1764) {
        const float x = place(engine), z = place(engine);
        SurfaceHit hit;
        if (!shape.CastRay({Vector3(x, 60, z), Vector3(0, -120, 0)}, hit)) continue;
        const Vector3 center(x, 60 - 120 * hit.fraction + 0.5f, z);
        Bounds box;
        box.lower = center - Vector3(0.75f, 0.75f, 0.75f);
        box.upper = center + Vector3(0.75f, 0.75f, 0.75f);
        boxes.push_back(box);
    }
    return boxes;
}

template <auto Make>
void BoxQuery(benchmark::State& state) {
    const SurfaceShape& shape = Shared<Make>();
    const std::vector<Bounds> boxes = RestingBoxes(shape);
    size_t i = 0, found = 0;
    for (auto _ : state) {
        uint32_t ids[64];
        found += shape.FindTriangles(boxes[i], ids);
        i = i + 1 == boxes.size() ? 0 : i + 1;
    }
    state.counters["triangles"] = static_cast<double>(found) / static_cast<double>(state.iterations());
}

template <auto Make>
void ReadTriangles(benchmark::State& state) {
    const SurfaceShape& shape = Shared<Make>();
    std::vector<uint32_t> ids;
    for (const Bounds& box : RestingBoxes(shape)) shape.VisitTriangles(box, [&](uint32_t id) { ids.push_back(id); });
    std::vector<TriangleView> views(4);
    size_t i = 0;
    for (auto _ : state) {
        shape.GetTriangles({ids.data() + i, 4}, views.data());
        benchmark::DoNotOptimize(views.data());
        i = i + 8 > ids.size() ? 0 : i + 4;
    }
    state.SetItemsProcessed(4 * static_cast<int64_t>(state.iterations()));
}

std::vector<SurfaceRay> Rays(bool vertical) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> place(-149, 149);
    std::vector<SurfaceRay> rays;
    for (int i = 0; i < 100000; ++i) {
        const float x = place(engine), z = place(engine), toX = place(engine), toZ = place(engine);
        rays.push_back({Vector3(x, 60, z), Vector3(vertical ? 0 : toX - x, -120, vertical ? 0 : toZ - z)});
    }
    return rays;
}

template <auto Make, bool kVertical>
void Ray(benchmark::State& state) {
    const SurfaceShape& shape = Shared<Make>();
    const std::vector<SurfaceRay> rays = Rays(kVertical);
    size_t i = 0, hits = 0;
    for (auto _ : state) {
        SurfaceHit hit;
        hits += shape.CastRay(rays[i], hit) ? 1 : 0;
        i = i + 1 == rays.size() ? 0 : i + 1;
    }
    state.SetItemsProcessed(static_cast<int64_t>(state.iterations()));
    state.counters["hits"] = static_cast<double>(hits) / static_cast<double>(state.iterations());
}

// Brute force: the same test on every triangle.
void RayByBruteForce(benchmark::State& state) {
    const Terrain terrain(100);
    const std::vector<SurfaceRay> rays = Rays(true);
    size_t i = 0;
    for (auto _ : state) {
        const ShearedRay sheared(rays[i].origin, rays[i].displacement);
        float best = 1;
        for (size_t t = 0; t < terrain.indices.size(); t += 3) {
            float fraction;
            bool isBack;
            if (IntersectTriangle(sheared, terrain.vertices[terrain.indices[t]],
                                  terrain.vertices[terrain.indices[t + 1]], terrain.vertices[terrain.indices[t + 2]],
                                  false, best, fraction, isBack))
                best = fraction;
        }
        benchmark::DoNotOptimize(best);
        i = i + 1 == rays.size() ? 0 : i + 1;
    }
    state.SetItemsProcessed(static_cast<int64_t>(state.iterations()));
}

template <auto Make>
void Build(benchmark::State& state) {
    const uint32_t n = static_cast<uint32_t>(state.range(0));
    size_t bytes = 0, triangles = 0;
    for (auto _ : state) {
        const std::shared_ptr<const SurfaceShape> shape = Make(n);
        bytes = shape->MemoryUsed();
        triangles = shape->TriangleCount();
    }
    const double vertices = (n + 1.0) * (n + 1.0) * sizeof(Vector3);
    state.counters["bytes/triangle"] = static_cast<double>(bytes) / static_cast<double>(triangles);
    state.counters["overVertices"] = (static_cast<double>(bytes) - vertices) / static_cast<double>(triangles);
}

BENCHMARK(BoxQuery<MakeMesh>);
BENCHMARK(BoxQuery<MakeField>);
BENCHMARK(ReadTriangles<MakeMesh>);
BENCHMARK(ReadTriangles<MakeField>);
BENCHMARK(Ray<MakeMesh, true>)->Name("VerticalRay<MakeMesh>");
BENCHMARK(Ray<MakeField, true>)->Name("VerticalRay<MakeField>");
BENCHMARK(Ray<MakeMesh, false>)->Name("SlantedRay<MakeMesh>");
BENCHMARK(Ray<MakeField, false>)->Name("SlantedRay<MakeField>");
BENCHMARK(RayByBruteForce);
BENCHMARK(Build<MakeMesh>)->Arg(100)->Arg(400)->Unit(benchmark::kMillisecond);
BENCHMARK(Build<MakeField>)->Arg(100)->Arg(400)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace fulcrum
