// What all parts have in common, against their Jacobians written out densely in double, and their lanes.
#include "PartCases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace fulcrum {
namespace {

using testing::Bits;
using testing::Lane;
using testing::MakeBody;
using testing::MakeInputs;
using testing::PartInputs;
using testing::PutLane;
using testing::RandomBody;
using testing::RandomPoses;
using testing::RowOf;
using testing::SameBits;
using testing::ToDense;

template <class Case, class Part = typename Case::template Part<float>>
struct Pair {
    RandomBody a, b;
    PartInputs<float> inputs;
    Part part;

    explicit Pair(RandomPoses& random) : a(MakeBody(random)), b(MakeBody(random)), inputs(MakeInputs(random)) {}
    Pair(const RandomBody& bodyA, const RandomBody& bodyB, const PartInputs<float>& partInputs)
        : a(bodyA), b(bodyB), inputs(partInputs) {}
    void SetUp() { Case::SetUp(part, a.mass, b.mass, inputs); }
    void WarmStart() { part.WarmStart(a.velocity, b.velocity, a.mass, b.mass); }
    bool Solve() { return part.SolveVelocity(a.velocity, b.velocity, a.mass, b.mass); }
    Eigen::VectorXd Motion() const { return testing::ToDense(part.RelativeMotion(a.velocity, b.velocity)); }
    Eigen::VectorXd Bias() const { return ToDense(inputs.bias).head(Case::kRows); }
    Eigen::MatrixXd K() const {
        const auto j = Case::Jacobian(inputs);
        return j * testing::DenseInverseMass(a.mass, b.mass) * j.transpose();
    }
    bool IsAs(const Pair& other) const {
        return SameBits(a.velocity, other.a.velocity) && SameBits(b.velocity, other.b.velocity);
    }
};

template <class Rows>
bool SameRows(const Rows& a, const Rows& b, int rows) {
    for (int i = 0; i < rows; ++i)
        if (Bits(RowOf(a, i)) != Bits(RowOf(b, i))) return false;
    return true;
}
// A value that every row gets.
template <class Part>
typename Part::Rows AllRows(float x) {
    typename Part::Rows rows{};
    if constexpr (std::is_same_v<typename Part::Rows, float>) rows = x;
    else
        for (int i = 0; i < rows.size(); ++i) rows[i] = x;
    return rows;
}

template <class Case>
class PartTest : public ::testing::Test {};
TYPED_TEST_SUITE(PartTest, testing::AllParts);

TYPED_TEST(PartTest, EffectiveMassIsTheInverseOfTheDenseProduct) {
    RandomPoses random(1);
    for (int i = 0; i < 200; ++i) {
        Pair<TypeParam> pair(random);
        pair.SetUp();
        const Eigen::MatrixXd expected = pair.K().inverse();
        const Eigen::MatrixXd mass = ToDense(pair.part.GetEffectiveMass());
        EXPECT_LT((mass - expected).norm(), TypeParam::kMassRounding * expected.norm()) << i;
        const Eigen::VectorXd motion =
            TypeParam::Jacobian(pair.inputs) * testing::DenseMotion(pair.a.velocity, pair.b.velocity);
        EXPECT_LT((pair.Motion() - motion).norm(), TypeParam::kRounding);
    }
}

TYPED_TEST(PartTest, OneSolveMeetsTheBias) {
    RandomPoses random(2);
    for (int i = 0; i < 200; ++i) {
        Pair<TypeParam> pair(random);
        pair.SetUp();
        const auto before = testing::DenseMotion(pair.a.velocity, pair.b.velocity);
        EXPECT_TRUE(pair.Solve());
        EXPECT_LT((pair.Motion() + pair.Bias()).norm(), TypeParam::kRounding);
        // And the velocities changed by M^-1 J^T lambda.
        const auto after = testing::DenseMotion(pair.a.velocity, pair.b.velocity);
        const Eigen::VectorXd gain = testing::DenseInverseMass(pair.a.mass, pair.b.mass) *
                                     TypeParam::Jacobian(pair.inputs).transpose() * ToDense(pair.part.GetTotalLambda());
        EXPECT_LT((after - before - gain).norm(), TypeParam::kRounding);
    }
}

TYPED_TEST(PartTest, ImpulsesKeepMomentum) {
    if constexpr (TypeParam::kKept != testing::Momentum::None) {
        RandomPoses random(3);
        for (int i = 0; i < 100; ++i) {
            Pair<TypeParam> pair(random);
            pair.inputs.r1 = pair.b.position + pair.inputs.r2 - pair.a.position;  // both impulses act at p2
            const auto momentum = [&] {
                Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
                for (const RandomBody* body : {&pair.a, &pair.b}) {
                    const Position p = body->velocity.linear.cast<double>() / static_cast<double>(body->mass.mass.x());
                    sum.head(3) += ToDense(p);
                    sum.tail(3) += ToDense(body->position.cast<double>().cross(p)) +
                                   testing::DenseInertia(body->mass).inverse() * ToDense(body->velocity.angular);
                }
                return sum;
            };
            const auto before = momentum();
            pair.SetUp();
            pair.Solve();
            // Velocities are rounded to 3e-7 or so, and multiplied by masses of up to 10 kg at up to 4 m.
            const Eigen::Matrix<double, 6, 1> gain = momentum() - before;
            EXPECT_LT(gain.head(3).norm(), 1e-4);
            if constexpr (TypeParam::kKept == testing::Momentum::LinearAndAngular) {
                EXPECT_LT(gain.tail(3).norm(), 2e-4);
            }
        }
    }
}

// delta = -s K^-1 (J v + b) - g lambda. With y = K lambda, J v = J v0 + y and r = J v0 + b, so y' = y - s (y + r) - g
// y: y runs to its fixed point -s r / (s + g) by the factor 1 - s - g, in every row alike.
TYPED_TEST(PartTest, SoftRowsFollowTheirRecursion) {
    RandomPoses random(4);
    for (int i = 0; i < 50; ++i) {
        Pair<TypeParam> pair(random);
        const float s = random.Between(0.1f, 0.8f), g = random.Between(0.05f, 0.2f);
        pair.inputs.softness = {s, g};
        pair.SetUp();
        const Eigen::VectorXd r = pair.Motion() + pair.Bias();
        const double ds = static_cast<double>(s), dg = static_cast<double>(g);
        for (int n = 1; n <= 5; ++n) {
            pair.Solve();
            const Eigen::VectorXd y = -ds / (ds + dg) * (1.0 - std::pow(1.0 - ds - dg, n)) * r;
            EXPECT_LT((pair.K() * ToDense(pair.part.GetTotalLambda()) - y).norm(), 2.0 * TypeParam::kRounding);
            EXPECT_LT((pair.Motion() + pair.Bias() - r - y).norm(), 2.0 * TypeParam::kRounding);
        }
        // Hard and without bias from here on: at rest after one more solve.
        pair.part.SetBias(AllRows<decltype(pair.part)>(0.0f), {});
        pair.Solve();
        EXPECT_LT(pair.Motion().norm(), TypeParam::kRounding);
    }
}

TYPED_TEST(PartTest, PositionPassTakesTheBaumgarteShareOfTheError) {
    RandomPoses random(5);
    for (int i = 0; i < 50; ++i) {
        Pair<TypeParam> pair(random);
        pair.inputs.softness = {0.5f, 0.1f};  // no matter for positions
        pair.SetUp();
        using Rows = typename decltype(pair.part)::Rows;
        const Rows error = AllRows<decltype(pair.part)>(0.1f);
        Twist<float> moved1, moved2;
        EXPECT_TRUE(pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass, error, 0.2f));
        const Eigen::VectorXd change = ToDense(pair.part.RelativeMotion(moved1, moved2));
        EXPECT_LT((change + 0.2 * ToDense(error)).norm(), 1e-6);
        EXPECT_FALSE(pair.part.SolvePosition(moved1, moved2, pair.a.mass, pair.b.mass,
                                             AllRows<decltype(pair.part)>(0.0f), 0.2f));
    }
}

// A compile-time side must be the dynamic block with zeros in the right places, whatever it is handed there.
template <class Case, BodySide kSide1, BodySide kSide2>
void ExpectSideIsDynamicWithZeros(uint32_t seed) {
    RandomPoses random(seed);
    for (int i = 0; i < 50; ++i) {
        Pair<Case> general(random);
        const RandomBody a = general.a, b = general.b;
        Pair<Case, typename Case::template Part<float, kSide1, kSide2>> special(a, b, general.inputs);
        const auto zero = [](RandomBody& body, BodySide side) {
            if (!HasMass(side)) body.mass = {};
            if (!HasVelocity(side)) body.velocity = {};
        };
        zero(general.a, kSide1);
        zero(general.b, kSide2);
        general.SetUp();
        special.SetUp();
        general.part.SetTotalLambda(AllRows<decltype(general.part)>(0.1f));
        special.part.SetTotalLambda(AllRows<decltype(special.part)>(0.1f));
        general.WarmStart();
        special.WarmStart();
        EXPECT_TRUE(general.Solve());
        EXPECT_TRUE(special.Solve());
        EXPECT_TRUE(SameRows(special.part.GetTotalLambda(), general.part.GetTotalLambda(), Case::kRows));
        EXPECT_TRUE(SameBits(special.a.velocity, (HasMass(kSide1) ? general.a : a).velocity));
        EXPECT_TRUE(SameBits(special.b.velocity, (HasMass(kSide2) ? general.b : b).velocity));
        EXPECT_LT((special.Motion() + special.Bias()).norm(), Case::kRounding);
    }
}

template <class Case>
class PartSidesTest : public ::testing::Test {};
TYPED_TEST_SUITE(PartSidesTest, testing::PartsWithSides);

TYPED_TEST(PartSidesTest, StaticAndKinematicSides) {
    ExpectSideIsDynamicWithZeros<TypeParam, BodySide::Static, BodySide::Dynamic>(7);
    ExpectSideIsDynamicWithZeros<TypeParam, BodySide::Dynamic, BodySide::Static>(8);
    ExpectSideIsDynamicWithZeros<TypeParam, BodySide::Kinematic, BodySide::Dynamic>(9);
    ExpectSideIsDynamicWithZeros<TypeParam, BodySide::Dynamic, BodySide::Kinematic>(10);
    ExpectSideIsDynamicWithZeros<TypeParam, BodySide::Dynamic, BodySide::Dynamic>(11);
}

TYPED_TEST(PartTest, WarmStartStateAndBodiesWithoutMass) {
    RandomPoses random(12);
    Pair<TypeParam> pair(random);
    using Part = decltype(pair.part);
    pair.SetUp();
    pair.part.SetTotalLambda(AllRows<Part>(0.2f));
    const auto before = testing::DenseMotion(pair.a.velocity, pair.b.velocity);
    pair.part.WarmStart(pair.a.velocity, pair.b.velocity, pair.a.mass, pair.b.mass);
    EXPECT_TRUE(SameRows(pair.part.GetTotalLambda(), AllRows<Part>(0.2f), TypeParam::kRows));
    const Eigen::VectorXd gain = testing::DenseInverseMass(pair.a.mass, pair.b.mass) *
                                 TypeParam::Jacobian(pair.inputs).transpose() * ToDense(AllRows<Part>(0.2f));
    EXPECT_LT((testing::DenseMotion(pair.a.velocity, pair.b.velocity) - before - gain).norm(), 2e-6);

    pair.Solve();
    Part fresh;
    EXPECT_FALSE(fresh.IsActive());
    fresh.RestoreState(pair.part.SaveState());
    TypeParam::SetUp(fresh, pair.a.mass, pair.b.mass, pair.inputs);
    EXPECT_TRUE(SameRows(fresh.GetTotalLambda(), pair.part.GetTotalLambda(), TypeParam::kRows));

    EXPECT_TRUE(pair.part.IsActive());
    // Two bodies that nothing moves.
    const Pair<TypeParam> still = pair;
    pair.part.SetTotalLambda(AllRows<Part>(2.0f));
    pair.a.mass = pair.b.mass = {};
    pair.SetUp();
    EXPECT_FALSE(pair.part.IsActive());
    EXPECT_EQ(ToDense(pair.part.GetTotalLambda()).norm(), 0.0);
    EXPECT_FALSE(pair.Solve());
    EXPECT_TRUE(pair.IsAs(still));
}

TYPED_TEST(PartTest, NotANumberSpoilsNoBody) {
    RandomPoses random(13);
    Pair<TypeParam> pair(random);
    pair.SetUp();
    pair.part.SetBias(AllRows<decltype(pair.part)>(std::numeric_limits<float>::quiet_NaN()), {});
    const Pair<TypeParam> before = pair;
    EXPECT_FALSE(pair.Solve());
    EXPECT_TRUE(pair.IsAs(before));
    EXPECT_EQ(ToDense(pair.part.GetTotalLambda()).norm(), 0.0);
}

// Every call of a part's life, for scalars and lanes alike.
template <class Case, class Real>
struct Life {
    Twist<Real> v1, v2;
    InverseMass<Real> m1, m2;
    PartInputs<Real> inputs;
    typename Case::template Part<Real> part;
    MaskOf<Real> applied{};

    void Run() {
        const auto rows = [&](const Vec3<Real>& v) {
            if constexpr (Case::kRows == 1) return v.x();
            else if constexpr (Case::kRows == 2) return testing::FirstTwo(v);
            else return v;
        };
        part.SetTotalLambda(rows(inputs.bias));
        Case::SetUp(part, m1, m2, inputs);
        part.WarmStart(v1, v2, m1, m2);
        for (int i = 0; i < 3; ++i) applied = part.SolveVelocity(v1, v2, m1, m2);
        part.SetBias(rows(inputs.r1), {});
        part.SolveVelocity(v1, v2, m1, m2);
        part.SolvePosition(v1, v2, m1, m2, rows(inputs.r2), Real(0.2f));
    }
};

template <class Case>
Life<Case, float> MakeLife(RandomPoses& random) {
    Life<Case, float> life;
    const RandomBody a = MakeBody(random), b = MakeBody(random);
    life.v1 = a.velocity;
    life.v2 = b.velocity;
    life.m1 = a.mass;
    life.m2 = b.mass;
    life.inputs = MakeInputs(random);
    if (random.Chance(0.2f)) life.m1 = {};
    if (random.Chance(0.2f)) life.m2 = {};
    if (random.Chance(0.5f)) life.inputs.softness = {random.Between(0.2f, 0.9f), random.Between(0.0f, 0.3f)};
    return life;
}

template <class Case, int N>
void PutLife(Life<Case, Wide<N>>& lanes, int lane, const Life<Case, float>& life) {
    PutLane(lanes.v1, lane, life.v1);
    PutLane(lanes.v2, lane, life.v2);
    PutLane(lanes.m1, lane, life.m1);
    PutLane(lanes.m2, lane, life.m2);
    PutLane(lanes.inputs.r1, lane, life.inputs.r1);
    PutLane(lanes.inputs.r2, lane, life.inputs.r2);
    PutLane(lanes.inputs.axis1, lane, life.inputs.axis1);
    PutLane(lanes.inputs.axis2, lane, life.inputs.axis2);
    PutLane(lanes.inputs.bias, lane, life.inputs.bias);
    lanes.inputs.ratio.Set(lane, life.inputs.ratio);
    lanes.inputs.softness.massScale.Set(lane, life.inputs.softness.massScale);
    lanes.inputs.softness.impulseScale.Set(lane, life.inputs.softness.impulseScale);
}

template <class Case, int N>
void ExpectLanesEqualScalar() {
    RandomPoses random(40 + N);
    for (int batch = 0; batch < 800 / N; ++batch) {
        Life<Case, Wide<N>> lanes{};
        std::vector<Life<Case, float>> expected;
        for (int i = 0; i < N; ++i) {
            expected.push_back(MakeLife<Case>(random));
            PutLife(lanes, i, expected.back());
            expected.back().Run();
        }
        lanes.Run();
        for (int i = 0; i < N; ++i) {
            ASSERT_TRUE(SameBits(Lane(lanes.v1, i), expected[i].v1)) << batch << " " << i;
            ASSERT_TRUE(SameBits(Lane(lanes.v2, i), expected[i].v2)) << batch << " " << i;
            ASSERT_EQ(lanes.applied[i], expected[i].applied);
            for (int row = 0; row < Case::kRows; ++row)
                ASSERT_EQ(Bits(RowOf(lanes.part.GetTotalLambda(), row)[i]),
                          Bits(RowOf(expected[i].part.GetTotalLambda(), row)));
        }
    }
}

TYPED_TEST(PartTest, LanesGiveTheBitsOfTheScalar) {
    ExpectLanesEqualScalar<TypeParam, 1>();
    ExpectLanesEqualScalar<TypeParam, kLanes>();
}

// No body of odd lanes can move, and these hold what arithmetic would disturb.
template <class Case, int N>
void ExpectInactiveLanesUntouched() {
    const float odd[] = {
        -0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e-42f, 0.0f, -3.5f};
    RandomPoses random(60 + N);
    for (int batch = 0; batch < 50; ++batch) {
        Life<Case, Wide<N>> lanes{};
        Twist<float> before1[N], before2[N];
        Wide<N> which(0.0f);
        for (int i = 0; i < N; ++i) {
            const bool inactive = i % 2 == 1 || N == 1;
            auto life = MakeLife<Case>(random);
            life.m1 = inactive ? InverseMass<float>() : MakeBody(random).mass;
            life.m2 = inactive ? InverseMass<float>() : MakeBody(random).mass;
            if (inactive)
                for (Twist<float>* twist : {&life.v1, &life.v2})
                    for (int k = 0; k < 3; ++k) {
                        twist->linear[k] = odd[static_cast<int>(random.Between(0.0f, 5.99f))];
                        twist->angular[k] = odd[static_cast<int>(random.Between(0.0f, 5.99f))];
                    }
            before1[i] = life.v1;
            before2[i] = life.v2;
            PutLife(lanes, i, life);
            which.Set(i, inactive ? 1.0f : 0.0f);
        }
        auto& part = lanes.part;
        using Rows = typename Case::template Part<Wide<N>>::Rows;
        Rows half = part.GetTotalLambda();  // zero
        if constexpr (Case::kRows == 1) half = Wide<N>(0.5f);
        else
            for (int i = 0; i < half.size(); ++i) half[i] = Wide<N>(0.5f);
        part.SetTotalLambda(half);
        Case::SetUp(part, lanes.m1, lanes.m2, lanes.inputs);
        const auto off = which > Wide<N>(0.0f);
        part.WarmStart(lanes.v1, lanes.v2, lanes.m1, lanes.m2);
        const auto applied = part.SolveVelocity(lanes.v1, lanes.v2, lanes.m1, lanes.m2);
        part.SolvePosition(lanes.v1, lanes.v2, lanes.m1, lanes.m2, half, Wide<N>(0.2f));
        for (int i = 0; i < N; ++i) {
            const bool inactive = off[i];
            EXPECT_EQ(applied[i], !inactive);
            EXPECT_EQ(part.IsActive()[i], !inactive);
            const bool same = SameBits(Lane(lanes.v1, i), before1[i]) && SameBits(Lane(lanes.v2, i), before2[i]);
            EXPECT_EQ(same, inactive) << N << " " << i;
            if (inactive) {
                EXPECT_EQ(RowOf(part.GetTotalLambda(), 0)[i], 0.0f);
            }
        }
    }
}

TYPED_TEST(PartTest, InactiveLanesAreUntouched) {
    ExpectInactiveLanesUntouched<TypeParam, 1>();
    ExpectInactiveLanesUntouched<TypeParam, kLanes>();
}

}  // namespace
}  // namespace fulcrum
