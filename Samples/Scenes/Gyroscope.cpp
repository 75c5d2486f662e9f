#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <array>

namespace fulcrum::GyroscopeScene {
namespace {

const Vector3 kSpin(0.01f, 6, 0.01f);  // rad/s, almost about y

// A T-shaped handle: its moments of inertia are 1.9, 6.0 and 7.5 kg m2 about x, y and z, so that turning about y is
// unstable.
void Build(SceneWorld& world) {
    const std::array<Compound::ChildSettings, 2> bars{
        {{.shape = world.BoxOf(0.6f, 0.1f, 0.1f)},
         {.shape = world.BoxOf(0.08f, 0.25f, 0.08f), .position = {0, -0.35f, 0}}}};
    world.watched.push_back(world.Add({.shape = world.CompoundOf(bars), .angularVelocity = kSpin}));
}

// Relative to the initial angular momentum, which is along y to within 1e-6.
double Accuracy(const SceneWorld& world) {
    const BodyId handle = world.watched[0];
    const MassProperties& mass = world.Bodies().GetShape(handle)->Mass();
    const double density = world.Bodies().GetMass(handle) / static_cast<double>(mass.volume);
    // The principal axes may be numbered in any order: in the shape's frame, L = R I R^T w.
    const Vector3 local = InverseRotate(mass.principalAxes, kSpin);
    const Vector3 began = Rotate(mass.principalAxes, Vector3(local.cwiseProduct(mass.principalInertia)));
    const Position start = began.cast<double>() * density;
    return (world.Bodies().GetAngularMomentum(handle).cast<double>() - start).norm() / start.norm();
}

}  // namespace

extern const Scene kScene{
    .name = "gyroscope",
    .description = "a T-handle spins without gravity and flips over every few seconds",
    .steps = 1200,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Plain},
    .adjust = [](SystemSettings& settings) { settings.gravity = Vector3::Zero(); },
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "change of angular momentum",
    .accuracyUnit = "parts",
    // 1200 steps of 6 substeps, each of which rounds the rotation and the velocity by 6e-8 of them: 9e-4 at most.
    .accuracyRange = {{0, 0.0009}},
};

}  // namespace fulcrum::GyroscopeScene
