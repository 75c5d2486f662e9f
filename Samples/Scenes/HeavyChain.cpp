#include <Fulcrum/Samples/Scenes/JointShorthands.h>

namespace fulcrum::HeavyChainScene {
namespace {

constexpr int kLinks = 16;
constexpr double kLength = kLinks + 0.5;  // m, to the middle of the ball

// Sixteen links of 1 kg and a ball of 100 kg, swung down from horizontal; links pass through each other.
void Build(SceneWorld& world) {
    const ShapePtr link = world.BoxOf(0.45f, 0.05f, 0.05f);
    BodyId last = AddHook(world, {0, 0, 0});
    for (int i = 0; i <= kLinks; ++i) {
        const bool isBall = i == kLinks;
        const BodyId next = world.Add({.shape = isBall ? world.SphereOf(0.4f) : link,
                                       .position = {i + 0.5, 0, 0},
                                       .mass = isBall ? 100.0f : 1.0f,
                                       .layer = 1});
        world.Join(JointOf<PointJointSettings>(last, next, {double(i), 0, 0}));
        last = next;
    }
    world.watched.push_back(last);
}

void NoContacts(SystemSettings& settings) { settings.layerCollides[1] &= ~2u; }

// All gaps together, of the length.
double Stretch(const SceneWorld& world) {
    double sum = 0;
    world.Joints().Visit([&](JointId id) {
        sum += (world.Joints().GetFrameB(id).position - world.Joints().GetFrameA(id).position).norm();
    });
    return 100 * sum / kLength;
}

}  // namespace

// The ball passes the lowest point, where the chain carries the most, after T / 4 = 2.3678 s sqrt(16.5) / 4 = 144
// steps.
extern const Scene kScene{
    .name = "heavy_chain",
    .description = "a chain of 16 links of 1 kg with a ball of 100 kg, swung from horizontal",
    .steps = 144,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .from = {0, 0.1f, 1}, .picture = 0.55, .showsJoints = false},
    .adjust = NoContacts,
    .build = Build,
    .accuracy = Stretch,
    .accuracyMeaning = "stretch of the chain, of its length",
    .accuracyUnit = "%",
    .accuracyRange = {{0, 0.1}},
};

}  // namespace fulcrum::HeavyChainScene
