// Every pair function against libccd on random poses: all pairs of types, 10^4 poses each (3000 of two round shapes and
// 300 of those with a curved core: there libccd builds polytopes of hundreds of facets, up to a millisecond each).
#include "NarrowPhaseTesting.h"

#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fulcrum::testing {
namespace {

int PosesFor(const ConvexShape& a, const ConvexShape& b) {
    const auto isRound = [](const ConvexShape& s) {
        return s.Type() == ShapeType::Sphere || s.Type() == ShapeType::Capsule;
    };
    if (std::max(a.Type(), b.Type()) > ShapeType::Triangle) return Cases(300);
    return Cases(isRound(a) && isRound(b) ? 3000 : 10000);
}

// A face contact may be taken in place of an axis that is better by at most this much: 2 % of the speculative distance.
constexpr double kPreference = 0.02 * 0.02;
// float positions of about 2 m, a few operations each.
constexpr double kRounding = 5e-6;

const std::vector<NamedShape>& Shapes() {
    static const std::vector<NamedShape> shapes = {
        {"sphere", MakeSphere(0.5f)},
        {"box", MakeBox(Vector3(0.5f, 0.4f, 0.7f))},
        {"capsule", MakeCapsule(0.5f, 0.25f)},
        {"hull", MakeRoundHull(32, 0.6f)},
        {"triangle",
         Triangle::Create(Vector3(-0.6f, 0, -0.5f), Vector3(0.7f, 0.1f, -0.4f), Vector3(0, 0, 0.8f)).Value()},
        {"drop", TaperedCapsule::Create(0.5f, 0.2f, 0.4f).Value()},
        {"cylinder", Cylinder::Create(0.5f, 0.4f).Value()},
        {"puck", Cylinder::Create(0.2f, 0.6f, 0.05f).Value()},
        {"frustum", Cylinder::CreateTapered(0.4f, 0.2f, 0.5f).Value()},
        {"cone", Cylinder::CreateCone(0.5f, 0.4f).Value()},
        {"ellipsoid", MakeEllipsoid(Vector3(0.3f, 0.5f, 0.7f))}};
    return shapes;
}

// Apart within and beyond the speculative distance, touching, shallow, deep, concentric; a third of them with parallel
// faces.
RelativePose RandomPose(const ConvexShape& a, const ConvexShape& b, int i, RandomPoses& random) {
    RelativePose pose;
    const bool parallel = i % 3 == 0;
    pose.rotation = parallel ? random.QuarterTurns() : random.Rotation();
    Vector3 direction = random.Direction();
    if (parallel && i % 2 == 0) {
        direction = Vector3::Zero();
        direction[i / 6 % 3] = 1;
        direction = Normalized(direction + 0.3f * random.InCube().cwiseProduct(Vector3::Ones() - direction));
    }
    const double reach = -SeparationAlong(a, b, {Vector3::Zero(), pose.rotation}, direction);
    const float low[5] = {-0.02f, -0.1f, -0.3f, -1.0f, -10.0f}, high[5] = {0.03f, 0.03f, 0.0f, 0.0f, -9.0f};
    const int kind = std::min(4, static_cast<int>(i % 21 / 5));
    const float distance = static_cast<float>(reach) + random.Between(low[kind], high[kind]);
    pose.position = direction * std::max(0.0f, distance);
    return pose;
}

struct Comparison {
    int found = 0, libccdWrong = 0, missed = 0, notUnit = 0;
    double worseAxis = 0;    // libccd's normal separates better than ours, at most by
    double pointError = 0;   // the deepest point against the separation along the normal
    double libccdError = 0;  // libccd's depth against ours, where libccd's agrees with its own normal
};

Comparison Compare(const ConvexPtr& a, const ConvexPtr& b, uint32_t seed) {
    Comparison result;
    RandomPoses random(seed);
    const CollideSettings settings;
    for (int i = 0; i < PosesFor(*a, *b); ++i) {
        const RelativePose pose = RandomPose(*a, *b, i, random);
        const Manifold manifold = CollideCold(a, b, pose, settings);
        const LibccdResult libccd = LibccdPenetration(*a, *b, pose, settings.speculativeDistance, LibccdAlgorithm::Epa);
        if (manifold.pointCount > 0) {
            ++result.found;
            const double along = SeparationAlong(*a, *b, pose, manifold.normal);
            result.pointError = std::max(result.pointError, std::abs(DeepestSeparation(manifold) - along));
            if (!(std::abs(Length(manifold.normal) - 1) < 1e-5f)) ++result.notUnit;
        }
        if (libccd.status != LibccdResult::Status::Found) continue;
        const double measured = SeparationAlong(*a, *b, pose, libccd.normal.cast<float>());
        const bool consistent = std::abs(measured - libccd.separation) < 1e-4;
        if (!consistent) ++result.libccdWrong;
        if (manifold.pointCount == 0) {
            if (consistent && libccd.separation < settings.speculativeDistance - kPreference) ++result.missed;
            continue;
        }
        const double ours = SeparationAlong(*a, *b, pose, manifold.normal);
        result.worseAxis = std::max(result.worseAxis, measured - ours);
        if (consistent) result.libccdError = std::max(result.libccdError, std::abs(libccd.separation - ours));
    }
    return result;
}

class PairFunctions : public ::testing::TestWithParam<std::pair<int, int>> {};

TEST_P(PairFunctions, FindAnAxisAsGoodAsLibccds) {
    const NamedShape &a = Shapes()[static_cast<size_t>(GetParam().first)],
                     &b = Shapes()[static_cast<size_t>(GetParam().second)];
    const int poses = PosesFor(*a.shape, *b.shape);
    const Comparison c = Compare(a.shape, b.shape, 17);
    std::printf(
        "  %-8s %-8s %d of %d touch; axis worse than libccd's by at most %.1e m, points off their axis %.1e m, "
        "libccd off by %.1e m, contradicting itself in %d\n",
        a.name.c_str(), b.name.c_str(), c.found, poses, c.worseAxis, c.pointError, c.libccdError, c.libccdWrong);
    EXPECT_GE(c.found, kIsSanitized ? 1 : poses / 5 + 1);  // a tenth of the cases has no exact shares
    EXPECT_EQ(c.missed, 0);
    EXPECT_EQ(c.notUnit, 0);
    // No axis separates better than the best, so one that is at least as good as libccd's is the best one or libccd is
    // wrong.
    EXPECT_LE(c.worseAxis, kPreference + kRounding);
    // The clipped feature may miss the depth along the normal by the preference, and the choice of points that depth
    // again.
    EXPECT_LE(c.pointError, 2 * kPreference + kRounding);
    // libccd stops within about 1e-4 of the size of the shapes.
    EXPECT_LE(c.libccdError, kPreference + 3e-4);
}

INSTANTIATE_TEST_SUITE_P(AllTypes, PairFunctions, ::testing::ValuesIn([] {
                             std::vector<std::pair<int, int>> pairs;
                             for (int i = 0; i < static_cast<int>(Shapes().size()); ++i)
                                 for (int k = 0; k <= i; ++k) pairs.push_back({i, k});
                             return pairs;
                         }()));

// Deep inside each other, curved cores have whole rings of axes that are nearly as good; the polytope has facets of a
// tenth of a radian there, which miss the depth by half a per cent before they are polished and pick any axis of the
// ring.
double CurvedError(const NamedShape& a, const NamedShape& b, float separation) {
    return std::max(a.shape->Type(), b.shape->Type()) > ShapeType::Triangle ? 0.006 * std::max(0.0f, -separation) : 0;
}

// How far x lies outside the shape (inside: negative). Of a hull, the farthest plane: less than the distance near an
// edge.
double SignedDistance(const ConvexShape& shape, const Vector3& x) {
    switch (shape.Type()) {
        case ShapeType::Sphere: return Length(x) - shape.ConvexRadius();
        case ShapeType::Capsule: {
            const float half = static_cast<const Capsule&>(shape).HalfHeight();
            // A point cut off the middle of a slanting capsule lies one radius along the normal from its axis, a little
            // inside.
            return std::max(0.0f,
                            Length(Vector3(x - Vector3(0, std::clamp(x.y(), -half, half), 0))) - shape.ConvexRadius());
        }
        case ShapeType::Box: return (x.cwiseAbs() - static_cast<const Box&>(shape).HalfExtents()).maxCoeff();
        case ShapeType::Triangle: {
            const auto& triangle = static_cast<const Triangle&>(shape);
            double most = std::abs(Dot(triangle.Normal(), x));
            for (int i = 0; i < 3; ++i) {
                const Vector3 from = triangle.Corner(i), to = triangle.Corner((i + 1) % 3);
                const Vector3 outwards = Normalized(Cross<float>(Vector3(to - from), triangle.Normal()));
                most = std::max(most, static_cast<double>(Dot(outwards, Vector3(x - from))));
            }
            return most;
        }
        case ShapeType::TaperedCapsule: {  // the union of the balls between its ends
            const auto& drop = static_cast<const TaperedCapsule&>(shape);
            double least = 1e30;
            for (int i = 0; i <= 10000; ++i) {
                const double t = i * 1e-4, y = (2 * t - 1) * drop.HalfHeight() - drop.Mass().centerOfMass.y();
                const double radius = drop.BottomRadius() + t * (drop.TopRadius() - drop.BottomRadius());
                least = std::min(least, Length(Vector3(x - Vector3(0, static_cast<float>(y), 0))) - radius);
            }
            return least;
        }
        case ShapeType::Cylinder: {
            const auto& c = static_cast<const Cylinder&>(shape);
            const double y = x.y() + c.Mass().centerOfMass.y(), h = c.HalfHeight();
            const double slope = (c.TopRadius() - c.BottomRadius()) / (2 * h), length = std::sqrt(1 + slope * slope);
            const double side =
                std::sqrt(x.x() * x.x() + x.z() * x.z()) - (c.TopRadius() + c.BottomRadius()) / 2 - slope * y;
            const double sharp = std::max(std::abs(y) - h, side / length);
            // Rims are rounded within: there the surface lies below the planes by at most (sqrt(2) - 1) of the
            // rounding.
            return c.ConvexRadius() > 0 && sharp < 0 ? std::min(0.0, sharp + 0.4143 * c.ConvexRadius()) : sharp;
        }
        case ShapeType::Custom: {
            const Vector3 scaled = x.cwiseQuotient(static_cast<const Ellipsoid&>(shape).Radii());
            const Vector3 gradient = scaled.cwiseQuotient(static_cast<const Ellipsoid&>(shape).Radii());
            return (Dot(scaled, scaled) - 1) / (2 * Length(gradient));
        }
        default: {
            double most = -1e30;
            for (const ConvexHull::Face& face : static_cast<const ConvexHull&>(shape).Faces())
                most = std::max(most, static_cast<double>(Dot(face.normal, x) - face.offset));
            return most;
        }
    }
}

TEST(PairFunctionsTest, PointsLieOnBothSurfaces) {
    RandomPoses random(5);
    for (const NamedShape& a : Shapes()) {
        for (const NamedShape& b : Shapes()) {
            double worst = 0;
            for (int i = 0; i < Cases(2000); ++i) {
                const RelativePose pose = RandomPose(*a.shape, *b.shape, i, random);
                const Manifold manifold = CollideCold(a.shape, b.shape, pose);
                if (DeepestSeparation(manifold) < -0.15f)
                    continue;  // deep inside, a clipped point may leave the other face
                for (int k = 0; k < manifold.pointCount; ++k) {
                    const ManifoldPoint& point = manifold.points[k];
                    const Vector3 onB = point.positionOnA + manifold.normal * point.separation;
                    worst = std::max({worst, std::abs(SignedDistance(*a.shape, point.positionOnA)),
                                      std::abs(SignedDistance(*b.shape, pose.InverseTransform(onB)))});
                    EXPECT_LE(point.separation, CollideSettings{}.speculativeDistance);
                }
            }
            // Clipping keeps what lies outside the sides of a face by no more than the preference, and edges may pass
            // each other by as much.
            EXPECT_LE(worst, 2 * kPreference + kRounding) << a.name << " " << b.name;
        }
    }
}

TEST(PairFunctionsTest, MirroredPairsGiveMirroredManifolds) {
    RandomPoses random(11);
    for (const NamedShape& a : Shapes()) {
        for (const NamedShape& b : Shapes()) {
            if (a.shape->Type() == b.shape->Type()) continue;  // either may provide the reference face
            for (int i = 0; i < Cases(500); ++i) {
                const RelativePose pose = RandomPose(*a.shape, *b.shape, i, random);
                const RelativePose inverse = Inverse(pose);
                const Manifold there = CollideCold(a.shape, b.shape, pose),
                               back = CollideCold(b.shape, a.shape, inverse);
                // Where b is placed by `inverse` twice rounded, features at the edge of a tolerance may differ.
                if (there.pointCount != back.pointCount) continue;
                if (there.pointCount == 0) continue;
                const float depth = DeepestSeparation(there);
                EXPECT_NEAR(depth, DeepestSeparation(back), kPreference + kRounding + CurvedError(a, b, depth));
                const Vector3 normal = -Rotate(pose.rotation, back.normal);
                if (Dot(normal, there.normal) < 0.9999f) continue;  // two equally good axes
                for (int k = 0; k < back.pointCount; ++k) {
                    const ManifoldPoint& point = back.points[k];
                    const Vector3 onA = pose.Transform(point.positionOnA + back.normal * point.separation);
                    float nearest = 1;
                    for (int m = 0; m < there.pointCount; ++m)
                        nearest = std::min(nearest, Length(Vector3(there.points[m].positionOnA - onA)));
                    EXPECT_LE(nearest, 2e-3 + CurvedError(a, b, depth)) << a.name << " " << b.name << " " << i;
                }
            }
        }
    }
}

TEST(PairFunctionsTest, TheLibccdMethodServesEveryPair) {
    RandomPoses random(3);
    const CollideSettings settings{.method = NarrowPhaseMethod::Libccd};
    for (const NamedShape& a : Shapes()) {
        for (const NamedShape& b : Shapes()) {
            int found = 0, wrong = 0;
            // Shares need some cases, under the sanitizers, too.
            const int poses = !kIsSanitized && PosesFor(*a.shape, *b.shape) > 300 ? 300 : 60;
            for (int i = 0; i < poses; ++i) {
                const RelativePose pose = RandomPose(*a.shape, *b.shape, i, random);
                const Manifold manifold = CollideCold(a.shape, b.shape, pose, settings);
                const Manifold expected = CollideCold(a.shape, b.shape, pose);
                if (manifold.pointCount == 0) continue;
                ++found;
                EXPECT_TRUE(IsFinite(manifold.normal));
                EXPECT_NEAR(Length(manifold.normal), 1.0f, 1e-5f);
                // 1 % of the depth or 5e-5 of the size, 1 m; and each may prefer a face.
                const double depth = DeepestSeparation(expected);
                const double tolerance = std::max(0.01 * std::abs(depth), 5e-5) + 2 * kPreference;
                if (!(std::abs(DeepestSeparation(manifold) - depth) <= tolerance)) ++wrong;
            }
            EXPECT_GT(found, poses / 6);
            EXPECT_EQ(wrong, 0) << a.name << " " << b.name;
        }
    }
}

TEST(PairFunctionsTest, CachedAndUncachedQueriesAgree) {
    RandomPoses random(23);
    for (const NamedShape& a : Shapes()) {
        for (const NamedShape& b : Shapes()) {
            for (int i = 0; i < Cases(1000); ++i) {
                RelativePose pose = RandomPose(*a.shape, *b.shape, i, random);
                PairCache cache;
                CollideOnce(a.shape, b.shape, pose, cache);
                pose.position += 0.01f * random.InCube();
                const Vector3 turn = 0.01f * random.InCube();
                pose.rotation = Normalized(Quaternion{turn.x(), turn.y(), turn.z(), 1} * pose.rotation);
                const Manifold warm = CollideOnce(a.shape, b.shape, pose, cache);
                const Manifold cold = CollideCold(a.shape, b.shape, pose);
                if (warm.pointCount == 0 || cold.pointCount == 0) {
                    // One sees the pair at the far end of the speculative distance.
                    const float separation = std::min(DeepestSeparation(warm), DeepestSeparation(cold));
                    EXPECT_GE(separation, 0.02f - 2 * kPreference) << a.name << " " << b.name << " " << i;
                    continue;
                }
                // Each may prefer a face, and the warm one its last feature, by the preference.
                const float depth = DeepestSeparation(warm);
                EXPECT_NEAR(depth, DeepestSeparation(cold), 2 * kPreference + kRounding + CurvedError(a, b, depth))
                    << a.name << " " << b.name << " " << i;
            }
        }
    }
}

}  // namespace
}  // namespace fulcrum::testing
