// The swing-twist part: its rows against their Jacobian, its solves and springs in closed form, position passes from
// anywhere, sides, lanes and states.
#include "BlockCases.h"

#include <Fulcrum/Constraints/Parts/SwingTwistPart.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace fulcrum {
namespace {

using testing::AnyDirection;
using testing::Bits;
using testing::Lane;
using testing::MakeBody;
using testing::PutLane;
using testing::RandomBody;
using testing::RandomPoses;
using testing::SameBits;

constexpr float kPi = 3.14159265f;
constexpr float kDegree = kPi / 180.0f;
constexpr float kBoth = -std::numeric_limits<float>::infinity();  // lowest impulse of a locked row
using Correction = SwingTwistCorrection<float>;

Quaternion RandomRotation(RandomPoses& random) {
    const Vector3 axis = AnyDirection(random);
    return RotationFromVector(Vector3(axis * random.Between(-kPi, kPi)));
}
Quaternion Swung(float y, float z, float twist) {
    return RotationFromVector(Vector3(0, y, z)) * RotationFromVector(Vector3(twist, 0, 0));
}

// `count` rows from the last one down, of random axes.
SwingTwistRows<float> MakeRows(RandomPoses& random, int count, float error, float lowest) {
    SwingTwistRows<float> rows;
    for (int i = 3 - count; i < 3; ++i) rows.row[i] = {AnyDirection(random), error, lowest};
    return rows;
}

struct Pair {
    RandomBody a, b;
    SwingTwistRows<float> rows;
    SwingTwistPart<float> part;

    explicit Pair(RandomPoses& random) : a(MakeBody(random)), b(MakeBody(random)) {}
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    void SetUp(const Correction& correction) {
        part.CalculateProperties<kSide1, kSide2>(a.mass, b.mass, rows, correction);
    }
    template <BodySide kSide1 = BodySide::Dynamic, BodySide kSide2 = BodySide::Dynamic>
    bool Solve() {
        return part.SolveVelocity<kSide1, kSide2>(a.velocity, b.velocity, a.mass, b.mass);
    }
    float Motion(int row) const { return part.RelativeMotion(a.velocity, b.velocity, row); }
    double K(int row) const {
        const Position axis = rows.row[row].axis.cast<double>();
        return axis.dot((testing::DenseInertia(a.mass) + testing::DenseInertia(b.mass)) * testing::ToDense(axis));
    }
    bool IsAs(const Pair& other) const {
        return SameBits(a.velocity, other.a.velocity) && SameBits(b.velocity, other.b.velocity);
    }
};

TEST(SwingTwistPart, EffectiveMassIsThatOfTheWrittenOutProduct) {
    RandomPoses random(1);
    for (int i = 0; i < 200; ++i) {
        Pair pair(random);
        pair.rows = MakeRows(random, 2, 0.0f, 0.0f);
        pair.SetUp({});
        EXPECT_FALSE(pair.part.IsActive(0));  // a row that is not there
        for (int k = 1; k < 3; ++k) {
            EXPECT_TRUE(pair.part.IsActive(k));
            EXPECT_NEAR(static_cast<double>(pair.part.GetEffectiveMass(k)) * pair.K(k), 1.0, 2e-6);
            const Vector3 apart = pair.b.velocity.angular - pair.a.velocity.angular;
            EXPECT_NEAR(pair.Motion(k), Dot(pair.rows.row[k].axis, apart), 1e-6f);
        }
    }
}

TEST(SwingTwistPart, OneSolveOfOneRowMeetsTheBiasAndKeepsMomentum) {
    RandomPoses random(2);
    for (int i = 0; i < 200; ++i) {
        Pair pair(random);
        pair.rows = MakeRows(random, 1, 0.2f, kBoth);
        const RandomBody a = pair.a, b = pair.b;
        pair.SetUp({3.0f, 0.0f, {}});
        EXPECT_TRUE(pair.Solve());
        EXPECT_NEAR(pair.Motion(2), -0.6f, 1e-5f);
        EXPECT_TRUE(SameBits(pair.a.velocity.linear, a.velocity.linear));
        EXPECT_TRUE(SameBits(pair.b.velocity.linear, b.velocity.linear));
        // The same angular impulse with opposite signs: I^-1 a times the total.
        const Vector3 impulse = pair.rows.row[2].axis * pair.part.GetTotalLambda().z();
        EXPECT_LT(Length(Vector3(pair.a.velocity.angular - a.velocity.angular + a.mass.inertia * impulse)), 5e-6f);
        EXPECT_LT(Length(Vector3(pair.b.velocity.angular - b.velocity.angular - b.mass.inertia * impulse)), 5e-6f);
    }
}

TEST(SwingTwistPart, IterationsMeetThreeRows) {
    RandomPoses random(3);
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        const Matrix3 axes = ToMatrix(RandomRotation(random));
        pair.rows.row = {{{axes.x, 0.1f, kBoth}, {axes.y, 0.2f, kBoth}, {axes.z, -0.1f, kBoth}}};
        pair.SetUp({2.0f, 0.0f, {}});
        // Of inertias of up to 1:25 Gauss-Seidel leaves at most 0.7 of the rest each time here.
        for (int iteration = 0; iteration < 100; ++iteration) pair.Solve();
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(pair.Motion(k), -2.0f * pair.rows.row[k].error, 1e-5f);
    }
}

TEST(SwingTwistPart, LimitsPushAndNeverPull) {
    RandomPoses random(4);
    int pushed = 0;
    for (int i = 0; i < 400; ++i) {
        Pair pair(random);
        pair.rows = MakeRows(random, 1, 0.0f, 0.0f);
        pair.SetUp({});
        const Pair before = pair;
        const float speed = pair.Motion(2);  // of C: falls where it is negative
        EXPECT_EQ(pair.Solve(), speed < 0.0f);
        if (speed < 0.0f) {
            EXPECT_NEAR(pair.Motion(2), 0.0f, 1e-5f);
            EXPECT_GT(pair.part.GetTotalLambda().z(), 0.0f);
            // What it gave it may take back, and no more.
            pair.a.velocity.angular -= pair.rows.row[2].axis * 20.0f;
            pair.b.velocity.angular += pair.rows.row[2].axis * 20.0f;
            pair.Solve();
            EXPECT_EQ(pair.part.GetTotalLambda().z(), 0.0f);
            ++pushed;
        } else {
            EXPECT_TRUE(pair.IsAs(before));
        }
    }
    EXPECT_GT(pushed, 100);
}

// C = 0.03 rad away with steps of 0.01 s: faster than 3 rad/s is slowed to that, which meets the limit exactly.
TEST(SwingTwistPart, LimitsThatAreNearAreMetAndNotBefore) {
    RandomPoses random(5);
    for (int i = 0; i < 200; ++i) {
        Pair pair(random);
        pair.rows = MakeRows(random, 1, 0.03f, 0.0f);
        pair.SetUp({7.0f, 100.0f, {0.5f, 0.3f}});  // softness and bias rate are of limits that are exceeded
        const float speed = pair.Motion(2);
        EXPECT_EQ(pair.Solve(), speed < -3.0f);
        EXPECT_NEAR(pair.Motion(2), std::max(speed, -3.0f), 1e-5f);
    }
}

// delta = -s m (J v + b) - g lambda. With y = lambda / m and r = J v0 + b: y runs to -s r / (s + g) by the factor 1 - s
// - g.
TEST(SwingTwistPart, SoftRowFollowsItsRecursion) {
    RandomPoses random(6);
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        pair.rows = MakeRows(random, 1, -0.4f, kBoth);
        const float s = random.Between(0.1f, 0.8f), g = random.Between(0.05f, 0.2f);
        pair.SetUp({2.0f, 0.0f, {s, g}});
        const double r = static_cast<double>(pair.Motion(2) - 0.8f), ds = static_cast<double>(s),
                     dg = static_cast<double>(g);
        for (int n = 1; n <= 5; ++n) {
            pair.Solve();
            const double y = -ds / (ds + dg) * (1.0 - std::pow(1.0 - ds - dg, n)) * r;
            EXPECT_NEAR(static_cast<double>(pair.part.GetTotalLambda().z()) * pair.K(2), y, 2e-5);
        }
    }
}

// A locked twist of 2 Hz and damping ratio 0.3 in 2000 steps a period, against the oscillator: the implicit step adds w
// h / 2 to the damping ratio, 0.5 %, and as much to the phase.
TEST(SwingTwistPart, SpringIsTheOscillatorInTheLimit) {
    const double w = 2.0 * 3.14159265358979 * 2.0, zeta = 0.3, h = 1.0 / 4000.0, start = 0.4;
    const double c = h * w * (2.0 * zeta + h * w);
    const Correction spring{static_cast<float>(w / (2.0 * zeta + h * w)),
                            0.0f,
                            {static_cast<float>(c / (1.0 + c)), static_cast<float>(1.0 / (1.0 + c))}};
    SwingTwistLimits limits;
    limits.twist = {0.0f, 0.0f};
    InverseMass<float> m1, m2;
    m2.inertia = {0.5f, 0.5f, 0.5f, 0, 0, 0};
    Twist<float> v1, v2;
    double angle = start;
    SwingTwistPart<float> part;
    const double damped = w * std::sqrt(1.0 - zeta * zeta);
    for (int n = 1; n <= 4000; ++n) {
        const Quaternion q = Swung(0.3f, -0.2f, static_cast<float>(angle));
        // The swing stays: turn about the twist's own axis in frame B, whose C is scaled by cos(alpha / 2).
        const SwingTwistRows<float> rows = RowsOf(CollectLimits(q, limits), Quaternion{});
        const float scale = Decompose(q).swing.w;
        SwingTwistRows<float> pure;
        pure.row[2] = {rows.row[2].axis, rows.row[2].error / scale, rows.row[2].lowest};
        part.CalculateProperties(m1, m2, pure, spring);
        part.WarmStart(v1, v2, m1, m2, 1.0f);
        part.SolveVelocity(v1, v2, m1, m2);
        angle += h * static_cast<double>(part.RelativeMotion(v1, v2, 2));
        const double t = n * h;
        const double expected =
            start * std::exp(-zeta * w * t) * (std::cos(damped * t) + zeta * w / damped * std::sin(damped * t));
        EXPECT_NEAR(angle, expected, 0.01 * start) << n;
    }
}

// A pair of bodies with joint frames fixed in them.
struct Joint {
    Quaternion frame1, frame2;  // world
    Vector3 inverseInertia1, inverseInertia2;
    SwingTwistLimits limits;

    Joint(RandomPoses& random, const Quaternion& relative)
        : frame1(RandomRotation(random)), frame2(Normalized(frame1 * relative)) {
        for (int k = 0; k < 3; ++k) {
            inverseInertia1[k] = random.Between(0.5f, 3.0f);
            inverseInertia2[k] = random.Between(0.5f, 3.0f);
        }
    }
    InverseMass<float> Mass1() const { return {0.7f, RotatedDiagonal(ToMatrix(frame1), inverseInertia1)}; }
    InverseMass<float> Mass2() const { return {1.3f, RotatedDiagonal(ToMatrix(frame2), inverseInertia2)}; }
    RotationLimitList Limits() const { return CollectLimits(Normalized(frame1.Conjugate() * frame2), limits); }
    float Violation() const {
        float worst = 0.0f;
        for (const RotationLimit& limit : Limits())
            worst = std::max(worst, limit.isLocked ? std::fabs(limit.error) : -limit.error);
        return worst;
    }
    // Passes until no limit is exceeded by more than 1e-5.
    int CountPasses(int most = 100) {
        for (int count = 0; count < most; ++count) {
            if (Violation() < 1e-5f) return count;
            const SwingTwistRows<float> rows = RowsOf(Limits(), frame1);
            SwingTwistPart<float> part;
            Twist<float> moved1, moved2;
            part.CalculateProperties(Mass1(), Mass2(), rows, {});
            part.SolvePosition(moved1, moved2, Mass1(), Mass2(), rows, 1.0f);
            frame1 = Normalized(RotationFromVector(moved1.angular) * frame1);
            frame2 = Normalized(RotationFromVector(moved2.angular) * frame2);
        }
        return most;
    }
};

AngleRange RandomRange(RandomPoses& random, float widest) {
    const float kind = random.Between(0.0f, 1.0f);
    if (kind < 0.2f) return {0.0f, 0.0f};
    const float low = random.Between(2.0f, widest), high = random.Between(2.0f, widest);
    return {-low * kDegree, high * kDegree};
}
// Of every third one the x axes start opposite.
Joint RandomJoint(RandomPoses& random, int i) {
    const float alpha = i % 3 == 0 ? kPi : random.Between(0.0f, kPi), psi = random.Between(-kPi, kPi);
    return Joint(random, Swung(alpha * Cos(psi), alpha * Sin(psi), random.Between(-kPi, kPi)));
}

TEST(SwingTwistPart, PositionPassesReachTheLimitsFromAnywhere) {
    RandomPoses random(7);
    int worst = 0, sum = 0;
    constexpr int kJoints = 2000;
    for (int i = 0; i < kJoints; ++i) {
        Joint joint = RandomJoint(random, i);
        joint.limits.shape = i % 2 ? SwingShape::Ellipse : SwingShape::Pyramid;
        joint.limits.swingY = RandomRange(random, 80.0f);
        joint.limits.swingZ = RandomRange(random, 80.0f);
        joint.limits.twist = i % 4 < 2 ? AngleRange{} : RandomRange(random, 175.0f);
        const int passes = joint.CountPasses();
        worst = std::max(worst, passes);
        sum += passes;
    }
    EXPECT_LE(worst, 40);
    EXPECT_LE(sum, 5 * kJoints);
}

// Up to 180 degrees the swing comes back at once. Near there a turn of the swing's direction is a twist as well, so
// that a narrow twist and a wide swing push against each other, and some of both are slow.
TEST(SwingTwistPart, PositionPassesReachSwingLimitsUpToHalfATurn) {
    RandomPoses random(16);
    int worstAlone = 0, slow = 0;
    constexpr int kJoints = 2000;
    for (int i = 0; i < kJoints; ++i) {
        Joint joint = RandomJoint(random, i);
        joint.limits.shape = i % 2 ? SwingShape::Ellipse : SwingShape::Pyramid;
        joint.limits.swingY = RandomRange(random, 179.0f);
        joint.limits.swingZ = RandomRange(random, 179.0f);
        Joint alone = joint;
        worstAlone = std::max(worstAlone, alone.CountPasses());
        joint.limits.twist = RandomRange(random, 175.0f);
        slow += joint.CountPasses() > 30;
    }
    EXPECT_LE(worstAlone, 10);
    EXPECT_LT(slow, kJoints / 5);
}

TEST(SwingTwistPart, PositionPassTakesTheBaumgarteShareAndLeavesWhatIsKept) {
    RandomPoses random(8);
    Pair pair(random);
    pair.rows = MakeRows(random, 1, -0.1f, 0.0f);
    pair.SetUp({1.0f, 0.0f, {0.5f, 0.1f}});  // softness is no matter for positions
    Twist<float> moved1, moved2;
    EXPECT_TRUE(pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass, pair.rows, 0.2f));
    EXPECT_NEAR(pair.part.RelativeMotion(moved1, moved2, 2), 0.02f, 1e-7f);
    const SwingTwistRows<float> kept = MakeRows(random, 3, 0.1f, 0.0f);
    const Twist<float> before1 = moved1, before2 = moved2;
    EXPECT_FALSE(pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass, kept, 0.2f));
    EXPECT_TRUE(SameBits(moved1, before1) && SameBits(moved2, before2));
}

// Body 1 twice as heavy for this constraint only: it turns half as much for the same impulse, and the row is met all
// the same.
TEST(SwingTwistPart, MassesMayBeOverridden) {
    RandomPoses random(9);
    for (int i = 0; i < 50; ++i) {
        Pair pair(random);
        pair.rows = MakeRows(random, 1, 0.0f, kBoth);
        const RandomBody a = pair.a, b = pair.b;
        const InverseMass<float> heavy = OverrideMass(a.mass, 0.5f * a.mass.mass, 0.5f);
        pair.part.CalculateProperties(heavy, b.mass, pair.rows, {});
        pair.part.SolveVelocity(pair.a.velocity, pair.b.velocity, heavy, b.mass);
        EXPECT_NEAR(pair.Motion(2), 0.0f, 1e-5f);
        const Vector3 impulse = pair.rows.row[2].axis * pair.part.GetTotalLambda().z();
        const Vector3 half = (a.mass.inertia * impulse) * 0.5f;
        EXPECT_LT(Length(Vector3(pair.a.velocity.angular - a.velocity.angular + half)), 5e-6f);
        // Without any inertia it turns nothing.
        const InverseMass<float> fixed = OverrideMass(a.mass, 0.0f, 0.0f);
        pair.a = a;
        pair.part.CalculateProperties(fixed, b.mass, pair.rows, {});
        pair.part.SolveVelocity(pair.a.velocity, pair.b.velocity, fixed, b.mass);
        EXPECT_LT(Length(Vector3(pair.a.velocity.angular - a.velocity.angular)), 1e-30f);
    }
}

// A compile-time side is the dynamic part with zeros in the right places, whatever it is handed there.
template <BodySide kSide1, BodySide kSide2>
void ExpectSideIsDynamicWithZeros(uint32_t seed) {
    RandomPoses random(seed);
    for (int i = 0; i < 50; ++i) {
        Pair general(random);
        general.rows = MakeRows(random, 3, 0.1f, kBoth);
        Pair special = general;
        const RandomBody a = special.a, b = special.b;
        const auto zero = [](RandomBody& body, BodySide side) {
            if (!HasMass(side)) body.mass = {};
            if (!HasVelocity(side)) body.velocity = {};
        };
        zero(general.a, kSide1);
        zero(general.b, kSide2);
        general.SetUp({1.0f, 0.0f, {}});
        special.SetUp<kSide1, kSide2>({1.0f, 0.0f, {}});
        for (Pair* pair : {&general, &special}) pair->part.SetTotalLambda(Vector3(0.1f, -0.2f, 0.3f));
        general.part.WarmStart(general.a.velocity, general.b.velocity, general.a.mass, general.b.mass, 0.5f);
        special.part.WarmStart<kSide1, kSide2>(special.a.velocity, special.b.velocity, special.a.mass, special.b.mass,
                                               0.5f);
        EXPECT_TRUE(general.Solve());
        EXPECT_TRUE((special.Solve<kSide1, kSide2>()));
        EXPECT_TRUE(SameBits(special.part.GetTotalLambda(), general.part.GetTotalLambda()));
        EXPECT_TRUE(SameBits(special.a.velocity, (HasMass(kSide1) ? general.a : a).velocity));
        EXPECT_TRUE(SameBits(special.b.velocity, (HasMass(kSide2) ? general.b : b).velocity));
        Twist<float> moved[4];
        general.part.SolvePosition(moved[0], moved[1], general.a.mass, general.b.mass, general.rows, 0.2f);
        special.part.SolvePosition<kSide1, kSide2>(moved[2], moved[3], special.a.mass, special.b.mass, special.rows,
                                                   0.2f);
        EXPECT_TRUE(SameBits(moved[0], moved[2]) && SameBits(moved[1], moved[3]));
    }
}

TEST(SwingTwistPart, StaticAndKinematicSides) {
    ExpectSideIsDynamicWithZeros<BodySide::Static, BodySide::Dynamic>(10);
    ExpectSideIsDynamicWithZeros<BodySide::Dynamic, BodySide::Static>(11);
    ExpectSideIsDynamicWithZeros<BodySide::Kinematic, BodySide::Dynamic>(12);
    ExpectSideIsDynamicWithZeros<BodySide::Dynamic, BodySide::Kinematic>(13);
}

TEST(SwingTwistPart, WarmStartStateAndDeactivation) {
    RandomPoses random(14);
    Pair pair(random);
    pair.rows = MakeRows(random, 3, 0.0f, kBoth);
    pair.SetUp({});
    pair.part.SetTotalLambda(Vector3(0.8f, 0.0f, -0.4f));
    const Vector3 before = pair.b.velocity.angular;
    pair.part.WarmStart(pair.a.velocity, pair.b.velocity, pair.a.mass, pair.b.mass, 0.25f);
    EXPECT_TRUE(SameBits(pair.part.GetTotalLambda(), Vector3(0.2f, 0.0f, -0.1f)));
    const Vector3 impulse = pair.rows.row[0].axis * 0.2f - pair.rows.row[2].axis * 0.1f;
    EXPECT_LT(Length(Vector3(pair.b.velocity.angular - before - pair.b.mass.inertia * impulse)), 2e-6f);

    pair.Solve();
    SwingTwistPart<float> fresh;
    EXPECT_FALSE(fresh.IsActive());
    fresh.RestoreState(pair.part.SaveState());
    fresh.CalculateProperties(pair.a.mass, pair.b.mass, pair.rows, {});
    EXPECT_TRUE(SameBits(fresh.GetTotalLambda(), pair.part.GetTotalLambda()));
    // A row that is gone takes its impulse with it, the others stay.
    SwingTwistRows<float> fewer = pair.rows;
    fewer.row[1] = {};
    fresh.CalculateProperties(pair.a.mass, pair.b.mass, fewer, {});
    EXPECT_EQ(fresh.GetTotalLambda().y(), 0.0f);
    EXPECT_EQ(Bits(fresh.GetTotalLambda().x()), Bits(pair.part.GetTotalLambda().x()));

    EXPECT_TRUE(pair.part.IsActive());
    pair.part.Deactivate();
    EXPECT_FALSE(pair.part.IsActive());
    EXPECT_EQ(Length(pair.part.GetTotalLambda()), 0.0f);
    const Pair still = pair;
    EXPECT_FALSE(pair.Solve());
    EXPECT_TRUE(pair.IsAs(still));

    // Two bodies that nothing moves.
    pair.a.mass = pair.b.mass = {};
    pair.SetUp({1.0f, 1.0f, {}});
    EXPECT_FALSE(pair.part.IsActive());
    EXPECT_FALSE(pair.Solve());
    EXPECT_TRUE(pair.IsAs(still));
}

TEST(SwingTwistPart, NotANumberSpoilsNoBody) {
    RandomPoses random(15);
    Pair pair(random);
    pair.rows = MakeRows(random, 3, std::numeric_limits<float>::quiet_NaN(), 0.0f);
    pair.SetUp({1.0f, 1.0f, {}});
    const Pair before = pair;
    EXPECT_FALSE(pair.Solve());
    EXPECT_TRUE(pair.IsAs(before));
    EXPECT_EQ(Length(pair.part.GetTotalLambda()), 0.0f);
}

// Of the ends of a range the nearer one, of limits those in reach, locks always.
TEST(SwingTwistPart, RowsAreTheLimitsInReach) {
    SwingTwistLimits limits;
    limits.shape = SwingShape::Pyramid;
    limits.swingY = {-0.5f, 1.0f};
    limits.swingZ = {-2.0f, 2.0f};
    limits.twist = {0.0f, 0.0f};
    const Quaternion world{0, 0, Sqrt(0.5f), Sqrt(0.5f)};  // x to y, y to -x
    const RotationLimitList list = CollectLimits(Swung(-0.3f, 0, 0.2f), limits);
    const SwingTwistRows<float> rows = RowsOf(list, world, 0.5f);
    EXPECT_NEAR(rows.row[0].error, 0.2f, 1e-6f);
    EXPECT_EQ(rows.row[0].lowest, 0.0f);
    EXPECT_LT(Length(Vector3(rows.row[0].axis - Vector3(-1, 0, 0))), 1e-6f);
    EXPECT_EQ(Length(rows.row[1].axis), 0.0f);
    EXPECT_NEAR(rows.row[2].error, 0.2f * Cos(0.15f), 1e-6f);
    EXPECT_EQ(rows.row[2].lowest, kBoth);
}

// Every call of a part's life, for scalars and lanes alike.
template <class Real>
struct Life {
    Twist<Real> v1, v2;
    InverseMass<Real> m1, m2;
    SwingTwistRows<Real> rows;
    SwingTwistCorrection<Real> correction;
    Vec3<Real> warm = Vec3<Real>(Real(0.0f), Real(0.0f), Real(0.0f));
    SwingTwistPart<Real> part;
    MaskOf<Real> applied{};

    void Run() {
        part.SetTotalLambda(warm);
        part.CalculateProperties(m1, m2, rows, correction);
        part.WarmStart(v1, v2, m1, m2, Real(0.9f));
        for (int i = 0; i < 3; ++i) applied = part.SolveVelocity(v1, v2, m1, m2);
        part.SolvePosition(v1, v2, m1, m2, rows, Real(0.2f));
    }
};

Life<float> MakeLife(RandomPoses& random) {
    Life<float> life;
    const RandomBody a = MakeBody(random), b = MakeBody(random);
    life.v1 = a.velocity;
    life.v2 = b.velocity;
    if (!random.Chance(0.2f)) life.m1 = a.mass;
    if (!random.Chance(0.2f)) life.m2 = b.mass;
    for (auto& row : life.rows.row)
        if (random.Chance(0.7f)) {
            const Vector3 axis = AnyDirection(random);
            const float error = random.Between(-0.3f, 0.3f);
            row = {axis, error, random.Chance(0.5f) ? 0.0f : kBoth};
        }
    life.warm = random.InBox(0.5f);
    life.correction = {random.Between(0.0f, 10.0f), random.Between(0.0f, 60.0f), {}};
    if (random.Chance(0.5f)) life.correction.softness = {random.Between(0.2f, 0.9f), random.Between(0.0f, 0.3f)};
    return life;
}

template <int N>
void PutLife(Life<Wide<N>>& lanes, int lane, const Life<float>& life) {
    PutLane(lanes.v1, lane, life.v1);
    PutLane(lanes.v2, lane, life.v2);
    PutLane(lanes.m1, lane, life.m1);
    PutLane(lanes.m2, lane, life.m2);
    SetLane(lanes.rows, lane, life.rows);
    PutLane(lanes.warm, lane, life.warm);
    lanes.correction.biasRate.Set(lane, life.correction.biasRate);
    lanes.correction.gapRate.Set(lane, life.correction.gapRate);
    lanes.correction.softness.massScale.Set(lane, life.correction.softness.massScale);
    lanes.correction.softness.impulseScale.Set(lane, life.correction.softness.impulseScale);
}

template <int N>
void ExpectLanesEqualScalar() {
    RandomPoses random(40 + N);
    for (int batch = 0; batch < 1600 / N; ++batch) {
        Life<Wide<N>> lanes{};
        std::vector<Life<float>> expected;
        for (int i = 0; i < N; ++i) {
            expected.push_back(MakeLife(random));
            PutLife(lanes, i, expected.back());
            expected.back().Run();
        }
        lanes.Run();
        for (int i = 0; i < N; ++i) {
            ASSERT_TRUE(SameBits(Lane(lanes.v1, i), expected[i].v1)) << batch << " " << i;
            ASSERT_TRUE(SameBits(Lane(lanes.v2, i), expected[i].v2)) << batch << " " << i;
            ASSERT_TRUE(SameBits(Lane(lanes.part.GetTotalLambda(), i), expected[i].part.GetTotalLambda()));
            ASSERT_EQ(lanes.applied[i], expected[i].applied);
        }
    }
}

TEST(SwingTwistPart, LanesGiveTheBitsOfTheScalar) {
    ExpectLanesEqualScalar<1>();
    ExpectLanesEqualScalar<kLanes>();
}

// Odd lanes are deactivated, and their bodies hold what arithmetic would disturb.
template <int N>
void ExpectInactiveLanesUntouched() {
    const float odd[] = {-0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         1e-42f};
    RandomPoses random(60 + N);
    for (int batch = 0; batch < 50; ++batch) {
        Life<Wide<N>> lanes{};
        Twist<float> before1[N], before2[N];
        Wide<N> which(0.0f);
        for (int i = 0; i < N; ++i) {
            const bool inactive = i % 2 == 1 || N == 1;
            Life<float> life = MakeLife(random);
            life.m1 = MakeBody(random).mass;
            life.rows.row[0] = {AnyDirection(random), 0.3f, kBoth};
            if (inactive)
                for (Twist<float>* twist : {&life.v1, &life.v2})
                    for (int k = 0; k < 3; ++k) twist->angular[k] = odd[static_cast<int>(random.Between(0.0f, 3.99f))];
            before1[i] = life.v1;
            before2[i] = life.v2;
            PutLife(lanes, i, life);
            which.Set(i, inactive ? 1.0f : 0.0f);
        }
        auto& part = lanes.part;
        part.SetTotalLambda(lanes.warm);
        part.CalculateProperties(lanes.m1, lanes.m2, lanes.rows, lanes.correction);
        const auto off = which > Wide<N>(0.0f);
        part.Deactivate(off);
        part.WarmStart(lanes.v1, lanes.v2, lanes.m1, lanes.m2, Wide<N>(1.0f));
        const auto applied = part.SolveVelocity(lanes.v1, lanes.v2, lanes.m1, lanes.m2);
        part.SolvePosition(lanes.v1, lanes.v2, lanes.m1, lanes.m2, lanes.rows, Wide<N>(0.2f));
        for (int i = 0; i < N; ++i) {
            const bool inactive = off[i];
            EXPECT_EQ(applied[i], !inactive);
            EXPECT_EQ(part.IsActive()[i], !inactive);
            const bool same = SameBits(Lane(lanes.v1, i), before1[i]) && SameBits(Lane(lanes.v2, i), before2[i]);
            EXPECT_EQ(same, inactive) << N << " " << i;
            if (inactive) {
                EXPECT_EQ(Length(Lane(part.GetTotalLambda(), i)), 0.0f);
            }
        }
    }
}

TEST(SwingTwistPart, InactiveLanesAreUntouched) {
    ExpectInactiveLanesUntouched<1>();
    ExpectInactiveLanesUntouched<kLanes>();
}

}  // namespace
}  // namespace fulcrum
