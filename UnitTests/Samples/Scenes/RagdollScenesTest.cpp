// The ragdoll scenes: their contents and figures.
#include <Fulcrum/Samples/Scenes/Scenes.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <gtest/gtest.h>

#include <cmath>

namespace fulcrum {
namespace {

std::unique_ptr<SceneWorld> Build(const char* name) {
    auto world = SceneWorld::Create(*FindScene(name));
    EXPECT_TRUE(world) << world.GetError().message;
    return std::move(world.Value());
}

TEST(RagdollScenes, PilesAreThoseOfThePeers) {
    const auto world = Build("ragdolls");
    ASSERT_EQ(world->ragdolls.size(), 160u);
    int joints = 0;
    world->Joints().Visit([&](JointId) { ++joints; });
    EXPECT_EQ(joints, 1760);
    // The ragdoll 3 of the pile in row 1, column 2: turned by 108 degrees, which takes (x, z) to (x cos + z sin, z cos
    // - x sin).
    const Ragdoll& ragdoll = world->ragdolls[(1 * 4 + 2) * 10 + 3];
    ASSERT_EQ(ragdoll.Bodies().size(), 12u);
    const Position foot = world->Bodies().GetPose(ragdoll.Bodies()[11]).position;
    const double sine = 0.9510565163, cosine = -0.3090169944;
    // (2, -2) lies on the diagonal of its cell of 3 m, from grid point (50, 50) to (51, 49), at two thirds of the way.
    const auto gridHeight = [](double x, double z) { return 5 + 5 * std::sin(0.5 * x) * std::cos(0.5 * z); };
    const double ground = (gridHeight(50, 50) + 2 * gridHeight(51, 49)) / 3;
    EXPECT_LT(
        (foot - Position(2 + 0.10 * cosine + 0.05 * sine, ground + 1 + 4.5 - 0.97, -2 + 0.05 * cosine - 0.10 * sine))
            .norm(),
        1e-6);
    // pi r^2 (2 h + 4 r / 3) of the pelvis, times 1000 kg/m3.
    EXPECT_NEAR(world->Bodies().GetMass(ragdoll.Bodies()[0]), kPi * 14.4 * (0.16 + 0.16), 1e-4);
    EXPECT_LT(world->Definition().accuracy(*world), 1e-6);
}

TEST(RagdollScenes, DrivenOnesTakeUpThePose) {
    const auto world = Build("ragdoll_drive");
    for (int step = 0; step < world->Definition().steps; ++step) ASSERT_TRUE(world->Step(1.0 / 60));
    // The hanging one yields by torque / stiffness, 0.55 degrees at the thighs; see RagdollDriveTest.
    EXPECT_LT(world->Definition().accuracy(*world), 1);
    EXPECT_LT(LargestJointGap(*world), 2e-3);
}

}  // namespace
}  // namespace fulcrum
