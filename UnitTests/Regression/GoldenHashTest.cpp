// The poses of the mixed scene, as one number. Every build gives it: scalar, SSE2 and AVX2 lanes, gcc and clang, any number of
// threads. A change of the engine that is meant to change results writes the new number here, which the failure prints.
#include <Fulcrum/UnitTests/Support/MixedScene.h>

#include <cstdio>
#include <string>

namespace fulcrum::testing {
namespace {

constexpr uint64_t kGoldenHash = 0x5f17211406508028ull;

std::string Hex(uint64_t number) {
    char text[24];
    std::snprintf(text, sizeof text, "0x%016llxull", static_cast<unsigned long long>(number));
    return text;
}

TEST(GoldenHash, OfTheMixedScene) {
    const uint64_t hash = HashOfMixedScene(1);
    EXPECT_EQ(hash, kGoldenHash) << "This build gives kGoldenHash = " << Hex(hash);
}

}  // namespace
}  // namespace fulcrum::testing
