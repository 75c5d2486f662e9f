#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/QueryGround.h>

namespace fulcrum::QueryRaysScene {
namespace {

constexpr int kFan = 90, kColumns = 12;

bool IsSame(const WorldRayHit& a, const WorldRayHit& b) {
    return a.body == b.body && a.subShape == b.subShape && a.fraction == b.fraction;
}

// A lighthouse: the closest hit of each ray, found by a batch and, for comparison, one by one.
void DrawFan(SceneWorld& world) {
    const Position eye(0, 1.6, 0);
    world.rays.clear();
    for (int i = 0; i < kFan; ++i) {
        const double angle = 2 * kPi * i / kFan + 0.1 * world.Time();
        world.rays.push_back({eye, Position(20 * Cos(angle), -1.2, 20 * Sin(angle)).cast<float>()});
    }
    world.rayHits.resize(world.rays.size());
    world.Queries().CastRays(world.rays, world.rayHits);
    for (size_t i = 0; i < world.rays.size(); ++i) {
        const Ray& ray = world.rays[i];
        const WorldRayHit& hit = world.rayHits[i];
        WorldRayHit single;
        const bool isHit = world.Queries().CastRay(ray, single);
        if (isHit != (hit.body != BodyId{}) || (isHit && !IsSame(single, hit))) ++world.figure;
        if (isHit) {
            world.Draw().Line(eye, hit.position, Ink::Path);
            world.Draw().Normal(hit.position, hit.normal, 0.3);
        } else {
            world.Draw().Line(eye, ray.origin + ray.displacement.cast<double>(), Ink::Miss);
        }
    }
}

// All hits of rays; the first must be the closest.
void DrawPiercing(SceneWorld& world) {
    std::vector<WorldRayHit> hits;
    for (int i = 0; i < 5; ++i) {
        const Ray ray{OverTheGround(world.Time(), 0.2 * i, 5), Vector3(0, -6, 1.5f)};
        world.Queries().CastRayAll(ray, hits, {.backFaces = true});
        WorldRayHit closest;
        const bool isHit = world.Queries().CastRay(ray, closest, {.backFaces = true});
        if (isHit == hits.empty() || (isHit && !IsSame(hits.front(), closest))) ++world.figure;
        world.Draw().Line(ray.origin, ray.origin + ray.displacement.cast<double>(), Ink::Shape);
        for (const WorldRayHit& hit : hits) world.Draw().Normal(hit.position, hit.normal, 0.4);
    }
}

// Whether anything but the ground is below: a row of rays that look for any hit.
void DrawCurtain(SceneWorld& world) {
    const double z = 0.8 * double{kQueryGround} * Sin(0.5 * world.Time());
    auto accepts = [&](BodyId id) { return world.Bodies().GetMotionType(id) != MotionType::Static; };
    const QueryFilter movers{.accepts = accepts};
    for (int i = 0; i < kColumns; ++i) {
        const Ray ray{{(i - 0.5 * (kColumns - 1)) * 1.2, 4, z}, Vector3(0, -4, 0)};
        const bool isHit = world.Queries().IsHit(ray, {}, movers);
        WorldRayHit closest;
        if (isHit != world.Queries().CastRay(ray, closest, {}, movers)) ++world.figure;
        world.Draw().Line(ray.origin, ray.origin + ray.displacement.cast<double>(), isHit ? Ink::Hit : Ink::Miss);
    }
}

void Ask(SceneWorld& world) {
    DrawFan(world);
    DrawPiercing(world);
    DrawCurtain(world);
}

}  // namespace

extern const Scene kScene{
    .name = "query_rays",
    .description =
        "rays among stirred bodies: closest hits (blue), all hits (violet), any hit (a curtain, red where blocked)",
    .steps = 600,
    .view = {.color = ColorMode::Plain},
    .build = AddQueryGround,
    .afterStep = Ask,
    .accuracy = FigureOf,
    .accuracyMeaning = "rays for which closest, all, any and batch disagree",
    .accuracyUnit = "rays",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::QueryRaysScene
