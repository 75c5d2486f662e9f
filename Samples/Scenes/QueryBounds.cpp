#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/QueryGround.h>

#include <algorithm>

namespace fulcrum::QueryBoundsScene {
namespace {

const Position kHalf(1.5, 0.8, 1);  // m, of the box

void Mark(SceneWorld& world, const std::vector<OverlapHit>& hits, Ink ink) {
    for (const OverlapHit& hit : hits)
        if (world.Bodies().GetMotionType(hit.body) == MotionType::Dynamic)
            world.Draw().Point(world.Bodies().GetCenterOfMass(hit.body), ink);
}

bool Has(const std::vector<OverlapHit>& hits, const OverlapHit& hit) {
    return std::binary_search(hits.begin(), hits.end(), hit);
}

// Bodies that a box overlaps must be among those that the query by bounds finds.
void AskBox(SceneWorld& world, const Position& center) {
    static const auto kBox = Box::Create(kHalf.cast<float>());
    std::vector<OverlapHit> near, inside;
    world.Queries().FindInBox(center - kHalf, center + kHalf, near);
    world.Queries().FindOverlaps(PlacedShape{kBox.Value().get(), {center, {}}}, inside);
    for (const OverlapHit& hit : inside) world.figure += Has(near, hit) ? 0 : 1;
    world.Draw().Box(center - kHalf, center + kHalf, Ink::Shape);
    Mark(world, near, Ink::Path);
    Mark(world, inside, Ink::Hit);
}

// Likewise bodies that a ray hits, among those whose bounds it hits.
void AskRay(SceneWorld& world, const Ray& ray) {
    std::vector<OverlapHit> near;
    std::vector<WorldRayHit> hits;
    world.Queries().FindOnRay(ray, near);
    world.Queries().CastRayAll(ray, hits);
    for (const WorldRayHit& hit : hits) world.figure += Has(near, {hit.body, hit.subShape.child}) ? 0 : 1;
    world.Draw().Line(ray.origin, ray.origin + ray.displacement.cast<double>(), Ink::Path);
    Mark(world, near, Ink::Path);
}

void AskSweep(SceneWorld& world, const Position& center, const Vector3& way) {
    const Position half(0.3, 0.3, 0.3), end = center + way.cast<double>();
    std::vector<OverlapHit> near;
    world.Queries().FindOnSweep(center - half, center + half, way, near);
    world.Draw().Box(center - half, center + half, Ink::Normal);
    world.Draw().Box(end - half, end + half, Ink::Normal);
    world.Draw().Line(center, end, Ink::Normal);
    Mark(world, near, Ink::Normal);
}

void Ask(SceneWorld& world) {
    const double time = world.Time();
    AskBox(world, OverTheGround(time, 0, 1.4));
    AskBox(world, OverTheGround(time, 0.45, 1.4));
    const double z = 6 * Sin(0.4 * time);
    AskRay(world, {{-7, 1.2, z}, Vector3(14, 0, 0)});
    AskSweep(world, {-6 * Sin(0.5 * time), 1.3, -6}, Vector3(4, 0, 12));
}

}  // namespace

extern const Scene kScene{
    .name = "query_bounds",
    .description = "boxes, a ray and a box on its way ask the broad phase alone; red: what really overlaps",
    .steps = 600,
    .view = {.color = ColorMode::Plain},
    .build = AddQueryGround,
    .afterStep = Ask,
    .accuracy = FigureOf,
    .accuracyMeaning = "hits that the broad phase did not name",
    .accuracyUnit = "hits",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::QueryBoundsScene
