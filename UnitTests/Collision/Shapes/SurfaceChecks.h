// Compares the queries of a surface with brute force, exactly. Used by the tests of triangle meshes and height fields.
#pragma once

#include <Fulcrum/UnitTests/Collision/Shapes/SurfaceSamples.h>

#include <gtest/gtest.h>

namespace fulcrum {

inline std::vector<uint32_t> Found(const SurfaceShape& shape, const Bounds& box) {
    std::vector<uint32_t> ids;
    shape.VisitTriangles(box, [&](uint32_t id) { ids.push_back(id); });
    std::sort(ids.begin(), ids.end());
    return ids;
}

inline Bounds RandomBox(SurfaceRandom& random, const Bounds& within, float largest) {
    const Vector3 center = random.InBounds(within), half = random.InBox(largest).cwiseAbs();
    Bounds box;
    box.lower = center - half;
    box.upper = center + half;
    return box;
}

inline void ExpectExactBoxes(const SurfaceShape& shape, int count, float largest) {
    const std::vector<TriangleView> all = AllTriangles(shape);
    ASSERT_EQ(all.size(), shape.TriangleCount());
    SurfaceRandom random(7);
    size_t hits = 0;
    for (int i = 0; i < count; ++i) {
        Bounds box = RandomBox(random, shape.LocalBounds(), largest);
        if (i % 3 == 0)
            box.lower = box.upper = all[random.Below(static_cast<uint32_t>(all.size()))].vertices[i % 9 / 3];
        const std::vector<uint32_t> expected = BruteForceBox(all, box);
        ASSERT_EQ(Found(shape, box), expected) << i;
        hits += expected.size();
    }
    EXPECT_GT(hits, static_cast<size_t>(count) / 4);
}

// Triangles whose boxes are within a distance of a box that is near or far away: all of them, and none twice, nor any
// that is clearly farther away. With a distance that shrinks, the nearest is found.
inline void ExpectNearTriangles(const SurfaceShape& shape, int count, float largest) {
    std::vector<std::pair<uint32_t, Bounds>> boxes;
    for (const TriangleView& triangle : AllTriangles(shape)) {
        Bounds box;
        for (const Vector3& vertex : triangle.vertices) box.Include(vertex);
        boxes.emplace_back(triangle.id, box);
    }
    const auto distanceOf = [](const Bounds& a, const Bounds& b) {
        const Vector3 gap = Vector3(a.lower - b.upper).cwiseMax(Vector3(b.lower - a.upper)).cwiseMax(0.0f);
        return std::sqrt(Dot<double>(gap.cast<double>(), gap.cast<double>()));
    };
    SurfaceRandom random(13);
    Bounds around = shape.LocalBounds();
    const Vector3 margin = around.HalfExtents() + Vector3::Constant(largest);
    around.lower -= margin;
    around.upper += margin;
    size_t hits = 0;
    for (int i = 0; i < count; ++i) {
        const Bounds box = RandomBox(random, around, random.Chance(0.3f) ? 0 : largest);
        const float reach = random.Chance(0.2f) ? 0 : random.Between(0, 4 * largest);
        std::vector<uint32_t> found;
        shape.VisitTrianglesNear(box, reach, [&](uint32_t id) { found.push_back(id); });
        std::sort(found.begin(), found.end());
        ASSERT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << i;
        const double rounding = 1e-6 * (double{shape.OuterRadius()} + double{reach} + 10 * double{largest});
        double nearest = 1e30, nearestFound = 1e30;
        for (const auto& [id, bounds] : boxes) {
            const double distance = distanceOf(bounds, box);
            const bool isFound = std::binary_search(found.begin(), found.end(), id);
            ASSERT_TRUE(isFound || distance > double{reach}) << i << " " << distance << " of " << reach;
            ASSERT_TRUE(!isFound || distance <= double{reach} + rounding) << i << " " << distance << " of " << reach;
            nearest = std::min(nearest, distance);
        }
        hits += found.size();
        float shrinking = std::numeric_limits<float>::infinity();
        size_t visited = 0;
        shape.VisitTrianglesNear(box, shrinking, [&](uint32_t id) {
            const auto at = std::lower_bound(boxes.begin(), boxes.end(), id,
                                             [](const auto& entry, uint32_t which) { return entry.first < which; });
            nearestFound = std::min(nearestFound, distanceOf(at->second, box));
            shrinking = static_cast<float>(nearestFound);
            ++visited;
        });
        ASSERT_NEAR(nearestFound, nearest, rounding) << i;
        ASSERT_LT(visited, 40 + found.size() + boxes.size() / 4) << i;  // the rest is farther away
        float none = -1;
        shape.VisitTrianglesNear(box, none, [&](uint32_t) { FAIL() << i; });
    }
    EXPECT_GT(hits, static_cast<size_t>(count) / 4);
}

// From anywhere near the shape to anywhere; a third of them at a vertex or the middle of an edge, a third along an
// axis.
inline SurfaceRay RandomRay(SurfaceRandom& random, const SurfaceShape& shape, const std::vector<TriangleView>& all,
                            int i) {
    Bounds around = shape.LocalBounds();
    const Vector3 margin = around.HalfExtents() * 0.5f;
    around.lower -= margin;
    around.upper += margin;
    SurfaceRay ray{random.InBounds(around), Vector3::Zero(), i % 2 == 0};
    const TriangleView& t = all[random.Below(static_cast<uint32_t>(all.size()))];
    const uint32_t k = random.Below(3);
    const Vector3 target = i % 4 < 2 ? t.vertices[k] : Vector3((t.vertices[k] + t.vertices[(k + 1) % 3]) * 0.5f);
    if (i % 3 == 0) {
        ray.displacement = (target - ray.origin) * 1.5f;
    } else if (i % 3 == 1) {
        const int axis = i / 3 % 3;
        ray.origin[(axis + 1) % 3] = target[(axis + 1) % 3];
        if (i % 5 != 0) ray.origin[(axis + 2) % 3] = target[(axis + 2) % 3];
        ray.displacement[axis] = (target[axis] - ray.origin[axis]) * 2;
    } else {
        ray.displacement = random.InBounds(around) - ray.origin;
    }
    return ray;
}

inline void ExpectExactRays(const SurfaceShape& shape, int count) {
    const std::vector<TriangleView> all = AllTriangles(shape);
    SurfaceRandom random(11);
    int hits = 0;
    for (int i = 0; i < count; ++i) {
        const SurfaceRay ray = RandomRay(random, shape, all, i);
        if (ray.displacement.isZero(0)) continue;
        const std::vector<SurfaceHit> expected = BruteForceRay(all, ray, shape.IsTwoSided());
        const std::optional<SurfaceHit> closest = ClosestOf(expected);
        SurfaceHit hit;
        ASSERT_EQ(shape.CastRay(ray, hit), closest.has_value()) << i;
        ASSERT_EQ(shape.IsHit(ray), closest.has_value()) << i;
        std::vector<SurfaceHit> every;
        shape.CastRayAll(ray, [&](const SurfaceHit& h) {
            every.push_back(h);
            return true;
        });
        std::sort(every.begin(), every.end(), [](const auto& a, const auto& b) { return a.triangle < b.triangle; });
        ASSERT_EQ(every.size(), expected.size()) << i;
        for (size_t k = 0; k < every.size(); ++k) {
            ASSERT_EQ(every[k].triangle, expected[k].triangle);
            ASSERT_EQ(every[k].fraction, expected[k].fraction);
        }
        if (!closest) continue;
        ++hits;
        ASSERT_EQ(hit.fraction, closest->fraction) << i;
        ASSERT_EQ(hit.triangle, closest->triangle) << i;
        ASSERT_EQ(hit.normal, closest->normal) << i;
        ASSERT_EQ(hit.isBackFace, closest->isBackFace) << i;
    }
    EXPECT_GT(hits, count / 8);
}

}  // namespace fulcrum
