#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::LayersScene {
namespace {

enum Layer : uint8_t { kGround, kSolid, kGhost, kSieve };
constexpr double kSieveHeight = 3;  // m, of its top

void Build(SceneWorld& world) {
    world.AddFloor(10, 10);
    world.Add({.shape = world.BoxOf(5, 0.1f, 5),
               .motion = MotionType::Static,
               .position = {0, kSieveHeight - 0.1, 0},
               .layer = kSieve});
    const ShapePtr cube = world.BoxOf(0.35f, 0.35f, 0.35f), ball = world.SphereOf(0.35f);
    for (int i = 0; i < 8; ++i)
        for (int j = 0; j < 8; ++j) {
            const bool ghost = (i + j) % 2 == 0;
            world.watched.push_back(world.Add({.shape = ghost ? ball : cube,
                                               .position = {1.0 * i - 3.5, 5 + 0.2 * j, 1.0 * j - 3.5},
                                               .layer = ghost ? kGhost : kSolid}));
        }
}

// Cubes belong on the sieve and balls on the ground.
double Accuracy(const SceneWorld& world) {
    int wrong = 0;
    for (BodyId id : world.watched) {
        const bool ghost = world.Bodies().GetShape(id)->Type() == ShapeType::Sphere;
        const double height = world.Bodies().GetPose(id).position.y();
        const bool onGround = height > 0 && height<0.5, onSieve = height> kSieveHeight && height < kSieveHeight + 0.5;
        if (!(ghost ? onGround : onSieve)) ++wrong;
    }
    return wrong;
}

void LetGhostsPass(SystemSettings& settings) {
    settings.layerCollides[kSieve] &= ~(1u << kGhost);
    settings.layerCollides[kGhost] &= ~(1u << kSieve);
}

}  // namespace

extern const Scene kScene{
    .name = "layers",
    .description = "a platform that catches cubes and lets balls of another layer fall through",
    .steps = 240,
    .view = {.color = ColorMode::Plain, .picture = 0.3},
    .adjust = LetGhostsPass,
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "bodies on the wrong floor",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::LayersScene
