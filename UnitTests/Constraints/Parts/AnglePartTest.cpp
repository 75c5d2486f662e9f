// The angle part against its derivation and in closed form.
#include "RandomBodies.h"

#include <Fulcrum/Constraints/Parts/AnglePart.h>

#include <gtest/gtest.h>

#include <limits>

namespace fulcrum {
namespace {

using testing::AnyDirection;
using testing::Bits;
using testing::MakeBody;
using testing::RandomBody;
using testing::RandomPoses;
using testing::SameBits;

constexpr float kNoLimit = std::numeric_limits<float>::max();

struct Pair {
    RandomBody a, b;
    Vector3 axis;
    AnglePart<float> part;

    explicit Pair(RandomPoses& random) : a(MakeBody(random)), b(MakeBody(random)), axis(AnyDirection(random)) {}
    void SetUp(float bias) { part.CalculateProperties(a.mass, b.mass, axis, bias); }
    bool Solve(float low = -kNoLimit, float high = kNoLimit) {
        return part.SolveVelocity(a.velocity, b.velocity, a.mass, b.mass, axis, low, high);
    }
    float Motion() const { return part.RelativeMotion(a.velocity, b.velocity, axis); }
};

// a . I^-1 a in double.
double Along(const SymmetricMatrix3& i, const Vector3& axis) {
    const double m[6] = {i.xx, i.yy, i.zz, i.xy, i.xz, i.yz};
    const double x = static_cast<double>(axis.x()), y = static_cast<double>(axis.y()),
                 z = static_cast<double>(axis.z());
    return m[0] * x * x + m[1] * y * y + m[2] * z * z + 2.0 * (m[3] * x * y + m[4] * x * z + m[5] * y * z);
}

TEST(AnglePart, EffectiveMassIsThatOfTheWrittenOutProduct) {
    RandomPoses random(1);
    for (int i = 0; i < 200; ++i) {
        Pair pair(random);
        pair.SetUp(0.0f);
        const double expected = 1.0 / (Along(pair.a.mass.inertia, pair.axis) + Along(pair.b.mass.inertia, pair.axis));
        EXPECT_NEAR(static_cast<double>(pair.part.GetEffectiveMass()), expected, 2e-6 * expected);
    }
}

TEST(AnglePart, OneSolveMeetsTheBiasAndTurnsNothingElse) {
    RandomPoses random(2);
    for (int i = 0; i < 200; ++i) {
        Pair pair(random);
        const RandomBody a = pair.a, b = pair.b;
        pair.SetUp(0.6f);
        EXPECT_TRUE(pair.Solve());
        EXPECT_NEAR(pair.Motion(), -0.6f, 1e-5f);
        EXPECT_TRUE(SameBits(pair.a.velocity.linear, a.velocity.linear));
        EXPECT_TRUE(SameBits(pair.b.velocity.linear, b.velocity.linear));
        // The same angular impulse, with opposite signs: I1^-1 a and I2^-1 a times the total.
        const float lambda = pair.part.GetTotalLambda();
        const Vector3 gained1 = pair.a.velocity.angular - a.velocity.angular;
        const Vector3 gained2 = pair.b.velocity.angular - b.velocity.angular;
        EXPECT_LT(Length(Vector3(gained1 + (a.mass.inertia * pair.axis) * lambda)), 5e-6f);
        EXPECT_LT(Length(Vector3(gained2 - (b.mass.inertia * pair.axis) * lambda)), 5e-6f);
    }
}

TEST(AnglePart, TotalImpulseIsClamped) {
    RandomPoses random(3);
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        pair.SetUp(random.Between(-5.0f, 5.0f));
        for (int iteration = 0; iteration < 4; ++iteration) pair.Solve(-0.02f, 0.03f);
        EXPECT_GE(pair.part.GetTotalLambda(), -0.02f);
        EXPECT_LE(pair.part.GetTotalLambda(), 0.03f);
    }
}

template <BodySide kSide1, BodySide kSide2>
void ExpectSideIsDynamicWithZeros(uint32_t seed) {
    RandomPoses random(seed);
    for (int i = 0; i < 50; ++i) {
        Pair general(random);
        Pair special = general;
        const RandomBody a = special.a, b = special.b;
        if (!HasMass(kSide1)) general.a.mass = {};
        if (!HasVelocity(kSide1)) general.a.velocity = {};
        if (!HasMass(kSide2)) general.b.mass = {};
        if (!HasVelocity(kSide2)) general.b.velocity = {};
        general.SetUp(0.3f);
        special.part.CalculateProperties<kSide1, kSide2>(special.a.mass, special.b.mass, special.axis, 0.3f);
        general.Solve(-1.0f, 1.0f);
        special.part.SolveVelocity<kSide1, kSide2>(special.a.velocity, special.b.velocity, special.a.mass,
                                                   special.b.mass, special.axis, -1.0f, 1.0f);
        EXPECT_EQ(special.part.GetTotalLambda(), general.part.GetTotalLambda());
        EXPECT_TRUE(SameBits(special.a.velocity.angular, (HasMass(kSide1) ? general.a : a).velocity.angular));
        EXPECT_TRUE(SameBits(special.b.velocity.angular, (HasMass(kSide2) ? general.b : b).velocity.angular));
    }
}

TEST(AnglePart, StaticAndKinematicSides) {
    ExpectSideIsDynamicWithZeros<BodySide::Static, BodySide::Dynamic>(4);
    ExpectSideIsDynamicWithZeros<BodySide::Dynamic, BodySide::Static>(5);
    ExpectSideIsDynamicWithZeros<BodySide::Kinematic, BodySide::Dynamic>(6);
    ExpectSideIsDynamicWithZeros<BodySide::Dynamic, BodySide::Kinematic>(7);
}

TEST(AnglePart, SpringIsTheMapOfItsSettings) {
    // w^2 = k K, 2 zeta w = c K: J v' = (J v - w^2 h C) / (1 + 2 zeta w h + (w h)^2).
    RandomPoses random(8);
    const double h = 1.0 / 120.0;
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        const double inverse = Along(pair.a.mass.inertia, pair.axis) + Along(pair.b.mass.inertia, pair.axis);
        pair.part.CalculateStiffnessProperties(static_cast<float>(h), pair.a.mass, pair.b.mass, pair.axis, 0.0f, 0.3f,
                                               20.0f, 0.5f);
        const double before = static_cast<double>(pair.Motion());
        pair.Solve();
        const double expected =
            (before - 20.0 * inverse * h * 0.3) / (1.0 + 0.5 * inverse * h + 20.0 * inverse * h * h);
        EXPECT_NEAR(static_cast<double>(pair.Motion()), expected, 1e-5);
    }
}

TEST(AnglePart, PositionPassTakesTheBaumgarteShareOfTheError) {
    RandomPoses random(9);
    Pair pair(random);
    pair.SetUp(0.0f);
    Twist<float> moved1, moved2;
    EXPECT_TRUE(pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass, pair.axis, 0.1f, 0.2f));
    EXPECT_NEAR(pair.part.RelativeMotion(moved1, moved2, pair.axis), -0.02f, 1e-7f);
    pair.part.CalculateFrequencyProperties(0.01f, pair.a.mass, pair.b.mass, pair.axis, 0.0f, 0.1f, 2.0f, 0.5f);
    EXPECT_FALSE(pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass, pair.axis, 0.1f, 0.2f));
}

TEST(AnglePart, WarmStartStateAndDeactivation) {
    RandomPoses random(10);
    Pair pair(random);
    pair.SetUp(0.0f);
    pair.part.SetTotalLambda(0.8f);
    const Vector3 before = pair.b.velocity.angular;
    pair.part.WarmStart(pair.a.velocity, pair.b.velocity, pair.a.mass, pair.b.mass, pair.axis, 2.0f);
    EXPECT_EQ(pair.part.GetTotalLambda(), 1.6f);
    const Vector3 expected = before + (pair.b.mass.inertia * pair.axis) * 1.6f;
    EXPECT_LT(Length(Vector3(pair.b.velocity.angular - expected)), 2e-6f);

    AnglePart<float> fresh;
    fresh.RestoreState(pair.part.SaveState());
    EXPECT_EQ(Bits(fresh.GetTotalLambda()), Bits(1.6f));

    pair.part.Deactivate();
    EXPECT_FALSE(pair.part.IsActive());
    const Twist<float> still = pair.a.velocity;
    EXPECT_FALSE(pair.Solve(0.5f, 1.0f));
    EXPECT_TRUE(SameBits(still, pair.a.velocity));
}

}  // namespace
}  // namespace fulcrum
