// Golden hashes of the mixed scene and of those of joints, surfaces, fast bodies and locked axes. Every build must give
// them: scalar, SSE2 and AVX2 lanes, gcc and clang, any number of threads. A change of the engine that is meant to
// change results writes the new numbers here, which the failure prints.
#include <Fulcrum/UnitTests/Support/FastScene.h>
#include <Fulcrum/UnitTests/Support/GuidedScene.h>
#include <Fulcrum/UnitTests/Support/JointScene.h>
#include <Fulcrum/UnitTests/Support/MixedScene.h>
#include <Fulcrum/UnitTests/Support/SurfaceScene.h>

#include <cstdio>
#include <string>

namespace fulcrum::testing {
namespace {

constexpr uint64_t kGoldenHash = 0x24d159f834794dbcull;
constexpr uint64_t kGoldenHashOfJoints = 0x473da7684c22a482ull;
constexpr uint64_t kGoldenHashOfSurfaces = 0xef9a70ead0e6dc84ull;
constexpr uint64_t kGoldenHashOfFastBodies = 0xc78b91e4bdeb6926ull;
constexpr uint64_t kGoldenHashOfGuidedBodies = 0x32d332132cb2078aull;

std::string Hex(uint64_t number) {
    char text[24];
    std::snprintf(text, sizeof text, "0x%016llxull", static_cast<unsigned long long>(number));
    return text;
}

TEST(GoldenHash, OfTheMixedScene) {
    const uint64_t hash = HashOfMixedScene(1);
    EXPECT_EQ(hash, kGoldenHash) << "This build gives kGoldenHash = " << Hex(hash);
}

TEST(GoldenHash, OfTheJointScene) {
    const uint64_t hash = HashOfJointScene(1);
    EXPECT_EQ(hash, kGoldenHashOfJoints) << "This build gives kGoldenHashOfJoints = " << Hex(hash);
}

TEST(GoldenHash, OfTheSurfaceScene) {
    const uint64_t hash = HashOfSurfaceScene(1);
    EXPECT_EQ(hash, kGoldenHashOfSurfaces) << "This build gives kGoldenHashOfSurfaces = " << Hex(hash);
}

TEST(GoldenHash, OfTheFastScene) {
    const uint64_t hash = HashOfFastScene(1);
    EXPECT_EQ(hash, kGoldenHashOfFastBodies) << "This build gives kGoldenHashOfFastBodies = " << Hex(hash);
}

TEST(GoldenHash, OfTheGuidedScene) {
    const uint64_t hash = HashOfGuidedScene(1);
    EXPECT_EQ(hash, kGoldenHashOfGuidedBodies) << "This build gives kGoldenHashOfGuidedBodies = " << Hex(hash);
}

}  // namespace
}  // namespace fulcrum::testing
