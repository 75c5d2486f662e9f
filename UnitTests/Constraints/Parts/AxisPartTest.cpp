// The axis part against its derivation, in double and in closed form.
#include "RandomBodies.h"

#include <Fulcrum/Constraints/Parts/AxisPart.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <limits>

namespace fulcrum {
namespace {

using testing::Bits;
using testing::MakeBody;
using testing::MakeFrame;
using testing::RandomBody;
using testing::RandomPoses;
using testing::SameBits;

constexpr float kNoLimit = std::numeric_limits<float>::max();
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix12 = Eigen::Matrix<double, 12, 12>;

Eigen::Matrix3d Inertia(const InverseMass<float>& mass) {
    const SymmetricMatrix3& i = mass.inertia;
    Eigen::Matrix3f m;
    m << i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz;
    return m.cast<double>();
}
Matrix12 InverseMassMatrix(const InverseMass<float>& mass1, const InverseMass<float>& mass2) {
    Matrix12 m = Matrix12::Zero();
    m.block<3, 3>(0, 0) = Eigen::Matrix3d::Identity() * static_cast<double>(mass1.mass);
    m.block<3, 3>(3, 3) = Inertia(mass1);
    m.block<3, 3>(6, 6) = Eigen::Matrix3d::Identity() * static_cast<double>(mass2.mass);
    m.block<3, 3>(9, 9) = Inertia(mass2);
    return m;
}
Vector12 Jacobian(const AxisFrame<float>& frame) {
    const Position n = frame.axis.cast<double>();
    const Eigen::Vector3d linear = n, angular1 = frame.r1PlusU.cast<double>().cross(n),
                          angular2 = frame.r2.cast<double>().cross(n);
    Vector12 j;
    j << -linear, -angular1, linear, angular2;
    return j;
}
Vector12 Stacked(const Twist<float>& a, const Twist<float>& b) {
    const Eigen::Vector3d va = a.linear.cast<double>(), wa = a.angular.cast<double>(), vb = b.linear.cast<double>(),
                          wb = b.angular.cast<double>();
    Vector12 v;
    v << va, wa, vb, wb;
    return v;
}

struct Pair {
    RandomBody a, b;
    AxisFrame<float> frame;
    AxisPart<float> part;

    explicit Pair(RandomPoses& random) : a(MakeBody(random)), b(MakeBody(random)), frame(MakeFrame(random)) {}
    void SetUp(float bias) { part.CalculateProperties(a.mass, b.mass, frame, bias); }
    bool Solve(float low = -kNoLimit, float high = kNoLimit) {
        return part.SolveVelocity(a.velocity, b.velocity, a.mass, b.mass, frame.axis, low, high);
    }
    float Motion() const { return part.RelativeMotion(a.velocity, b.velocity, frame.axis); }
};

// Numbers below are of order 10 and go through about 20 roundings of 6e-8.
constexpr double kRounding = 2e-5;

TEST(AxisPart, EffectiveMassIsThatOfTheWrittenOutProduct) {
    RandomPoses random(1);
    for (int i = 0; i < 200; ++i) {
        Pair pair(random);
        pair.SetUp(0.0f);
        const Vector12 j = Jacobian(pair.frame);
        const double expected = 1.0 / j.dot(InverseMassMatrix(pair.a.mass, pair.b.mass) * j);
        EXPECT_NEAR(static_cast<double>(pair.part.GetEffectiveMass()), expected, 2e-6 * expected);
        EXPECT_NEAR(static_cast<double>(pair.Motion()), j.dot(Stacked(pair.a.velocity, pair.b.velocity)), kRounding);
    }
}

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

TEST(AxisPart, OneSolveMeetsTheBias) {
    RandomPoses random(3);
    for (int i = 0; i < 200; ++i) {
        Pair pair(random);
        const float bias = random.Between(-2.0f, 2.0f);
        pair.SetUp(bias);
        EXPECT_TRUE(pair.Solve());
        EXPECT_NEAR(static_cast<double>(pair.Motion() + bias), 0.0, kRounding);
    }
}

TEST(AxisPart, ImpulsesKeepMomentum) {
    RandomPoses random(4);
    for (int i = 0; i < 100; ++i) {
        Pair pair(random);
        pair.frame.r1PlusU = pair.b.position + pair.frame.r2 - pair.a.position;  // both impulses act at p2
        const auto momentum = [&](Position& linear, Position& angular) {
            linear.setZero();
            angular.setZero();
            for (const RandomBody* body : {&pair.a, &pair.b}) {
                const Position p = body->velocity.linear.cast<double>() / static_cast<double>(body->mass.mass);
                linear += p;
                const Eigen::Vector3d w = body->velocity.angular.cast<double>();
                angular += body->position.cast<double>().cross(p) + Position(Inertia(body->mass).inverse() * w);
            }
        };
        Position linearBefore, angularBefore, linear, angular;
        momentum(linearBefore, angularBefore);
        pair.SetUp(0.7f);
        pair.Solve();
        momentum(linear, angular);
        // Velocities are rounded to 3e-7 or so, and multiplied by masses of up to 10 kg at up to 4 m.
        EXPECT_LT((linear - linearBefore).norm(), 1e-4);
        EXPECT_LT((angular - angularBefore).norm(), 2e-4);
    }
}

TEST(AxisPart, TotalImpulseIsClamped) {
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
        EXPECT_NEAR(Length(Vector3(gained - pair.frame.axis * (pair.a.mass.mass * lambda))), 0.0f, 1e-6f);
    }
}

TEST(AxisPart, TwoHalvesGiveTheBitsOfTheWhole) {
    RandomPoses random(6);
    for (int i = 0; i < 50; ++i) {
        Pair whole(random);
        whole.SetUp(0.4f);
        Pair halves = whole;
        whole.Solve(-1.0f, 1.0f);
        const Twist<float> before = halves.a.velocity;
        const float candidate = halves.part.SolveTotalLambda(halves.a.velocity, halves.b.velocity, halves.frame.axis);
        EXPECT_TRUE(SameBits(before, halves.a.velocity));
        halves.part.ApplyTotalLambda(halves.a.velocity, halves.b.velocity, halves.a.mass, halves.b.mass,
                                     halves.frame.axis, Clamp(candidate, -1.0f, 1.0f));
        EXPECT_TRUE(SameBits(whole.a.velocity, halves.a.velocity));
        EXPECT_TRUE(SameBits(whole.b.velocity, halves.b.velocity));
        EXPECT_EQ(Bits(whole.part.GetTotalLambda()), Bits(halves.part.GetTotalLambda()));
    }
}

// A compile-time side must be the dynamic row with zeros in the right places, whatever it is handed there.
template <BodySide kSide1, BodySide kSide2>
void ExpectSideIsDynamicWithZeros(uint32_t seed) {
    RandomPoses random(seed);
    for (int i = 0; i < 50; ++i) {
        Pair general(random);
        const auto zero = [](RandomBody& body, BodySide side) {
            if (!HasMass(side)) body.mass = InverseMass<float>();
            if (!HasVelocity(side)) body.velocity = Twist<float>();
        };
        Pair special = general;  // with masses and velocities that must not matter
        zero(general.a, kSide1);
        zero(general.b, kSide2);
        const RandomBody a = special.a, b = special.b;
        general.SetUp(0.3f);
        special.part.CalculateProperties<kSide1, kSide2>(special.a.mass, special.b.mass, special.frame, 0.3f);
        for (AxisPart<float>* part : {&general.part, &special.part}) part->SetTotalLambda(0.1f);
        general.part.WarmStart(general.a.velocity, general.b.velocity, general.a.mass, general.b.mass,
                               general.frame.axis, 1.0f);
        special.part.WarmStart<kSide1, kSide2>(special.a.velocity, special.b.velocity, special.a.mass, special.b.mass,
                                               special.frame.axis, 1.0f);
        general.Solve(-1.0f, 1.0f);
        special.part.SolveVelocity<kSide1, kSide2>(special.a.velocity, special.b.velocity, special.a.mass,
                                                   special.b.mass, special.frame.axis, -1.0f, 1.0f);
        EXPECT_EQ(special.part.GetTotalLambda(), general.part.GetTotalLambda());
        const Twist<float>& expected1 = HasMass(kSide1) ? general.a.velocity : a.velocity;
        const Twist<float>& expected2 = HasMass(kSide2) ? general.b.velocity : b.velocity;
        EXPECT_TRUE(SameBits(special.a.velocity, expected1));
        EXPECT_TRUE(SameBits(special.b.velocity, expected2));
    }
}

TEST(AxisPart, StaticAndKinematicSides) {
    ExpectSideIsDynamicWithZeros<BodySide::Static, BodySide::Dynamic>(7);
    ExpectSideIsDynamicWithZeros<BodySide::Dynamic, BodySide::Static>(8);
    ExpectSideIsDynamicWithZeros<BodySide::Kinematic, BodySide::Dynamic>(9);
    ExpectSideIsDynamicWithZeros<BodySide::Dynamic, BodySide::Kinematic>(10);
    ExpectSideIsDynamicWithZeros<BodySide::Dynamic, BodySide::Dynamic>(11);
}

TEST(AxisPart, KinematicBodyCarriesTheOther) {
    RandomPoses random(12);
    Pair pair(random);
    const Twist<float> driven = pair.a.velocity;
    pair.part.CalculateProperties<BodySide::Kinematic, BodySide::Dynamic>(pair.a.mass, pair.b.mass, pair.frame, 0.0f);
    pair.part.SolveVelocity<BodySide::Kinematic, BodySide::Dynamic>(pair.a.velocity, pair.b.velocity, pair.a.mass,
                                                                    pair.b.mass, pair.frame.axis, -kNoLimit, kNoLimit);
    EXPECT_TRUE(SameBits(pair.a.velocity, driven));
    EXPECT_NEAR(static_cast<double>(pair.Motion()), 0.0, kRounding);
}

TEST(AxisPart, MassOverrideShiftsTheImpulse) {
    // Head-on, 1 kg each at +-1 m/s, no arms: as they are both stop; with body 1 as of 4 kg the common velocity is
    // (4 - 1) / 5 = 0.6, reached by impulses over the overridden masses.
    RandomBody a, b;
    a.mass.mass = b.mass.mass = 1.0f;
    a.velocity = {Vector3(1, 0, 0), Vector3::Zero()};
    b.velocity = {Vector3(-1, 0, 0), Vector3::Zero()};
    const AxisFrame<float> frame{Vector3::Zero(), Vector3::Zero(), Vector3(1, 0, 0)};
    const InverseMass<float> heavy = OverrideMass(a.mass, 0.25f, 1.0f);
    AxisPart<float> part;
    part.CalculateProperties(heavy, b.mass, frame, 0.0f);
    EXPECT_FLOAT_EQ(part.GetEffectiveMass(), 1.0f / 1.25f);
    part.SolveVelocity(a.velocity, b.velocity, heavy, b.mass, frame.axis, -kNoLimit, kNoLimit);
    EXPECT_FLOAT_EQ(a.velocity.linear.x(), 0.6f);
    EXPECT_FLOAT_EQ(b.velocity.linear.x(), 0.6f);
    // The position pass shares an error of 0.1 m in the same proportion, 1 to 4.
    Twist<float> moved1, moved2;
    part.SolvePosition(moved1, moved2, heavy, b.mass, frame.axis, -0.1f, 1.0f);
    EXPECT_FLOAT_EQ(moved1.linear.x(), -0.02f);
    EXPECT_FLOAT_EQ(moved2.linear.x(), 0.08f);

    // The inertia's scale acts on K: an arm of 1 m across the axis, inverse inertia 3 scaled by 2.
    InverseMass<float> spinning = b.mass;
    spinning.inertia.zz = 3.0f;
    const AxisFrame<float> arm{Vector3::Zero(), Vector3(0, 1, 0), Vector3(1, 0, 0)};
    part.CalculateProperties(heavy, OverrideMass(spinning, 1.0f, 2.0f), arm, 0.0f);
    EXPECT_FLOAT_EQ(part.GetEffectiveMass(), 1.0f / (0.25f + 1.0f + 6.0f));
}

TEST(AxisPart, PositionPassTakesTheBaumgarteShareOfTheError) {
    RandomPoses random(13);
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        pair.SetUp(0.0f);
        const float error = random.Between(-0.2f, 0.2f), baumgarte = 0.2f;
        Twist<float> moved1, moved2;
        EXPECT_TRUE(
            pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass, pair.frame.axis, error, baumgarte));
        EXPECT_NEAR(pair.part.RelativeMotion(moved1, moved2, pair.frame.axis), -baumgarte * error, 1e-6f);
        EXPECT_FALSE(pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass, pair.frame.axis, 0.0f, 0.2f));
    }
    // Along an axis through both centers nothing turns, so the constraint itself shrinks by exactly that factor.
    RandomBody a, b;
    a.mass.mass = 1.0f;
    b.mass.mass = 0.5f;
    float gap = -0.1f;
    AxisPart<float> part;
    for (int pass = 0; pass < 5; ++pass) {
        const AxisFrame<float> frame{Vector3(0.5f, 0, 0), Vector3(-0.5f, 0, 0), Vector3(1, 0, 0)};
        part.CalculateProperties(a.mass, b.mass, frame, 0.0f);
        Twist<float> moved1, moved2;
        part.SolvePosition(moved1, moved2, a.mass, b.mass, frame.axis, gap, 0.2f);
        const float next = gap + moved2.linear.x() - moved1.linear.x();
        EXPECT_NEAR(next, 0.8f * gap, 1e-7f);
        gap = next;
    }
}

TEST(AxisPart, PositionPassLeavesSpringsAlone) {
    RandomPoses random(14);
    Pair pair(random);
    Twist<float> moved1, moved2;
    pair.part.CalculateFrequencyProperties(0.01f, pair.a.mass, pair.b.mass, pair.frame, 0.0f, 0.1f, 2.0f, 0.5f);
    EXPECT_FALSE(pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass, pair.frame.axis, 0.1f, 0.2f));
    EXPECT_TRUE(SameBits(moved1, Twist<float>()) && SameBits(moved2, Twist<float>()));
    pair.part.CalculateFrequencyProperties(0.01f, pair.a.mass, pair.b.mass, pair.frame, 0.0f, 0.1f, 0.0f, 0.5f);
    EXPECT_TRUE(pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass, pair.frame.axis, 0.1f, 0.2f));
}

TEST(AxisPart, SoftSolveIsTheMapOfItsSpring) {
    // J v' = (J v - w^2 h C) / (1 + 2 zeta w h + (w h)^2) by frequency; by stiffness w^2 = k K and 2 zeta w = c K.
    RandomPoses random(15);
    const double h = 1.0 / 120.0;
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        const Vector12 j = Jacobian(pair.frame);
        const double inverse = j.dot(InverseMassMatrix(pair.a.mass, pair.b.mass) * j);
        const float error = random.Between(-0.5f, 0.5f), k = random.Between(1.0f, 50.0f),
                    c = random.Between(0.0f, 2.0f);
        const double e = static_cast<double>(error);
        pair.part.CalculateStiffnessProperties(static_cast<float>(h), pair.a.mass, pair.b.mass, pair.frame, 0.0f, error,
                                               k, c);
        const double jv = static_cast<double>(pair.Motion());
        const double w2 = static_cast<double>(k) * inverse, decay = static_cast<double>(c) * inverse;
        pair.Solve();
        EXPECT_NEAR(static_cast<double>(pair.Motion()), (jv - w2 * h * e) / (1.0 + decay * h + w2 * h * h), kRounding);

        // All ways to the same spring agree.
        const double frequency = std::sqrt(w2) / (2.0 * 3.14159265358979), zeta = 0.5 * decay / std::sqrt(w2);
        Pair other = pair;
        const SpringSettings settings{.frequency = static_cast<float>(frequency),
                                      .dampingRatio = static_cast<float>(zeta),
                                      .form = SpringForm::Implicit};
        other.part.CalculateSpringProperties(static_cast<float>(h), pair.a.mass, pair.b.mass, pair.frame, 0.0f, error,
                                             settings);
        EXPECT_NEAR(other.part.GetEffectiveMass(), pair.part.GetEffectiveMass(), 2e-5f);
    }
}

TEST(AxisPart, WarmStartScalesWithTheTimeStep) {
    RandomPoses random(16);
    Pair pair(random);
    pair.SetUp(0.0f);
    pair.part.SetTotalLambda(0.8f);
    const Twist<float> before = pair.b.velocity;
    pair.part.WarmStart(pair.a.velocity, pair.b.velocity, pair.a.mass, pair.b.mass, pair.frame.axis, 0.25f);
    EXPECT_EQ(pair.part.GetTotalLambda(), 0.2f);
    const Vector3 expected = before.linear + pair.frame.axis * (pair.b.mass.mass * 0.2f);
    EXPECT_LT(Length(Vector3(pair.b.velocity.linear - expected)), 1e-6f);
}

TEST(AxisPart, StateIsRestored) {
    RandomPoses random(17);
    Pair pair(random);
    pair.SetUp(0.5f);
    pair.Solve();
    const auto saved = pair.part.SaveState();
    AxisPart<float> fresh;
    fresh.RestoreState(saved);
    fresh.CalculateProperties(pair.a.mass, pair.b.mass, pair.frame, 0.5f);
    EXPECT_EQ(Bits(fresh.GetTotalLambda()), Bits(pair.part.GetTotalLambda()));
}

TEST(AxisPart, WithoutMassesOrDeactivatedDoesNothing) {
    RandomPoses random(18);
    Pair pair(random);
    pair.SetUp(0.5f);
    pair.part.SetTotalLambda(2.0f);
    EXPECT_TRUE(pair.part.IsActive());
    pair.part.Deactivate();
    EXPECT_FALSE(pair.part.IsActive());
    EXPECT_EQ(pair.part.GetTotalLambda(), 0.0f);
    const Pair before = pair;
    EXPECT_FALSE(pair.Solve(0.5f, 1.0f));  // even with limits that demand an impulse
    EXPECT_TRUE(SameBits(before.a.velocity, pair.a.velocity) && SameBits(before.b.velocity, pair.b.velocity));

    const InverseMass<float> none;
    pair.part.SetTotalLambda(2.0f);
    pair.part.CalculateProperties(none, none, pair.frame, 0.5f);
    EXPECT_FALSE(pair.part.IsActive());
    EXPECT_EQ(pair.part.GetTotalLambda(), 0.0f);
    pair.part.CalculateFrequencyProperties(0.01f, none, none, pair.frame, 0.5f, 0.1f, 2.0f, 0.0f);
    EXPECT_FALSE(pair.part.IsActive());
}

}  // namespace
}  // namespace fulcrum
