#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <array>

namespace fulcrum::FrictionRampScene {
namespace {

constexpr double kSlope = 25 * kDegree;  // its tangent is 0.466
constexpr std::array<float, 9> kFriction{0.1f, 0.2f, 0.3f, 0.4f, 0.44f, 0.49f, 0.55f, 0.65f, 0.8f};
constexpr double kHalfLength = 9;

// `along` meters downhill (+x) of the ramp's middle, `above` meters off its surface.
Position OnRamp(double along, double above, double z) {
    const double sine = Sin(kSlope), cosine = Cos(kSlope);
    return {along * cosine + above * sine, 5 - along * sine + above * cosine, z};
}

Position StartOf(size_t box) { return OnRamp(2 - kHalfLength, 0.4, 1.2 * (static_cast<double>(box) - 4)); }

// The ramp's coefficient is 1 and the boxes multiply theirs with it, so each slides or sticks by its own.
void Build(SceneWorld& world) {
    world.AddFloor(20, 10);
    world.AddWalls(19, 9, 1);
    const Quaternion tilt = RotationAbout(Vector3(0, 0, 1), -kSlope);
    world.Add({.shape = world.BoxOf(kHalfLength, 0.2f, 6),
               .motion = MotionType::Static,
               .position = OnRamp(0, -0.2, 0),
               .rotation = tilt,
               .material = {.friction = 1}});
    const ShapePtr cube = world.BoxOf(0.4f, 0.4f, 0.4f);
    for (size_t i = 0; i < kFriction.size(); ++i)
        world.watched.push_back(
            world.Add({.shape = cube,
                       .position = StartOf(i),
                       .rotation = tilt,
                       .material = {.friction = kFriction[i], .frictionRule = CombineRule::Multiply}}));
    for (size_t i = 0; i < kFriction.size(); ++i) world.Show(world.watched[i], {.label = LabelOf(kFriction[i])});
}

// A box that sticks has moved less than 1 cm; one that slides has covered the 1 m that even mu = 0.44 slides in 3 s.
double Accuracy(const SceneWorld& world) {
    int wrong = 0;
    for (size_t i = 0; i < kFriction.size(); ++i) {
        const double moved = (world.Bodies().GetPose(world.watched[i]).position - StartOf(i)).norm();
        const bool shouldStick = kFriction[i] > Sin(kSlope) / Cos(kSlope);
        if (!(shouldStick ? moved < 0.01 : moved > 1)) ++wrong;
    }
    return wrong;
}

}  // namespace

extern const Scene kScene{
    .name = "friction_ramp",
    .description = "nine boxes on a ramp of 25 degrees: those with a friction above its tangent, 0.466, stick",
    .steps = 300,
    .isClosed = true,
    .view = {.color = ColorMode::Plain,
             .from = {0.8f, 0.5f, 0.8f},
             .lower = {-8, 0.5, -6},
             .upper = {8, 15, 6},  // room for the labels
             .picture = 0.42},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "boxes that slide but should stick, or stick but should slide",
    .accuracyUnit = "boxes",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::FrictionRampScene
