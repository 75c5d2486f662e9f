// What all parts have in common, continued: springs against the continuous oscillator, masses overridden for one
// constraint, snapshots of lanes; and parts whose callers count turns over many of them.
#include "PartCases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

using testing::Bits;
using testing::MakeBody;
using testing::MakeInputs;
using testing::PartInputs;
using testing::PutLane;
using testing::RandomBody;
using testing::RandomPoses;
using testing::RowOf;
using testing::SameBits;
using testing::ToDense;

template <class Rows>
Rows FromDense(const Eigen::VectorXd& x) {
    if constexpr (std::is_same_v<Rows, float>) return static_cast<float>(x[0]);
    else if constexpr (std::is_same_v<Rows, Vec2<float>>) return {static_cast<float>(x[0]), static_cast<float>(x[1])};
    else return Vector3(Eigen::Vector3f(x.cast<float>()));
}

template <class Case>
class PartSpringTest : public ::testing::Test {};
TYPED_TEST_SUITE(PartSpringTest, testing::AllParts);

// 2 Hz and damping ratio 0.3 in 2000 steps a period. Every row is an oscillator of its own, whatever the masses couple.
// The implicit step adds w h / 2 to the damping ratio: 0.5 % of it, of which the motion shows less.
TYPED_TEST(PartSpringTest, IsTheOscillatorInTheLimitOfSmallSteps) {
    using Part = typename TypeParam::template Part<float>;
    using Rows = typename Part::Rows;
    const double w = 2.0 * 3.14159265358979 * 2.0, zeta = 0.3, h = 1.0 / 4000.0;
    const double damped = w * std::sqrt(1.0 - zeta * zeta), a = h * w * (2.0 * zeta + h * w);
    RandomPoses random(1);
    for (int i = 0; i < 3; ++i) {
        const InverseMass<float> m1 = MakeBody(random).mass, m2 = MakeBody(random).mass;
        PartInputs<float> inputs = MakeInputs(random);
        inputs.softness = {static_cast<float>(a / (1.0 + a)), static_cast<float>(1.0 / (1.0 + a))};
        const Eigen::VectorXd start = ToDense(inputs.bias).head(TypeParam::kRows);
        Eigen::VectorXd error = start;
        Twist<float> v1, v2;
        Part part;
        for (int n = 1; n <= 4000; ++n) {
            TypeParam::SetUp(part, m1, m2, inputs);
            part.SetBias(FromDense<Rows>(error * (w / (2.0 * zeta + h * w))), inputs.softness);
            // From a total of zero one solve is the implicit step.
            part.SetTotalLambda(FromDense<Rows>(Eigen::VectorXd::Zero(TypeParam::kRows)));
            part.SolveVelocity(v1, v2, m1, m2);
            error += h * ToDense(part.RelativeMotion(v1, v2));
            const double t = n * h;
            const double share =
                std::exp(-zeta * w * t) * (std::cos(damped * t) + zeta * w / damped * std::sin(damped * t));
            ASSERT_LT((error - share * start).norm(), 0.01 * start.norm()) << n;
        }
    }
}

// Body 1 heavier for this constraint only. Set-up and solve see the other mass, and the row is met all the same.
TYPED_TEST(PartSpringTest, MassesMayBeOverridden) {
    using Part = typename TypeParam::template Part<float>;
    RandomPoses random(2);
    for (int i = 0; i < 100; ++i) {
        const RandomBody a = MakeBody(random), b = MakeBody(random);
        const PartInputs<float> inputs = MakeInputs(random);
        InverseMass<float> heavy = testing::OverrideMass(a.mass, 0.25f * a.mass.mass.x(), 0.5f);
        heavy.mass.y() = 0;  // its translation along y is locked
        const auto j = TypeParam::Jacobian(inputs);
        const Eigen::MatrixXd inverseMass = testing::DenseInverseMass(heavy, b.mass);
        Twist<float> v1 = a.velocity, v2 = b.velocity;
        Part part;
        TypeParam::SetUp(part, heavy, b.mass, inputs);
        const Eigen::MatrixXd expected = (j * inverseMass * j.transpose()).inverse();
        EXPECT_LT((ToDense(part.GetEffectiveMass()) - expected).norm(), TypeParam::kMassRounding * expected.norm());
        EXPECT_TRUE(part.SolveVelocity(v1, v2, heavy, b.mass));
        EXPECT_LT((ToDense(part.RelativeMotion(v1, v2)) + ToDense(inputs.bias).head(TypeParam::kRows)).norm(),
                  TypeParam::kRounding);
        const Eigen::VectorXd gain = inverseMass * j.transpose() * ToDense(part.GetTotalLambda());
        EXPECT_LT((testing::DenseMotion(v1, v2) - testing::DenseMotion(a.velocity, b.velocity) - gain).norm(),
                  TypeParam::kRounding);
        Twist<float> moved1, moved2;
        part.SolvePosition(moved1, moved2, heavy, b.mass, part.GetTotalLambda(), 0.2f);
        EXPECT_LT((ToDense(part.RelativeMotion(moved1, moved2)) + 0.2 * ToDense(part.GetTotalLambda())).norm(),
                  TypeParam::kRounding);

        // Without any mass it is a wall: the row is met by the other body alone.
        const InverseMass<float> wall = testing::OverrideMass(a.mass, 0.0f, 0.0f);
        Twist<float> still = a.velocity;
        v2 = b.velocity;
        part.SetTotalLambda(FromDense<typename Part::Rows>(Eigen::VectorXd::Zero(TypeParam::kRows)));
        TypeParam::SetUp(part, wall, b.mass, inputs);
        part.SolveVelocity(still, v2, wall, b.mass);
        EXPECT_TRUE(SameBits(still, a.velocity));
        EXPECT_LT((ToDense(part.RelativeMotion(still, v2)) + ToDense(inputs.bias).head(TypeParam::kRows)).norm(),
                  TypeParam::kRounding);
    }
}

// A step that goes on from a snapshot is the step that it was taken from, in every lane.
TYPED_TEST(PartSpringTest, SnapshotsOfLanesGoOnAsBefore) {
    constexpr int N = kLanes;
    using Real = Wide<N>;
    using Part = typename TypeParam::template Part<Real>;
    RandomPoses random(3);
    Twist<Real> v1, v2;
    InverseMass<Real> m1, m2;
    PartInputs<Real> inputs{};
    for (int i = 0; i < N; ++i) {
        const RandomBody a = MakeBody(random), b = MakeBody(random);
        const PartInputs<float> in = MakeInputs(random);
        PutLane(v1, i, a.velocity);
        PutLane(v2, i, b.velocity);
        PutLane(m1, i, a.mass);
        PutLane(m2, i, b.mass);
        PutLane(inputs.r1, i, in.r1);
        PutLane(inputs.r2, i, in.r2);
        PutLane(inputs.axis1, i, in.axis1);
        PutLane(inputs.axis2, i, in.axis2);
        PutLane(inputs.bias, i, in.bias);
        inputs.ratio.Set(i, in.ratio);
    }
    const auto step = [&](Part& part, Twist<Real>& a, Twist<Real>& b) {
        TypeParam::SetUp(part, m1, m2, inputs);
        part.WarmStart(a, b, m1, m2);
        part.SolveVelocity(a, b, m1, m2);
    };
    Part part;
    step(part, v1, v2);
    Twist<Real> again1 = v1, again2 = v2;
    Part restored;
    restored.RestoreState(part.SaveState());
    step(part, v1, v2);
    step(restored, again1, again2);
    for (int i = 0; i < N; ++i) {
        EXPECT_TRUE(SameBits(testing::Lane(v1, i), testing::Lane(again1, i)));
        EXPECT_TRUE(SameBits(testing::Lane(v2, i), testing::Lane(again2, i)));
        for (int row = 0; row < TypeParam::kRows; ++row)
            EXPECT_EQ(Bits(RowOf(part.GetTotalLambda(), row)[i]), Bits(RowOf(restored.GetTotalLambda(), row)[i]));
    }
}

// A rack that a pinion pulls over 100000 turns, its caller counting both: 10 rad per meter, so some 63 km.
TEST(RackAndPinionPart, KeepsItsPhaseOverManyTurns) {
    InverseMass<float> pinion, rack;
    pinion.inertia.zz = 0.7f;
    rack.mass = Vector3::Constant(0.4f);
    const float ratio = 10.0f, h = 1.0f / 240.0f;
    Twist<float> v1, v2;
    v1.angular.z() = 600.0f;
    const Vector3 none = Vector3::Zero();
    testing::OneRowPart<float> part;
    part.SetJacobian(RackAndPinionJacobian<float>({none, none, Vector3(0, 0, 1), Vector3(1, 0, 0), ratio}));
    double angle = 0.0, way = 0.0, worst = 0.0;
    while (angle < 2.0 * 3.14159265358979 * 100000.0) {
        const float error = static_cast<float>(angle - static_cast<double>(ratio) * way);
        part.CalculateProperties(pinion, rack);
        part.SetBias(0.2f / h * error, {});
        part.SetTotalLambda(0.0f);
        v2.linear.x() -= 0.01f;  // something brakes
        v1.angular.z() += 0.02f * (500.0f - v1.angular.z());
        part.SolveVelocity(v1, v2, pinion, rack);
        angle += static_cast<double>(v1.angular.z() * h);
        way += static_cast<double>(v2.linear.x() * h);
        worst = std::max(worst, std::fabs(angle - static_cast<double>(ratio) * way));
    }
    // One step's rounding of 500 rad/s (3e-5), and of 50 m/s times the ratio (4e-5), for 1 / 240 s, divided by the
    // share of 0.2 that is fed back, a few times over.
    EXPECT_LT(worst, 1e-5);
}

}  // namespace
}  // namespace fulcrum
