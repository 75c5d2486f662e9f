#include <Fulcrum/UnitTests/Support/SurfaceScene.h>

#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

namespace fulcrum::testing {

namespace {

constexpr int kSteps = 240;
constexpr int kCells = 24;

// Rough ground of whole numbers alone, so that every compiler makes the same.
float HeightAt(int x, int z) { return 0.1f * static_cast<float>((x * x + 3 * z + x * z) % 7); }

ShapePtr RoughMesh(bool twoSided) {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    std::vector<uint8_t> materials;
    for (int z = 0; z <= kCells; ++z)
        for (int x = 0; x <= kCells; ++x)
            vertices.emplace_back(0.5f * static_cast<float>(x), HeightAt(x, z), 0.5f * static_cast<float>(z));
    for (uint32_t z = 0; z < kCells; ++z)
        for (uint32_t x = 0; x < kCells; ++x) {
            const uint32_t corner = z * (kCells + 1) + x, next = corner + kCells + 1;
            indices.insert(indices.end(), {corner, next, corner + 1, corner + 1, next, next + 1});
            materials.insert(materials.end(), {static_cast<uint8_t>(x % 2), static_cast<uint8_t>(z % 2)});
        }
    const SurfaceMaterial palette[] = {{.friction = 0.8f}, {.friction = 0.2f, .restitution = 0.3f}};
    return TriangleMesh::Create({.vertices = vertices,
                                 .indices = indices,
                                 .triangleMaterials = materials,
                                 .materials = palette,
                                 .isTwoSided = twoSided})
        .Value();
}

ShapePtr RoughField() {
    std::vector<float> heights;
    std::vector<uint8_t> cells;
    for (int z = 0; z <= kCells; ++z)
        for (int x = 0; x <= kCells; ++x) heights.push_back(HeightAt(z, x));
    for (int i = 0; i < kCells * kCells; ++i) cells.push_back(i % 97 == 50 ? kHoleCell : uint8_t{0});
    return HeightField::Create({.sampleCountX = kCells + 1,
                                .sampleCountZ = kCells + 1,
                                .heights = heights,
                                .cellSizeX = 0.5f,
                                .cellSizeZ = 0.5f,
                                .cells = cells})
        .Value();
}

BodyId AddGrounds(TestWorld& world) {
    const auto add = [&](const ShapePtr& shape, const Position& position) {
        return world.Add({.shape = shape, .motion = MotionType::Static, .position = position});
    };
    add(RoughMesh(false), {0, 0, 0});
    add(RoughMesh(true), {12, 0, 0});
    add(RoughField(), {24, 0, 0});
    for (int x = 0; x < 12; ++x)
        for (int z = 0; z < 12; ++z) add(BoxOf(0.5f, 0.5f, 0.5f), {36.5 + x, 0, 0.5 + z});
    add(Plane::Create(Vector3(0.05f, 1, 0), -4).Value(), {20, 0, 0});
    return world.Add({.shape = RoughMesh(false),
                      .motion = MotionType::Kinematic,
                      .position = {-14, 0, 0},
                      .linearVelocity = {0.3f, 0.2f, 0},
                      .angularVelocity = {0, 0.1f, 0}});
}

}  // namespace

BodyId BuildSurfaceScene(TestWorld& world) {
    const BodyId lift = AddGrounds(world);
    const ShapePtr shapes[] = {
        SphereOf(0.3f),
        BoxOf(0.3f, 0.2f, 0.4f),
        CapsuleOf(0.3f, 0.2f),
        HullOf({{0.5f, -0.3f, 0}, {-0.4f, -0.3f, 0.4f}, {-0.4f, -0.3f, -0.4f}, {0, 0.5f, 0}, {0.2f, 0.3f, 0.3f}}),
        Cylinder::Create(0.2f, 0.3f).Value(),
        Cylinder::CreateCone(0.3f, 0.3f).Value(),
        TaperedCapsule::Create(0.3f, 0.15f, 0.25f).Value(),
        CompoundOf({{.shape = BoxOf(0.4f, 0.1f, 0.1f)}, {.shape = SphereOf(0.2f), .position = {0.4f, 0, 0}}}),
    };
    uint32_t random = 4711;
    const auto number = [&] {
        return static_cast<float>((random = random * 1664525u + 1013904223u) >> 8) / 16777216.0f;
    };
    for (int i = 0; i < 160; ++i) {
        const float x = number(), y = number(), z = number(), w = number();
        const double across = -13 + 62 * double(x), along = 1 + 10 * double(z);
        world.Add({.shape = shapes[i % 8],
                   .position = {across, 1.5 + 2 * double(y), along},
                   .rotation = Normalized(Quaternion{x, y, z, w + 0.1f}),
                   .linearVelocity = {4 * w - 2, 0, 3 * y - 1.5f},
                   .angularVelocity = Vector3(x, y, z) * 4.0f});
    }
    return lift;
}

uint64_t HashOfSurfaceScene(uint32_t threads) {
    TestWorld world({}, threads);
    const BodyId lift = BuildSurfaceScene(world);
    for (int step = 0; step < kSteps; ++step) {
        EXPECT_TRUE(step != 120 || world.Bodies().SetVelocity(lift, {-0.3f, -0.2f, 0.1f}, {0, -0.1f, 0}));
        world.Step();
    }
    EXPECT_TRUE(world.AllFinite());
    return world.System().HashPoses();
}

}  // namespace fulcrum::testing
