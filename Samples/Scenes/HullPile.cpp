#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum::HullPileScene {
namespace {

constexpr int kPoints = 32;

// 32 points spread evenly over a sphere of radius 2 m along a spiral of the golden angle.
ShapePtr FibonacciHull(SceneWorld& world) {
    std::vector<Vector3> points;
    for (int n = 0; n < kPoints; ++n) {
        const double y = 1 - (2 * n + 1) / static_cast<double>(kPoints);
        const double radius = std::sqrt(1 - y * y);
        const double angle = n * kPi * (3 - std::sqrt(5.0));
        points.push_back(Position(2 * radius * Cos(angle), 2 * y, 2 * radius * Sin(angle)).cast<float>());
    }
    return world.HullOf(points);
}

void Build(SceneWorld& world) {
    world.AddFloor(250, 250);
    const ShapePtr hull = FibonacciHull(world);
    for (int layer = 0; layer < 40; ++layer)
        for (int column = 0; column < 8; ++column)
            for (int row = 0; row < 8; ++row)
                world.Add({.shape = hull, .position = {4.0 * (column - 4), 2 + 4.0 * layer, 4.0 * (row - 4)}});
}

// A body whose pose is not finite counts as infinitely deep.
double Accuracy(const SceneWorld& world) {
    double lowest = 0;
    world.System().VisitBodies([&](BodyId id) {
        if (world.Bodies().GetMotionType(id) != MotionType::Dynamic) return;
        const double margin = world.Bodies().GetPose(id).position.y() - 1.8;
        lowest = std::isfinite(margin) ? std::min(lowest, margin) : -std::numeric_limits<double>::infinity();
    });
    return lowest;
}

}  // namespace

extern const Scene kScene{
    .name = "hull_pile",
    .description = "2560 hulls of 32 points in columns that collapse into a pile",
    .kind = SceneKind::Performance,
    .steps = 300,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .picture = 1},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "smallest height of a body's center minus 1.8 m, where negative",
    .accuracyUnit = "m",
    .accuracyRange = {{-0.1, 0}},
    .accuracyTolerance = 0.02,
};

}  // namespace fulcrum::HullPileScene
