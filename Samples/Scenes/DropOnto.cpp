#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::DropOntoScene {
namespace {

// Just above the ground, over a grid of the places that have ground below.
std::vector<Position> PlacesAbove(const SceneWorld& world, const Bounds& box, double spacing) {
    std::vector<Position> places;
    const double top = double{box.upper.y()} + 1;
    const auto count = [&](int axis) {
        const double extent = double{box.upper[axis]} - double{box.lower[axis]};
        return std::clamp(static_cast<int>(extent / spacing), 1, 200);
    };
    const int rows = count(0), columns = count(2);
    const Position center(double{box.Center().x()}, top, double{box.Center().z()});
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < columns; ++j) {
            const Position place =
                center + Position(spacing * (i - 0.5 * (rows - 1)), 0, spacing * (j - 0.5 * (columns - 1)));
            WorldRayHit hit;
            const Vector3 down(0, static_cast<float>(double{box.lower.y()} - top - 1), 0);
            if (world.Queries().CastRay({place, down}, hit, {.backFaces = true}))
                places.push_back(hit.position + Position(0, spacing, 0));
        }
    if (places.empty()) places.push_back(center);
    return places;
}

// With random rotations, over evenly spread places, each as low as possible: bodies that fall far are fast enough to
// tunnel through thin ground. Several at one place fall one after another.
void Build(SceneWorld& world) {
    const ShapePtr shape = world.Input().shape, ground = world.Input().ground;
    if (!shape || !ground) return;
    const Bounds box = ground->LocalBounds();
    const double spacing = 2.1 * static_cast<double>(shape->OuterRadius());
    const size_t count = static_cast<size_t>(std::max(1, world.Input().count));
    world.Add({.shape = ground, .motion = MotionType::Static});
    const ShapePtr ball = world.SphereOf(static_cast<float>(0.5 * spacing));
    std::vector<Position> places = PlacesAbove(world, box, spacing);
    const size_t layer = std::min(count, places.size());
    for (size_t i = 0; ball && i < count; ++i) {
        Position& place = places[i % layer * places.size() / layer];
        while (place.y() < double{box.upper.y()} + spacing && world.Queries().IsOverlapping({ball.get(), {place, {}}}))
            place.y() += 0.25 * spacing;
        const double height = world.random.Between(-1, 1);
        const double around = world.random.Between(0, 2 * kPi);
        const double turn = world.random.Between(0, 2 * kPi);
        const double flat = std::sqrt(1 - height * height);
        const Quaternion rotation =
            RotationAbout(Position(flat * Cos(around), height, flat * Sin(around)).cast<float>(), turn);
        const Position origin = place - Rotate(rotation, shape->Mass().centerOfMass).cast<double>();
        world.watched.push_back(world.Add({.shape = shape, .position = origin, .rotation = rotation}));
        place.y() += spacing;
    }
    // What rolls off the mesh stays in sight, even from its top.
    const float halfX = 0.5f * (box.upper.x() - box.lower.x()), halfZ = 0.5f * (box.upper.z() - box.lower.z());
    const float margin = static_cast<float>(3 * spacing) + 0.5f * (box.upper.y() - box.lower.y());
    world.AddFloor(halfX + 2 * margin, halfZ + 2 * margin);
    world.AddWalls(halfX + margin, halfZ + margin, static_cast<float>(spacing));
}

}  // namespace

extern const Scene kScene{
    .name = "drop_onto",
    .description = "bodies of one shape, given by a mesh file, fall onto the triangles of another",
    .steps = 600,
    .usesSeed = true,
    .build = Build,
    .accuracy = BodiesBelowTheFloor,
    .accuracyMeaning = "bodies that fell through the floor",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::DropOntoScene
