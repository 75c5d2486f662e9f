#include <Fulcrum/Samples/Scenes/WavyGround.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

double GridHeight(int x, int z) { return 5 + 5 * std::sin(50.0 * x / kWavyCells) * std::cos(50.0 * z / kWavyCells); }

}  // namespace

double WavyHeight(double x, double z) {
    const double gridX = x / kWavyCell + kWavyCells / 2, gridZ = z / kWavyCell + kWavyCells / 2;
    const int cellX = std::clamp(static_cast<int>(gridX), 0, kWavyCells - 1),
              cellZ = std::clamp(static_cast<int>(gridZ), 0, kWavyCells - 1);
    const double u = gridX - cellX, v = gridZ - cellZ;
    const double across = GridHeight(cellX + 1, cellZ), along = GridHeight(cellX, cellZ + 1);
    // Cells are cut from (0, 1) to (1, 0).
    if (u + v <= 1) {
        const double corner = GridHeight(cellX, cellZ);
        return corner + u * (across - corner) + v * (along - corner);
    }
    const double corner = GridHeight(cellX + 1, cellZ + 1);
    return corner + (1 - u) * (along - corner) + (1 - v) * (across - corner);
}

BodyId AddWavyGround(SceneWorld& world, const Material& material) {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    const auto at = [](int x, int z) { return static_cast<uint32_t>(z * (kWavyCells + 1) + x); };
    for (int z = 0; z <= kWavyCells; ++z)
        for (int x = 0; x <= kWavyCells; ++x)
            vertices.emplace_back(static_cast<float>(kWavyCell * (x - kWavyCells / 2)),
                                  static_cast<float>(GridHeight(x, z)),
                                  static_cast<float>(kWavyCell * (z - kWavyCells / 2)));
    for (int z = 0; z < kWavyCells; ++z)
        for (int x = 0; x < kWavyCells; ++x)
            indices.insert(indices.end(),
                           {at(x, z), at(x, z + 1), at(x + 1, z), at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)});
    const BodyId id =
        world.Add({.shape = world.MeshOf(vertices, indices), .motion = MotionType::Static, .material = material});
    world.Show(id, {.look = Look::Grass});
    return id;
}

void AddShapesOverWaves(SceneWorld& world) {
    const Material bouncy{.friction = 0.5f, .restitution = 0.6f};
    AddWavyGround(world, bouncy);
    const Vector3 corners[] = {Vector3(0, 1, 0), Vector3(1, 0, 0), Vector3(-1, 0, 0), Vector3(0, 0, 1),
                               Vector3(0, 0, -1)};
    const ShapePtr shapes[] = {world.BoxOf(0.5f, 0.75f, 1), world.SphereOf(0.5f), world.CapsuleOf(0.75f, 0.5f),
                               world.HullOf(corners)};
    for (int x = -10; x <= 10; ++x)
        for (int y = 0; y < 4; ++y)
            for (int z = -10; z <= 10; ++z)
                world.Add({.shape = shapes[y], .position = {7.5 * x, 15 + 2.0 * y, 7.5 * z}, .material = bouncy});
}

}  // namespace fulcrum
