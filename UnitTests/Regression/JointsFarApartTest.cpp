// Joints whose bodies were put far apart, by SetPose, say: every kind of joint, with limits, motors, springs and
// friction, brings its bodies together within seconds, no body gets fast on the way, and no energy is left behind.
#include <Fulcrum/UnitTests/Regression/FarApart.h>

namespace fulcrum::testing::far_apart {
namespace {

// Bodies are at rest in the beginning: what they get is the work of gravity, motors and springs, and the rest of the
// last push. Not judged: drives, whose powers are seen between steps alone (JointSpringTest and SpringEnergyTest judge
// them), and racks on the ground (Docs/Joints.md).
constexpr double kLeftBehind = 5;  // J, of bodies of 0.4 and 1 t

void ExpectToRecover(Kind kind, uint32_t i) {
    SCOPED_TRACE(std::string(kNames[static_cast<size_t>(kind)]) + " " + std::to_string(i));
    const Case how = CaseOf(i);
    const Recovery result = FarApart(kind, how, 1000003u * static_cast<uint32_t>(kind) + i).Run();
    EXPECT_TRUE(result.finite);
    // A rack's way is turns of its pinion, of which jointPushSpeed corrects 20 rad/s.
    EXPECT_TRUE(result.together || kind == Kind::RackAndPinion) << "apart by " << result.apart;
    EXPECT_LT(result.fastest, kFastest);
    const bool isJudged = !how.isDriven && (!how.hasFloor || kind != Kind::RackAndPinion);
    if (isJudged) {
        EXPECT_LT(result.gained, kLeftBehind) << "of " << result.energy;
    }
}

void ExpectAllToRecover(Kind kind, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) ExpectToRecover(kind, i);
}

class JointsFarApart : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Every, JointsFarApart, ::testing::Range(0, static_cast<int>(Kind::Count)),
                         [](const auto& kind) { return std::string(kNames[kind.param]); });

TEST_P(JointsFarApart, ComeTogetherWithoutAnExplosion) { ExpectAllToRecover(static_cast<Kind>(GetParam()), 30); }
// A quarter of an hour for all kinds.
TEST_P(JointsFarApart, DISABLED_TenThousandComeTogetherWithoutAnExplosion) {
    ExpectAllToRecover(static_cast<Kind>(GetParam()), 10000);
}

// As B came near a curved path, its rotation was pulled, which moved it away again, where its rotation was free: it
// never arrived. Or its rotation was pulled about the wrong axis.
TEST(PathsFarApart, ComeTogetherWhereTheirRotationMovesThemAway) {
    for (const uint32_t i : {2099u, 2147u, 3467u, 3879u, 3901u, 4179u}) ExpectToRecover(Kind::Path, i);
}

// Where a path curves tightly, its rows depend on each other: solved one after the other they left pushes that should
// have been relaxed, of up to 10 m/s, and rotation was locked to a frame that turned about B. Gained up to 24 kJ.
TEST(PathsFarApart, GainNothingWhereTheyCurveTightly) {
    for (const uint32_t i : {635u, 4773u, 4797u, 7083u, 7499u, 9341u}) ExpectToRecover(Kind::Path, i);
}

// The way along a wheel's suspension, tens of meters beyond its limits, counted as a lever arm: as one of the bodies
// touched the ground on the way, the other was spun up, by up to 17 kJ.
TEST(WheelsFarApart, AreNotSpunUpByTheGround) {
    for (const uint32_t i : {1528u, 3700u, 8488u}) ExpectToRecover(Kind::Wheel, i);
}

// On a soft limit bodies were meters apart along their line, which is no gap. But the lever arm along it was cut, so
// that they drifted off the line as fast as they were pulled back to it, with all springs inactive.
TEST(SixDofsFarApart, ComeTogetherWhereASpringHoldsThemMetersAlongTheirLine) {
    for (const uint32_t i : {2477u, 9413u}) ExpectToRecover(Kind::SixDof, i);
}

}  // namespace
}  // namespace fulcrum::testing::far_apart
