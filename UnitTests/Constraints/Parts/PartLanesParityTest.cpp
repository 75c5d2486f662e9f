// The parts over lanes: the bits of the scalar part in every lane of every width, and nothing done to inactive lanes.
#include "RandomBodies.h"

#include <Fulcrum/Constraints/Parts/AnglePart.h>

#include <gtest/gtest.h>

#include <limits>

namespace fulcrum {
namespace {

using testing::Bits;
using testing::Lane;
using testing::MakeBody;
using testing::MakeFrame;
using testing::PutLane;
using testing::RandomBody;
using testing::RandomPoses;
using testing::SameBits;

// One lane's constraint, solved by the scalar parts.
struct Row {
    RandomBody a, b;
    AxisFrame<float> frame;
    SpringConstants<float> spring;
    float bias, error, low, high, warmLambda;
    AxisPart<float> axis;
    AnglePart<float> angle;
};

// Hard rows and springs of every mode and form, tight and wide limits, bodies without mass.
Row MakeRow(RandomPoses& random) {
    Row row{MakeBody(random), MakeBody(random), MakeFrame(random), {}, 0, 0, 0, 0, 0, {}, {}};
    if (random.Chance(0.2f)) row.a.mass = {};
    if (random.Chance(0.2f)) row.b.mass = {};
    if (random.Chance(0.6f)) {
        SpringSettings settings;
        if (random.Chance(0.5f)) settings.mode = SpringMode::StiffnessAndDamping;
        settings.frequency = random.Between(0.1f, 30.0f);
        settings.dampingRatio = random.Chance(0.2f) ? 0.0f : random.Between(0.0f, 2.0f);
        settings.stiffness = random.Between(1.0f, 500.0f);
        settings.damping = random.Between(0.0f, 20.0f);
        settings.form = static_cast<SpringForm>(static_cast<int>(random.Between(0.0f, 2.99f)));
        row.spring = ToConstants(settings);
    }
    row.bias = random.Between(-1.0f, 1.0f);
    row.error = random.Between(-0.3f, 0.3f);
    row.high = random.Chance(0.5f) ? 0.05f : 1e30f;
    row.low = random.Chance(0.5f) ? 0.0f : -row.high;
    row.warmLambda = random.Between(-0.1f, 0.1f);
    return row;
}

constexpr float kDt = 1.0f / 60.0f;
constexpr float kRatio = 0.9f;
constexpr float kBaumgarte = 0.2f;
constexpr int kIterations = 3;

struct Outcome {
    Twist<float> v1, v2;
    float axisLambda, angleLambda;
    bool applied;
};

// Every call of the parts' life, for scalars and lanes alike.
template <class Real>
struct Life {
    Twist<Real> v1, v2;
    InverseMass<Real> m1, m2;
    AxisFrame<Real> frame;
    SpringConstants<Real> spring;
    Real bias, error, low, high, warmLambda;
    AxisPart<Real> axis;
    AnglePart<Real> angle;
    MaskOf<Real> applied;

    void Run() {
        const Vec3<Real>& n = frame.axis;
        axis.SetTotalLambda(warmLambda);
        angle.SetTotalLambda(warmLambda);
        axis.CalculateSpringProperties(Real(kDt), m1, m2, frame, bias, error, spring);
        angle.CalculateSpringProperties(Real(kDt), m1, m2, n, bias, error, spring);
        axis.WarmStart(v1, v2, m1, m2, n, Real(kRatio));
        angle.WarmStart(v1, v2, m1, m2, n, Real(kRatio));
        for (int i = 0; i < kIterations; ++i) {
            applied = axis.SolveVelocity(v1, v2, m1, m2, n, low, high);
            angle.SolveVelocity(v1, v2, m1, m2, n, low, high);
        }
        axis.SolvePosition(v1, v2, m1, m2, n, error, Real(kBaumgarte));
        angle.SolvePosition(v1, v2, m1, m2, n, error, Real(kBaumgarte));
    }
};

Outcome RunScalar(const Row& row) {
    Life<float> life{row.a.velocity, row.b.velocity, row.a.mass, row.b.mass,     row.frame, row.spring, row.bias,
                     row.error,      row.low,        row.high,   row.warmLambda, {},        {},         false};
    life.Run();
    return {life.v1, life.v2, life.axis.GetTotalLambda(), life.angle.GetTotalLambda(), life.applied};
}

template <int N>
void ExpectLanesEqualScalar() {
    using Real = Wide<N>;
    RandomPoses random(40 + N);
    for (int batch = 0; batch < 1600 / N; ++batch) {
        Life<Real> life;
        Outcome expected[N];
        for (int i = 0; i < N; ++i) {
            const Row row = MakeRow(random);
            expected[i] = RunScalar(row);
            PutLane(life.v1, i, row.a.velocity);
            PutLane(life.v2, i, row.b.velocity);
            PutLane(life.m1, i, row.a.mass);
            PutLane(life.m2, i, row.b.mass);
            PutLane(life.frame.r1PlusU, i, row.frame.r1PlusU);
            PutLane(life.frame.r2, i, row.frame.r2);
            PutLane(life.frame.axis, i, row.frame.axis);
            SetLane(life.spring, i, row.spring);
            life.bias.Set(i, row.bias);
            life.error.Set(i, row.error);
            life.low.Set(i, row.low);
            life.high.Set(i, row.high);
            life.warmLambda.Set(i, row.warmLambda);
        }
        life.Run();
        for (int i = 0; i < N; ++i) {
            ASSERT_TRUE(SameBits(Lane(life.v1, i), expected[i].v1)) << batch << " " << i;
            ASSERT_TRUE(SameBits(Lane(life.v2, i), expected[i].v2)) << batch << " " << i;
            ASSERT_EQ(Bits(life.axis.GetTotalLambda()[i]), Bits(expected[i].axisLambda));
            ASSERT_EQ(Bits(life.angle.GetTotalLambda()[i]), Bits(expected[i].angleLambda));
            ASSERT_EQ(life.applied[i], expected[i].applied);
        }
    }
}

TEST(PartLanes, LanesGiveTheBitsOfTheScalar) {
    ExpectLanesEqualScalar<1>();
    ExpectLanesEqualScalar<kLanes>();
}

// The same bits from every compiler and processor. The number changes only with the parts' arithmetic (or that of Exp
// and Sin), never with the build.
TEST(PartLanes, EveryBuildGivesTheSameBits) {
    RandomPoses random(70);
    uint64_t hash = 14695981039346656037ull;  // FNV-1a
    const auto add = [&hash](float x) { hash = (hash ^ Bits(x)) * 1099511628211ull; };
    for (int i = 0; i < 500; ++i) {
        const Outcome outcome = RunScalar(MakeRow(random));
        for (const Twist<float>* twist : {&outcome.v1, &outcome.v2})
            for (int k = 0; k < 3; ++k) {
                add(twist->linear[k]);
                add(twist->angular[k]);
            }
        add(outcome.axisLambda);
        add(outcome.angleLambda);
    }
    EXPECT_EQ(hash, 17746675870070632894ull);
}

// A row that is known to be hard gives the bits of a row that might be soft.
TEST(PartLanes, HardOnlyPartsGiveTheBitsOfHardRows) {
    RandomPoses random(50);
    for (int i = 0; i < 200; ++i) {
        const Row row = MakeRow(random);
        AxisPart<float, true> general;
        AxisPart<float, false> hard;
        general.CalculateProperties(row.a.mass, row.b.mass, row.frame, row.bias);
        hard.CalculateProperties(row.a.mass, row.b.mass, row.frame, row.bias);
        RandomBody a1 = row.a, b1 = row.b, a2 = row.a, b2 = row.b;
        for (int k = 0; k < 3; ++k) {
            general.SolveVelocity(a1.velocity, b1.velocity, a1.mass, b1.mass, row.frame.axis, row.low, row.high);
            hard.SolveVelocity(a2.velocity, b2.velocity, a2.mass, b2.mass, row.frame.axis, row.low, row.high);
        }
        ASSERT_TRUE(SameBits(a1.velocity, a2.velocity) && SameBits(b1.velocity, b2.velocity));
        ASSERT_EQ(Bits(general.GetTotalLambda()), Bits(hard.GetTotalLambda()));
    }
}

// Odd lanes are deactivated. Their bodies hold what arithmetic would disturb (-0, NaN, infinity, denormals), their
// limits demand an impulse, and the error of the position pass is not zero.
template <int N>
void ExpectInactiveLanesUntouched() {
    using Real = Wide<N>;
    const float odd[] = {
        -0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e-42f, 0.0f, -3.5f};
    RandomPoses random(60 + N);
    for (int batch = 0; batch < 50; ++batch) {
        Twist<Real> v1, v2;
        InverseMass<Real> m1, m2;
        AxisFrame<Real> frame;
        Twist<float> before1[N], before2[N];
        MaskOf<Real> off = Real(0.0f) > Real(0.0f);
        Real which(0.0f);
        for (int i = 0; i < N; ++i) {
            const Row row = MakeRow(random);
            const bool inactive = i % 2 == 1 || N == 1;
            const auto pick = [&] { return odd[static_cast<int>(random.Between(0.0f, 5.99f))]; };
            before1[i] = row.a.velocity;
            before2[i] = row.b.velocity;
            if (inactive)
                for (int k = 0; k < 3; ++k) {
                    before1[i].linear[k] = pick();
                    before1[i].angular[k] = pick();
                    before2[i].linear[k] = pick();
                    before2[i].angular[k] = pick();
                }
            which.Set(i, inactive ? 1.0f : 0.0f);
            PutLane(v1, i, before1[i]);
            PutLane(v2, i, before2[i]);
            PutLane(m1, i, MakeBody(random).mass);
            PutLane(m2, i, MakeBody(random).mass);
            PutLane(frame.r1PlusU, i, row.frame.r1PlusU);
            PutLane(frame.r2, i, row.frame.r2);
            PutLane(frame.axis, i, row.frame.axis);
        }
        off = which > Real(0.0f);
        AxisPart<Real> axis;
        AnglePart<Real> angle;
        axis.SetTotalLambda(Real(0.5f));
        angle.SetTotalLambda(Real(0.5f));
        axis.CalculateProperties(m1, m2, frame, Real(0.1f));
        angle.CalculateProperties(m1, m2, frame.axis, Real(0.1f));
        axis.Deactivate(off);
        angle.Deactivate(off);
        axis.WarmStart(v1, v2, m1, m2, frame.axis, Real(1.0f));
        angle.WarmStart(v1, v2, m1, m2, frame.axis, Real(1.0f));
        const auto applied = axis.SolveVelocity(v1, v2, m1, m2, frame.axis, Real(0.6f), Real(0.7f));
        angle.SolveVelocity(v1, v2, m1, m2, frame.axis, Real(0.6f), Real(0.7f));
        axis.SolvePosition(v1, v2, m1, m2, frame.axis, Real(0.1f), Real(0.2f));
        angle.SolvePosition(v1, v2, m1, m2, frame.axis, Real(0.1f), Real(0.2f));
        for (int i = 0; i < N; ++i) {
            const bool inactive = off[i];
            EXPECT_EQ(applied[i], !inactive);
            EXPECT_EQ(axis.IsActive()[i], !inactive);
            EXPECT_EQ(SameBits(Lane(v1, i), before1[i]), inactive) << N << " " << i;
            EXPECT_EQ(SameBits(Lane(v2, i), before2[i]), inactive) << N << " " << i;
            if (inactive) {
                EXPECT_EQ(axis.GetTotalLambda()[i], 0.0f);
            }
        }
    }
}

TEST(PartLanes, InactiveLanesAreUntouched) {
    ExpectInactiveLanesUntouched<1>();
    ExpectInactiveLanesUntouched<kLanes>();
}

}  // namespace
}  // namespace fulcrum
