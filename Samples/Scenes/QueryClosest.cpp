#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/QueryGround.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::QueryClosestScene {
namespace {

constexpr float kReach = 6;  // m
constexpr int kPoints = 24;

// Brute force: the least distance to the bodies one by one. A shape's own frame is its center frame here.
double LeastDistance(SceneWorld& world, const Position& point) {
    double least = double{kReach};
    world.System().VisitBodies([&](BodyId id) {
        const ShapePtr shape = world.Bodies().GetShape(id);
        const Pose pose = world.Bodies().GetPose(id);
        ClosestPoints found;
        const Vector3 local = pose.InverseTransform(point) - shape->Mass().centerOfMass;
        if (FindClosestPoint(*shape, local, kReach, found)) least = std::min(least, double{found.distance});
    });
    return least;
}

void Draw(SceneWorld& world, const WorldClosest& closest) {
    world.Draw().Line(closest.onQuery, closest.onBody, closest.distance > 0 ? Ink::Path : Ink::Hit);
    world.Draw().Normal(closest.onBody, closest.normal, 0.25);
    world.Draw().Point(closest.onQuery, Ink::Shape);
}

// A swarm of points, and a box and a capsule, each with a line to what is closest to it.
void Ask(SceneWorld& world) {
    static const auto kBox = Box::Create(Vector3(0.7f, 0.15f, 0.4f));
    static const auto kPill = Capsule::Create(0.6f, 0.25f);
    const double time = world.Time();
    WorldClosest closest;
    for (int i = 0; i < kPoints; ++i) {
        const Position point = OverTheGround(time, static_cast<double>(i) / kPoints, 2.2 + 0.8 * Sin(1.3 * time + i));
        const bool isFound = world.Queries().FindClosest(point, kReach, closest);
        if (isFound) Draw(world, closest);
        const double distance = isFound ? double{closest.distance} : double{kReach};
        // Brute force takes long: a quarter of the points in each step.
        if (i % 4 == world.StepCount() % 4)
            world.figure = std::max(world.figure, std::fabs(distance - LeastDistance(world, point)));
    }
    const auto ask = [&](const ConvexShape& shape, const Pose& pose) {
        world.Draw().Outline(shape, pose, Ink::Shape);
        if (world.Queries().FindClosest(PlacedShape{&shape, pose}, kReach, closest)) Draw(world, closest);
    };
    ask(*kBox.Value(), {OverTheGround(time, 0.1, 2.6), RotationAbout(Vector3(0.6f, 0.8f, 0), time)});
    ask(*kPill.Value(), {OverTheGround(time, 0.6, 2.6), RotationAbout(Vector3(0, 0.6f, 0.8f), time)});
}

}  // namespace

extern const Scene kScene{
    .name = "query_closest",
    .description = "points, a box and a capsule over stirred bodies, each with a line to what is closest to it",
    .steps = 600,
    .view = {.color = ColorMode::Plain},
    .build = AddQueryGround,
    .afterStep = Ask,
    .accuracy = FigureOf,
    .accuracyMeaning = "largest difference to the distance that all bodies one by one give",
    .accuracyUnit = "m",
    // Both ways subtract floats of up to 12 m.
    .accuracyRange = {{0, 5e-06}},
};

}  // namespace fulcrum::QueryClosestScene
