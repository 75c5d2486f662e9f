#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::StructuresScene {
namespace {

constexpr int kBoxes = 50;

// Boxes of a meter, up to 1 cm out of line. The last one is the figure's.
void AddColumn(SceneWorld& world, int boxes, double x) {
    const ShapePtr cube = world.BoxOf(0.5f, 0.5f, 0.5f);
    BodyId top;
    for (int i = 0; i < boxes; ++i) {
        const double dx = world.random.Between(-0.01, 0.01), dz = world.random.Between(-0.01, 0.01);
        top = world.Add({.shape = cube, .position = {x + dx, 0.5 + i, dz}});
    }
    world.watched.push_back(top);
}

// A cube with so many times its mass on it.
void AddLoad(SceneWorld& world, float times, double x) {
    const ShapePtr cube = world.BoxOf(0.5f, 0.5f, 0.5f);
    for (int i = 0; i < 2; ++i)
        world.Add({.shape = cube, .position = {x, 0.5 + i, 6}, .mass = i == 0 ? 1000 : 1000 * times});
}

// Planks over the edge of a block: the k-th from the top overhangs the one below it by 0.9 m / k.
void AddHarmonicStack(SceneWorld& world, int planks, double x) {
    world.Add({.shape = world.BoxOf(1, 1, 0.5f), .motion = MotionType::Static, .position = {x - 1, 1, 6}});
    double aside = x - 1;
    for (int i = 0; i < planks; ++i) {
        aside += 0.9 / (planks - i);
        world.Add({.shape = world.BoxOf(1, 0.1f, 0.5f), .position = {aside, 2.1 + 0.2 * i, 6}});
    }
}

// A wall of small boxes that tapers to one.
void AddSmallWall(SceneWorld& world, float edge, int layers, double x) {
    const ShapePtr cube = world.BoxOf(0.5f * edge, 0.5f * edge, 0.5f * edge);
    const double e = double{edge};
    for (int i = 0; i < layers; ++i)
        for (int j = 0; j < layers - i; ++j)
            world.Add({.shape = cube, .position = {x + e * (j + 0.5 * i), e * (0.5 + i), 8}});
}

void Build(SceneWorld& world) {
    world.AddFloor(40, 20);
    AddColumn(world, 10, -6);
    AddColumn(world, 25, 0);
    AddColumn(world, kBoxes, 6);
    double x = -6;
    for (const float times : {10.0f, 100.0f, 1000.0f, 1e4f}) AddLoad(world, times, x += 2);
    AddHarmonicStack(world, 4, 8);
    AddSmallWall(world, 0.05f, 10, -2);
    AddSmallWall(world, 0.01f, 10, 0);
}

double Accuracy(const SceneWorld& world) {
    return world.Bodies().GetPose(world.watched.back()).position.y() - (kBoxes - 0.5);
}

}  // namespace

extern const Scene kScene{
    .name = "structures",
    .description = "columns of 10, 25 and 50 boxes; 10 to 10,000 times its weight on a cube; walls of 5 and 1 cm boxes",
    .steps = 600,
    .usesSeed = true,
    .isBuiltToStand = true,
    .view = {.color = ColorMode::Plain, .from = {0.3f, 0.12f, 1}},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "height of the top box of the highest column minus 49.5 m, that of a perfect one",
    .accuracyUnit = "m",
    .accuracyRange = {{-0.02, 0.001}},
};

}  // namespace fulcrum::StructuresScene
