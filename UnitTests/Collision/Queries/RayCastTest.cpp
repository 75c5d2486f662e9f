// Rays against single shapes. A hit must lie on the surface, and no point of the ray before it in the shape, both
// checked by distances of points.
#include "QueryTesting.h"

#include <Fulcrum/Collision/Queries/ConvexDistance.h>
#include <Fulcrum/Collision/Queries/ConvexRay.h>
#include <Fulcrum/Collision/Queries/CoreShapes.h>
#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/UnitTests/Support/Cases.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

float DistanceOf(const ConvexShape& shape, const Vector3& point) {
    return MeasureConvex(shape, PointCore(), {point, {}}, 1e6f).separation;
}

// A ray that passes near the shape, from up to 3 m away.
Ray RayNear(RandomPoses& random) {
    const Vector3 target = random.InCube() * 0.8f, direction = random.Direction();
    const Vector3 from = direction * random.Between(0.1f, 3);
    return {from.cast<double>(), (target - from) * random.Between(0.5f, 2)};
}

TEST(RayCast, TheHitIsTheFirstPointOfTheShape) {
    RandomPoses random(5);
    int hits = 0, cases = 0;
    for (const NamedShape& named : QueryShapes()) {
        const ConvexShape& shape = *named.shape;
        for (int i = 0; i < Cases(15000); ++i, ++cases) {
            const Ray ray = RayNear(random);
            const Vector3 origin = ray.origin.cast<float>();
            RayHit hit;
            const bool found = CastRay(shape, ray, {}, hit);
            // Independent of the closed forms: GJK on the support function.
            const float length = Length(ray.displacement);
            const LineResult other = EnterBySupport(shape, {origin, ray.displacement / length, 0, length});
            const float least = DistanceOf(shape, origin);
            if (found != other.hit) {
                // They may differ where the ray grazes the surface, or ends or begins on it.
                float nearest = std::min(std::abs(least), std::abs(DistanceOf(shape, origin + ray.displacement)));
                for (int k = 0; k <= 400; ++k)
                    nearest =
                        std::min(nearest, std::abs(DistanceOf(shape, origin + ray.displacement * (float(k) / 400))));
                EXPECT_LT(nearest, 0.02f) << named.name << " " << i;
                continue;
            }
            if (!found) continue;
            ++hits;
            if (least < -1e-5f) {
                EXPECT_EQ(hit.fraction, 0) << named.name << " " << i;
                EXPECT_LT(Length(Vector3(hit.normal + ray.displacement / length)), 1e-6f);
                continue;
            }
            const Vector3 point = origin + ray.displacement * hit.fraction;
            // A rounding of coordinates of up to 3 m, 2.7e-7 m; in some three of a million cases the distance itself is
            // off by up to 8e-6 m. At a grazing angle the surface is as near over a longer way.
            EXPECT_LT(std::abs(DistanceOf(shape, point)), 1e-5f) << named.name << " " << i;
            const float slope = std::max(1e-3f, -Dot(hit.normal, ray.displacement) / length);
            EXPECT_NEAR(hit.fraction * length, other.entry.distance, 1e-6f / slope) << named.name << " " << i;
            if (hit.fraction > 0) {
                EXPECT_LE(Dot(hit.normal, ray.displacement), 0.0f);
                EXPECT_NEAR(Length(hit.normal), 1, 1e-5f);
                // A point beyond the surface along the normal is as far away: it is the normal there.
                EXPECT_NEAR(DistanceOf(shape, point + hit.normal * 0.01f), 0.01f, 1e-6f) << named.name << " " << i;
            }
        }
    }
    EXPECT_GE(cases, Cases(100000));
    EXPECT_GT(hits, cases / 4);
}

TEST(RayCast, ShapesKnownBySupportAreHitAsTheirFormulaSays) {
    RandomPoses random(6);
    const Vector3 radii(0.3f, 0.6f, 0.9f);
    const RoundedEllipsoid shape(radii);
    for (int i = 0; i < 100000; ++i) {
        const Ray ray = RayNear(random);
        const float length = Length(ray.displacement);
        const LineResult found =
            EnterBySupport(shape, {ray.origin.cast<float>(), ray.displacement / length, 0, length});
        const Position inverse = Position::Ones().cwiseQuotient(radii.cast<double>());
        const Position o = ray.origin.cwiseProduct(inverse), d = ray.displacement.cast<double>().cwiseProduct(inverse);
        const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - 1, root = b * b - a * c;
        const double entry = (-b - std::sqrt(std::max(root, 0.0))) / a;
        const bool isInside = c < 0, expected = isInside || (root >= 0 && entry >= 0 && entry <= 1);
        // Within 1e-5 of the surface either result is right.
        if (std::abs(root) < 1e-4 * a || std::abs(c) < 1e-4 || std::abs(entry - 1) < 1e-4) continue;
        ASSERT_EQ(found.hit, expected) << i;
        if (!expected) continue;
        EXPECT_EQ(found.startsInside, isInside) << i;
        // The tolerance in space is 1e-6 of the size; along the ray it is larger by the slope, sqrt(root) / a.
        if (!isInside) {
            EXPECT_NEAR(found.entry.distance, entry * double{length}, 2e-6 * a / std::sqrt(root) + 2e-6) << i;
        }
    }
}

TEST(RayCast, FarRaysHitAsNearOnesDo) {
    RandomPoses random(8);
    for (const NamedShape& named : QueryShapes()) {
        for (int i = 0; i < 2000; ++i) {
            const Vector3 target = random.InCube() * 0.3f, direction = random.Direction();
            RayHit near, far;
            const Ray short_{(target - direction * 4).cast<double>(), direction * 8};
            const Ray long_{target.cast<double>() - direction.cast<double>() * 5000, direction * 10000};
            const bool hit = CastRay(*named.shape, short_, {}, near);
            ASSERT_EQ(CastRay(*named.shape, long_, {}, far), hit) << named.name << i;
            // The fraction is a float: half a unit in its last place is 3e-4 m of 10 km. Its displacement's direction
            // has a rounding of 6e-8, which moves the ray sideways by as much as 3e-4 m.
            if (hit) {
                EXPECT_NEAR(far.fraction * 10000 - 4996, near.fraction * 8, 1e-2) << named.name;
            }
        }
    }
}

TEST(RayCast, StartsInsideSolidOrHollow) {
    for (const NamedShape& named : QueryShapes()) {
        const Ray ray{Position(0.001, 0.002, 0.003), Vector3(0, 0, 10)};
        RayHit hit;
        ASSERT_TRUE(CastRay(*named.shape, ray, {}, hit)) << named.name;
        EXPECT_EQ(hit.fraction, 0);
        EXPECT_EQ(hit.normal, Vector3(0, 0, -1));
        EXPECT_FALSE(CastRay(*named.shape, ray, {.hollow = true}, hit)) << named.name;
        ASSERT_TRUE(CastRay(*named.shape, ray, {.backFaces = true, .hollow = true}, hit)) << named.name;
        EXPECT_TRUE(hit.isBackFace);
        const Vector3 exit = (ray.origin + ray.displacement.cast<double>() * double{hit.fraction}).cast<float>();
        EXPECT_LT(std::abs(DistanceOf(*named.shape, exit)), 1e-5f) << named.name;
        EXPECT_LT(hit.normal.z(), 0);
    }
}

TEST(RayCast, DegenerateRaysHitNothing) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    RayHit hit;
    for (const NamedShape& named : QueryShapes()) {
        EXPECT_FALSE(CastRay(*named.shape, {Position::Zero(), Vector3::Zero()}, {}, hit));
        EXPECT_FALSE(CastRay(*named.shape, {Position::Zero(), Vector3(nan, 0, 0)}, {}, hit));
        EXPECT_FALSE(CastRay(*named.shape, {Position(0, double{nan}, 0), Vector3(1, 0, 0)}, {}, hit));
        EXPECT_FALSE(CastRay(*named.shape, {Position::Zero(), Vector3(infinity, 0, 0)}, {}, hit));
    }
}

TEST(RayCast, CompoundsAndSurfacesAreHitWhereTheirPartsAre) {
    RandomPoses random(9);
    const auto compound = MakeCompound(random, 40, 3);
    const auto terrain = MakeTerrain(12, 0.5f, [](float x, float z) { return 0.3f * std::sin(3 * x) + 0.2f * z; });
    int hits = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vector3 from = random.InCube() * 5;
        const Ray ray{from.cast<double>(), random.InCube() * 8};
        const Pose pose{Position(0.3, -0.2, 0.1), random.Rotation()};
        const RayCaster caster(ray);
        RayHit hit, best;
        bool any = false;
        for (uint32_t c = 0; c < compound->Children().size(); ++c) {
            const Compound::Child& child = compound->Children()[c];
            RayHit here;
            if (!caster.CastClosest(*child.shape, pose * child.pose, {}, here) ||
                (any && here.fraction >= best.fraction))
                continue;
            any = true;
            best = here;
            best.subShape.child = c;
        }
        ASSERT_EQ(caster.CastClosest(*compound, pose, {}, hit), any) << i;
        EXPECT_EQ(caster.IsHit(*compound, pose, {}), any);
        if (any) {
            ++hits;
            // Poses are combined in one order here, in another inside.
            EXPECT_NEAR(hit.fraction, best.fraction, 1e-6f);
            EXPECT_EQ(hit.subShape, best.subShape);
            EXPECT_LT(Length(Vector3(hit.normal - best.normal)), 1e-4f);
        }
        int all = 0, expected = 0;
        caster.CastAll(*compound, pose, {}, [&](const RayHit&) { return ++all, true; });
        for (const Compound::Child& child : compound->Children())
            expected += caster.IsHit(*child.shape, pose * child.pose, {});
        EXPECT_EQ(all, expected);

        SurfaceHit surfaceHit;
        const SurfaceRay local{pose.InverseTransform(ray.origin), InverseRotate(pose.rotation, ray.displacement)};
        const bool found = terrain->CastRay(local, surfaceHit, 1);
        ASSERT_EQ(caster.CastClosest(*terrain, pose, {}, hit), found);
        if (found) {
            EXPECT_EQ(hit.subShape.triangle, surfaceHit.triangle);
        }
        if (found) {
            EXPECT_NEAR(hit.fraction, surfaceHit.fraction, 1e-5f);
        }
    }
    EXPECT_GT(hits, 3000);
}

}  // namespace
}  // namespace fulcrum::testing
