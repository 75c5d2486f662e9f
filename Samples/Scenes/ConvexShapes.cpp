#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::ConvexShapesScene {
namespace {

// A custom shape as a user would write it: an egg, blunt below and pointed above.
class Egg final : public CustomConvex {
public:
    Vector3 FarthestPoint(const Vector3& direction) const override {
        const Vector3 radii(0.3f, direction.y() < 0 ? 0.3f : 0.5f, 0.3f), scaled = direction.cwiseProduct(radii);
        return scaled.cwiseProduct(radii) * (1.0f / Length(scaled));
    }
};

constexpr double kSlope = 15 * kDegree;
constexpr double kSpacing = 1.5;  // m

// Each kind of shape once on its base, once rolling down a slope, and all of them falling into a heap.
void Build(SceneWorld& world) {
    world.AddFloor(15, 15);
    world.AddWalls(15, 15, 1);
    const Result<std::shared_ptr<const Cylinder>> drum = Cylinder::Create(0.4f, 0.3f),
                                                  cone = Cylinder::CreateCone(0.4f, 0.3f);
    const auto cup = Cylinder::CreateTapered(0.4f, 0.35f, 0.2f), puck = Cylinder::Create(0.15f, 0.4f, 0.05f);
    const auto skittle = TaperedCapsule::Create(0.4f, 0.12f, 0.28f);
    const auto plate = Triangle::Create(Vector3(-0.5f, 0, -0.4f), Vector3(0, 0, 0.5f), Vector3(0.5f, 0, -0.4f), 0.04f);
    const auto egg = CreateCustom<Egg>();
    const ShapePtr shapes[] = {drum.Value(),    cone.Value(),  cup.Value(), puck.Value(),
                               skittle.Value(), plate.Value(), egg.Value()};
    constexpr int kKinds = static_cast<int>(std::size(shapes));

    const Quaternion tilt = RotationAbout(Vector3(0, 0, 1), -kSlope);
    world.Add(
        {.shape = world.BoxOf(4, 0.1f, 6), .motion = MotionType::Static, .position = {-7, 1.5, 0}, .rotation = tilt});
    for (int i = 0; i < kKinds; ++i) {
        const double z = kSpacing * (i - 0.5 * (kKinds - 1));
        const double foot = -double{shapes[i]->LocalBounds().lower.y()} - double{shapes[i]->Mass().centerOfMass.y()};
        world.watched.push_back(world.Add({.shape = shapes[i], .position = {5, foot, z}}));
        // On its side, its axis along z.
        const double radius = double{shapes[i]->LocalBounds().upper.x()};
        const Position top =
            Position(-7, 1.5, 0) + Rotate(tilt, Vector3(-3, 0.12f + static_cast<float>(radius), 0)).cast<double>();
        world.watched.push_back(world.Add({.shape = shapes[i],
                                           .position = top + Position(0, 0, z),
                                           .rotation = tilt * RotationAbout(Vector3(1, 0, 0), 90 * kDegree)}));
    }
    for (int i = 0; i < 5 * kKinds; ++i) {
        const Position place(1 + 0.9 * (i % 3), 1.5 + 0.35 * i, 0.9 * (i / 3 % 3 - 1));
        world.watched.push_back(world.Add({.shape = shapes[i % kKinds],
                                           .position = place,
                                           .rotation = RotationAbout(Vector3(0.6f, 0, 0.8f), 0.7 * i)}));
    }
}

}  // namespace

extern const Scene kScene{
    .name = "convex_shapes",
    .description = "cylinders, cones, tapered capsules, plates and a user's egg stand, roll and fall",
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .lower = {-10, 0, -4.5}, .upper = {7, 3, 5}, .picture = 0.3},
    .build = Build,
    .accuracy = BodiesBelowTheFloor,
    .accuracyMeaning = "bodies that fell through the floor",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::ConvexShapesScene
