// The errors of the joints' parts and their position passes: from small and large errors back to none.
#include "PartCases.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fulcrum {
namespace {

float LengthOf(const Vec2<float>& v) { return std::hypot(v.x(), v.y()); }

using testing::AnyDirection;
using testing::AnyRotation;
using testing::MakeBody;
using testing::RandomBody;
using testing::RandomPoses;

constexpr float kPi = 3.14159265f;

// A body with a pose, whose inertia turns with it.
struct Body {
    Vector3 position;
    Quaternion rotation;
    float inverseMass;
    Vector3 inverseInertia;  // along its own axes

    InverseMass<float> Mass() const { return {inverseMass, RotatedDiagonal(ToMatrix(rotation), inverseInertia)}; }
    void Move(const Twist<float>& by) {
        position += by.linear;
        rotation = Normalized(RotationFromVector(by.angular) * rotation);
    }
};

Body RandomPose(RandomPoses& random) {
    const float a = random.Between(0.5f, 3.0f), b = random.Between(0.5f, 3.0f), c = random.Between(0.5f, 3.0f);
    return {random.InBox(2.0f), AnyRotation(random), random.Between(0.1f, 2.0f), Vector3(a, b, c)};
}
Body Immovable(Body body) {
    body.inverseMass = 0.0f;
    body.inverseInertia = Vector3::Zero();
    return body;
}

// Passes until the error is below 1e-6 (float's 6e-8 times numbers of up to 10), or 100.
template <class Pass>
int CountPasses(Pass pass) {
    for (int count = 0; count < 100; ++count)
        if (pass() < 1e-6f) return count;
    return 100;
}

TEST(JointError, PointPartBringsTheAnchorsTogether) {
    RandomPoses random(1);
    int worst = 0;
    for (int i = 0; i < 200; ++i) {
        Body a = RandomPose(random), b = RandomPose(random);
        const Vector3 local1 = random.InBox(1.0f), local2 = random.InBox(1.0f);
        worst = std::max(worst, CountPasses([&] {
                             const Vector3 r1 = Rotate(a.rotation, local1), r2 = Rotate(b.rotation, local2);
                             const Vector3 error = b.position + r2 - a.position - r1;
                             PointPart<float> part;
                             Twist<float> moved1, moved2;
                             part.CalculateProperties(a.Mass(), b.Mass(), r1, r2);
                             part.SolvePosition(moved1, moved2, a.Mass(), b.Mass(), error, 1.0f);
                             a.Move(moved1);
                             b.Move(moved2);
                             return Length(error);
                         }));
    }
    EXPECT_LE(worst, 8);
}

TEST(JointError, DualAxisPartBringsThePointToTheLine) {
    RandomPoses random(2);
    int worst = 0;
    for (int i = 0; i < 200; ++i) {
        Body a = RandomPose(random), b = RandomPose(random);
        const Vector3 local1 = random.InBox(1.0f), local2 = random.InBox(1.0f);
        worst = std::max(worst, CountPasses([&] {
                             const Vector3 r2 = Rotate(b.rotation, local2),
                                           u = b.position + r2 - a.position - Rotate(a.rotation, local1);
                             const Vector3 n1 = Rotate(a.rotation, Vector3(1, 0, 0)),
                                           n2 = Rotate(a.rotation, Vector3(0, 1, 0));
                             const Vec2<float> error(Dot(u, n1), Dot(u, n2));
                             DualAxisPart<float> part;
                             Twist<float> moved1, moved2;
                             part.CalculateProperties(a.Mass(), b.Mass(), {b.position + r2 - a.position, r2, n1, n2});
                             part.SolvePosition(moved1, moved2, a.Mass(), b.Mass(), error, 1.0f);
                             a.Move(moved1);
                             b.Move(moved2);
                             return LengthOf(error);
                         }));
    }
    EXPECT_LE(worst, 8);
}

// Both bodies free, or one of them immovable: then the way back is a turn about C itself and one pass is enough.
int RotationPasses(Body a, Body b, const Quaternion& inverseInitial) {
    return CountPasses([&] {
        const Vector3 error = RotationError<float>(a.rotation, b.rotation, inverseInitial);
        RotationEulerPart<float> part;
        Twist<float> moved1, moved2;
        part.CalculateProperties(a.Mass(), b.Mass());
        part.SolvePosition(moved1, moved2, a.Mass(), b.Mass(), error, 1.0f);
        a.Move(moved1);
        b.Move(moved2);
        return Length(error);
    });
}

TEST(JointError, RotationEulerPartTurnsBackFromAnyRotation) {
    RandomPoses random(3);
    int worst = 0, worstFixed = 0;
    for (int i = 0; i < 300; ++i) {
        const Body a = RandomPose(random), b = RandomPose(random);
        const Quaternion inverseInitial = AnyRotation(random);
        worst = std::max(worst, RotationPasses(a, b, inverseInitial));
        worstFixed = std::max(worstFixed, RotationPasses(Immovable(a), b, inverseInitial));
        worstFixed = std::max(worstFixed, RotationPasses(a, Immovable(b), inverseInitial));
    }
    EXPECT_LE(worst, 5);
    EXPECT_LE(worstFixed, 2);
}

TEST(JointError, RotationErrorIsTheRotationBackByTheShortWay) {
    RandomPoses random(4);
    for (int i = 0; i < 200; ++i) {
        const Quaternion q1 = AnyRotation(random), q0 = AnyRotation(random);
        const Vector3 axis = AnyDirection(random);
        // In degrees, 180 among them; beyond it the short way is the other way round.
        for (const float degrees : {0.001f, 1.0f, 90.0f, 179.0f, 180.0f, 181.0f, 270.0f, 359.0f}) {
            const float angle = degrees * kPi / 180.0f;
            const Quaternion q2 = RotationFromVector(Vector3(axis * angle)) * (q1 * q0);
            const Vector3 error = RotationError<float>(
                q1, q2, InverseInitialOrientation(q1.Conjugate(), Quaternion(q1 * q0).Conjugate()));
            // Half of it is the rounding of quaternions, a few 6e-8, whose angle is twice that.
            EXPECT_NEAR(Length(error), std::min(angle, 2.0f * kPi - angle), 2e-6f) << degrees;
            if (degrees != 180.0f) {
                const Vector3 expected = axis * (degrees < 180.0f ? angle : angle - 2.0f * kPi);
                EXPECT_LT(Length(Vector3(error - expected)), 5e-6f) << degrees;
            }
        }
    }
    // Exactly half a turn about each axis.
    for (const Quaternion& half : {Quaternion{1, 0, 0, 0}, Quaternion{0, 1, 0, 0}, Quaternion{0, 0, -1, -0.0f}})
        EXPECT_FLOAT_EQ(Length(RotationError<float>({}, half, {})), kPi);
}

TEST(JointError, InitialOrientationFromAxesMakesThemMeet) {
    RandomPoses random(5);
    for (int i = 0; i < 300; ++i) {
        // Frames of any orientation, those of half a turn among them, seen from both bodies.
        Quaternion frame1 = AnyRotation(random), frame2 = AnyRotation(random);
        if (i < 4) frame1 = {i == 0 ? 1.0f : 0.0f, i == 1 ? 1.0f : 0.0f, i == 2 ? 1.0f : 0.0f, i == 3 ? 1.0f : 0.0f};
        const Matrix3 m1 = ToMatrix(frame1), m2 = ToMatrix(frame2);
        const Quaternion expected = frame2 * frame1.Conjugate();
        const Quaternion xy = InverseInitialOrientation(RotationFromAxesXY(m1.x, m1.y), RotationFromAxesXY(m2.x, m2.y));
        const Quaternion xz = InverseInitialOrientation(RotationFromAxesXZ(m1.x, m1.z), RotationFromAxesXZ(m2.x, m2.z));
        const Quaternion q1 = AnyRotation(random), q2 = q1 * frame1 * frame2.Conjugate();
        for (const Quaternion& q : {xy, xz}) {
            EXPECT_NEAR(std::fabs(q.x * expected.x + q.y * expected.y + q.z * expected.z + q.w * expected.w), 1.0f,
                        1e-6f);
            // Bodies turned so that the frames meet have no error.
            EXPECT_LT(Length(RotationError<float>(q1, q2, q)), 3e-6f);
        }
        EXPECT_LT(Length(RotationError<float>(q1, q2, InverseInitialOrientation(q1.Conjugate(), q2.Conjugate()))),
                  1e-6f);
    }
    // A y axis that is not quite perpendicular is straightened; x stays.
    const Quaternion q = RotationFromAxesXY(Vector3(0, 1, 0), Normalized(Vector3(-1, 0.3f, 0)));
    EXPECT_LT(Length(Vector3(Rotate(q, Vector3(0, 1, 0)) - Vector3(-1, 0, 0))), 1e-6f);
}

struct HingePasses {
    int count;
    float misalignment;
};
HingePasses RunHinge(Body a, Body b) {
    const int count = CountPasses([&] {
        const Vector3 a1 = Rotate(a.rotation, Vector3(0, 0, 1));
        const Vector3 b2 = Rotate(b.rotation, Vector3(1, 0, 0)), c2 = Rotate(b.rotation, Vector3(0, 1, 0));
        const Vec2<float> error = HingeError<float>(a1, b2, c2);
        HingeRotationPart<float> part;
        Twist<float> moved1, moved2;
        part.CalculateProperties(a.Mass(), b.Mass(), b2, c2);
        part.SolvePosition(moved1, moved2, a.Mass(), b.Mass(), error, 1.0f);
        a.Move(moved1);
        b.Move(moved2);
        return LengthOf(error);
    });
    const Vector3 apart = Rotate(a.rotation, Vector3(0, 0, 1)) - Rotate(b.rotation, Vector3(0, 0, 1));
    return {count, Length(apart)};
}

TEST(JointError, HingeRotationPartAlignsTheAxesFromAnyAngle) {
    RandomPoses random(6);
    int worst = 0, worstOpposite = 0;
    for (int i = 0; i < 300; ++i) {
        const Body a = RandomPose(random), b = RandomPose(random);
        const HingePasses any = RunHinge(a, b);
        worst = std::max(worst, any.count);
        EXPECT_LT(any.misalignment, 3e-6f);
        // Exactly opposite, and a right angle apart.
        Body opposite = b, square = b;
        opposite.rotation =
            a.rotation * Quaternion{1, 0, 0, 0} * RotationFromVector(Vector3(0, 0, random.Between(-3, 3)));
        square.rotation = a.rotation * RotationFromVector(Vector3(0.5f * kPi, 0, 0));
        for (const Body& other : {opposite, square}) {
            const HingePasses passes = RunHinge(a, other);
            worstOpposite = std::max(worstOpposite, passes.count);
            EXPECT_LT(passes.misalignment, 3e-6f);
        }
    }
    EXPECT_LE(worst, 5);
    EXPECT_LE(worstOpposite, 5);
}

TEST(JointError, HingeErrorIsTheAngleBetweenTheAxes) {
    RandomPoses random(7);
    for (int i = 0; i < 200; ++i) {
        const Matrix3 frame2 = ToMatrix(AnyRotation(random));
        const Vector3 way = AnyDirection(random);
        const Vector3 across = Normalized(Vector3(way - frame2.z * Dot(way, frame2.z)));
        for (const float angle : {1e-6f, 0.01f, 1.0f, 0.5f * kPi, 3.0f, kPi}) {
            // a1 turned from a2 by the angle.
            const Vector3 a1 = frame2.z * Cos(angle) + across * Sin(angle);
            const Vec2<float> error = HingeError<float>(a1, frame2.x, frame2.y);
            EXPECT_NEAR(LengthOf(error), angle, 2e-6f);
        }
    }
    EXPECT_EQ(HingeError<float>(Vector3(0, 0, -1), Vector3(1, 0, 0), Vector3(0, 1, 0)), Vec2<float>(kPi, 0.0f));
    EXPECT_EQ(HingeError<float>(Vector3(0, 0, 1), Vector3(1, 0, 0), Vector3(0, 1, 0)), Vec2<float>(0.0f, 0.0f));
}

// The angle-scaled dot products change as J says: by w2 - w1 across a2, near alignment in any direction.
TEST(JointError, HingeJacobianIsTheDerivativeOfTheError) {
    RandomPoses random(8);
    for (int i = 0; i < 100; ++i) {
        const Body a = RandomPose(random), b{Vector3::Zero(), a.rotation, 1.0f, Vector3(1, 1, 1)};
        const Twist<float> v1{Vector3::Zero(), random.InBox(1e-3f)}, v2{Vector3::Zero(), random.InBox(1e-3f)};
        const Matrix3 m = ToMatrix(b.rotation);
        HingeRotationPart<float> part;
        part.CalculateProperties(a.Mass(), b.Mass(), m.x, m.y);
        Body turned1 = a, turned2 = b;
        turned1.Move(v1);
        turned2.Move(v2);
        const Matrix3 m2 = ToMatrix(turned2.rotation);
        const Vec2<float> error = HingeError<float>(Rotate(turned1.rotation, Vector3(0, 0, 1)), m2.x, m2.y);
        // Second order: a product of two turns of up to 2e-3.
        EXPECT_LT(LengthOf(error - part.RelativeMotion(v1, v2)), 5e-6f);
    }
}

// A pivot that vanishes: bodies that can turn about one axis only, or two, in any direction of the world.
TEST(SymmetricInverse, ActsWhereSomethingCanMove) {
    RandomPoses random(9);
    for (int i = 0; i < 300; ++i) {
        const Matrix3 axes = ToMatrix(AnyRotation(random));
        const float a = random.Between(0.1f, 5.0f), b = i % 2 ? random.Between(0.1f, 5.0f) : 0.0f;
        const SymmetricMatrix3 k = RotatedDiagonal(axes, Vector3(a, b, 0.0f));
        const SymmetricMatrix3 inverse = SymmetricInverse(k);
        const float x = random.Between(-1, 1), y = b > 0.0f ? random.Between(-1, 1) : 0.0f;
        const Vector3 possible = axes.x * x + axes.y * y;
        const Vector3 wanted = k * possible, reached = k * (inverse * wanted);
        // Rounding of 6e-8, times a condition of up to 50, times as much again where the first two rows are nearly
        // alike.
        EXPECT_LT(Length(Vector3(reached - wanted)), 1e-3f * Length(wanted)) << i;
    }
    const SymmetricMatrix3 none = SymmetricInverse(SymmetricMatrix3());
    EXPECT_EQ(none.xx + none.yy + none.zz + none.xy + none.xz + none.yz, 0.0f);
}

// Eigenvalues 1, 1 and 20000: an anchor one meter beside a thin axle. 6e-8 times the condition, some ten times over.
TEST(SymmetricInverse, KeepsItsDigitsBesideAThinAxle) {
    RandomPoses random(10);
    for (int i = 0; i < 300; ++i) {
        const SymmetricMatrix3 k = RotatedDiagonal(ToMatrix(AnyRotation(random)), Vector3(1.0f, 20000.0f, 1.0f));
        const Eigen::MatrixXd expected = testing::ToDense(k).inverse();
        EXPECT_LT((testing::ToDense(SymmetricInverse(k)) - expected).norm(), 0.01 * expected.norm());
    }
}

// A gear train whose caller counts turns, 100000 of them: the phase stays, whatever the velocities round to.
TEST(GearPart, KeepsItsPhaseOverManyTurns) {
    InverseMass<float> m1, m2;
    m1.inertia.zz = 0.7f;
    m2.inertia.zz = 2.3f;
    const Vector3 axis(0, 0, 1);
    const float ratio = 2.5f, h = 1.0f / 240.0f;
    Twist<float> v1, v2;
    double angle1 = 0.0, angle2 = 0.0;
    v1.angular.z() = 600.0f;
    testing::OneRowPart<float> gear;
    gear.SetJacobian(GearJacobian<float>(axis, axis, ratio));
    double worst = 0.0;
    while (angle1 < 2.0 * 3.14159265358979 * 100000.0) {
        const float error = static_cast<float>(angle1 + static_cast<double>(ratio) * angle2);
        gear.CalculateProperties(m1, m2);
        gear.SetBias(0.2f / h * error, {});
        v2.angular.z() += 0.01f;  // something pulls
        v1.angular.z() += 0.02f * (500.0f - v1.angular.z());
        gear.SolveVelocity(v1, v2, m1, m2);
        angle1 += static_cast<double>(v1.angular.z() * h);
        angle2 += static_cast<double>(v2.angular.z() * h);
        worst = std::max(worst, std::fabs(angle1 + static_cast<double>(ratio) * angle2));
    }
    // One step's rounding of 500 rad/s (3e-5) for 1 / 240 s, divided by the share of 0.2 that is fed back, a few times
    // over.
    EXPECT_LT(worst, 1e-5);
}

// A rope that pulls 2 kg up by 5 kg over a tackle of ratio 2, from rest: with T the rope's pull, a1 = T / m1 - g,
// a2 = 2 T / m2 - g and a1 + 2 a2 = 0, so T = 3 g / (1 / m1 + 4 / m2). Slack, it does nothing.
TEST(IndependentAxisPart, RopePullsAndNeverPushes) {
    const float g = 9.81f, h = 0.01f;
    InverseMass<float> m1, m2;
    m1.mass = Vector3::Constant(1.0f / 2.0f);
    m2.mass = Vector3::Constant(1.0f / 5.0f);
    const Vector3 down(0, -1, 0), none = Vector3::Zero();
    const IndependentAxisFrame<float> frame{none, none, down, down * 2.0f};
    Twist<float> v1{Vector3(0, -g * h, 0), none}, v2 = v1;
    RowPart<float> part;
    part.SetJacobian(IndependentAxisJacobian<float>(frame));
    part.CalculateProperties(m1, m2);
    part.SetBias(0.0f);
    EXPECT_TRUE(part.SolveVelocity(v1, v2, -1e30f, 0.0f));
    const float tension = 3.0f * g / (1.0f / 2.0f + 4.0f / 5.0f);
    EXPECT_NEAR(part.GetTotalLambda(), -tension * h, 1e-6f);
    EXPECT_NEAR(v1.linear.y(), (tension / 2.0f - g) * h, 1e-6f);
    EXPECT_NEAR(v2.linear.y(), (2.0f * tension / 5.0f - g) * h, 1e-6f);

    part.SetTotalLambda(0.0f);
    v1.linear = v2.linear = Vector3(0, 1, 0);
    EXPECT_FALSE(part.SolveVelocity(v1, v2, -1e30f, 0.0f));
    EXPECT_EQ(v1.linear.y(), 1.0f);
}

// A pinion of radius 0.1 m turns 10 rad per meter of rack: m v = -lambda ratio and I w = lambda, from w = 5 and v = 0.
TEST(RackAndPinionPart, RackTakesTheSpeedOfTheTeeth) {
    InverseMass<float> pinion, rack;
    pinion.inertia.zz = 1.0f / 0.02f;
    rack.mass = Vector3::Constant(1.0f / 3.0f);
    Twist<float> v1, v2;
    v1.angular = Vector3(0, 0, 5);
    testing::OneRowPart<float> part;
    const Vector3 none = Vector3::Zero();
    part.SetJacobian(RackAndPinionJacobian<float>({none, none, Vector3(0, 0, 1), Vector3(1, 0, 0), 10.0f}));
    part.CalculateProperties(pinion, rack);
    part.SetBias(0.0f, {});
    part.SolveVelocity(v1, v2, pinion, rack);
    // Energy's generalized mass: I + m / ratio^2 = 0.02 + 0.03.
    EXPECT_NEAR(v1.angular.z(), 5.0f * 0.02f / 0.05f, 1e-5f);
    EXPECT_NEAR(v2.linear.x(), 0.2f, 1e-6f);
}

}  // namespace
}  // namespace fulcrum
