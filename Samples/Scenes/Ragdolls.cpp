#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/Samples/Scenes/WavyGround.h>

namespace fulcrum::RagdollsScene {
namespace {

constexpr int kPilesPerSide = 4, kRagdollsPerPile = 10;

void Build(SceneWorld& world) {
    AddWavyGround(world, {});
    const RagdollSettings humanoid = Humanoid();
    for (int row = 0; row < kPilesPerSide; ++row)
        for (int column = 0; column < kPilesPerSide; ++column)
            for (int i = 0; i < kRagdollsPerPile; ++i) {
                const double x = 4 * (column - 1.5), z = 4 * (row - 1.5);
                const Position origin(x, WavyHeight(x, z) + 1 + 1.5 * i, z);
                world.AddRagdoll(humanoid, {origin, RotationAbout(Vector3(0, 1, 0), 2 * kPi * i / kRagdollsPerPile)});
            }
}

}  // namespace

extern const Scene kScene{
    .name = "ragdolls",
    .description = "16 piles of 10 ragdolls, each of 12 capsules and 11 joints, that start overlapped",
    .kind = SceneKind::Performance,
    .steps = 300,
    .sleeping = false,
    .isClosed = true,
    .accuracyRuns = 8,
    .view = {.color = ColorMode::Plain, .lower = {-8, 4, -8}, .upper = {8, 17, 8}, .picture = 0.25},
    .build = Build,
    .accuracy = LargestJointGap,
    .accuracyMeaning = "largest distance between the two anchors of a joint",
    .accuracyUnit = "m",
    .accuracyRange = {{0, 0.05}},
    .accuracyTolerance = 0.01,
};

}  // namespace fulcrum::RagdollsScene
