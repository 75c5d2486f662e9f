#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>

#include <Fulcrum/UnitTests/Collision/Shapes/PointSets.h>
#include <Fulcrum/UnitTests/Collision/Shapes/QhullVolume.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fulcrum {
namespace {

using test::kPi;

// Results are rounded from double to float once.
constexpr double kFloat = 1e-7;

void ExpectRelative(double actual, double expected, double tolerance) {
    EXPECT_NEAR(actual, expected, tolerance * std::fabs(expected));
}
void ExpectIdentity(const Quaternion& q) {
    EXPECT_EQ(q.x, 0);
    EXPECT_EQ(q.y, 0);
    EXPECT_EQ(q.z, 0);
    EXPECT_EQ(q.w, 1);
}
std::array<float, 3> Sorted(const Vector3& v) {
    std::array<float, 3> s{v.x(), v.y(), v.z()};
    std::sort(s.begin(), s.end());
    return s;
}
SymmetricMatrix3 TensorOf(const MassProperties& m) {
    return RotatedDiagonal(ToMatrix(m.principalAxes), m.principalInertia);
}

void ExpectSameTensor(const MassProperties& a, const MassProperties& b, float tolerance) {
    const SymmetricMatrix3 x = TensorOf(a), y = TensorOf(b);
    const float scale = tolerance * a.principalInertia.maxCoeff();
    EXPECT_NEAR(x.xx, y.xx, scale);
    EXPECT_NEAR(x.yy, y.yy, scale);
    EXPECT_NEAR(x.zz, y.zz, scale);
    EXPECT_NEAR(x.xy, y.xy, scale);
    EXPECT_NEAR(x.xz, y.xz, scale);
    EXPECT_NEAR(x.yz, y.yz, scale);
}

TEST(MassProperties, OfASphere) {
    const auto sphere = Sphere::Create(2).Value();
    ExpectRelative(sphere->Mass().volume, 4.0 / 3 * kPi * 8, kFloat);
    for (int i = 0; i < 3; ++i) ExpectRelative(sphere->Mass().principalInertia[i], 0.4 * 4.0 / 3 * kPi * 8 * 4, kFloat);
    ExpectIdentity(sphere->Mass().principalAxes);
}

TEST(MassProperties, OfABox) {
    const auto box = Box::Create(Vector3(1, 2, 3)).Value();
    ExpectRelative(box->Mass().volume, 48, kFloat);
    // m (b^2 + c^2) / 12 with full edges.
    ExpectRelative(box->Mass().principalInertia.x(), 48 * (16.0 + 36) / 12, kFloat);
    ExpectRelative(box->Mass().principalInertia.y(), 48 * (4.0 + 36) / 12, kFloat);
    ExpectRelative(box->Mass().principalInertia.z(), 48 * (4.0 + 16) / 12, kFloat);
    ExpectIdentity(box->Mass().principalAxes);
    const auto rounded = Box::Create(Vector3(1, 2, 3), 0.5f).Value();
    EXPECT_EQ(rounded->Mass().volume, box->Mass().volume);
}

TEST(MassProperties, OfACapsuleEqualTheIntegralOverDiscs) {
    const double h = 0.7, r = 0.4;
    const auto capsule = Capsule::Create(static_cast<float>(h), static_cast<float>(r)).Value();
    // Discs of radius s(y): dV = pi s^2 dy, dI_along = dV s^2 / 2, dI_across = dV (s^2 / 4 + y^2). The midpoint rule
    // over 20000 discs is off by O(step^2), about 1e-8.
    constexpr int kDiscs = 20000;
    const double top = h + r, step = 2 * top / kDiscs;
    double volume = 0, along = 0, across = 0;
    for (int i = 0; i < kDiscs; ++i) {
        const double y = -top + (i + 0.5) * step, beyond = std::max(std::fabs(y) - h, 0.0),
                     s2 = r * r - beyond * beyond;
        const double disc = kPi * s2 * step;
        volume += disc;
        along += disc * s2 / 2;
        across += disc * (s2 / 4 + y * y);
    }
    ExpectRelative(capsule->Mass().volume, volume, 3e-7);
    ExpectRelative(capsule->Mass().principalInertia.y(), along, 3e-7);
    ExpectRelative(capsule->Mass().principalInertia.x(), across, 3e-7);
    EXPECT_EQ(capsule->Mass().principalInertia.x(), capsule->Mass().principalInertia.z());
    ExpectIdentity(capsule->Mass().principalAxes);
}

TEST(MassProperties, OfAShortCapsuleApproachThoseOfASphere) {
    const auto capsule = Capsule::Create(1e-6f, 1).Value();
    const auto sphere = Sphere::Create(1).Value();
    ExpectRelative(capsule->Mass().principalInertia.x(), sphere->Mass().principalInertia.x(), 5e-6);
}

TEST(MassProperties, OfARegularTetrahedron) {
    const std::vector<Vector3> corners{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    const auto hull = ConvexHull::Create(corners).Value();
    // Edge a = 2 sqrt 2: V = a^3 / (6 sqrt 2) = 8/3, I = m a^2 / 20 about every axis.
    ExpectRelative(hull->Mass().volume, 8.0 / 3, kFloat);
    for (int i = 0; i < 3; ++i) ExpectRelative(hull->Mass().principalInertia[i], 8.0 / 3 * 8 / 20, 2 * kFloat);
    ExpectIdentity(hull->Mass().principalAxes);
    EXPECT_LT(Length(hull->Mass().centerOfMass), 1e-7f);
    // The insphere has radius a / (2 sqrt 6), the circumsphere three times that.
    ExpectRelative(hull->InnerRadius(), 1 / std::sqrt(3.0), 2 * kFloat);
    ExpectRelative(hull->OuterRadius(), std::sqrt(3.0), 2 * kFloat);
}

TEST(MassProperties, OfABoxAsAHullAreTheBoxes) {
    const Vector3 halfExtents(0.3f, 1.7f, 0.9f);
    const auto box = Box::Create(halfExtents).Value();
    const auto hull = ConvexHull::Create(test::BoxCorners(halfExtents)).Value();
    ExpectRelative(hull->Mass().volume, double{box->Mass().volume}, kFloat);
    for (int i = 0; i < 3; ++i)
        ExpectRelative(hull->Mass().principalInertia[i], double{box->Mass().principalInertia[i]}, 2 * kFloat);
    ExpectIdentity(hull->Mass().principalAxes);
    ExpectRelative(hull->InnerRadius(), double{box->InnerRadius()}, kFloat);
    ExpectRelative(hull->OuterRadius(), double{box->OuterRadius()}, kFloat);
}

TEST(MassProperties, OfATurnedAndMovedHullAreTheSameTurnedAndMoved) {
    for (int seed = 0; seed < 100; ++seed) {
        test::Random random(seed + 1000);
        const std::vector<Vector3> points = test::MakePointSet(test::PointSet::InBall, seed);
        const Quaternion turn = random.Rotation();
        const Vector3 shift = (random.InCube() * 10).cast<float>();
        std::vector<Vector3> moved;
        for (const Vector3& p : points) moved.push_back(Rotate(turn, p) + shift);
        const auto a = ConvexHull::Create(points), b = ConvexHull::Create(moved);
        if (!a || !b) continue;
        const MassProperties &m = a.Value()->Mass(), &n = b.Value()->Mass();
        // Coordinates of up to 11 m have a spacing of 1e-6 m, on bodies 0.1 m thick or more.
        ExpectRelative(n.volume, double{m.volume}, 1e-4);
        EXPECT_LT(Length(n.centerOfMass - (Rotate(turn, m.centerOfMass) + shift)), 1e-5f);
        const std::array<float, 3> x = Sorted(m.principalInertia), y = Sorted(n.principalInertia);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(x[i], y[i], 1e-4f * x[2]);
    }
}

TEST(MassProperties, OfTheThirtyTwoPointSphereOfTheHullPile) {
    const std::vector<Vector3> points = test::FibonacciSphere(32, 2);
    const auto hull = ConvexHull::Create(points).Value();
    EXPECT_EQ(hull->Vertices().size(), 32u);
    EXPECT_EQ(hull->Edges().size(), hull->Vertices().size() + hull->Faces().size() - 2);
    ExpectRelative(hull->Mass().volume, test::QhullSize(test::ToPositions(points))->volume, kFloat);
    EXPECT_LT(Length(hull->Mass().centerOfMass), 1e-3f);
    EXPECT_LE(hull->OuterRadius(), 2.001f);
}

TEST(MassProperties, OfTwoHalvesAreThoseOfTheWholeBox) {
    const auto half = Box::Create(Vector3(0.5f, 0.8f, 0.3f)).Value();
    const auto whole = Box::Create(Vector3(1, 0.8f, 0.3f)).Value();
    // Density is relative: two parts of 3 weigh as two of 1.
    const std::vector<Compound::ChildSettings> children{
        {.shape = half, .position = {4.5f, 1, -2}, .rotation = {}, .density = 3},
        {.shape = half, .position = {5.5f, 1, -2}, .rotation = {}, .density = 3}};
    const auto compound = Compound::Create(children).Value();
    ExpectRelative(compound->Mass().volume, double{whole->Mass().volume}, kFloat);
    ExpectSameTensor(compound->Mass(), whole->Mass(), 3e-7f);
    ExpectIdentity(compound->Mass().principalAxes);
    EXPECT_LT(Length(compound->Mass().centerOfMass - Vector3(5, 1, -2)), 1e-6f);
}

TEST(MassProperties, OfATurnedChildAreThoseOfItsHull) {
    test::Random random(5);
    const Vector3 halfExtents(0.5f, 0.8f, 0.3f);
    const auto box = Box::Create(halfExtents).Value();
    for (int i = 0; i < 50; ++i) {
        const Quaternion turn = random.Rotation();
        std::vector<Vector3> corners = test::BoxCorners(halfExtents);
        for (Vector3& c : corners) c = Rotate(turn, c) + Vector3(1, 2, 3);
        const std::vector<Compound::ChildSettings> children{{.shape = box, .position = {1, 2, 3}, .rotation = turn}};
        const auto compound = Compound::Create(children).Value();
        const auto hull = ConvexHull::Create(corners).Value();
        ExpectSameTensor(compound->Mass(), hull->Mass(), 4e-6f);
    }
}

TEST(MassProperties, HeavierChildDrawsTheCenter) {
    const auto sphere = Sphere::Create(1).Value();
    const std::vector<Compound::ChildSettings> children{
        {.shape = sphere, .position = {0, 0, 0}, .rotation = {}, .density = 3},
        {.shape = sphere, .position = {4, 0, 0}, .rotation = {}, .density = 1}};
    const auto compound = Compound::Create(children).Value();
    EXPECT_NEAR(compound->Mass().centerOfMass.x(), 1, 1e-6);
    // Mean density 1: masses 1.5 V and 0.5 V at 1 m and 3 m.
    const double volume = 4.0 / 3 * kPi;
    ExpectRelative(compound->Mass().principalInertia.y(), volume * (2 * 0.4 + 1.5 * 1 + 0.5 * 9), 3e-7);
    EXPECT_NEAR(compound->Children()[0].pose.position.x(), -1, 1e-6);
}

TEST(Diagonalized, RebuildsTheTensorFromProperRotations) {
    test::Random random(9);
    for (int i = 0; i < 1000; ++i) {
        const Position a = random.InCube(), b = random.InCube();
        Sym3<double> t;
        t.xx = 2 + a.x(), t.yy = 2 + a.y(), t.zz = 2 + a.z(), t.xy = b.x(), t.xz = b.y(), t.yz = b.z();
        const PrincipalAxes p = Diagonalized(t);
        EXPECT_NEAR(LengthSquared(p.rotation), 1, 3e-7);
        const Quat<double> q{p.rotation.x, p.rotation.y, p.rotation.z, p.rotation.w};
        const Sym3<double> back = RotatedDiagonal(ToMatrix(q), p.values);
        // The quaternion is rounded to float: 1e-7 of the tensor's size, 4.
        EXPECT_NEAR(back.xx, t.xx, 1e-6);
        EXPECT_NEAR(back.yy, t.yy, 1e-6);
        EXPECT_NEAR(back.zz, t.zz, 1e-6);
        EXPECT_NEAR(back.xy, t.xy, 1e-6);
        EXPECT_NEAR(back.xz, t.xz, 1e-6);
        EXPECT_NEAR(back.yz, t.yz, 1e-6);
    }
}

TEST(Diagonalized, KeepsTheAxesOfAnAlmostDiagonalTensor) {
    Sym3<double> t;
    t.xx = 3, t.yy = 1, t.zz = 1, t.xy = 1e-7, t.yz = -5e-7;
    const PrincipalAxes p = Diagonalized(t);
    ExpectIdentity(p.rotation);
    EXPECT_EQ(p.values, Position(3, 1, 1));
}

}  // namespace
}  // namespace fulcrum
