// Row parts over lanes, springs and limits among them: the bits of the scalar part in every lane of every width, and
// nothing done to inactive lanes.
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
using testing::SetSpring;

// One lane's constraint.
struct Row {
    RandomBody a, b;
    AxisFrame<float> frame;
    SpringConstants<float> spring;
    float bias, error, low, high, warmLambda;
};

template <int N>
void SetLane(SpringConstants<Wide<N>>& lanes, int lane, const SpringConstants<float>& constants) {
    lanes.squaredFrequency.Set(lane, constants.squaredFrequency);
    lanes.decayRate.Set(lane, constants.decayRate);
    lanes.stiffness.Set(lane, constants.stiffness);
    lanes.damping.Set(lane, constants.damping);
    lanes.form.Set(lane, constants.form);
}

// Hard rows and springs of every mode and form, tight and wide limits, bodies without mass.
Row MakeRow(RandomPoses& random) {
    Row row{MakeBody(random), MakeBody(random), MakeFrame(random), {}, 0, 0, 0, 0, 0};
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
    RowPart<Real> axis, angle;
    MaskOf<Real> applied;

    void Run() {
        axis.SetJacobian(AxisJacobian(frame));
        angle.SetJacobian(AngleJacobian(frame.axis));
        for (RowPart<Real>* part : {&axis, &angle}) {
            part->SetTotalLambda(warmLambda);
            part->CalculateProperties(m1, m2);
            SetSpring(*part, Real(kDt), bias, error, spring);
        }
        axis.WarmStart(v1, v2);
        angle.WarmStart(v1, v2);
        for (int i = 0; i < kIterations; ++i) {
            applied = axis.SolveVelocity(v1, v2, low, high);
            angle.SolveVelocity(v1, v2, low, high);
        }
        axis.SolvePosition(v1, v2, error, Real(kBaumgarte));
        angle.SolvePosition(v1, v2, error, Real(kBaumgarte));
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
    EXPECT_EQ(hash, 2219270516395270000ull);
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
        RowPart<Real> axis, angle;
        axis.SetJacobian(AxisJacobian(frame));
        angle.SetJacobian(AngleJacobian(frame.axis));
        for (RowPart<Real>* part : {&axis, &angle}) {
            part->SetTotalLambda(Real(0.5f));
            part->CalculateProperties(m1, m2);
            part->SetBias(Real(0.1f));
            part->Deactivate(off);
            part->WarmStart(v1, v2);
        }
        const auto applied = axis.SolveVelocity(v1, v2, Real(0.6f), Real(0.7f));
        angle.SolveVelocity(v1, v2, Real(0.6f), Real(0.7f));
        axis.SolvePosition(v1, v2, Real(0.1f), Real(0.2f));
        angle.SolvePosition(v1, v2, Real(0.1f), Real(0.2f));
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
