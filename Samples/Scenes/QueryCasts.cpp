#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/QueryGround.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::QueryCastsScene {
namespace {

constexpr int kGhosts = 4;  // outlines along the motion

// Where a motion is after a fraction of it.
Pose PoseAt(const MovingShape& shape, double fraction) {
    const float angle = Length(shape.turn);
    Pose pose = shape.pose;
    pose.position += shape.displacement.cast<double>() * fraction;
    if (angle > 0) pose.rotation = RotationAbout(shape.turn / angle, double{angle} * fraction) * pose.rotation;
    return pose;
}

// The distance between the shapes where the cast ends, m. The shapes here have their center of mass at their origin.
double GapAt(SceneWorld& world, const MovingShape& shape, const WorldShapeHit& hit) {
    WorldClosest closest;
    const Pose pose = PoseAt(shape, double{hit.fraction});
    if (!world.Queries().FindClosest(PlacedShape{shape.shape, pose}, 1, closest)) return 1;
    return std::fabs(double{closest.distance});
}

void CastAndDraw(SceneWorld& world, const MovingShape& shape) {
    WorldShapeHit hit;
    const bool isHit = world.Queries().CastShape(shape, hit);
    if (isHit && hit.fraction > 0 && !hit.isEarly) world.figure = std::max(world.figure, GapAt(world, shape, hit));
    const double end = isHit ? double{hit.fraction} : 1;
    world.Draw().Line(shape.pose.position, PoseAt(shape, end).position, Ink::Path);
    world.Draw().Outline(*shape.shape, shape.pose, Ink::Path);
    for (int i = 1; i < kGhosts; ++i) world.Draw().Outline(*shape.shape, PoseAt(shape, end * i / kGhosts), Ink::Miss);
    world.Draw().Outline(*shape.shape, PoseAt(shape, end), isHit ? Ink::Shape : Ink::Miss);
    if (isHit) world.Draw().Normal(hit.position, hit.normal, 0.7);
}

void Ask(SceneWorld& world) {
    static const auto kBall = Sphere::Create(0.4f);
    static const auto kBox = Box::Create(Vector3(0.5f, 0.2f, 0.3f));
    static const auto kRod = Box::Create(Vector3(1.2f, 0.08f, 0.08f));
    static const auto kPill = Capsule::Create(0.5f, 0.2f);
    const double time = world.Time();
    // Straight down, and level between the walls.
    CastAndDraw(world,
                {.shape = kBall.Value().get(), .pose = {OverTheGround(time, 0, 5), {}}, .displacement = {0, -6, 0}});
    CastAndDraw(world, {.shape = kPill.Value().get(),
                        .pose = {OverTheGround(time, 0.5, 5), RotationAbout(Vector3(1, 0, 0), time)},
                        .displacement = {0, -6, 0}});
    const double z = 5.5 * Sin(0.6 * time);
    CastAndDraw(world, {.shape = kBox.Value().get(),
                        .pose = {{-6, 1.6, z}, RotationAbout(Vector3(0, 1, 0), 0.5 * time)},
                        .displacement = {13, -0.4f, 0}});
    // A rod that makes a turn and a half on its way down, and one that turns on the spot like a clock's hand.
    CastAndDraw(world, {.shape = kRod.Value().get(),
                        .pose = {OverTheGround(time, 0.25, 5), {}},
                        .displacement = {1, -5, 0},
                        .turn = {0, 0, static_cast<float>(3 * kPi)}});
    CastAndDraw(world, {.shape = kRod.Value().get(),
                        .pose = {OverTheGround(time, 0.75, 1.7), {}},
                        .turn = {0, static_cast<float>(2 * kPi), 0}});
}

}  // namespace

extern const Scene kScene{
    .name = "query_casts",
    .description = "shapes on their way, straight and turning, up to the first touch among stirred bodies",
    .steps = 600,
    .view = {.color = ColorMode::Plain},
    .build = AddQueryGround,
    .afterStep = Ask,
    .accuracy = FigureOf,
    .accuracyMeaning = "largest gap or overlap where a cast ends",
    .accuracyUnit = "m",
    // The cast ends, and the distance is measured, within 1e-6 of the shapes' size: that of the ground, 16 m x 16 m,
    // is 23 m.
    .accuracyRange = {{0, 5e-05}},
};

}  // namespace fulcrum::QueryCastsScene
