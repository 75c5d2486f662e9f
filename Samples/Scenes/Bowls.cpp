#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <array>

namespace fulcrum::BowlsScene {
namespace {

constexpr double kInner = 2, kOuter = 2.2;  // m, radii of a bowl
constexpr int kBands = 5, kSectors = 24;
constexpr double kRim = 55 * kDegree;  // from the bottom
constexpr std::array<float, 4> kDamping{0, 0.1f, 0.5f, 3};

Position BowlCenter(size_t bowl) { return {4.2 * (static_cast<double>(bowl) - 1.5), kOuter, 0}; }

// The lower part of a hollow ball, of convex pieces: bands from the bottom to the rim, each cut into sectors.
ShapePtr Bowl(SceneWorld& world) {
    std::vector<Compound::ChildSettings> pieces;
    for (int band = 0; band < kBands; ++band)
        for (int sector = 0; sector < kSectors; ++sector) {
            std::vector<Vector3> corners;
            for (int corner = 0; corner < 8; ++corner) {
                const double radius = corner & 1 ? kOuter : kInner;
                const double polar = kRim * (band + (corner >> 1 & 1)) / kBands;
                const double around = 2 * kPi * (sector + (corner >> 2)) / kSectors;
                corners.push_back(
                    Position(radius * Sin(polar) * Cos(around), -radius * Cos(polar), radius * Sin(polar) * Sin(around))
                        .cast<float>());
            }
            pieces.push_back({.shape = world.HullOf(corners)});
        }
    return world.CompoundOf(pieces);
}

// In each bowl two balls let go near the rim, at opposite sides of different planes, and a capsule.
void Build(SceneWorld& world) {
    world.AddFloor(12, 12);
    const ShapePtr bowl = Bowl(world), ball = world.SphereOf(0.2f), capsule = world.CapsuleOf(0.2f, 0.12f);
    for (size_t i = 0; i < kDamping.size(); ++i) {
        const Position center = BowlCenter(i);
        const BodyId id = world.Add({.shape = bowl, .motion = MotionType::Static, .position = center});
        world.Show(id, {.label = LabelOf(kDamping[i]) + "/s", .look = Look::Wood});
        const auto addMoving = [&](const ShapePtr& shape, const Position& place) {
            world.watched.push_back(world.Add({.shape = shape,
                                               .position = center + place,
                                               .linearDamping = kDamping[i],
                                               .angularDamping = kDamping[i]}));
        };
        addMoving(ball, {1.3, -1.1, 0});
        addMoving(ball, {0.1, -1.05, 1.35});
        addMoving(capsule, {-1, -0.9, -0.5});
    }
}

double Accuracy(const SceneWorld& world) {
    int outside = 0;
    for (size_t i = 0; i < world.watched.size(); ++i) {
        const Position place = world.Bodies().GetPose(world.watched[i]).position - BowlCenter(i / 3);
        if (!(place.norm() < kInner)) ++outside;
    }
    return outside;
}

}  // namespace

extern const Scene kScene{
    .name = "bowls",
    .description = "balls and capsules roll in four bowls, damped by 0, 0.1, 0.5 and 3 per second",
    .steps = 600,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .from = {0, 0.8f, 1}, .picture = 0.08},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "bodies outside their bowl",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::BowlsScene
