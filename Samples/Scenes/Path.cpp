#include <Fulcrum/Constraints/Parts/RotationEulerPart.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>

namespace fulcrum::PathScene {
namespace {

constexpr int kCars = 6;
constexpr float kSpeed = 4;  // m/s

// A closed track with two hills, through twelve points.
std::shared_ptr<const Path> Track() {
    std::vector<Vector3> points;
    for (int i = 0; i < 12; ++i) {
        const double angle = 2 * kPi * i / 12;
        points.push_back(Position(6 * Cos(angle), 3 + Sin(2 * angle), 4 * Sin(angle)).cast<float>());
    }
    const Vector3 up(0, 1, 0);
    auto path = Path::CatmullRom(points, {&up, 1}, true);
    return path ? path.Value() : nullptr;
}

// Cars that motors drive around, upright, and a bead on a wire that gravity alone moves.
void Build(SceneWorld& world) {
    const std::shared_ptr<const Path> track = Track();
    if (!track) return;
    const BodyId ground = world.AddFloor(10, 8);
    const auto add = [&](const ShapePtr& shape, double t, PathRotation rotation) {
        const PathSample at = track->Sample(t);
        const Position place = at.position.cast<double>();
        const BodyId body = world.Add({.shape = shape,
                                       .position = place,
                                       .rotation = RotationFromAxesXY(at.tangent, at.normal),
                                       .mass = 10,
                                       .layer = 1});
        auto settings = JointOfTwo<PathJointSettings>(ground, body, {0, 0, 0}, place);
        settings.anchorA.normal = Vector3(0, 1, 0);
        settings.anchorB->axis = at.tangent;
        settings.anchorB->normal = at.normal;
        settings.path = track;
        settings.rotation = rotation;
        if (rotation == PathRotation::TangentAndNormal) settings.along.motor = MotorToSpeed(kSpeed, 2000);
        world.watched.push_back(body);
        world.joints.push_back(world.Join(settings));
    };
    const ShapePtr car = world.BoxOf(0.4f, 0.15f, 0.2f);
    for (int i = 0; i < kCars; ++i) add(car, 2.0 * i, PathRotation::TangentAndNormal);
    add(world.SphereOf(0.2f), 1, PathRotation::Free);
}

void NoContacts(SystemSettings& settings) { settings.layerCollides[1] &= ~2u; }

double Accuracy(const SceneWorld& world) {
    const std::shared_ptr<const Path> track = Track();
    double worst = 0;
    for (const BodyId id : world.watched) {
        const Position place = world.Bodies().GetPose(id).position;
        const Vector3 local = place.cast<float>();
        worst = std::max(worst, double(Length(Vector3(track->Sample(track->Closest(local)).position - local))));
    }
    return worst;
}

}  // namespace

extern const Scene kScene{
    .name = "path",
    .description = "cars that motors drive along a hilly track, and a bead that slides on it",
    .steps = 600,
    .sleeping = false,
    .view = {.color = ColorMode::Plain},
    .adjust = NoContacts,
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "largest distance of a car or the bead from the track",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.005}},
};

}  // namespace fulcrum::PathScene
