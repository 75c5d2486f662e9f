#include <Fulcrum/Samples/Scenes/Humanoid.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum {
namespace {

constexpr int kPilesPerSide = 4, kRagdollsPerPile = 10;

void Build(SceneWorld& world) {
    world.AddFloor(125, 125);
    const RagdollSettings humanoid = Humanoid();
    for (int row = 0; row < kPilesPerSide; ++row)
        for (int column = 0; column < kPilesPerSide; ++column)
            for (int i = 0; i < kRagdollsPerPile; ++i) {
                const Position origin(4 * (column - 1.5), 1 + 1.5 * i, 4 * (row - 1.5));
                world.AddRagdoll(humanoid, {origin, Turn(Vector3(0, 1, 0), 2 * kPi * i / kRagdollsPerPile)});
            }
}

}  // namespace

extern const Scene kRagdollsScene{
    .name = "ragdolls",
    .description = "16 piles of 10 ragdolls, each of 12 capsules and 11 joints, that start overlapped",
    .kind = SceneKind::Performance,
    .steps = 300,
    .sleeping = false,
    .build = Build,
    .accuracy = LargestJointGap,
    .accuracyMeaning = "largest distance between the two anchors of a joint, m",
};

}  // namespace fulcrum
