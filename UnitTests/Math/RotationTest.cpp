// Quaternion, Matrix and Pose.
#include <Fulcrum/Math/Pose.h>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace fulcrum {
namespace {

// Values of order 1 through a handful of float operations.
constexpr float kTolerance = 2e-6f;

void ExpectNear(const Vector3& a, const Vector3& b, float tolerance = kTolerance) {
    EXPECT_LE(Length(a - b), tolerance) << a << " against " << b;
}

// A quarter turn about an axis, exact but for the root of a half.
Quaternion QuarterTurn(const Vector3& axis) {
    const float s = std::sqrt(0.5f);
    return {axis.x() * s, axis.y() * s, axis.z() * s, s};
}

// A rotation of no special direction.
Quaternion Skew() { return Normalized(Quaternion{0.1f, -0.5f, 0.3f, 0.7f}); }
Quaternion OtherSkew() { return Normalized(Quaternion{-0.6f, 0.2f, 0.4f, -0.3f}); }

TEST(Quaternion, TurnsByTheRightHandRule) {
    ExpectNear(Rotate(QuarterTurn(Vector3::UnitZ()), Vector3(1, 0, 0)), Vector3(0, 1, 0));
    ExpectNear(Rotate(QuarterTurn(Vector3::UnitX()), Vector3(0, 1, 0)), Vector3(0, 0, 1));
    ExpectNear(Rotate(QuarterTurn(Vector3::UnitY()), Vector3(0, 0, 1)), Vector3(1, 0, 0));
    EXPECT_EQ(Rotate(Quaternion{}, Vector3(1, 2, 3)), Vector3(1, 2, 3));
}

TEST(Quaternion, ProductIsTheRightFactorFirst) {
    const Quaternion x = QuarterTurn(Vector3::UnitX()), z = QuarterTurn(Vector3::UnitZ());
    ExpectNear(Rotate(x * z, Vector3(1, 0, 0)), Vector3(0, 0, 1));
    const Vector3 v(1, -2, 3);
    ExpectNear(Rotate(Skew() * OtherSkew(), v), Rotate(Skew(), Rotate(OtherSkew(), v)), 4 * kTolerance);
}

TEST(Quaternion, InverseUndoes) {
    const Vector3 v(1, -2, 3);
    ExpectNear(InverseRotate(Skew(), Rotate(Skew(), v)), v, 4 * kTolerance);
    const Quaternion one = Skew() * Skew().Conjugate();
    ExpectNear(one.Imaginary(), Vector3(0, 0, 0));
    EXPECT_NEAR(one.w, 1.0f, kTolerance);
}

TEST(Quaternion, KnowsWhatIsFinite) {
    EXPECT_TRUE(IsFinite(Quaternion{}));
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(IsFinite(Quaternion{nan, 0, 0, 1}));
    EXPECT_FALSE(IsFinite(Quaternion{0, nan, 0, 1}));
    EXPECT_FALSE(IsFinite(Quaternion{0, 0, nan, 1}));
    EXPECT_FALSE(IsFinite(Quaternion{0, 0, 0, nan}));
}

TEST(Matrix, OfAQuaternionRotatesLikeIt) {
    const Matrix3 m = ToMatrix(Skew());
    const Vector3 v(1, -2, 3);
    ExpectNear(m * v, Rotate(Skew(), v), 4 * kTolerance);
    ExpectNear(m.TransposeMultiply(m * v), v, 4 * kTolerance);
    ExpectNear(Cross<float>(m.x, m.y), m.z);
}

TEST(Matrix, TransposeTimesMatrixIsTheRelativeRotation) {
    const Matrix3 relative = TransposeMultiply(ToMatrix(Skew()), ToMatrix(OtherSkew()));
    const Matrix3 expected = ToMatrix(Skew().Conjugate() * OtherSkew());
    ExpectNear(relative.x, expected.x);
    ExpectNear(relative.y, expected.y);
    ExpectNear(relative.z, expected.z);
}

TEST(Matrix, RotatedDiagonalHasItsPrincipalAxes) {
    const Matrix3 r = ToMatrix(Skew());
    const SymmetricMatrix3 inertia = RotatedDiagonal(r, Vector3(1, 2, 3));
    ExpectNear(inertia * r.x, r.x * 1.0f, 4 * kTolerance);
    ExpectNear(inertia * r.y, r.y * 2.0f, 4 * kTolerance);
    ExpectNear(inertia * r.z, r.z * 3.0f, 4 * kTolerance);
}

TEST(Pose, TransformsThereAndBackFarFromTheOrigin) {
    const Pose pose{Position(1e10, -2e10, 3.5e9), Skew()};
    const Vector3 local(0.25f, -1.5f, 2.0f);
    const Position world = pose.Transform(local);
    // A double at 2e10 m has steps of 4e-6 m.
    ExpectNear(pose.InverseTransform(world), local, 2e-5f);
}

TEST(Pose, RelativePosesCompose) {
    const Pose a{Position(1e6, 2, 3), Skew()}, b{Position(1e6 + 1, 4, 1), OtherSkew()};
    const RelativePose aToB = Relative(a, b);
    const Vector3 inB(0.5f, 1.0f, -1.0f);
    ExpectNear(aToB.Transform(inB), a.InverseTransform(b.Transform(inB)), 4 * kTolerance);
    const Pose composed = a * aToB;
    EXPECT_LE((composed.position - b.position).norm(), 4e-6);
    ExpectNear(Rotate(composed.rotation, inB), Rotate(b.rotation, inB), 4 * kTolerance);
    const RelativePose identity = aToB * Inverse(aToB);
    ExpectNear(identity.Transform(inB), inB, 8 * kTolerance);
    ExpectNear(aToB.InverseTransform(aToB.Transform(inB)), inB, 4 * kTolerance);
}

}  // namespace
}  // namespace fulcrum
