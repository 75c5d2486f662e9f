#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/QueryGround.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fulcrum::QueryOverlapsScene {
namespace {

// A line from the probe to each body it overlaps. Overlap and the distance to the closest body must agree, except
// within 0.1 mm of touching.
void Probe(SceneWorld& world, const ConvexShape& shape, const Pose& pose) {
    std::vector<OverlapHit> hits;
    const PlacedShape probe{&shape, pose};
    auto accepts = [&](BodyId id) { return world.Bodies().GetMotionType(id) != MotionType::Static; };
    const QueryFilter movers{.accepts = accepts};
    world.Queries().FindOverlaps(probe, hits, movers);
    world.Draw().Outline(shape, pose, hits.empty() ? Ink::Miss : Ink::Hit);
    for (const OverlapHit& hit : hits) {
        const Position center = world.Bodies().GetCenterOfMass(hit.body);
        world.Draw().Line(pose.position, center, Ink::Shape);
        world.Draw().Point(center, Ink::Hit);
    }
    WorldClosest closest;
    const bool isNear = world.Queries().FindClosest(probe, 1, closest, movers);
    const bool isSure = !isNear || std::fabs(closest.distance) > 1e-4f;
    if (isSure && hits.empty() == (isNear && closest.distance <= 0)) ++world.figure;
    if (world.Queries().IsOverlapping(probe, movers) == hits.empty()) ++world.figure;
}

// A cloud of points, red where one is inside a body.
void ProbePoints(SceneWorld& world) {
    std::vector<OverlapHit> hits;
    const Position middle = OverTheGround(world.Time(), 0.6, 1.3);
    for (int i = 0; i < 125; ++i) {
        const Position point = middle + 0.4 * Position(i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2);
        world.Queries().FindBodiesAt(point, hits);
        world.Draw().Point(point, hits.empty() ? Ink::Miss : Ink::Hit);
    }
}

void Ask(SceneWorld& world) {
    static const auto kBall = Sphere::Create(1.2f);
    static const auto kBox = Box::Create(Vector3(1.4f, 0.5f, 0.7f));
    static const auto kPill = Capsule::Create(1.2f, 0.4f);
    static const std::array<Vector3, 4> kCorners{
        {{1.2f, 0.9f, 0.9f}, {1.2f, -0.9f, -0.9f}, {-1.2f, 0.9f, -0.9f}, {-1.2f, -0.9f, 0.9f}}};
    static const auto kTetrahedron = ConvexHull::Create(kCorners);
    const double time = world.Time();
    Probe(world, *kBall.Value(), {OverTheGround(time, 0, 1.5), {}});
    Probe(world, *kBox.Value(), {OverTheGround(time, 0.2, 1.5), RotationAbout(Vector3(0, 1, 0), time)});
    Probe(world, *kPill.Value(), {OverTheGround(time, 0.4, 1.5), RotationAbout(Vector3(1, 0, 0), 0.7 * time)});
    Probe(world, *kTetrahedron.Value(), {OverTheGround(time, 0.8, 1.8), RotationAbout(Vector3(0, 0, 1), 0.5 * time)});
    ProbePoints(world);
}

}  // namespace

extern const Scene kScene{
    .name = "query_overlaps",
    .description = "shapes and a cloud of points drift through stirred bodies and mark what they overlap",
    .steps = 600,
    .view = {.color = ColorMode::Plain},
    .build = AddQueryGround,
    .afterStep = Ask,
    .accuracy = FigureOf,
    .accuracyMeaning = "probes whose overlap and distance disagree",
    .accuracyUnit = "probes",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::QueryOverlapsScene
