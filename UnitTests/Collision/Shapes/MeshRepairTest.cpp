// Repair of bad meshes, active edges, scaled instances, determinism.
#include <Fulcrum/UnitTests/Collision/Shapes/SurfaceChecks.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>

namespace fulcrum {
namespace {

using MeshPtr = std::shared_ptr<const TriangleMesh>;

ErrorCode CodeOf(const IndexedTriangles& triangles) {
    const auto mesh = TriangleMesh::Create(triangles.Settings());
    EXPECT_FALSE(mesh);
    return mesh ? ErrorCode::UnknownId : mesh.GetError().code;
}

TEST(MeshRepair, RefusesWhatItCannotRepair) {
    const std::vector<Vector3> corners = {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 0, 1)};
    EXPECT_EQ(CodeOf({corners, {0, 1, 3}}), ErrorCode::OutOfRange);
    EXPECT_EQ(CodeOf({corners, {0, 1}}), ErrorCode::Degenerate);
    EXPECT_EQ(CodeOf({corners, {}}), ErrorCode::Degenerate);
    EXPECT_EQ(CodeOf({corners, {0, 1, 1}}), ErrorCode::Degenerate);
    EXPECT_EQ(CodeOf({{}, {}}), ErrorCode::Degenerate);
    IndexedTriangles bad{corners, {0, 2, 1}};
    bad.vertices[2].y() = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(CodeOf(bad), ErrorCode::NonFinite);
    EXPECT_NE(TriangleMesh::Create(bad.Settings()).GetError().message.find("vertex 2"), std::string::npos);
    bad.vertices[2].y() = std::numeric_limits<float>::infinity();
    EXPECT_EQ(CodeOf(bad), ErrorCode::NonFinite);
    bad.vertices[2].y() = 1e20f;
    EXPECT_EQ(CodeOf(bad), ErrorCode::OutOfRange);
}

TEST(MeshRepair, ReportsWhatItRepaired) {
    IndexedTriangles mesh;
    mesh.vertices = {Vector3(0, 0, 0),     Vector3(1, 0, 0), Vector3(0, 0, 1),   Vector3(1, 0, 1),
                     Vector3(1, 5e-8f, 0), Vector3(9, 9, 9), Vector3(0.5f, 0, 0)};
    mesh.indices = {0, 2, 1,   // kept
                    4, 2, 3,   // kept, its vertex 4 is vertex 1
                    1, 0, 2,   // the first again
                    0, 6, 1,   // a line
                    1, 1, 2,   // a point and a line
                    2, 3, 1};  // the second again
    MeshReport report;
    const MeshPtr built = TriangleMesh::Create(mesh.Settings(), &report).Value();
    EXPECT_EQ(built->TriangleCount(), 2u);
    EXPECT_EQ(built->VertexCount(), 4u);
    EXPECT_EQ(report.weldedVertices.count, 1u);
    EXPECT_EQ(report.weldedVertices.first, 4u);
    EXPECT_EQ(report.unusedVertices.count, 2u);
    EXPECT_EQ(report.unusedVertices.first, 5u);
    EXPECT_EQ(report.degenerateTriangles.count, 2u);
    EXPECT_EQ(report.degenerateTriangles.first, 3u);
    EXPECT_EQ(report.duplicateTriangles.count, 2u);
    EXPECT_EQ(report.duplicateTriangles.first, 2u);
    EXPECT_EQ(report.boundaryEdges, 4u);
    EXPECT_EQ(report.irregularEdges, 0u);
    EXPECT_FALSE(report.IsClean());
}

TEST(MeshRepair, WeldsExactlyWithinTheDistance) {
    const IndexedTriangles soup = Soup(2000, 0.05f, 0.02f, 9);
    TriangleMeshSettings settings = soup.Settings();
    settings.weldDistance = 2e-3f;
    MeshReport report;
    const MeshPtr mesh = TriangleMesh::Create(settings, &report).Value();
    EXPECT_GT(report.weldedVertices.count, 100u);
    for (uint32_t i = 0; i < mesh->VertexCount(); ++i)
        for (uint32_t k = 0; k < i; ++k) ASSERT_GT(Length(mesh->Vertex(i) - mesh->Vertex(k)), 1.9999e-3f);
}

// Random garbage of every kind of float: refused, or built so that queries agree with brute force.
TEST(MeshRepair, SurvivesAnyInput) {
    std::mt19937 engine(1);
    SurfaceRandom random(1);
    int built = 0;
    for (int round = 0; round < 3000; ++round) {
        IndexedTriangles mesh;
        const uint32_t vertices = 1 + random.Below(20), indices = 3 * random.Below(30) + (round % 50 == 0 ? 1 : 0);
        for (uint32_t i = 0; i < vertices; ++i) {
            Vector3 v;
            for (int axis = 0; axis < 3; ++axis) {
                const auto bits = static_cast<uint32_t>(engine());
                std::memcpy(&v[axis], &bits, 4);
                const bool isTame = round % 4 != 0 || !(std::fabs(v[axis]) < 1e14f);
                if (isTame)
                    v[axis] = static_cast<float>(static_cast<int>(random.Below(5))) * (round % 3 == 0 ? 1e-7f : 1.0f);
            }
            mesh.vertices.push_back(v);
        }
        for (uint32_t i = 0; i < indices; ++i)
            mesh.indices.push_back(random.Below(vertices + (round % 20 == 0 ? 1 : 0)));
        const auto result = TriangleMesh::Create(mesh.Settings());
        if (!result) continue;
        ++built;
        const std::vector<TriangleView> all = AllTriangles(*result.Value());
        ASSERT_EQ(all.size(), result.Value()->TriangleCount());
        for (const TriangleView& t : all) {
            ASSERT_TRUE(IsFinite(t.normal));
            ASSERT_NEAR(Length(t.normal), 1, 1e-5f);
        }
        const SurfaceRay ray{random.InBox(5), random.InBox(20), true};
        SurfaceHit hit;
        const auto closest = ClosestOf(BruteForceRay(all, ray, false));
        ASSERT_EQ(result.Value()->CastRay(ray, hit), closest.has_value());
        if (closest) {
            ASSERT_EQ(hit.triangle, closest->triangle);
        }
    }
    EXPECT_GT(built, 1000);
}

TEST(MeshRepair, ManyTrianglesInOnePlaceStillMakeATree) {
    IndexedTriangles mesh;
    for (uint32_t i = 0; i < 2000; ++i) {  // a fan of nearly the same triangle, two-sided
        mesh.vertices.push_back(Vector3(0, 0, 0));
        mesh.vertices.push_back(Vector3(1, 1e-6f * static_cast<float>(i), 0));
        mesh.vertices.push_back(Vector3(0, 0, 1 + 1e-6f * static_cast<float>(i)));
        mesh.indices.insert(mesh.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    }
    const MeshPtr built = TriangleMesh::Create(mesh.Settings()).Value();
    const std::vector<TriangleView> all = AllTriangles(*built);
    EXPECT_EQ(all.size(), 2000u);
    EXPECT_EQ(Found(*built, built->LocalBounds()).size(), 2000u);
}

// ---- Active edges

// Two triangles that share the edge (1, 2) along z; the second's far corner lies `angle` below the first's plane.
std::vector<uint8_t> SharedEdge(double angle, bool isTwoSided = false) {
    IndexedTriangles mesh;
    mesh.vertices = {Vector3(-1, 0, 0), Vector3(0, 0, -1), Vector3(0, 0, 1),
                     Vector3(static_cast<float>(std::cos(angle)), static_cast<float>(-std::sin(angle)), 0)};
    mesh.indices = {0, 2, 1, 1, 2, 3};
    TriangleMeshSettings settings = mesh.Settings();
    settings.isTwoSided = isTwoSided;
    settings.keepSourceTriangles = true;
    const MeshPtr built = TriangleMesh::Create(settings).Value();
    std::vector<uint8_t> edges(2);
    for (uint32_t id = 0; id < 2; ++id) edges[built->SourceTriangle(id)] = built->GetTriangle(id).activeEdges;
    return edges;
}

TEST(MeshEdges, AreActiveWhereConvexAboveTheAngleOrOpen) {
    const double degree = M_PI / 180;
    // Of the first triangle the shared edge is 2 -> 1, number 1; of the second 1 -> 2, number 0. The others are open.
    const std::vector<uint8_t> active = {7, 7}, inactive = {5, 6};
    EXPECT_EQ(SharedEdge(30 * degree), active);
    EXPECT_EQ(SharedEdge(6 * degree), active);
    EXPECT_EQ(SharedEdge(4 * degree), inactive);  // 0.996 is the cosine of 5.1 degrees
    EXPECT_EQ(SharedEdge(0), inactive);
    EXPECT_EQ(SharedEdge(-30 * degree), inactive);
    EXPECT_EQ(SharedEdge(-30 * degree, true), active);
    EXPECT_EQ(SharedEdge(170 * degree), active);
}

TEST(MeshEdges, OfThreeTrianglesAreActive) {
    IndexedTriangles mesh;
    mesh.vertices = {Vector3(-1, 0, 0), Vector3(0, 0, -1), Vector3(0, 0, 1), Vector3(1, 0, 0), Vector3(0, 1, 0)};
    mesh.indices = {0, 2, 1, 1, 2, 3, 1, 2, 4};
    MeshReport report;
    const MeshPtr built = TriangleMesh::Create(mesh.Settings(), &report).Value();
    EXPECT_EQ(report.irregularEdges, 1u);
    EXPECT_EQ(report.boundaryEdges, 6u);
    for (uint32_t id = 0; id < 3; ++id) EXPECT_EQ(built->GetTriangle(id).activeEdges, 7);
}

TEST(MeshEdges, OfABoxAreTheTwelveSharpOnes) {
    IndexedTriangles mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back(Vector3(i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f));
    const uint32_t quads[6][4] = {{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3}, {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};
    for (const auto& q : quads) mesh.indices.insert(mesh.indices.end(), {q[0], q[1], q[2], q[0], q[2], q[3]});
    MeshReport report;
    const MeshPtr built = TriangleMesh::Create(mesh.Settings(), &report).Value();
    EXPECT_EQ(report.boundaryEdges, 0u);
    int active = 0;
    for (uint32_t id = 0; id < 12; ++id) active += std::popcount(unsigned{built->GetTriangle(id).activeEdges});
    EXPECT_EQ(active, 24);  // each from both sides; the six diagonals are flat
}

// ---- Scaled instances

TEST(ScaledMesh, SharesDataAndSearchesExactly) {
    const MeshPtr mesh = TriangleMesh::Create(BallOf(16, 24, 2).Settings()).Value();
    for (const Vector3& scale : {Vector3(2, 2, 2), Vector3(1, 3, 0.2f), Vector3(-1, 1, 1), Vector3(-0.7f, -10, -0.01f),
                                 Vector3(1e-3f, 1e3f, 1)}) {
        const MeshPtr scaled = TriangleMesh::Scaled(*mesh, scale).Value();
        EXPECT_EQ(scaled->TriangleCount(), mesh->TriangleCount());
        for (uint32_t id = 0; id < mesh->TriangleCount(); id += 7) {
            const TriangleView t = scaled->GetTriangle(id), u = mesh->GetTriangle(id);
            EXPECT_EQ(t.vertices[0], u.vertices[0].cwiseProduct(scale));
            // Fronts stay outside.
            EXPECT_GT(Dot(t.normal, t.vertices[0]), 0);
        }
        ExpectExactBoxes(*scaled, 3000, 0.5f * scale.cwiseAbs().maxCoeff());
        ExpectExactRays(*scaled, 6000);
        ExpectNearTriangles(*scaled, 600, 0.5f * scale.cwiseAbs().maxCoeff());
    }
}

TEST(ScaledMesh, RefusesZeroAndNonFinite) {
    const MeshPtr mesh = TriangleMesh::Create(BallOf(6, 6, 2).Settings()).Value();
    EXPECT_EQ(TriangleMesh::Scaled(*mesh, Vector3(1, 0, 1)).GetError().code, ErrorCode::OutOfRange);
    EXPECT_EQ(TriangleMesh::Scaled(*mesh, Vector3(1, NAN, 1)).GetError().code, ErrorCode::NonFinite);
    EXPECT_EQ(TriangleMesh::Scaled(*mesh, Vector3(1, 1e7f, 1)).GetError().code, ErrorCode::OutOfRange);
}

// ---- Determinism

bool AreEqual(const TriangleMesh& a, const TriangleMesh& b) {
    if (a.TriangleCount() != b.TriangleCount() || a.MemoryUsed() != b.MemoryUsed()) return false;
    for (uint32_t id = 0; id < a.TriangleCount(); ++id) {
        const TriangleView t = a.GetTriangle(id), u = b.GetTriangle(id);
        for (int k = 0; k < 3; ++k)
            if (t.vertices[k] != u.vertices[k] || t.vertexIds[k] != u.vertexIds[k]) return false;
        if (t.activeEdges != u.activeEdges || t.normal != u.normal) return false;
    }
    return true;
}

TEST(MeshBuild, IsTheSameForAnyNumberOfThreads) {
    const IndexedTriangles terrain = WavyTerrain(150, 3, 5);
    const MeshPtr serial = TriangleMesh::Create(terrain.Settings()).Value();
    for (const uint32_t threads : {1u, 2u, 3u, 4u}) {
        const ParallelLoop parallel = [&](uint32_t count, const std::function<void(uint32_t)>& job) {
            std::atomic<uint32_t> next{0};
            const auto work = [&] {
                for (uint32_t i = next++; i < count; i = next++) job(i);
            };
            std::vector<std::thread> helpers;
            for (uint32_t i = 1; i < threads; ++i) helpers.emplace_back(work);
            work();
            for (std::thread& helper : helpers) helper.join();
        };
        const MeshPtr mesh = TriangleMesh::Create(terrain.Settings(), nullptr, parallel).Value();
        EXPECT_TRUE(AreEqual(*serial, *mesh)) << threads;
    }
}

}  // namespace
}  // namespace fulcrum
