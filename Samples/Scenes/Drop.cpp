#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::DropScene {
namespace {

// Layers of a square grid above a shallow tray, each body turned at random. Spaced by the shape's diameter, so that
// none overlap whatever their turn.
void Build(SceneWorld& world) {
    const ShapePtr shape = world.Input().shape;
    if (!shape) return;
    const double spacing = 2.1 * static_cast<double>(shape->OuterRadius());
    const int count = std::max(1, world.Input().count);
    const int side = std::clamp(static_cast<int>(std::ceil(std::cbrt(0.5 * count))), 1, 64);
    // The heap may slump to a few layers; walls half a body high keep it from rolling away.
    const float tray = static_cast<float>(spacing * (0.5 * side + 2));
    world.AddFloor(2 * tray + 5, 2 * tray + 5);
    world.AddWalls(tray, tray, static_cast<float>(0.5 * spacing));
    for (int i = 0; i < count; ++i) {
        const int layer = i / (side * side), row = i / side % side, column = i % side;
        const Position center(spacing * (column - 0.5 * (side - 1)), spacing * (layer + 0.75),
                              spacing * (row - 0.5 * (side - 1)));
        const double height = world.random.Between(-1, 1), around = world.random.Between(0, 2 * kPi);
        const double turn = world.random.Between(0, 2 * kPi), flat = std::sqrt(1 - height * height);
        const Vector3 axis = Position(flat * Cos(around), height, flat * Sin(around)).cast<float>();
        const Quaternion rotation = RotationAbout(axis, turn);
        // The grid places centers of mass, the body's position is its shape's own origin.
        const Position origin = center - Rotate(rotation, shape->Mass().centerOfMass).cast<double>();
        world.watched.push_back(world.Add({.shape = shape, .position = origin, .rotation = rotation}));
    }
}

}  // namespace

extern const Scene kScene{
    .name = "drop",
    .description = "a heap of one shape, given by a mesh file, in a shallow tray",
    .steps = 480,
    .usesSeed = true,
    .build = Build,
    .accuracy = BodiesBelowTheFloor,
    .accuracyMeaning = "bodies that fell through the floor",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::DropScene
