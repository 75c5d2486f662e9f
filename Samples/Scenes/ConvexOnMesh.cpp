#include <Fulcrum/Samples/Scenes/WavyGround.h>

namespace fulcrum {
namespace {

void Build(SceneWorld& world) {
    const Material bouncy{.friction = 0.5f, .restitution = 0.6f};
    AddWavyGround(world, bouncy);
    const Vector3 corners[] = {Vector3(0, 1, 0), Vector3(1, 0, 0), Vector3(-1, 0, 0), Vector3(0, 0, 1), Vector3(0, 0, -1)};
    const ShapePtr shapes[] = {world.BoxOf(0.5f, 0.75f, 1), world.SphereOf(0.5f), world.CapsuleOf(0.75f, 0.5f), world.HullOf(corners)};
    for (int x = -10; x <= 10; ++x)
        for (int y = 0; y < 4; ++y)
            for (int z = -10; z <= 10; ++z)
                world.Add({.shape = shapes[y], .position = {7.5 * x, 15 + 2.0 * y, 7.5 * z}, .material = bouncy});
}

double BodiesBelowTheMesh(const SceneWorld& world) {
    double count = 0;
    world.System().VisitBodies([&](BodyId id) {
        if (world.Bodies().GetMotionType(id) == MotionType::Dynamic) count += !(world.Bodies().GetPose(id).position.y() >= -1);
    });
    return count;
}

}  // namespace

extern const Scene kConvexOnMeshScene{
    .name = "convex_on_mesh",
    .description = "1764 boxes, balls, capsules and pyramids bounce on a wavy mesh of 20,000 triangles",
    .kind = SceneKind::Performance,
    .steps = 300,
    .sleeping = false,
    .build = Build,
    .accuracy = BodiesBelowTheMesh,
    .accuracyMeaning = "bodies more than 1 m below the lowest point of the mesh",
};

}  // namespace fulcrum
