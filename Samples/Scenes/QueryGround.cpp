#include <Fulcrum/Samples/Scenes/QueryGround.h>

#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <array>

namespace fulcrum {
namespace {

ShapePtr Waves(SceneWorld& world) {
    constexpr int kCells = 32;
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    const auto at = [](int x, int z) { return static_cast<uint32_t>(z * (kCells + 1) + x); };
    for (int z = 0; z <= kCells; ++z)
        for (int x = 0; x <= kCells; ++x) {
            const double u = 2.0 * x / kCells - 1, v = 2.0 * z / kCells - 1;
            const Position vertex(double{kQueryGround} * u, 0.5 + 0.4 * Sin(7 * u) * Cos(6 * v),
                                  double{kQueryGround} * v);
            vertices.push_back(vertex.cast<float>());
        }
    for (int z = 0; z < kCells; ++z)
        for (int x = 0; x < kCells; ++x)
            indices.insert(indices.end(),
                           {at(x, z), at(x, z + 1), at(x + 1, z), at(x + 1, z), at(x, z + 1), at(x + 1, z + 1)});
    return world.MeshOf(vertices, indices);
}

ShapePtr Dumbbell(SceneWorld& world) {
    const ShapePtr ball = world.SphereOf(0.3f), bar = world.BoxOf(0.4f, 0.1f, 0.1f);
    const std::array<Compound::ChildSettings, 3> children{
        {{.shape = bar}, {.shape = ball, .position = {-0.5f, 0, 0}}, {.shape = ball, .position = {0.5f, 0, 0}}}};
    return world.CompoundOf(children);
}

}  // namespace

void AddQueryGround(SceneWorld& world) {
    world.Add({.shape = Waves(world), .motion = MotionType::Static});
    world.AddWalls(kQueryGround, kQueryGround, 3);
    const ShapePtr bar = world.BoxOf(3, 0.35f, 0.15f);
    for (double side : {-1.0, 1.0})
        world.Add({.shape = bar,
                   .motion = MotionType::Kinematic,
                   .position = {side * 3.4, 1.4, 0},
                   .rotation = RotationAbout(Vector3(0, 1, 0), 0.4 * side),
                   .angularVelocity = {0, static_cast<float>(0.7 * side), 0}});
    const std::array<Vector3, 6> octahedron{
        {{0.5f, 0, 0}, {-0.5f, 0, 0}, {0, 0.6f, 0}, {0, -0.6f, 0}, {0, 0, 0.5f}, {0, 0, -0.5f}}};
    const auto cylinder = Cylinder::Create(0.3f, 0.35f);
    const std::array<ShapePtr, 6> shapes{
        world.BoxOf(0.35f, 0.35f, 0.35f), world.SphereOf(0.4f), world.CapsuleOf(0.4f, 0.25f),
        world.HullOf(octahedron),         cylinder.Value(),     Dumbbell(world)};
    for (int i = 0; i < 70; ++i) {
        const Position place(1.8 * (i % 8 - 3.5), 2 + 1.2 * (i / 32), 2.8 * (i / 8 % 4 - 1.5) + 0.4 * (i % 3));
        world.watched.push_back(world.Add({.shape = shapes[static_cast<size_t>(i) % shapes.size()],
                                           .position = place,
                                           .rotation = RotationAbout(Vector3(0.6f, 0, 0.8f), 0.5 * i)}));
    }
}

Position OverTheGround(double time, double phase, double height) {
    const double angle = 2 * kPi * (time / 10 + phase);
    return {0.7 * double{kQueryGround} * Sin(angle), height, 0.6 * double{kQueryGround} * Sin(2 * angle + 1)};
}

}  // namespace fulcrum
