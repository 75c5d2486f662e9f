#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <cmath>

namespace fulcrum::DrumScene {
namespace {

constexpr double kHeight = 21;  // m, of the drum's axis

// Segment i spans 10 degrees about z between two radii, 20 m long.
Compound::ChildSettings Segment(SceneWorld& world, int i, double inner, double outer) {
    std::vector<Vector3> corners;
    for (double z : {-10.0, 10.0})
        for (int side = 0; side < 2; ++side)
            for (double radius : {inner, outer}) {
                const double angle = 10.0 * (i + side) * kDegree;
                corners.push_back(Position(radius * Cos(angle), radius * Sin(angle), z).cast<float>());
            }
    return {.shape = world.HullOf(corners)};
}

void Build(SceneWorld& world) {
    std::vector<Compound::ChildSettings> segments;
    for (int i = 0; i < 36; ++i) {
        segments.push_back(Segment(world, i, 16, 18));
        if (i % 9 == 0) segments.push_back(Segment(world, i, 14, 16));  // a paddle
    }
    world.Add({.shape = world.CompoundOf(segments),
               .motion = MotionType::Kinematic,
               .position = {0, kHeight, 0},
               .angularVelocity = {0, 0, static_cast<float>(25 * kDegree)}});

    const ShapePtr cube = world.BoxOf(0.2f, 0.2f, 0.2f);
    for (int i = 0; i < 20; ++i)
        for (int j = 0; j < 20; ++j)
            for (int k = 0; k < 20; ++k)
                world.watched.push_back(world.Add(
                    {.shape = cube, .position = {0.8 * (i - 9.5), kHeight + 0.8 * (j - 9.5), 0.8 * (k - 9.5)}}));
}

// They may leave through the open ends.
double Accuracy(const SceneWorld& world) {
    int outside = 0;
    for (BodyId id : world.watched) {
        const Position place = world.Bodies().GetPose(id).position;
        const double x = place.x(), y = place.y() - kHeight;
        if (!(std::sqrt(x * x + y * y) <= 18 || std::fabs(place.z()) >= 9.5)) ++outside;
    }
    return outside;
}

}  // namespace

extern const Scene kScene{
    .name = "drum",
    .description = "8000 boxes tumble in a turning drum with four paddles",
    .kind = SceneKind::Performance,
    .steps = 300,
    .sleeping = false,
    .view = {.color = ColorMode::Speed,
             .from = {0.25f, 0.1f, 1},
             .lower = {-18, 2, -10},
             .upper = {18, 40, 10},
             .picture = 0.75},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "boxes that went through the drum's wall",
    .accuracyUnit = "boxes",
    // A box in a corner of the paddles may be pressed through.
    .accuracyRange = {{0, 1}},
    .accuracyTolerance = 1,
};

}  // namespace fulcrum::DrumScene
