#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <cmath>

namespace fulcrum::HighSpeedScene {
namespace {

constexpr double kSide = 50;   // m, half
constexpr float kSpeed = 250;  // m/s

void NoGravity(SystemSettings& settings) { settings.gravity.setZero(); }

// Between the walls' middles.
void AddRoom(SceneWorld& world) {
    const Material wall{.friction = 1, .restitution = 1};
    const auto half = static_cast<float>(kSide);
    const ShapePtr across[3] = {world.BoxOf(0.2f, half, half), world.BoxOf(half, 0.2f, half),
                                world.BoxOf(half, half, 0.2f)};
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-kSide, kSide}) {
            Position at = Position::Zero();
            at[axis] = side;
            world.Add({.shape = across[axis], .motion = MotionType::Static, .position = at, .material = wall});
        }
}

Position InCube(Random& random, double half) {
    const double x = random.Between(-half, half), y = random.Between(-half, half), z = random.Between(-half, half);
    return {x, y, z};
}

Vector3 Direction(Random& random) {
    for (;;) {
        const Position d = InCube(random, 1);
        const double length = std::sqrt(Dot<double>(d, d));
        if (length <= 1 && length >= 1e-3) return Position(d * (1 / length)).cast<float>();
    }
}

void Build(SceneWorld& world) {
    AddRoom(world);
    const ShapePtr shapes[] = {world.SphereOf(0.5f), world.BoxOf(0.25f, 0.5f, 0.5f), world.BoxOf(0.5f, 0.125f, 0.125f)};
    Random random(1);  // a performance scene is the same for any seed
    for (int i = 0; i < 5000; ++i) {
        const Position at = InCube(random, 45);
        const Vector3 direction = Direction(random);
        world.Add({.shape = shapes[i % 3],
                   .position = at,
                   .linearVelocity = direction * kSpeed,
                   .material = {.friction = 0, .restitution = 1},
                   .continuous = ContinuousCollision::Linear});
    }
}

double EscapedBodies(const SceneWorld& world) {
    double count = 0;
    world.System().VisitBodies([&](BodyId id) {
        const Position p = world.Bodies().GetPose(id).position;
        if (world.Bodies().GetMotionType(id) == MotionType::Dynamic) count += !(p.cwiseAbs().maxCoeff() <= kSide);
    });
    return count;
}

}  // namespace

extern const Scene kScene{
    .name = "high_speed",
    .description = "5000 balls, boxes and rods at 250 m/s in a room of walls 40 cm thick",
    .kind = SceneKind::Performance,
    .steps = 200,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Speed, .picture = 0.2},
    .adjust = NoGravity,
    .build = Build,
    .accuracy = EscapedBodies,
    .accuracyMeaning = "bodies outside the room",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
    .accuracyTolerance = 0,
};

}  // namespace fulcrum::HighSpeedScene
