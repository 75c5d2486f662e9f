#include <Fulcrum/Samples/Scenes/WavyGround.h>

#include <algorithm>

namespace fulcrum::ThinScene {
namespace {

constexpr int kRodsPerSide = 8, kRods = 40, kPlatesPerSide = 20;

// With a random rotation, centered at this height above the ground.
void Toss(SceneWorld& world, const ShapePtr& shape, double x, double z, double height) {
    const double axisX = world.random.Between(-1, 1), axisY = world.random.Between(-1, 1),
                 axisZ = world.random.Between(-1, 1);
    const double angle = world.random.Between(0, 2 * kPi);
    const Vector3 axis = Position(axisX, axisY, axisZ).cast<float>();
    const Vector3 unit = Length(axis) > 0.01f ? Normalized(axis) : Vector3(0, 1, 0);
    world.watched.push_back(world.Add(
        {.shape = shape, .position = {x, WavyHeight(x, z) + height, z}, .rotation = RotationAbout(unit, angle)}));
}

void Build(SceneWorld& world) {
    AddWavyGround(world, {});
    const ShapePtr rod = world.BoxOf(0.05f, 4, 0.05f), plate = world.BoxOf(0.02f, 0.2f, 0.04f);
    for (int i = 0; i < kRods; ++i)
        Toss(world, rod, 15.0 * (i % kRodsPerSide) - 52.5, 20.0 * (i / kRodsPerSide) - 40, 8);
    for (int i = 0; i < kPlatesPerSide; ++i)
        for (int j = 0; j < kPlatesPerSide; ++j) Toss(world, plate, 6.0 * i - 57, 6.0 * j - 57, 2);
}

// Bodies that fell through are below all hills; comparing with the ground below the center would be unreliable on
// slopes.
double LostOrAwake(const SceneWorld& world) {
    return static_cast<double>(std::count_if(world.watched.begin(), world.watched.end(), [&](BodyId id) {
        const Position at = world.Bodies().GetPose(id).position;
        return world.Bodies().IsAwake(id) || !(at.y() > WavyHeight(at.x(), at.z()) - 1e-3);
    }));
}

}  // namespace

extern const Scene kScene{
    .name = "thin",
    .description = "40 rods of 8 m and 400 plates of 4 cm, 10 cm thick at most, fall on a wavy mesh and come to rest",
    .steps = 1500,
    .usesSeed = true,
    .view = {.color = ColorMode::Plain, .lower = {-14, 0, -4}, .upper = {14, 9, 20}, .picture = 0.04},
    .build = Build,
    .accuracy = LostOrAwake,
    .accuracyMeaning = "bodies that fell through the ground or do not sleep yet",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::ThinScene
