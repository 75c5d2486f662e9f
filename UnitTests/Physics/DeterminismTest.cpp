// The same scene gives the same bits, however many threads compute it and however often.
#include <Fulcrum/UnitTests/Support/FastScene.h>
#include <Fulcrum/UnitTests/Support/GuidedScene.h>
#include <Fulcrum/UnitTests/Support/JointScene.h>
#include <Fulcrum/UnitTests/Support/MixedScene.h>
#include <Fulcrum/UnitTests/Support/SurfaceScene.h>

namespace fulcrum::testing {
namespace {

TEST(Determinism, TheSameBitsForAnyNumberOfThreads) {
    const uint64_t one = HashOfMixedScene(1);
    EXPECT_EQ(HashOfMixedScene(1), one);
    EXPECT_EQ(HashOfMixedScene(2), one);
    EXPECT_EQ(HashOfMixedScene(4), one);
}

TEST(Determinism, EveryStepIsTheSameForAnyNumberOfThreads) {
    // Where the test above fails, this one says when it began.
    TestWorld one({}, 1), four({}, 4);
    MixedScene sceneOfOne(one), sceneOfFour(four);
    for (int step = 0; step < 60; ++step) {
        sceneOfOne.BeforeStep(step);
        sceneOfFour.BeforeStep(step);
        one.Step();
        four.Step();
        ASSERT_EQ(one.System().HashPoses(), four.System().HashPoses()) << "step " << step;
        ASSERT_EQ(one.Report().contacts, four.Report().contacts) << "step " << step;
        ASSERT_EQ(one.Report().largestPenetration, four.Report().largestPenetration) << "step " << step;
        ASSERT_EQ(one.Report().deepestA, four.Report().deepestA) << "step " << step;
    }
}

TEST(Determinism, OfJointsForAnyNumberOfThreads) {
    const uint64_t one = HashOfJointScene(1);
    EXPECT_EQ(HashOfJointScene(1), one);
    EXPECT_EQ(HashOfJointScene(2), one);
    EXPECT_EQ(HashOfJointScene(3), one);
    EXPECT_EQ(HashOfJointScene(4), one);
}

TEST(Determinism, SurfacesAreTheSameForAnyNumberOfThreads) {
    const uint64_t one = HashOfSurfaceScene(1);
    EXPECT_EQ(HashOfSurfaceScene(1), one);
    for (uint32_t threads : {2u, 3u, 4u}) EXPECT_EQ(HashOfSurfaceScene(threads), one) << threads;
}

TEST(Determinism, FastBodiesAreTheSameForAnyNumberOfThreads) {
    const uint64_t one = HashOfFastScene(1);
    for (uint32_t threads : {2u, 3u, 4u}) EXPECT_EQ(HashOfFastScene(threads), one) << threads;
}

TEST(Determinism, GuidedBodiesAreTheSameForAnyNumberOfThreads) {
    const uint64_t one = HashOfGuidedScene(1);
    for (uint32_t threads : {2u, 3u, 4u}) EXPECT_EQ(HashOfGuidedScene(threads), one) << threads;
}

TEST(Determinism, EveryStepOfJointsIsTheSameForAnyNumberOfThreads) {
    TestWorld one(JointScene::Settings(), 1), three(JointScene::Settings(), 3);
    JointScene sceneOfOne(one), sceneOfThree(three);
    for (int step = 0; step < 60; ++step) {
        sceneOfOne.BeforeStep(step);
        sceneOfThree.BeforeStep(step);
        one.Step();
        three.Step();
        ASSERT_EQ(sceneOfOne.Hash(), sceneOfThree.Hash()) << "step " << step;
        ASSERT_EQ(one.Report().largestJointError, three.Report().largestJointError) << "step " << step;
        ASSERT_EQ(one.Report().worstJoint, three.Report().worstJoint) << "step " << step;
        ASSERT_EQ(one.Report().largestJointAngle, three.Report().largestJointAngle) << "step " << step;
        ASSERT_EQ(one.Report().mostTurnedJoint, three.Report().mostTurnedJoint) << "step " << step;
    }
}

}  // namespace
}  // namespace fulcrum::testing
