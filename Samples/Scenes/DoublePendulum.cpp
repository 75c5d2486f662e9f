#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <cmath>

namespace fulcrum::DoublePendulumScene {
namespace {

// Two rods on hinges, and beside them the same pair, half a millimeter aside at the start: soon they go different ways.
// They pass through each other and their hooks.
void Build(SceneWorld& world) {
    const ShapePtr rod = world.BoxOf(0.5f, 0.05f, 0.05f);
    for (const double aside : {0.0, 5e-4}) {
        const double z = aside > 0 ? 1 : 0;
        const BodyId hook = AddHook(world, {0, 3, z});
        const BodyId upper = world.Add({.shape = rod, .position = {0.5, 3, z}, .mass = 1, .layer = 1});
        const BodyId lower = world.Add({.shape = rod, .position = {1.5, 3 + aside, z}, .mass = 1, .layer = 1});
        world.Join(JointOf<HingeJointSettings>(hook, upper, {0, 3, z}, {0, 0, 1}));
        world.Join(JointOf<HingeJointSettings>(upper, lower, {1, 3, z}, {0, 0, 1}));
    }
}

void NoContacts(SystemSettings& settings) {
    settings.layerCollides[0] &= ~2u;
    settings.layerCollides[1] &= ~3u;
}

double EnergyChange(const SceneWorld& world) {
    constexpr double kStart = 4 * 9.81 * 3, kScale = 2 * 9.81 * (0.5 + 1.5);  // of four rods; what can fall
    return 100 * std::fabs(world.System().GetEnergy() - kStart) / kScale;
}

}  // namespace

extern const Scene kScene{
    .name = "double_pendulum",
    .description = "two double pendulums that start half a millimeter apart",
    .steps = 600,
    .sleeping = false,
    .isClosed = true,
    .view = {.color = ColorMode::Island, .from = {0.45f, 0.15f, 1}, .picture = 0.4, .showsJoints = false},
    .adjust = NoContacts,
    .build = Build,
    .accuracy = EnergyChange,
    .accuracyMeaning = "change of the energy, of that of the fall",
    .accuracyUnit = "%",
    // Chaotic: 1.3 % was measured.
    .accuracyRange = {{0, 3}},
};

}  // namespace fulcrum::DoublePendulumScene
