#include <Fulcrum/UnitTests/Collision/Shapes/SurfaceChecks.h>

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace fulcrum {
namespace {

using MeshPtr = std::shared_ptr<const TriangleMesh>;

MeshPtr MeshOf(const IndexedTriangles& triangles) { return TriangleMesh::Create(triangles.Settings()).Value(); }

TEST(TriangleMesh, BoxQueriesAreExact) {
    ExpectExactBoxes(*MeshOf(WavyTerrain(14, 3, 5)), 40000, 4);
    ExpectExactBoxes(*MeshOf(BallOf(10, 16, 2)), 30000, 0.5f);
    ExpectExactBoxes(*MeshOf(Soup(300, 10, 2, 1)), 30000, 2);
}

TEST(TriangleMesh, FindsWhatIsNear) {
    ExpectNearTriangles(*MeshOf(WavyTerrain(14, 3, 5)), 3000, 4);
    ExpectNearTriangles(*MeshOf(BallOf(10, 16, 2)), 3000, 0.5f);
    ExpectNearTriangles(*MeshOf(Soup(300, 10, 2, 1)), 3000, 2);
}

TEST(TriangleMesh, RayCastsAreExact) {
    ExpectExactRays(*MeshOf(WavyTerrain(14, 3, 5)), 40000);
    ExpectExactRays(*MeshOf(BallOf(10, 16, 2)), 30000);
    ExpectExactRays(*MeshOf(Soup(300, 10, 2, 1)), 30000);
}

TEST(TriangleMesh, TwoSidedMeshesAreHitFromBehind) {
    const IndexedTriangles soup = Soup(300, 10, 2, 3);
    TriangleMeshSettings settings = soup.Settings();
    settings.isTwoSided = true;
    ExpectExactRays(*TriangleMesh::Create(settings).Value(), 10000);
}

// The engine's test against an independent one in double. A hit's place may differ by the rounding of the sheared
// coordinates, 2^-22 of their size of up to 60 m, over the sine of the angle of incidence: 1e-3 m covers angles down to
// a degree; rays within that of a triangle's rim may be told apart otherwise and are left out.
TEST(TriangleMesh, RayCastsAgreeWithDouble) {
    const MeshPtr mesh = MeshOf(WavyTerrain(20, 3, 5));
    const std::vector<TriangleView> all = AllTriangles(*mesh);
    SurfaceRandom random(5);
    for (int i = 0; i < 20000; ++i) {
        const Vector3 origin{random.Between(-29, 29), random.Between(20, 30), random.Between(-29, 29)};
        const SurfaceRay ray{origin, Vector3{random.Between(-5, 5), -40, random.Between(-5, 5)}, true};
        double best = 2;
        for (const TriangleView& t : all) {
            const double f = DoubleFraction(t, ray);
            if (f >= 0) best = std::min(best, f);
        }
        SurfaceHit hit;
        const bool isHit = mesh->CastRay(ray, hit);
        if (best > 1) continue;  // past the rim
        ASSERT_TRUE(isHit);
        ASSERT_NEAR(double{hit.fraction}, best, 1e-3 / 40);
        ASSERT_LT(Dot(hit.normal, ray.displacement), 0);
    }
}

// Rays at every vertex and at points along every edge of a closed ball, from inside and outside: each hits the surface.
TEST(TriangleMesh, NoRaySlipsBetweenTriangles) {
    const MeshPtr mesh = MeshOf(BallOf(24, 32, 3));
    SurfaceRandom random(2);
    int misses = 0, casts = 0;
    for (const TriangleView& t : AllTriangles(*mesh)) {
        for (int k = 0; k < 3; ++k) {
            for (int i = 0; i < 8; ++i) {
                const float along = i == 0 ? 0.0f : random.Between(0, 1);
                const Vector3 target = t.vertices[k] + (t.vertices[(k + 1) % 3] - t.vertices[k]) * along;
                const Vector3 inside = random.InBox(1);
                SurfaceHit hit;
                misses += mesh->CastRay({inside, (target - inside) * 3, true}, hit) ? 0 : 1;
                misses += mesh->IsHit({inside, (target - inside) * 3, true}) ? 0 : 1;
                ++casts;
            }
        }
    }
    EXPECT_EQ(misses, 0);
    EXPECT_GT(casts, 30000);
}

TEST(TriangleMesh, AxisParallelRaysThroughGridLinesHit) {
    const IndexedTriangles flat = WavyTerrain(16, 1, 0);
    const MeshPtr mesh = MeshOf(flat);
    for (int x = -8; x <= 8; ++x) {
        for (int z = -8; z <= 8; ++z) {
            SurfaceHit hit;
            const Vector3 from(static_cast<float>(x), 10, static_cast<float>(z));
            ASSERT_TRUE(mesh->CastRay({from, Vector3(0, -10, 0)}, hit)) << x << ' ' << z;
            EXPECT_EQ(hit.fraction, 0.5f);
            EXPECT_EQ(hit.normal, Vector3(0, 1, 0));
            EXPECT_FALSE(mesh->IsHit({from, Vector3(0, 10, 0)}));
            EXPECT_FALSE(mesh->IsHit({Vector3(from.x(), 0, from.z()), Vector3(0, 10, 0)}));
            EXPECT_TRUE(mesh->IsHit({Vector3(from.x(), 0, from.z()), Vector3(0, 10, 0), true}));
        }
    }
}

TEST(TriangleMesh, HandlesInvalidRaysAndBoxes) {
    const MeshPtr mesh = MeshOf(WavyTerrain(4, 1, 1));
    const float nan = NAN, inf = INFINITY;
    for (const Vector3& bad : {Vector3(nan, 0, 0), Vector3(0, inf, 0), Vector3(1e30f, 0, 0)}) {
        EXPECT_FALSE(mesh->IsHit({bad, Vector3(0, -1, 0)}));
        EXPECT_FALSE(mesh->IsHit({Vector3(0, 10, 0), bad}));
    }
    EXPECT_FALSE(mesh->IsHit({Vector3(0, 10, 0), Vector3::Zero()}));
    EXPECT_TRUE(Found(*mesh, Bounds{}).empty());
    Bounds bad;
    bad.lower = Vector3::Constant(-1);
    bad.upper = Vector3(1, nan, 1);
    EXPECT_TRUE(Found(*mesh, bad).empty());
    EXPECT_TRUE(mesh->IsHit({Vector3(0, 1e6f, 0), Vector3(0, -2e6f, 0)}));
}

TEST(TriangleMesh, FindTrianglesCountsWhatDoesNotFit) {
    const MeshPtr mesh = MeshOf(WavyTerrain(10, 1, 1));
    std::vector<uint32_t> few(5, kNoTriangle), all(200);
    EXPECT_EQ(mesh->FindTriangles(mesh->LocalBounds(), few), 200u);
    EXPECT_EQ(mesh->FindTriangles(mesh->LocalBounds(), all), 200u);
    EXPECT_TRUE(std::equal(few.begin(), few.end(), all.begin()));
}

// Everything over the vertices: nodes, pages, indices, a byte of edge flags and a byte of material a triangle.
double BytesPerTriangle(const IndexedTriangles& triangles) {
    std::vector<uint8_t> materials(triangles.indices.size() / 3);
    for (size_t i = 0; i < materials.size(); ++i) materials[i] = static_cast<uint8_t>(i % 3);
    const std::vector<SurfaceMaterial> palette(3);
    TriangleMeshSettings settings = triangles.Settings();
    settings.triangleMaterials = materials;
    settings.materials = palette;
    const MeshPtr mesh = TriangleMesh::Create(settings).Value();
    const double over = static_cast<double>(mesh->MemoryUsed() - mesh->VertexCount() * sizeof(Vector3));
    const double bytes = over / mesh->TriangleCount();
    std::printf("%u triangles: %.2f bytes a triangle\n", mesh->TriangleCount(), bytes);
    return bytes;
}

TEST(TriangleMesh, TakesAtMostTwelveBytesATriangle) {
    EXPECT_LE(BytesPerTriangle(WavyTerrain(100, 3, 5)), 12);
    EXPECT_LE(BytesPerTriangle(BallOf(100, 100, 5)), 12);
    EXPECT_LE(BytesPerTriangle(Soup(50000, 50, 1, 1)), 12);
    EXPECT_LE(BytesPerTriangle(WavyTerrain(300, 3, 5)), 12);  // more vertices than 16 bits number
}

TEST(TriangleMesh, KeepsMaterialsAndSources) {
    const IndexedTriangles terrain = WavyTerrain(20, 1, 1);
    const uint32_t count = static_cast<uint32_t>(terrain.indices.size() / 3);
    std::vector<uint8_t> materials(count);
    for (uint32_t i = 0; i < count; ++i) materials[i] = static_cast<uint8_t>(i % 7);
    const std::vector<SurfaceMaterial> palette(7, {.friction = 0.3f, .restitution = 0.1f});
    TriangleMeshSettings settings = terrain.Settings();
    settings.triangleMaterials = materials;
    settings.materials = palette;
    settings.keepSourceTriangles = true;
    const MeshPtr mesh = TriangleMesh::Create(settings).Value();
    ASSERT_EQ(mesh->TriangleCount(), count);
    std::vector<bool> seen(count);
    for (uint32_t id = 0; id < count; ++id) {
        const TriangleView t = mesh->GetTriangle(id);
        const uint32_t source = mesh->SourceTriangle(id);
        EXPECT_FALSE(seen[source]);
        seen[source] = true;
        EXPECT_EQ(t.material, source % 7);
        for (uint32_t k = 0; k < 3; ++k) EXPECT_EQ(t.vertices[k], terrain.vertices[terrain.indices[3 * source + k]]);
        for (uint32_t k = 0; k < 3; ++k) EXPECT_EQ(t.vertices[k], mesh->Vertex(t.vertexIds[k]));
    }
}

TEST(TriangleMesh, ViewsInBatchesAreTheSame) {
    const MeshPtr mesh = MeshOf(BallOf(10, 10, 1));
    std::vector<uint32_t> ids(mesh->TriangleCount());
    std::iota(ids.begin(), ids.end(), 0u);
    std::vector<TriangleView> views(ids.size());
    mesh->GetTriangles(ids, views.data());
    for (const uint32_t id : ids) {
        EXPECT_EQ(views[id].normal, mesh->GetTriangle(id).normal);
        EXPECT_EQ(views[id].id, id);
        // Fronts outwards: the normal points away from the center.
        EXPECT_GT(Dot(views[id].normal, views[id].vertices[0]), 0);
    }
}

}  // namespace
}  // namespace fulcrum
