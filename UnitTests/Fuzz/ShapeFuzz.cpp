// Shape files, points of hulls, triangles of meshes. Whatever is accepted must be usable: finite bounds and mass, rays
// and contacts, and a file that reads the same.
#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/ShapeHash.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Fuzz/FuzzTargets.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {

namespace {

void Use(const ShapePtr& shape) {
    const Bounds& bounds = shape->LocalBounds();
    Promise(shape->Type() == ShapeType::Empty || shape->Type() == ShapeType::Plane ||
                (IsFinite(bounds.lower) && IsFinite(bounds.upper) && bounds.lower.isAtMost(bounds.upper)),
            "bounds of a shape are finite and not inverted");
    const MassProperties& mass = shape->Mass();
    Promise(std::isfinite(mass.volume) && mass.volume >= 0 && IsFinite(mass.principalInertia) &&
                IsFinite(mass.centerOfMass),
            "the mass of a shape is finite");
    const auto file = SaveShape(*shape);
    if (file) {
        const auto again = LoadShape(file.Value());
        Promise(static_cast<bool>(again), "what was saved can be loaded");
        Promise(SaveShape(*again.Value()).Value() == file.Value(), "what was loaded is saved to the same bytes");
        Promise(ContentHash(*again.Value()) == ContentHash(*shape), "what was loaded has the same hash");
    }
    RandomPoses random(1);
    const float size = std::min(shape->OuterRadius(), 1e6f);
    for (int i = 0; i < 8; ++i) {
        const Vector3 from = random.InBox(2 * size), to = random.InBox(size);
        const RayCaster caster(Ray{from.cast<double>(), to - from});
        RayHit hit;
        if (!caster.IsValid() || !caster.CastClosest(*shape, {Position::Zero(), random.Rotation()}, {}, hit)) continue;
        Promise(hit.fraction >= 0 && hit.fraction <= 1 && IsFinite(hit.normal), "a ray's hit is on the ray");
    }
    TestWorld world;
    const auto body = world.Bodies().Create({.shape = shape, .motion = MotionType::Static});
    const BodySettings ball{.shape = SphereOf(0.25f),
                            .position = {0, double{std::min(bounds.upper.y(), 1e6f)} + 0.3, 0}};
    if (!body || !world.Bodies().Create(ball)) return;
    static_cast<void>(world.Bodies().Create({.shape = shape, .position = {0, 3.0 * double{size}, 0}}));
    for (int step = 0; step < 3; ++step) world.Step();
    Promise(world.AllFinite(), "bodies of a shape stay finite");
}

// ---- Files. The checksum is repaired, so that what is behind it is reached.

void RunShapeFile(std::span<const uint8_t> bytes) {
    static_cast<void>(LoadShape(bytes));
    constexpr size_t kLength = 8, kChecksum = 16, kHead = 24;
    if (bytes.size() < kHead) return;
    FuzzBytes file(bytes.begin(), bytes.end());
    const uint64_t length = file.size() - kHead;
    uint64_t checksum = 0xCBF29CE484222325ull;
    for (const uint8_t byte : std::span(file).subspan(kHead)) checksum = (checksum ^ byte) * 0x100000001B3ull;
    std::memcpy(file.data() + kLength, &length, sizeof length);
    std::memcpy(file.data() + kChecksum, &checksum, sizeof checksum);
    if (const auto shape = LoadShape(file)) Use(shape.Value());
}

std::vector<FuzzBytes> SeedsOfShapeFiles() {
    std::vector<Vector3> vertices;
    for (int i = 0; i < 9; ++i) vertices.emplace_back(float(i % 3), i == 4 ? 0.3f : 0.0f, float(i / 3));
    const uint32_t indices[] = {0, 3, 1, 1, 3, 4, 1, 4, 2, 2, 4, 5, 3, 6, 4, 4, 6, 7, 4, 7, 5, 5, 7, 8};
    const std::vector<float> heights(16, 0.5f);
    const ShapePtr hull = HullOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
    const std::vector<ShapePtr> shapes = {
        SphereOf(0.5f),
        BoxOf(1, 2, 3),
        Box::Create(Vector3(1, 1, 1), 0.1f).Value(),
        CapsuleOf(1, 0.5f),
        hull,
        CompoundOf({{.shape = hull}, {.shape = SphereOf(1), .position = {2, 0, 0}}}),
        Plane::Create().Value(),
        TriangleMesh::Create({.vertices = vertices, .indices = indices}).Value(),
        HeightField::Create({.sampleCountX = 4, .sampleCountZ = 4, .heights = heights}).Value(),
    };
    std::vector<FuzzBytes> seeds;
    for (const ShapePtr& shape : shapes) seeds.push_back(SaveShape(*shape).Value());
    return seeds;
}

// ---- Hulls

void RunHull(std::span<const uint8_t> bytes) {
    FuzzReader reader(bytes);
    const int maxVertices = reader.Get<uint8_t>();
    const float convexRadius = static_cast<float>(reader.Get<int8_t>()) * 0.01f;
    std::vector<Vector3> points;
    while (reader.Left() >= 12 && points.size() < 300) {
        const float x = reader.Get<float>(), y = reader.Get<float>();
        points.emplace_back(x, y, reader.Get<float>());
    }
    const auto hull = ConvexHull::Create(points, {.maxVertices = maxVertices, .convexRadius = convexRadius});
    if (!hull) return;
    Promise(hull.Value()->Vertices().size() <= static_cast<size_t>(maxVertices),
            "a hull has as many vertices as asked");
    Promise(hull.Value()->Mass().volume > 0, "a hull has a volume");
    // All points are inside, but for those dropped by a limit of the vertices.
    float largest = 0;
    for (const Vector3& point : points) largest = std::max(largest, point.cwiseAbs().maxCoeff());
    if (convexRadius == 0 && hull.Value()->Vertices().size() < static_cast<size_t>(maxVertices) &&
        hull.Value()->Faces().size() < 250 && largest < 1e15f) {
        const Vector3 center = hull.Value()->Mass().centerOfMass;
        const float slack = 2e-3f * hull.Value()->OuterRadius() + 1e-5f * largest;
        for (const Vector3& point : points)
            for (const ConvexHull::Face& face : hull.Value()->Faces())
                Promise(Dot<float>(face.normal, Vector3(point - center)) - face.offset <= slack,
                        "the points are inside their hull");
    }
    Use(hull.Value());
}

std::vector<FuzzBytes> SeedsOfHulls() {
    std::vector<FuzzBytes> seeds;
    RandomPoses random(4);
    for (const int count : {4, 8, 20, 60}) {
        FuzzBytes seed = {64, 0};
        for (int i = 0; i < count; ++i) {
            const Vector3 point = count == 8 ? Vector3(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f)
                                             : random.InBox(2);
            for (int k = 0; k < 3; ++k) Append(seed, point[k]);
        }
        seeds.push_back(seed);
    }
    return seeds;
}

// ---- Meshes: coordinates of 16 bits, so that vertices coincide and triangles are flat, or floats.

void RunMesh(std::span<const uint8_t> bytes) {
    FuzzReader reader(bytes);
    const uint8_t flags = reader.Get<uint8_t>();
    const size_t count = reader.Get<uint8_t>();
    std::vector<Vector3> vertices;
    for (size_t i = 0; i < count; ++i) {
        Vector3 vertex;
        for (int k = 0; k < 3; ++k)
            vertex[k] = flags & 1 ? reader.Get<float>() : static_cast<float>(reader.Get<int16_t>()) / 256;
        vertices.push_back(vertex);
    }
    std::vector<uint32_t> indices;
    while (reader.Left() > 0 && indices.size() < 3000) indices.push_back(reader.Get<uint8_t>());
    if (flags & 2) indices.resize(indices.size() / 3 * 3);
    const auto mesh = TriangleMesh::Create({.vertices = vertices,
                                            .indices = indices,
                                            .isTwoSided = (flags & 4) != 0,
                                            .keepSourceTriangles = (flags & 8) != 0});
    if (mesh) Use(mesh.Value());
}

std::vector<FuzzBytes> SeedsOfMeshes() {
    FuzzBytes grid = {2, 25};
    for (int i = 0; i < 25; ++i)
        for (const int at : {i % 5, i * 7 % 3, i / 5}) Append(grid, static_cast<int16_t>(at * 256));
    for (int x = 0; x < 4; ++x)
        for (int z = 0; z < 4; ++z)
            for (const int corner : {0, 5, 1, 1, 5, 6}) grid.push_back(static_cast<uint8_t>(z * 5 + x + corner));
    FuzzBytes pair = {3, 4};
    for (const float at : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 0.f, 1.f, 1.f, 1e-6f, 1.f}) Append(pair, at);
    for (const int index : {0, 2, 1, 1, 2, 3}) pair.push_back(static_cast<uint8_t>(index));
    return {grid, pair};
}

}  // namespace

const FuzzTarget kShapeFileTarget{"shape-file", RunShapeFile, SeedsOfShapeFiles, 3000};
const FuzzTarget kHullTarget{"hull", RunHull, SeedsOfHulls, 600};
const FuzzTarget kMeshTarget{"mesh", RunMesh, SeedsOfMeshes, 1500};

}  // namespace fulcrum::testing
