// What row parts have beyond the life that all parts share (PartTest.cpp): limits, the solve in two halves, springs,
// the reaction of locks; most of it on rows along an axis, whose Jacobian is checked against its constraint.
#include "PartCases.h"

#include <cmath>

namespace fulcrum {
namespace {

using testing::AnyDirection;
using testing::Bits;
using testing::MakeBody;
using testing::MakeFrame;
using testing::RandomBody;
using testing::RandomPoses;
using testing::SameBits;
using testing::SetSpring;

constexpr float kNoLimit = std::numeric_limits<float>::max();

struct Pair {
    RandomBody a, b;
    AxisFrame<float> frame;
    RowPart<float> part;

    explicit Pair(RandomPoses& random) : a(MakeBody(random)), b(MakeBody(random)), frame(MakeFrame(random)) {}
    void SetUp(float bias) {
        part.SetJacobian(AxisJacobian(frame));
        part.CalculateProperties(a.mass, b.mass);
        part.SetBias(bias);
    }
    bool Solve(float low = -kNoLimit, float high = kNoLimit) {
        return part.SolveVelocity(a.velocity, b.velocity, low, high);
    }
    float Motion() const { return RelativeMotion(part.GetJacobian(), a.velocity, b.velocity); }
    // K in double.
    double InverseMass() const {
        const RowJacobian<float>& row = part.GetJacobian();
        const Eigen::Matrix<double, 12, 1> j = testing::DenseMotion({-row.a.linear, -row.a.angular}, row.b);
        return j.dot(testing::DenseInverseMass(a.mass, b.mass) * j);
    }
};

// Numbers below are of order 10 and go through about 20 roundings of 6e-8.
constexpr double kRounding = 2e-5;

// C = (p2 - p1) . n with n carried by body 1: its derivative is J v, u included.
TEST(AxisPart, JacobianIsTheDerivativeOfTheConstraint) {
    RandomPoses random(2);
    for (int i = 0; i < 100; ++i) {
        Pair pair(random);
        const Position x1 = pair.a.position.cast<double>(), x2 = pair.b.position.cast<double>();
        const Position r1 = random.InBox(1.0f).cast<double>(), r2 = pair.frame.r2.cast<double>();
        const Position n = pair.frame.axis.cast<double>();
        pair.frame.r1PlusU = (x2 + r2 - x1).cast<float>();
        const auto error = [&](double t) {
            const auto turn = [t](const Vector3& w, const Position& r) {
                const Position angle = w.cast<double>() * t;
                const Eigen::Vector3d axis = angle.normalized(), arm = r;
                return Position(Eigen::AngleAxisd(angle.norm(), axis) * arm);
            };
            const Twist<float>&v1 = pair.a.velocity, &v2 = pair.b.velocity;
            const Position p1 = x1 + v1.linear.cast<double>() * t + turn(v1.angular, r1);
            const Position p2 = x2 + v2.linear.cast<double>() * t + turn(v2.angular, r2);
            return (p2 - p1).dot(turn(v1.angular, n));
        };
        const double derivative = (error(1e-5) - error(-1e-5)) / 2e-5;
        pair.SetUp(0.0f);
        EXPECT_NEAR(static_cast<double>(pair.Motion()), derivative, 2.0 * kRounding);
    }
}

TEST(AnglePart, TurnsAndMovesNothing) {
    RandomPoses random(1);
    Pair pair(random);
    const RandomBody a = pair.a, b = pair.b;
    pair.part.SetJacobian(AngleJacobian(AnyDirection(random)));
    pair.part.CalculateProperties(a.mass, b.mass);
    pair.part.SetBias(0.6f);
    EXPECT_TRUE(pair.Solve());
    EXPECT_TRUE(SameBits(pair.a.velocity.linear, a.velocity.linear));
    EXPECT_TRUE(SameBits(pair.b.velocity.linear, b.velocity.linear));
    EXPECT_FALSE(SameBits(pair.a.velocity.angular, a.velocity.angular));
    EXPECT_FALSE(SameBits(pair.b.velocity.angular, b.velocity.angular));
}

TEST(RowPart, TotalImpulseIsClamped) {
    RandomPoses random(5);
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        pair.SetUp(random.Between(-5.0f, 5.0f));
        for (int iteration = 0; iteration < 4; ++iteration) {
            pair.Solve(-0.2f, 0.3f);
            EXPECT_GE(pair.part.GetTotalLambda(), -0.2f);
            EXPECT_LE(pair.part.GetTotalLambda(), 0.3f);
        }
        EXPECT_FALSE(pair.Solve(pair.part.GetTotalLambda(), pair.part.GetTotalLambda()));
        // Back to no impulse: the bodies are as before, to rounding.
        const Twist<float> before = pair.a.velocity;
        const float lambda = pair.part.GetTotalLambda();
        EXPECT_TRUE(pair.Solve(0.0f, 0.0f));
        EXPECT_EQ(pair.part.GetTotalLambda(), 0.0f);
        const Vector3 gained = pair.a.velocity.linear - before.linear;
        EXPECT_NEAR(Length(Vector3(gained - pair.frame.axis * (pair.a.mass.mass.x() * lambda))), 0.0f, 1e-6f);
    }
}

TEST(RowPart, TwoHalvesGiveTheBitsOfTheWhole) {
    RandomPoses random(6);
    for (int i = 0; i < 50; ++i) {
        Pair whole(random);
        whole.SetUp(0.4f);
        Pair halves = whole;
        whole.Solve(-1.0f, 1.0f);
        const Twist<float> before = halves.a.velocity;
        const float candidate = halves.part.SolveTotalLambda(halves.a.velocity, halves.b.velocity);
        EXPECT_TRUE(SameBits(before, halves.a.velocity));
        halves.part.ApplyTotalLambda(halves.a.velocity, halves.b.velocity, Clamp(candidate, -1.0f, 1.0f));
        EXPECT_TRUE(SameBits(whole.a.velocity, halves.a.velocity));
        EXPECT_TRUE(SameBits(whole.b.velocity, halves.b.velocity));
        EXPECT_EQ(Bits(whole.part.GetTotalLambda()), Bits(halves.part.GetTotalLambda()));
    }
}

// With limits a static or kinematic side still is the dynamic one with zeros in the right places.
template <BodySide kSide1, BodySide kSide2>
void ExpectSideIsDynamicWithZeros(uint32_t seed) {
    RandomPoses random(seed);
    for (int i = 0; i < 50; ++i) {
        Pair general(random);
        Pair special = general;  // with masses and velocities that must not matter
        const auto zero = [](RandomBody& body, BodySide side) {
            if (!HasMass(side)) body.mass = {};
            if (!HasVelocity(side)) body.velocity = {};
        };
        zero(general.a, kSide1);
        zero(general.b, kSide2);
        const RandomBody a = special.a, b = special.b;
        general.SetUp(0.3f);
        special.part.SetJacobian(AxisJacobian(special.frame));
        special.part.CalculateProperties<kSide1, kSide2>(special.a.mass, special.b.mass);
        special.part.SetBias(0.3f);
        general.Solve(-1.0f, 1.0f);
        special.part.SolveVelocity<kSide1, kSide2>(special.a.velocity, special.b.velocity, -1.0f, 1.0f);
        EXPECT_EQ(special.part.GetTotalLambda(), general.part.GetTotalLambda());
        EXPECT_TRUE(SameBits(special.a.velocity, (HasMass(kSide1) ? general.a : a).velocity));
        EXPECT_TRUE(SameBits(special.b.velocity, (HasMass(kSide2) ? general.b : b).velocity));
        Twist<float> moved[4];
        general.part.SolvePosition(moved[0], moved[1], 0.1f, 0.2f);
        special.part.SolvePosition<kSide1, kSide2>(moved[2], moved[3], 0.1f, 0.2f);
        EXPECT_TRUE(SameBits(moved[HasMass(kSide1) ? 0 : 2], moved[2]));
        EXPECT_TRUE(SameBits(moved[HasMass(kSide2) ? 1 : 3], moved[3]));
    }
}

TEST(RowPart, StaticAndKinematicSidesWithLimits) {
    ExpectSideIsDynamicWithZeros<BodySide::Static, BodySide::Dynamic>(7);
    ExpectSideIsDynamicWithZeros<BodySide::Dynamic, BodySide::Static>(8);
    ExpectSideIsDynamicWithZeros<BodySide::Kinematic, BodySide::Dynamic>(9);
    ExpectSideIsDynamicWithZeros<BodySide::Dynamic, BodySide::Kinematic>(10);
}

TEST(RowPart, KinematicBodyCarriesTheOther) {
    RandomPoses random(12);
    Pair pair(random);
    const Twist<float> driven = pair.a.velocity;
    pair.part.SetJacobian(AxisJacobian(pair.frame));
    pair.part.CalculateProperties<BodySide::Kinematic, BodySide::Dynamic>(pair.a.mass, pair.b.mass);
    pair.part.SetBias(0.0f);
    pair.part.SolveVelocity<BodySide::Kinematic, BodySide::Dynamic>(pair.a.velocity, pair.b.velocity, -kNoLimit,
                                                                    kNoLimit);
    EXPECT_TRUE(SameBits(pair.a.velocity, driven));
    EXPECT_NEAR(static_cast<double>(pair.Motion()), 0.0, kRounding);
}

TEST(RowPart, MassOverrideShiftsTheImpulse) {
    // Head-on, 1 kg each at +-1 m/s, no arms: as they are both stop; with body 1 as of 4 kg the common velocity is
    // (4 - 1) / 5 = 0.6, reached by impulses over the overridden masses.
    RandomBody a, b;
    a.mass.mass = b.mass.mass = Vector3::Constant(1.0f);
    a.velocity = {Vector3(1, 0, 0), Vector3::Zero()};
    b.velocity = {Vector3(-1, 0, 0), Vector3::Zero()};
    const InverseMass<float> heavy = testing::OverrideMass(a.mass, 0.25f, 1.0f);
    RowPart<float> part;
    part.SetJacobian(AxisJacobian<float>({Vector3::Zero(), Vector3::Zero(), Vector3(1, 0, 0)}));
    part.CalculateProperties(heavy, b.mass);
    part.SetBias(0.0f);
    EXPECT_FLOAT_EQ(part.GetEffectiveMass(), 1.0f / 1.25f);
    part.SolveVelocity(a.velocity, b.velocity, -kNoLimit, kNoLimit);
    EXPECT_FLOAT_EQ(a.velocity.linear.x(), 0.6f);
    EXPECT_FLOAT_EQ(b.velocity.linear.x(), 0.6f);
    // The position pass shares an error of 0.1 m in the same proportion, 1 to 4.
    Twist<float> moved1, moved2;
    part.SolvePosition(moved1, moved2, -0.1f, 1.0f);
    EXPECT_FLOAT_EQ(moved1.linear.x(), -0.02f);
    EXPECT_FLOAT_EQ(moved2.linear.x(), 0.08f);

    // The inertia's scale acts on K: an arm of 1 m across the axis, inverse inertia 3 scaled by 2.
    InverseMass<float> spinning = b.mass;
    spinning.inertia.zz = 3.0f;
    part.SetJacobian(AxisJacobian<float>({Vector3::Zero(), Vector3(0, 1, 0), Vector3(1, 0, 0)}));
    part.CalculateProperties(heavy, testing::OverrideMass(spinning, 1.0f, 2.0f));
    EXPECT_FLOAT_EQ(part.GetEffectiveMass(), 1.0f / (0.25f + 1.0f + 6.0f));
}

TEST(RowPart, PositionPassTakesTheBaumgarteShareOfTheError) {
    RandomPoses random(13);
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        pair.SetUp(0.0f);
        const float error = random.Between(-0.2f, 0.2f), baumgarte = 0.2f;
        Twist<float> moved1, moved2;
        EXPECT_TRUE(pair.part.SolvePosition(moved1, moved2, error, baumgarte));
        EXPECT_NEAR(RelativeMotion(pair.part.GetJacobian(), moved1, moved2), -baumgarte * error, 1e-6f);
        EXPECT_FALSE(pair.part.SolvePosition(moved1, moved2, 0.0f, 0.2f));
    }
    // Along an axis through both centers nothing turns, so the constraint itself shrinks by exactly that factor.
    RandomBody a, b;
    a.mass.mass = Vector3::Constant(1.0f);
    b.mass.mass = Vector3::Constant(0.5f);
    float gap = -0.1f;
    RowPart<float> part;
    for (int pass = 0; pass < 5; ++pass) {
        part.SetJacobian(AxisJacobian<float>({Vector3(0.5f, 0, 0), Vector3(-0.5f, 0, 0), Vector3(1, 0, 0)}));
        part.CalculateProperties(a.mass, b.mass);
        Twist<float> moved1, moved2;
        part.SolvePosition(moved1, moved2, gap, 0.2f);
        const float next = gap + moved2.linear.x() - moved1.linear.x();
        EXPECT_NEAR(next, 0.8f * gap, 1e-7f);
        gap = next;
    }
    // And of an angle.
    Pair pair(random);
    pair.part.SetJacobian(AngleJacobian(AnyDirection(random)));
    pair.part.CalculateProperties(pair.a.mass, pair.b.mass);
    Twist<float> moved1, moved2;
    EXPECT_TRUE(pair.part.SolvePosition(moved1, moved2, 0.1f, 0.2f));
    EXPECT_NEAR(RelativeMotion(pair.part.GetJacobian(), moved1, moved2), -0.02f, 1e-7f);
}

// J v' = (J v - w^2 h C) / (1 + 2 zeta w h + (w h)^2); by stiffness w^2 = k K and 2 zeta w = c K.
TEST(RowPart, SoftSolveIsTheMapOfItsSpring) {
    RandomPoses random(15);
    const double h = 1.0 / 120.0;
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        const float error = random.Between(-0.5f, 0.5f), k = random.Between(1.0f, 50.0f),
                    c = random.Between(0.0f, 2.0f);
        const double e = static_cast<double>(error);
        pair.SetUp(0.0f);
        SetSpring(pair.part, static_cast<float>(h), 0.0f, error, StiffnessConstants(k, c, SpringForm::Implicit));
        const double jv = static_cast<double>(pair.Motion()), inverse = pair.InverseMass();
        const double w2 = static_cast<double>(k) * inverse, decay = static_cast<double>(c) * inverse;
        // All ways to the same spring agree.
        const double frequency = std::sqrt(w2) / (2.0 * 3.14159265358979), zeta = 0.5 * decay / std::sqrt(w2);
        Pair other = pair;
        const SpringSettings settings{.frequency = static_cast<float>(frequency),
                                      .dampingRatio = static_cast<float>(zeta),
                                      .form = SpringForm::Implicit};
        SetSpring(other.part, static_cast<float>(h), 0.0f, error, ToConstants(settings));
        for (Pair* any : {&pair, &other}) {
            any->Solve();
            EXPECT_NEAR(static_cast<double>(any->Motion()), (jv - w2 * h * e) / (1.0 + decay * h + w2 * h * h),
                        kRounding);
        }
        EXPECT_NEAR(other.part.GetTotalLambda(), pair.part.GetTotalLambda(), 2e-5f);
    }
}

TEST(RowPart, AngleSpringIsTheMapOfItsSettings) {
    RandomPoses random(8);
    const double h = 1.0 / 120.0;
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        pair.part.SetJacobian(AngleJacobian(AnyDirection(random)));
        pair.part.CalculateProperties(pair.a.mass, pair.b.mass);
        SetSpring(pair.part, static_cast<float>(h), 0.0f, 0.3f, StiffnessConstants(20.0f, 0.5f, SpringForm::Implicit));
        const double before = static_cast<double>(pair.Motion()), inverse = pair.InverseMass();
        pair.Solve();
        const double expected =
            (before - 20.0 * inverse * h * 0.3) / (1.0 + 0.5 * inverse * h + 20.0 * inverse * h * h);
        EXPECT_NEAR(static_cast<double>(pair.Motion()), expected, 1e-5);
    }
}

TEST(RowPart, WarmStartAppliesTheTotalImpulse) {
    RandomPoses random(16);
    Pair pair(random);
    pair.SetUp(0.0f);
    pair.part.SetTotalLambda(0.2f);
    const Twist<float> before = pair.b.velocity;
    pair.part.WarmStart(pair.a.velocity, pair.b.velocity);
    EXPECT_EQ(pair.part.GetTotalLambda(), 0.2f);
    const Vector3 expected = before.linear + pair.frame.axis * (pair.b.mass.mass.x() * 0.2f);
    EXPECT_LT(Length(Vector3(pair.b.velocity.linear - expected)), 1e-6f);
}

TEST(RowPart, WithoutMassesOrDeactivatedDoesNothing) {
    RandomPoses random(18);
    Pair pair(random);
    pair.SetUp(0.5f);
    pair.part.SetTotalLambda(2.0f);
    EXPECT_TRUE(pair.part.IsActive());
    pair.part.Deactivate(false);
    EXPECT_TRUE(pair.part.IsActive());
    EXPECT_EQ(pair.part.GetTotalLambda(), 2.0f);
    pair.part.Deactivate(true);
    EXPECT_FALSE(pair.part.IsActive());
    EXPECT_EQ(pair.part.GetTotalLambda(), 0.0f);
    EXPECT_EQ(pair.part.GetEffectiveMass(), 0.0f);
    const Pair before = pair;
    const auto expectStill = [&] {
        EXPECT_FALSE(pair.Solve(0.5f, 1.0f));  // even with limits that demand an impulse
        pair.part.WarmStart(pair.a.velocity, pair.b.velocity);
        EXPECT_FALSE(pair.part.SolvePosition(pair.a.velocity, pair.b.velocity, 0.1f, 0.2f));
        EXPECT_TRUE(SameBits(before.a.velocity, pair.a.velocity) && SameBits(before.b.velocity, pair.b.velocity));
    };
    expectStill();

    const InverseMass<float> none;
    pair.part.SetTotalLambda(2.0f);
    pair.part.CalculateProperties(none, none);
    pair.part.SetBias(0.5f);
    EXPECT_FALSE(pair.part.IsActive());
    EXPECT_EQ(pair.part.GetTotalLambda(), 0.0f);
    expectStill();
    SetSpring(pair.part, 0.01f, 0.5f, 0.1f, FrequencyConstants(2.0f, 0.0f));
    EXPECT_FALSE(pair.part.IsActive());
    expectStill();
}

// Locks that let both bodies turn a quarter as easily: the row meets four times the mass. Where they hold all that it
// could move, but for rounding, it is left to them.
TEST(RowPart, MeetsTheMassThatLocksLeave) {
    RandomPoses random(19);
    Pair pair(random);
    pair.SetUp(0.5f);
    const float alone = pair.part.GetEffectiveMass();
    RowResponse<float> response = pair.part.GetResponse();
    const auto scale = [&](float by) {
        for (Vector3* v : {&response.a.linear, &response.a.angular, &response.b.linear, &response.b.angular})
            *v = *v * by;
    };
    scale(0.25f);
    pair.part.SetResponse(response);
    pair.part.SetBias(0.5f);
    EXPECT_FLOAT_EQ(pair.part.GetEffectiveMass(), 4.0f * alone);
    EXPECT_TRUE(pair.Solve());
    EXPECT_NEAR(static_cast<double>(pair.Motion() + 0.5f), 0.0, kRounding);
    scale(1e-5f);
    pair.part.SetResponse(response);
    EXPECT_FALSE(pair.part.IsActive());
    EXPECT_EQ(pair.part.GetTotalLambda(), 0.0f);
    EXPECT_FALSE(pair.Solve(0.5f, 1.0f));
}

}  // namespace
}  // namespace fulcrum
