// Meshes and brute-force queries for the tests of triangle meshes and height fields.
#pragma once

#include <Fulcrum/Collision/Shapes/RayTriangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace fulcrum {

struct IndexedTriangles {
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;

    TriangleMeshSettings Settings() const {
        TriangleMeshSettings settings;
        settings.vertices = vertices;
        settings.indices = indices;
        return settings;
    }
};

// (n + 1)^2 vertices on waves, two triangles a cell.
inline IndexedTriangles WavyTerrain(uint32_t n, float cell, float height) {
    IndexedTriangles mesh;
    for (uint32_t z = 0; z <= n; ++z) {
        for (uint32_t x = 0; x <= n; ++x) {
            const double u = 50.0 * x / n, v = 50.0 * z / n, half = 0.5 * n;
            mesh.vertices.push_back(Vector3(static_cast<float>((x - half) * double{cell}),
                                            static_cast<float>(5 + double{height} * std::sin(u) * std::cos(v)),
                                            static_cast<float>((z - half) * double{cell})));
        }
    }
    for (uint32_t z = 0; z < n; ++z) {
        for (uint32_t x = 0; x < n; ++x) {
            const uint32_t a = z * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
            mesh.indices.insert(mesh.indices.end(), {a, c, b, b, c, d});
        }
    }
    return mesh;
}

// Rings of quads between two poles, fronts outwards.
inline IndexedTriangles BallOf(uint32_t rings, uint32_t sectors, float radius) {
    IndexedTriangles mesh;
    mesh.vertices.push_back(Vector3(0, radius, 0));
    for (uint32_t i = 1; i < rings; ++i) {
        for (uint32_t k = 0; k < sectors; ++k) {
            const double a = M_PI * i / rings, b = 2 * M_PI * k / sectors;
            mesh.vertices.push_back(Vector3(
                Position(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)).cast<float>() * radius));
        }
    }
    const uint32_t last = static_cast<uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(Vector3(0, -radius, 0));
    const auto at = [&](uint32_t i, uint32_t k) { return 1 + (i - 1) * sectors + k % sectors; };
    for (uint32_t k = 0; k < sectors; ++k) {
        mesh.indices.insert(mesh.indices.end(), {0u, at(1, k + 1), at(1, k)});
        for (uint32_t i = 1; i + 1 < rings; ++i) {
            mesh.indices.insert(mesh.indices.end(), {at(i, k), at(i, k + 1), at(i + 1, k)});
            mesh.indices.insert(mesh.indices.end(), {at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
        }
        mesh.indices.insert(mesh.indices.end(), {at(rings - 1, k), at(rings - 1, k + 1), last});
    }
    return mesh;
}

class SurfaceRandom : public testing::RandomPoses {
public:
    using RandomPoses::RandomPoses;
    Vector3 InBounds(const Bounds& b) {
        const float x = Between(b.lower.x(), b.upper.x()), y = Between(b.lower.y(), b.upper.y()),
                    z = Between(b.lower.z(), b.upper.z());
        return Vector3(x, y, z);
    }
};

// Triangles of random sizes anywhere, none sharing a vertex.
inline IndexedTriangles Soup(uint32_t count, float half, float size, uint32_t seed) {
    IndexedTriangles mesh;
    SurfaceRandom random(seed);
    for (uint32_t i = 0; i < count; ++i) {
        const Vector3 center = random.InBox(half);
        const float own = size * random.Between(0.01f, 1.0f);
        for (int k = 0; k < 3; ++k) {
            mesh.indices.push_back(static_cast<uint32_t>(mesh.vertices.size()));
            mesh.vertices.push_back(center + random.InBox(own));
        }
    }
    return mesh;
}

inline Bounds BoundsOf(const TriangleView& t) {
    Bounds bounds;
    for (const Vector3& v : t.vertices) bounds.Include(v);
    return bounds;
}

// All triangles of a surface, for brute force.
inline std::vector<TriangleView> AllTriangles(const SurfaceShape& shape) {
    std::vector<TriangleView> all;
    Bounds everything;
    everything.lower = Vector3::Constant(-INFINITY);
    everything.upper = Vector3::Constant(INFINITY);
    shape.VisitTriangles(everything, [&](uint32_t id) { all.push_back(shape.GetTriangle(id)); });
    std::sort(all.begin(), all.end(), [](const TriangleView& a, const TriangleView& b) { return a.id < b.id; });
    return all;
}

inline std::vector<uint32_t> BruteForceBox(const std::vector<TriangleView>& triangles, const Bounds& box) {
    std::vector<uint32_t> ids;
    for (const TriangleView& t : triangles)
        if (BoundsOf(t).Overlaps(box)) ids.push_back(t.id);
    return ids;
}

// Every hit in the order of ids.
inline std::vector<SurfaceHit> BruteForceRay(const std::vector<TriangleView>& triangles, const SurfaceRay& ray,
                                             bool isTwoSided) {
    std::vector<SurfaceHit> hits;
    const ShearedRay sheared(ray.origin, ray.displacement);
    for (const TriangleView& t : triangles) {
        float fraction;
        bool isBack;
        if (IntersectTriangle(sheared, t.vertices[0], t.vertices[1], t.vertices[2], ray.backFaces || isTwoSided, 1,
                              fraction, isBack))
            hits.push_back({fraction, t.id, isBack ? Vector3(-t.normal) : t.normal, isBack});
    }
    return hits;
}

// The closest, the lowest id of equals.
inline std::optional<SurfaceHit> ClosestOf(const std::vector<SurfaceHit>& hits) {
    std::optional<SurfaceHit> best;
    for (const SurfaceHit& hit : hits)
        if (!best || hit.fraction < best->fraction) best = hit;
    return best;
}

// Moeller-Trumbore in double, independent of the engine's test. The smallest fraction, or a negative number.
inline double DoubleFraction(const TriangleView& t, const SurfaceRay& ray) {
    const Position a = t.vertices[0].cast<double>(), e1 = t.vertices[1].cast<double>() - a,
                   e2 = t.vertices[2].cast<double>() - a, d = ray.displacement.cast<double>(),
                   s = ray.origin.cast<double>() - a;
    const Position p = d.cross(e2), q = s.cross(e1);
    const double det = e1.dot(p);
    if (det == 0) return -1;
    const double u = s.dot(p) / det, v = d.dot(q) / det, f = e2.dot(q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && f >= 0 && f <= 1 ? f : -1;
}

}  // namespace fulcrum
