#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>

namespace fulcrum {
namespace {

// Layers of a square grid above a shallow tray, each body turned at random. Spaced by the shape's diameter, so that none
// overlap whatever their turn.
void Build(SceneWorld& world) {
    const ShapePtr shape = world.Input().shape;
    if (!shape) return;
    const double spacing = 2.1 * static_cast<double>(shape->OuterRadius());
    const int count = std::max(1, world.Input().count);
    const int side = std::clamp(static_cast<int>(std::ceil(std::cbrt(0.5 * count))), 1, 64);
    // The heap may slump to a few layers; walls half a body high keep it from rolling away.
    const double tray = spacing * (0.5 * side + 2);
    world.AddFloor(static_cast<float>(2 * tray + 5), static_cast<float>(2 * tray + 5));
    const float wall = static_cast<float>(0.25 * spacing), length = static_cast<float>(tray);
    for (double sign : {-1.0, 1.0}) {
        world.Add({.shape = world.BoxOf(0.1f, wall, length), .motion = MotionType::Static, .position = {sign * tray, wall, 0}});
        world.Add({.shape = world.BoxOf(length, wall, 0.1f), .motion = MotionType::Static, .position = {0, wall, sign * tray}});
    }
    for (int i = 0; i < count; ++i) {
        const int layer = i / (side * side), row = i / side % side, column = i % side;
        const Position centre(spacing * (column - 0.5 * (side - 1)), spacing * (layer + 0.75),
                              spacing * (row - 0.5 * (side - 1)));
        const double height = world.random.Between(-1, 1), around = world.random.Between(0, 2 * kPi);
        const double turn = world.random.Between(0, 2 * kPi), flat = std::sqrt(1 - height * height);
        const Vector3 axis = Position(flat * Cos(around), height, flat * Sin(around)).cast<float>();
        const Quaternion rotation = Turn(axis, turn);
        // The grid places centres of mass, the body's position is its shape's own origin.
        const Position origin = centre - Rotate(rotation, shape->Mass().centreOfMass).cast<double>();
        world.watched.push_back(world.Add({.shape = shape, .position = origin, .rotation = rotation}));
    }
}

}  // namespace

extern const Scene kDropScene{
    .name = "drop",
    .description = "a heap of one shape, given by a mesh file, in a shallow tray",
    .steps = 480,
    .usesSeed = true,
    .build = Build,
    .accuracy = BodiesBelowTheFloor,
    .accuracyMeaning = "bodies that fell through the floor",
};

}  // namespace fulcrum
