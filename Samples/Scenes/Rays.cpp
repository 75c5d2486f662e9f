#include <Fulcrum/Samples/Scenes/WavyGround.h>

#include <algorithm>

namespace fulcrum::RaysScene {
namespace {

constexpr int kRays = 100'000;

// The numbers of the rays are fixed: another seed makes the same ones.
void Build(SceneWorld& world) {
    AddShapesOverWaves(world);
    Random random(1);
    for (int i = 0; i < kRays; ++i) {
        const double x = random.Between(-150, 150);
        const double z = random.Between(-150, 150);
        world.rays.push_back({.origin = {x, 60, z}, .displacement = {0, -120, 0}});
    }
    world.rayHits.resize(world.rays.size());
}

void Cast(SceneWorld& world) { world.Queries().CastRays(world.rays, world.rayHits); }

void CastSingly(SceneWorld& world) {
    for (size_t i = 0; i < world.rays.size(); ++i) {
        world.rayHits[i] = {};
        world.Queries().CastRay(world.rays[i], world.rayHits[i]);
    }
}

double Misses(const SceneWorld& world) {
    return static_cast<double>(std::count_if(world.rayHits.begin(), world.rayHits.end(),
                                             [](const WorldRayHit& hit) { return hit.body == BodyId{}; }));
}

}  // namespace

extern const Scene kScene{
    .name = "rays",
    .description = "100,000 rays from above find what is closest, after 2 s of convex_on_mesh; the rays are timed",
    .kind = SceneKind::Performance,
    .steps = 120,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .lower = {-45, 0, -45}, .upper = {45, 14, 45}, .picture = 0.3},
    .build = Build,
    .query = Cast,
    .queryCount = kRays,
    .queryName = "rays",
    .querySingly = CastSingly,
    .accuracy = Misses,
    .accuracyMeaning = "rays that hit nothing",
    .accuracyUnit = "rays",
    .accuracyRange = {{0, 0}},
    .accuracyTolerance = 0,
};

}  // namespace fulcrum::RaysScene
