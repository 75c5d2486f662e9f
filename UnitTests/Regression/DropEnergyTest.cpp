// Bodies that fall, bounce, slide and tumble never have more energy than initially, whatever the time step. Newton's
// law of restitution at several points, with friction, or for impulses of several substeps had made up to three times
// as much.
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/Drops.h>

#include <gtest/gtest.h>

namespace fulcrum::testing {
namespace {

constexpr double kMost = 1.01;

struct Group {
    DropGround ground;
    int together;
};
constexpr Group kGroups[] = {{DropGround::Floor, 1}, {DropGround::Mesh, 1}, {DropGround::Hills, 1},
                             {DropGround::Air, 2},   {DropGround::Air, 5},  {DropGround::Mesh, 5}};

void ExpectNoGain(const DropSettings& settings, uint32_t drops, double seconds) {
    const DropEnergy energy = EnergyOfDrops(settings, 1, drops, seconds);
    EXPECT_TRUE(energy.finite) << NameOf(settings);
    EXPECT_LE(energy.most, kMost) << NameOf(settings) << ": drop " << energy.drop << " in step " << energy.step;
}

// All kinds of restitution and friction.
void ExpectNoGain(const Group& group, int substeps, double dt, uint32_t drops, double seconds) {
    for (const ContinuousCollision kind :
         {ContinuousCollision::Off, ContinuousCollision::Linear, ContinuousCollision::LinearAndAngular})
        for (const float restitution : {0.0f, 0.5f, 1.0f})
            for (const float friction : {0.0f, 0.6f})
                ExpectNoGain({group.ground, group.together, kind, restitution, friction, substeps, dt}, drops, seconds);
}

class DropEnergy : public ::testing::TestWithParam<Group> {};

TEST_P(DropEnergy, IsNeverMoreThanAtFirst) {
    for (const int substeps : {1, 4, 16})
        ExpectNoGain(GetParam(), substeps, 1.0 / 60, kIsSanitized ? 2 : 15, kIsSanitized ? 1 : 2);
}

// A thousand of each; minutes.
TEST_P(DropEnergy, DISABLED_OfAThousandIsNeverMoreThanAtFirst) {
    for (const int substeps : {1, 4, 16})
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) ExpectNoGain(GetParam(), substeps, dt, 1000, 3);
}

INSTANTIATE_TEST_SUITE_P(Grounds, DropEnergy, ::testing::ValuesIn(kGroups));

}  // namespace
}  // namespace fulcrum::testing
