// Swing and twist: the decomposition, and limits as distances on the sphere against dense samples of their edges, as
// continuous functions through 180 degrees and against their derivatives.
#include "AllLimits.h"
#include "RandomBodies.h"

#include <Fulcrum/Constraints/Parts/SwingTwist.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

using testing::AnyDirection;
using testing::AnyRotation;
using testing::CollectLimits;
using testing::RandomPoses;

constexpr float kPi = 3.14159265f;
constexpr double kPiDouble = 3.14159265358979324;
constexpr float kDegree = kPi / 180.0f;

// The rotation of frame B in frame A: twist first.
Quaternion Swung(float y, float z, float twist) {
    return RotationFromVector(Vector3(0, y, z)) * RotationFromVector(Vector3(twist, 0, 0));
}
float Alike(const Quaternion& a, const Quaternion& b) {
    return std::fabs(a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w);
}
AngleRange Degrees(float minimum, float maximum) { return {minimum * kDegree, maximum * kDegree}; }
SwingTwistLimits Swing(const AngleRange& y, const AngleRange& z, SwingShape shape) {
    SwingTwistLimits limits;
    limits.swingY = y;
    limits.swingZ = z;
    limits.shape = shape;
    return limits;
}
// Half of the angles are of more than a right angle or of less than a degree.
float HalfAngle(RandomPoses& random) {
    const float kind = random.Between(0.0f, 1.0f);
    return kDegree * (kind < 0.15f  ? random.Between(0.2f, 1.0f)
                      : kind < 0.5f ? random.Between(90.0f, 179.0f)
                                    : random.Between(1.0f, 90.0f));
}
SwingTwistLimits RandomSwing(RandomPoses& random, SwingShape shape) {
    const float y = HalfAngle(random), z = HalfAngle(random);
    if (shape == SwingShape::Ellipse) return Swing({-y, y}, {-z, z}, shape);
    const float y2 = HalfAngle(random), z2 = HalfAngle(random);
    return Swing({-y2, y}, {-z2, z}, shape);
}
float Least(const RotationLimitList& list) {
    float least = 1e30f;
    for (const RotationLimit& limit : list) least = std::min(least, limit.error);
    return least;
}

TEST(SwingTwist, DecompositionIsUndoneByItsProduct) {
    RandomPoses random(1);
    for (int i = 0; i < 500; ++i) {
        const float alpha = i % 5 == 0 ? kPi : random.Between(0.0f, kPi), psi = random.Between(-kPi, kPi);
        const float y = alpha * Cos(psi), z = alpha * Sin(psi), twist = random.Between(-kPi, kPi);
        const Quaternion q = Swung(y, z, twist);
        for (const Quaternion& same : {q, Quaternion{-q.x, -q.y, -q.z, -q.w}}) {
            const SwingTwist r = Decompose(same);
            // The angle of a quaternion rounded to 6e-8 is off by some 3e-7.
            EXPECT_NEAR(r.alpha, alpha, 2e-6f);
            EXPECT_GT(Alike(Swung(r.SwingY(), r.SwingZ(), r.twist), q), 1.0f - 1e-6f);
            EXPECT_LT(Length(Vector3(r.direction - Rotate(q, Vector3(1, 0, 0)))), 1e-6f);
            if (alpha < 3.1f) {
                // Twist is worth 1 / cos(alpha / 2) = 50 times the rounding there, phi's direction as much.
                EXPECT_NEAR(r.SwingY(), y, 3e-5f);
                EXPECT_NEAR(r.SwingZ(), z, 3e-5f);
                EXPECT_NEAR(r.twist, twist, 2e-5f);
            }
        }
    }
}

TEST(SwingTwist, DecompositionAtZeroAndHalfATurn) {
    const SwingTwist none = Decompose(Quaternion{});
    EXPECT_EQ(none.alpha, 0.0f);
    EXPECT_EQ(none.twist, 0.0f);
    const SwingTwist twist = Decompose(Quaternion{1, 0, 0, 0});
    EXPECT_EQ(twist.alpha, 0.0f);
    EXPECT_FLOAT_EQ(std::fabs(twist.twist), kPi);
    const SwingTwist swing = Decompose(Quaternion{0, 0.6f, 0.8f, 0});
    EXPECT_FLOAT_EQ(swing.alpha, kPi);
    EXPECT_EQ(swing.twist, 0.0f);
    EXPECT_FLOAT_EQ(swing.e1, 0.6f);
    EXPECT_FLOAT_EQ(swing.e2, 0.8f);
}

// Edges in double. t runs once round in 0..1.
Position DirectionOf(double alpha, double e1, double e2) {
    return Position(std::cos(alpha), std::sin(alpha) * e2, -std::sin(alpha) * e1);
}
Position EdgeAt(const SwingTwistLimits& limits, double t) {
    const auto number = [](float x) { return static_cast<double>(x); };
    if (limits.shape == SwingShape::Ellipse) {
        const double angle = 2.0 * kPiDouble * t;
        const double y = number(limits.swingY.maximum) * std::cos(angle),
                     z = number(limits.swingZ.maximum) * std::sin(angle);
        const double alpha = std::sqrt(y * y + z * z);
        return DirectionOf(alpha, y / alpha, z / alpha);
    }
    // Along a side both half angles are linear in the parameter.
    const double side = std::floor(4.0 * t), share = 4.0 * t - side;
    const auto between = [&](const AngleRange& range) {
        return std::tan(0.5 * (number(range.minimum) + share * number(range.maximum - range.minimum)));
    };
    double y = 0, z = 0;
    if (side < 2.0) {
        y = std::tan(0.5 * number(side < 1.0 ? limits.swingY.maximum : limits.swingY.minimum));
        z = between(limits.swingZ);
    } else {
        y = between(limits.swingY);
        z = std::tan(0.5 * number(side < 3.0 ? limits.swingZ.maximum : limits.swingZ.minimum));
    }
    const double tangent = std::sqrt(y * y + z * z);
    return tangent > 0.0 ? DirectionOf(2.0 * std::atan(tangent), y / tangent, z / tangent) : Position(1, 0, 0);
}
double DistanceToEdge(const SwingTwistLimits& limits, const Position& d) {
    const auto distance = [&](double t) {
        const Position at = EdgeAt(limits, t);
        return std::atan2(at.cross(d).norm(), at.dot(d));
    };
    double least = 10.0;
    for (int quarter = 0; quarter < 4; ++quarter) {
        constexpr int kSamples = 500;
        const double start = 0.25 * quarter, end = start + 0.25 - 1e-12, step = (end - start) / kSamples;
        double best = start;
        for (int i = 1; i <= kSamples; ++i)
            if (distance(start + i * step) < distance(best)) best = start + i * step;
        double low = std::max(best - step, start), high = std::min(best + step, end);
        for (int i = 0; i < 60; ++i) {  // the distance has one minimum between
            const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
            if (distance(a) < distance(b)) high = b;
            else low = a;
        }
        least = std::min(least, std::min(distance(best), distance(0.5 * (low + high))));
    }
    return least;
}
// Positive inside, of any size.
double InsideBy(const SwingTwistLimits& limits, double y, double z) {
    const auto number = [](float x) { return static_cast<double>(x); };
    if (limits.shape == SwingShape::Ellipse) {
        const double a = y / number(limits.swingY.maximum), b = z / number(limits.swingZ.maximum);
        return 1.0 - std::sqrt(a * a + b * b);
    }
    const double alpha = std::sqrt(y * y + z * z), scale = alpha > 0.0 ? std::tan(0.5 * alpha) / alpha : 0.5;
    const double ay = 2.0 * std::atan(y * scale), az = 2.0 * std::atan(z * scale);
    return std::min(std::min(number(limits.swingY.maximum) - ay, ay - number(limits.swingY.minimum)),
                    std::min(number(limits.swingZ.maximum) - az, az - number(limits.swingZ.minimum)));
}

void ExpectDistances(SwingShape shape, uint32_t seed) {
    RandomPoses random(seed);
    for (int i = 0; i < 600; ++i) {
        const SwingTwistLimits limits = RandomSwing(random, shape);
        const float alpha = i % 8 == 0 ? kPi : random.Between(0.0f, kPi), psi = random.Between(-kPi, kPi);
        const double y = static_cast<double>(alpha * Cos(psi)), z = static_cast<double>(alpha * Sin(psi));
        const Quaternion q = Swung(static_cast<float>(y), static_cast<float>(z), random.Between(-3.0f, 3.0f));
        const Position d =
            DirectionOf(std::sqrt(y * y + z * z), y / std::sqrt(y * y + z * z), z / std::sqrt(y * y + z * z));
        const double distance = DistanceToEdge(limits, d);
        const float error = Least(CollectLimits(q, limits));
        // Rounding of directions and angles of up to pi, a few 2e-7.
        EXPECT_NEAR(std::fabs(static_cast<double>(error)), distance, 3e-6)
            << i << " ranges " << limits.swingY.minimum / kDegree << ".." << limits.swingY.maximum / kDegree << ", "
            << limits.swingZ.minimum / kDegree << ".." << limits.swingZ.maximum / kDegree << " at " << y / kDegree
            << " " << z / kDegree;
        if (distance > 1e-5) {
            EXPECT_EQ(error > 0.0f, InsideBy(limits, y, z) > 0.0) << i;
        }
    }
}
TEST(SwingLimit, EllipseIsTheDistanceToItsEdge) { ExpectDistances(SwingShape::Ellipse, 2); }
TEST(SwingLimit, PyramidIsTheDistanceToItsEdge) { ExpectDistances(SwingShape::Pyramid, 3); }

TEST(SwingLimit, ConeIsTheAngleBetweenTheAxes) {
    RandomPoses random(4);
    for (int i = 0; i < 500; ++i) {
        const Quaternion q = AnyRotation(random);
        const float angle = Acos(Rotate(q, Vector3(1, 0, 0)).x()), cone = random.Between(0.0f, kPi);
        const RotationLimit limit = ConeLimit(Decompose(q), cone);
        // Acos near 0 and pi is worth the square root of 1e-7.
        EXPECT_NEAR(limit.error, cone - angle, 6e-4f);
        const RotationLimit ellipse = EllipseLimit(Decompose(q), cone, cone);
        EXPECT_EQ(ellipse.error, limit.error);
    }
    EXPECT_FLOAT_EQ(ConeLimit(Decompose(Quaternion{0, 0, 1, 0}), 1.0f).error, 1.0f - kPi);
    EXPECT_EQ(ConeLimit(Decompose(Quaternion{}), 0.0f).error, 0.0f);
}

// C is a distance: it changes by no more than d moves, anywhere, at the far end of the sphere too.
TEST(SwingLimit, ErrorsAreContinuousThroughHalfATurn) {
    RandomPoses random(5);
    for (int i = 0; i < 200; ++i) {
        const SwingTwistLimits limits = RandomSwing(random, i % 2 ? SwingShape::Ellipse : SwingShape::Pyramid);
        // Round a great circle, of which every second one passes through the opposite of x.
        const float psi = random.Between(-kPi, kPi);
        Vector3 axis = i % 4 < 2 ? Vector3(0, Cos(psi), Sin(psi)) : AnyDirection(random);
        const float step = 2.0f * kPi / 1024.0f;
        const Quaternion start = i % 4 < 2 ? Quaternion{} : AnyRotation(random);
        float before = 0.0f;
        for (int k = 0; k <= 1024; ++k) {
            const Quaternion q = RotationFromVector(Vector3(axis * (step * static_cast<float>(k)))) * start;
            const float error = Least(CollectLimits(q, limits));
            if (k > 0) {
                EXPECT_LT(std::fabs(error - before), step + 5e-6f) << i << " " << k;
            }
            before = error;
        }
    }
}

// By central differences: a step of 0.005 leaves 1e-7 / 0.005 of rounding, and step^2 / 6 times a third derivative of
// up to 1 / distance^2. Where the nearest point changes sides C has a kink, which the two halves of the difference
// show.
TEST(SwingLimit, AxesAreTheGradientsOfTheErrors) {
    RandomPoses random(6);
    int checked = 0, kinks = 0;
    for (int i = 0; i < 4000; ++i) {
        SwingTwistLimits limits = RandomSwing(random, i % 2 ? SwingShape::Ellipse : SwingShape::Pyramid);
        if (i % 7 == 0) limits.swingY = {};
        if (i % 7 == 1) limits.swingZ = {};
        if (i % 7 == 2) limits.swingY = {0, 0};
        if (i % 7 == 3) limits.swingZ = {0, 0};
        const Quaternion q = AnyRotation(random);
        if (i % 7 < 4 && std::fabs(Rotate(q, Vector3(1, 0, 0)).x()) < 0.2f) continue;  // latitudes are poles there
        const Vector3 turn = AnyDirection(random) * 0.005f;
        const RotationLimitList here = CollectLimits(q, limits);
        const RotationLimitList on = CollectLimits(RotationFromVector(turn) * q, limits);
        const RotationLimitList back = CollectLimits(RotationFromVector(Vector3(-turn)) * q, limits);
        if (on.count != here.count || back.count != here.count) continue;
        for (int k = 0; k < here.count; ++k) {
            const RotationLimit& limit = here.limits[k];
            EXPECT_NEAR(Length(limit.axis), 1.0f, 1e-5f);
            // In slots that others' axes scale (longitude) only the angle's own change counts: to first order of C.
            const bool isScaled = (i % 7 == 2 && limit.slot >= RotationLimit::SwingZMaximum) ||
                                  (i % 7 == 3 && limit.slot < RotationLimit::SwingZMaximum && !limit.isLocked);
            if (isScaled || std::fabs(limit.error) < 0.1f) continue;
            const float forth = on.limits[k].error - limit.error, up = limit.error - back.limits[k].error;
            if (std::fabs(forth - up) > 1e-3f) {
                ++kinks;
                continue;
            }
            EXPECT_NEAR(0.5f * (forth + up), Dot(limit.axis, turn), 5e-5f) << i << " " << k << " C " << limit.error;
            ++checked;
        }
    }
    EXPECT_GT(checked, 4000);
    EXPECT_LT(kinks, checked / 20);
}

// The great circle to the nearest point of the edge, from any depth: a turn by -C leads there.
TEST(SwingLimit, TheAxisLeadsToTheEdge) {
    RandomPoses random(7);
    for (int i = 0; i < 2000; ++i) {
        const SwingShape shape = i % 2 ? SwingShape::Ellipse : SwingShape::Pyramid;
        const SwingTwistLimits limits = RandomSwing(random, shape);
        const Quaternion q = AnyRotation(random);
        const RotationLimitList list = CollectLimits(q, limits);
        const RotationLimit* worst =
            std::min_element(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.error < b.error; });
        if (worst->error >= 0.0f) continue;
        const Quaternion there = RotationFromVector(Vector3(worst->axis * -worst->error)) * q;
        // The tips of thin ellipses bend within 1e-5 rad; elsewhere it is a few 1e-6.
        EXPECT_NEAR(Least(CollectLimits(Normalized(there), limits)), 0.0f, 1e-4f)
            << i << " C " << worst->error / kDegree << " " << limits.swingY.maximum / kDegree << " "
            << limits.swingZ.maximum / kDegree;
    }
}

TEST(SwingLimit, PyramidMayBeLopsidedAndShowsAllItsFaces) {
    const SwingTwistLimits limits = Swing({-0.5f, 1.5f}, {-0.7f, 0.7f}, SwingShape::Pyramid);
    const auto errorOf = [](const RotationLimitList& list, RotationLimit::Slot slot) {
        for (const RotationLimit& limit : list)
            if (limit.slot == slot) return limit.error;
        return 1e30f;
    };
    const RotationLimitList straight = CollectLimits(Quaternion{}, limits);
    EXPECT_EQ(straight.count, 4);
    EXPECT_NEAR(errorOf(straight, RotationLimit::SwingYMaximum), 1.5f, 1e-6f);
    EXPECT_NEAR(errorOf(straight, RotationLimit::SwingYMinimum), 0.5f, 1e-6f);
    EXPECT_NEAR(errorOf(straight, RotationLimit::SwingZMaximum), 0.7f, 1e-6f);
    const RotationLimitList low = CollectLimits(Swung(-0.55f, 0, 0), limits),
                            high = CollectLimits(Swung(1.55f, 0, 0), limits);
    EXPECT_NEAR(errorOf(low, RotationLimit::SwingYMinimum), -0.05f, 1e-6f);
    EXPECT_LT(Length(Vector3(low.limits[0].axis - Vector3(0, 1, 0))), 1e-6f);
    EXPECT_NEAR(errorOf(high, RotationLimit::SwingYMaximum), -0.05f, 1e-6f);
    EXPECT_LT(Length(Vector3(high.limits[0].axis - Vector3(0, -1, 0))), 1e-6f);
    EXPECT_EQ(high.count, 4);  // a little outside the other faces stay
    // From deep outside there is one way.
    EXPECT_EQ(CollectLimits(Swung(-2.0f, 0, 0), limits).count, 1);
}

TEST(SwingLimit, LockedAndFreeAxes) {
    const AngleRange locked{0, 0}, free;
    const auto list = [&](const Quaternion& q, const AngleRange& y, const AngleRange& z) {
        return CollectLimits(q, Swing(y, z, SwingShape::Ellipse));
    };
    RandomPoses random(8);
    for (int i = 0; i < 200; ++i) {
        const Quaternion q = i % 3 == 0 ? Swung(kPi * Cos(float(i)), kPi * Sin(float(i)), 1.0f) : AnyRotation(random);
        const Vector3 d = Rotate(q, Vector3(1, 0, 0));
        EXPECT_EQ(list(q, free, free).count, 0);
        // Both locked: turned by -C along both axes, x is where it was, from any angle.
        const RotationLimitList both = list(q, locked, locked);
        ASSERT_EQ(both.count, 2);
        EXPECT_TRUE(both.limits[0].isLocked && both.limits[1].isLocked);
        EXPECT_NEAR(Dot(both.limits[0].axis, both.limits[1].axis), 0.0f, 1e-6f);
        const Vector3 way = both.limits[0].axis * -both.limits[0].error - both.limits[1].axis * both.limits[1].error;
        EXPECT_LT(Length(Vector3(Rotate(RotationFromVector(way), d) - Vector3(1, 0, 0))), 3e-6f);
        // One locked: d stays on a great circle; one free and one limited: in a band about it, whatever the other does.
        const RotationLimitList plane = list(q, locked, free), band = list(q, {-0.5f, 0.6f}, free);
        ASSERT_EQ(plane.count, 1);
        EXPECT_NEAR(plane.limits[0].error, Asin(-d.z()), 6e-4f);
        ASSERT_EQ(band.count, 2);
        EXPECT_NEAR(band.limits[0].error, 0.6f - Asin(-d.z()), 6e-4f);
        EXPECT_NEAR(band.limits[1].error, Asin(-d.z()) + 0.5f, 6e-4f);
        const RotationLimitList flat = list(q, free, locked);
        EXPECT_NEAR(flat.limits[0].error, Asin(d.y()), 6e-4f);
        EXPECT_EQ(list(q, free, {-0.5f, 1.6f}).count, 1);  // beyond a right angle there is nothing
    }
    // One locked, one limited: z in -20..100 degrees, by either way round.
    for (const float z : {-170.0f, -30.0f, 0.0f, 90.0f, 130.0f, 180.0f}) {
        const RotationLimitList arc = list(Swung(0, z * kDegree, 0.3f), locked, Degrees(-20, 100));
        ASSERT_EQ(arc.count, 3);
        EXPECT_NEAR(arc.limits[0].error, 0.0f, 1e-6f);
        const float expected = z < -140.0f ? -90.0f : std::min(100.0f - z, z + 20.0f);
        EXPECT_NEAR(std::min(arc.limits[1].error, arc.limits[2].error) / kDegree, expected, 1e-4f) << z;
        for (const RotationLimit& limit : arc) EXPECT_NEAR(Length(limit.axis), 1.0f, 1e-6f);
    }
}

TEST(TwistLimit, CountsByTheNearerWay) {
    // The least of the errors, in degrees.
    const auto twist = [](float minimum, float maximum, float angle) {
        SwingTwistLimits limits;
        limits.twist = Degrees(minimum, maximum);
        return Least(CollectLimits(Swung(0, 0, angle * kDegree), limits)) / kDegree;
    };
    const float rounding = 1e-4f;
    EXPECT_NEAR(twist(-30, 60, 50), 10.0f, rounding);
    EXPECT_NEAR(twist(-30, 60, -10), 20.0f, rounding);
    EXPECT_NEAR(twist(-30, 60, 70), -10.0f, rounding);
    EXPECT_NEAR(twist(-30, 60, -50), -20.0f, rounding);
    EXPECT_NEAR(twist(0, 90, -170), -100.0f, rounding);  // beyond 180 from above
    EXPECT_NEAR(twist(0, 90, -130), -130.0f, rounding);
    EXPECT_NEAR(twist(-175, 175, 179), -4.0f, rounding);
    EXPECT_NEAR(twist(-175, 175, 174), 1.0f, rounding);
    EXPECT_GT(twist(-180, 180, 180), 1e20f);  // free: no row
    EXPECT_NEAR(twist(0, 0, 25), 25.0f, rounding);
    EXPECT_NEAR(std::fabs(twist(0, 0, 180)), 180.0f, rounding);
    EXPECT_NEAR(twist(170, 170, -170), 20.0f, rounding);  // locked across 180
    EXPECT_NEAR(twist(180, 180, -179), 1.0f, rounding);
}

// dtau/dt = t . w / cos(alpha / 2), by central differences; a third derivative of up to 1 / cos^3.
TEST(TwistLimit, AxisIsTheGradientOfTheTwist) {
    RandomPoses random(9);
    for (int i = 0; i < 1000; ++i) {
        const float alpha = random.Between(0.0f, 2.6f), psi = random.Between(-kPi, kPi);
        const Quaternion q = Swung(alpha * Cos(psi), alpha * Sin(psi), random.Between(-3.0f, 3.0f));
        const Vector3 turn = AnyDirection(random) * 2e-3f;
        const SwingTwist r = Decompose(q);
        const float change = 0.5f * (Decompose(RotationFromVector(turn) * q).twist -
                                     Decompose(RotationFromVector(Vector3(-turn)) * q).twist);
        EXPECT_NEAR(Length(TwistAxis(r)), 1.0f, 1e-6f);
        EXPECT_NEAR(change * r.swing.w, Dot(TwistAxis(r), turn), 2e-6f) << alpha;
        // The range's errors are this angle, scaled.
        SwingTwistLimits limits;
        limits.twist = {-1.0f, 2.0f};
        const RotationLimitList list = CollectLimits(q, limits);
        ASSERT_EQ(list.count, 2);
        if (r.twist > -2.5f) {
            EXPECT_NEAR(list.limits[0].error, r.swing.w * (2.0f - r.twist), 1e-6f);
        }
        EXPECT_NEAR(list.limits[0].error + list.limits[1].error, r.swing.w * 3.0f, 2e-6f);
        EXPECT_EQ(list.limits[0].axis, -list.limits[1].axis);
    }
}

TEST(SwingLimit, NothingIsNotANumberAtAwkwardPoses) {
    const float half = Sqrt(0.5f);
    const Quaternion poses[] = {
        {0, 0, 0, 1},       {0, 0, 0, -1},      {1, 0, 0, 0},           {0, 1, 0, 0},
        {0, 0, 1, 0},       {0, half, half, 0}, {0, -half, half, 0},    {half, 0, half, 0},
        {half, half, 0, 0}, {0, half, 0, half}, {0, 0, half, half},     {0, 1, 0, 1e-20f},
        {0, 0, -1, 1e-8f},  {1e-30f, 0, 0, 1},  {0, 1e-30f, 1e-25f, 1}, {0.5f, 0.5f, 0.5f, 0.5f}};
    const float angles[] = {0.0f, 0.1f, 1.0f, 90.0f, 179.0f, 179.9f, 180.0f};
    for (const Quaternion& pose : poses)
        for (const float y : angles)
            for (const float z : angles)
                for (const SwingShape shape : {SwingShape::Ellipse, SwingShape::Pyramid}) {
                    SwingTwistLimits limits = Swing(Degrees(-y, y), Degrees(-z, z), shape);
                    limits.twist = Degrees(-y, z);
                    for (const RotationLimit& limit : CollectLimits(pose, limits)) {
                        EXPECT_TRUE(std::isfinite(limit.error));
                        EXPECT_NEAR(Length(limit.axis), 1.0f, 1e-4f)
                            << y << " " << z << " slot " << int(limit.slot) << " " << pose.y << " " << pose.z;
                    }
                }
}

}  // namespace
}  // namespace fulcrum
