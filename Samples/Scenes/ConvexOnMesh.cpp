#include <Fulcrum/Samples/Scenes/WavyGround.h>

namespace fulcrum::ConvexOnMeshScene {
namespace {

void Build(SceneWorld& world) { AddShapesOverWaves(world); }

double BodiesBelowTheMesh(const SceneWorld& world) {
    double count = 0;
    world.System().VisitBodies([&](BodyId id) {
        if (world.Bodies().GetMotionType(id) == MotionType::Dynamic)
            count += !(world.Bodies().GetPose(id).position.y() >= -1);
    });
    return count;
}

}  // namespace

extern const Scene kScene{
    .name = "convex_on_mesh",
    .description = "1764 boxes, balls, capsules and pyramids bounce on a wavy mesh of 20,000 triangles",
    .kind = SceneKind::Performance,
    .steps = 300,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .lower = {-45, 0, -45}, .upper = {45, 14, 45}, .picture = 0.3},
    .build = Build,
    .accuracy = BodiesBelowTheMesh,
    .accuracyMeaning = "bodies more than 1 m below the lowest point of the mesh",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
    .accuracyTolerance = 0,
};

}  // namespace fulcrum::ConvexOnMeshScene
