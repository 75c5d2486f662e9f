// Vectors beside those of Eigen: the same results, and conversions both ways.
#include <Fulcrum/Math/Vector.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <sstream>

namespace fulcrum {
namespace {

TEST(Vector, ConvertsFromEigensExpressions) {
    const Eigen::Vector3f e(1, -2, 3);
    const Vector3 copied = e;
    EXPECT_EQ(copied, Vector3(1, -2, 3));
    const Vector3 summed = e + Eigen::Vector3f(1, 1, 1);
    EXPECT_EQ(summed, Vector3(2, -1, 4));
    const Vector3 turned = Eigen::Matrix3f(2 * Eigen::Matrix3f::Identity()) * e;
    EXPECT_EQ(turned, Vector3(2, -4, 6));
    Position assigned;
    assigned = e.cast<double>();
    EXPECT_EQ(assigned, Position(1, -2, 3));
    const auto length = [](const Vector3& v) { return Length(v); };
    EXPECT_FLOAT_EQ(length(e), std::sqrt(14.0f));
}

TEST(Vector, ConvertsToEigensVectors) {
    const Vector3 v(1, -2, 3);
    const Eigen::Vector3f copied = v;
    EXPECT_EQ(copied, Eigen::Vector3f(1, -2, 3));
    Eigen::Vector3d assigned;
    assigned = Position(4, 5, 6);
    EXPECT_EQ(assigned, Eigen::Vector3d(4, 5, 6));
    const auto sum = [](const Eigen::Vector3f& e) { return e.sum(); };
    EXPECT_EQ(sum(v), 2);
    EXPECT_EQ(Eigen::Map<const Eigen::Vector3f>(v.data()), copied);
}

// To the bit: the order of sums is part of the engine's results.
TEST(Vector, ComputesWhatEigenDoes) {
    const Eigen::Vector3f a(0.1f, -2.7f, 1e3f), b(-3.3f, 1e-4f, 7.1f);
    const Vector3 u = a, v = b;
    EXPECT_EQ(u + v, Vector3(a + b));
    EXPECT_EQ(u - v, Vector3(a - b));
    EXPECT_EQ(-u, Vector3(-a));
    EXPECT_EQ(u * 1.7f, Vector3(a * 1.7f));
    EXPECT_EQ(1.7f * u, Vector3(1.7f * a));
    EXPECT_EQ(u / 1.7f, Vector3(a / 1.7f));
    EXPECT_EQ(u.cwiseAbs(), Vector3(a.cwiseAbs()));
    EXPECT_EQ(u.cwiseProduct(v), Vector3(a.cwiseProduct(b)));
    EXPECT_EQ(u.cwiseQuotient(v), Vector3(a.cwiseQuotient(b)));
    EXPECT_EQ(u.cwiseMin(v), Vector3(a.cwiseMin(b)));
    EXPECT_EQ(u.cwiseMax(v), Vector3(a.cwiseMax(b)));
    EXPECT_EQ(u.minCoeff(), a.minCoeff());
    EXPECT_EQ(u.maxCoeff(), a.maxCoeff());
    EXPECT_EQ(u.sum(), a.x() + (a.y() + a.z()));  // not Eigen's order, which on ARM begins with x + y
    EXPECT_FLOAT_EQ(u.sum(), a.sum());
    EXPECT_EQ(u.cross(v), Vector3(a.cross(b)));
    EXPECT_EQ(u.cast<double>(), Position(a.cast<double>()));
    EXPECT_EQ(Vector3::Unit(1), Vector3::UnitY());
    EXPECT_EQ(u.isZero(1e3f), true);
    EXPECT_EQ(u.isZero(999.0f), false);
}

TEST(Vector, KeepsCoordinatesBesideThoseThatAreNotNumbers) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(Vector3(1, 2, 3).cwiseMin(Vector3(nan, 1, nan)), Vector3(1, 1, 3));
    EXPECT_EQ(Vector3(1, 2, 3).cwiseMax(Vector3(nan, 5, nan)), Vector3(1, 5, 3));
    EXPECT_FALSE(Vector3(nan, 0, 0).isZero(1));
    EXPECT_FALSE(Vector3(nan, 0, 0).isAtMost(Vector3(1, 1, 1)));
}

TEST(Vector, IsWrittenWithSpaces) {
    std::ostringstream text;
    text << Vector3(1, -2.5f, 3) << '|';
    EXPECT_EQ(text.str(), "1 -2.5 3|");
}

}  // namespace
}  // namespace fulcrum
