#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::EndlessSlopeScene {
namespace {

constexpr double kSlope = 10 * kDegree;
constexpr float kRadius = 0.4f;  // m
constexpr int kBalls = 6, kSwings = 4;

const Position kTop(0, 5, 0), kNormal(Sin(kSlope), Cos(kSlope), 0), kDown(Cos(kSlope), -Sin(kSlope), 0);

// On the slope, `down` m from the top line.
Position OnSlope(double down, double height, double z) {
    return kTop + kDown * down + kNormal * height + Position(0, 0, z);
}

// A half space; balls that roll down it, crates that friction holds, and swings that hang from bodies without a shape.
void Build(SceneWorld& world) {
    const auto slope = Plane::Create(kNormal.cast<float>());
    world.Add({.shape = slope.Value(), .motion = MotionType::Static, .position = kTop});
    const ShapePtr ball = world.SphereOf(kRadius), crate = world.BoxOf(0.4f, 0.3f, 0.4f),
                   seat = world.BoxOf(0.5f, 0.05f, 0.25f);
    const Quaternion tilt = RotationAbout(Vector3(0, 0, 1), -kSlope);
    for (int i = 0; i < kBalls; ++i)
        world.watched.push_back(world.Add({.shape = ball, .position = OnSlope(0, double{kRadius}, 2.0 * i - 5)}));
    for (int i = 0; i < kBalls; ++i)
        world.Add({.shape = crate, .position = OnSlope(2.5 * i + 1, 0.3, 2.0 * i - 6), .rotation = tilt});
    for (int i = 0; i < kSwings; ++i) {
        const Position hook = OnSlope(3.0 * i + 2, 4, 7);
        const BodyId anchor =
            world.Add({.shape = EmptyShape::Create(), .motion = MotionType::Static, .position = hook});
        const BodyId swing = world.Add(
            {.shape = seat, .position = hook + Position(2.0 * Sin(0.3 + 0.3 * i), -2.0 * Cos(0.3 + 0.3 * i), 0)});
        world.Join(JointOf<HingeJointSettings>(anchor, swing, hook, {0, 0, 1}));
    }
}

// A ball that rolls without sliding is accelerated by 5/7 g sin.
double LargestError(const SceneWorld& world) {
    const double expected = 0.5 * (5.0 / 7) * 9.81 * Sin(kSlope) * world.Time() * world.Time();
    double largest = 0;
    for (const BodyId id : world.watched)
        largest =
            std::max(largest, std::fabs(Dot<double>(world.Bodies().GetPose(id).position - kTop, kDown) - expected));
    return largest;
}

}  // namespace

extern const Scene kScene{
    .name = "endless_slope",
    .description = "balls roll down a half space that has no end, crates stay; swings hang from bodies without a shape",
    .view = {.color = ColorMode::Plain,
             .from = {0.35f, 0.3f, 1},
             .lower = {-1, 1, -6},
             .upper = {15, 8.6, 7.5},
             .picture = 0.35},
    .build = Build,
    .accuracy = LargestError,
    .accuracyMeaning = "largest distance of a ball from where rolling takes it",
    .accuracyUnit = "m",
    // Velocities lead by half a substep: a t h / 2, a = 5/7 g sin(10 degrees), t = 5 s, h = 1/240 s, make 12.7 mm.
    .accuracyRange = {{0, 0.013}},
};

}  // namespace fulcrum::EndlessSlopeScene
