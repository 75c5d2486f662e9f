#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <array>
#include <cmath>

namespace fulcrum::ConveyorBeltScene {
namespace {

// A body whose surface runs straight ahead, or round a pivot where it turns.
struct Belt {
    BodyId body;
    Vector3 velocity = Vector3::Zero();  // m/s
    Position pivot = Position::Zero();
    Vector3 turning = Vector3::Zero();  // rad/s
};

class Belts final : public ContactListener {
public:
    explicit Belts(std::vector<Belt> belts) : belts_(std::move(belts)) {}

    void ModifyContact(const ContactView& contact, ContactChange& change) const override {
        for (const Belt& belt : belts_) {
            if (belt.body != contact.bodyB) continue;
            change.MoveSurface(contact, belt.body, belt.velocity);
            change.RotateSurface(contact, belt.body, belt.pivot, belt.turning);
        }
    }

private:
    std::vector<Belt> belts_;
};

// The loop: two straight belts along x and two bends, their tops at one height.
constexpr double kTop = 1, kHalfLength = 5, kRadius = 2.2;  // m; the radius is that of the bends' middle
constexpr float kHalfWidth = 0.9f, kHalfThickness = 0.2f;
constexpr float kSpeed = 1.5f;           // m/s
constexpr double kSlope = 12 * kDegree;  // of the belt that brings goods up to the loop

BodyId AddBelt(SceneWorld& world, float halfX, float halfZ, const Position& top) {
    return world.Add({.shape = world.BoxOf(halfX, kHalfThickness, halfZ),
                      .motion = MotionType::Static,
                      .position = top - Position(0, double{kHalfThickness}, 0),
                      .material = {.friction = 0.8f}});
}

std::vector<Belt> AddLoop(SceneWorld& world) {
    std::vector<Belt> belts;
    const float outer = static_cast<float>(kRadius) + kHalfWidth;
    for (double side : {1.0, -1.0}) {
        belts.push_back({.body = AddBelt(world, kHalfLength, kHalfWidth, {0, kTop, side * kRadius}),
                         .velocity = {static_cast<float>(side) * kSpeed, 0, 0}});
        belts.push_back(
            {.body = AddBelt(world, 0.5f * outer, outer, {side * (kHalfLength + double{0.5f * outer}), kTop, 0}),
             .pivot = {side * kHalfLength, kTop, 0},
             .turning = {0, kSpeed / static_cast<float>(kRadius), 0}});
    }
    return belts;
}

// From the floor up to the edge of the loop's belt at z > 0, which it overlooks a little.
Belt AddFeeder(SceneWorld& world) {
    constexpr double kHalf = 3.5;
    const Quaternion tilt = RotationAbout(Vector3(1, 0, 0), kSlope);
    const Position end(0, kTop + 0.1, kRadius + double{kHalfWidth});
    const Position along = Rotate(tilt, Vector3(0, 0, 1)).cast<double>(),
                   up = Rotate(tilt, Vector3(0, 1, 0)).cast<double>();
    return {.body = world.Add({.shape = world.BoxOf(kHalfWidth, kHalfThickness, kHalf),
                               .motion = MotionType::Static,
                               .position = end + along * kHalf - up * double{kHalfThickness},
                               .rotation = tilt,
                               .material = {.friction = 0.8f}}),
            .velocity = (along * -0.8).cast<float>()};
}

void AddGoods(SceneWorld& world, const Position& at, const Quaternion& rotation, int kind) {
    const Vector3 corners[] = {{-0.3f, -0.25f, -0.3f}, {0.3f, -0.25f, -0.3f}, {0, -0.25f, 0.35f},
                               {-0.2f, 0.25f, -0.2f},  {0.2f, 0.25f, -0.2f},  {0, 0.25f, 0.2f}};
    const ShapePtr shapes[] = {world.BoxOf(0.25f, 0.25f, 0.25f), Cylinder::Create(0.25f, 0.3f).Value(),
                               world.HullOf(corners), world.BoxOf(0.4f, 0.25f, 0.2f)};
    world.watched.push_back(world.Add({.shape = shapes[kind % 4], .position = at, .rotation = rotation}));
}

void Build(SceneWorld& world) {
    world.AddFloor(14, 14);
    std::vector<Belt> belts = AddLoop(world);
    belts.push_back(AddFeeder(world));
    for (const Belt& belt : belts)
        world.Show(
            belt.body,
            {.look = Look::Belt, .beltVelocity = belt.velocity, .beltTurning = belt.turning, .beltPivot = belt.pivot});
    world.Listen(std::make_unique<Belts>(belts));
    for (int i = 0; i < 6; ++i)
        for (double side : {1.0, -1.0}) AddGoods(world, {1.6 * i - 4, kTop + 0.3, side * kRadius}, {}, i);
    const Pose feeder = world.Bodies().GetPose(belts.back().body);
    for (int i = 0; i < 4; ++i)
        AddGoods(world, feeder.Transform(Vector3(0, kHalfThickness + 0.27f, 1.4f * static_cast<float>(i) - 3.0f)),
                 feeder.rotation, i);
}

// The number of goods that are not on the loop.
double Accuracy(const SceneWorld& world) {
    int lost = 0;
    for (BodyId id : world.watched) {
        const Position at = world.Bodies().GetPose(id).position;
        const double beyond = std::max(std::fabs(at.x()) - kHalfLength, 0.0);  // of the straight part
        const double radius = std::sqrt(beyond * beyond + at.z() * at.z());
        if (!(at.y() > kTop && std::fabs(radius - kRadius) < double{kHalfWidth})) ++lost;
    }
    return lost;
}

}  // namespace

extern const Scene kScene{
    .name = "conveyor_belt",
    .description = "boxes, cylinders and hulls ride round a loop of belts with two bends, fed by a belt that climbs",
    .steps = 1500,
    .view = {.color = ColorMode::Plain,
             .from = {0.35f, 0.75f, 1},
             .lower = {-8.5, 0.5, -3.5},
             .upper = {8.5, 2, 9},
             .picture = 0.12},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "goods that do not ride on the loop",
    .accuracyUnit = "goods",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::ConveyorBeltScene
