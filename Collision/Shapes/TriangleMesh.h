// Triangle mesh: indexed triangles in a tree of eight-way nodes with boxes of 8 bits per coordinate (MeshTree.h). For
// static and kinematic bodies: it has no volume. Immutable; instances of other scales share the data.
#pragma once

#include <Fulcrum/Collision/Shapes/MeshRepair.h>
#include <Fulcrum/Collision/Shapes/ParallelLoop.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>
#include <Fulcrum/Math/List.h>
#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

struct MeshTree;

struct TriangleMeshSettings {
    List<Vector3> vertices{};           // m
    List<uint32_t> indices{};           // three per triangle, counter-clockwise seen from the front
    List<uint8_t> triangleMaterials{};  // one per triangle, or empty: all 0
    List<SurfaceMaterial> materials{};  // the palette, at most 255; none: the body's own material everywhere
    bool isTwoSided = false;
    float activeEdgeCosine = 0.996f;   // -1 .. 1: edges whose normals have a larger cosine (5 degrees) count as flat
    float weldDistance = 1e-7f;        // m, >= 0: vertices this close are merged
    bool keepSourceTriangles = false;  // enables SourceTriangle(), 4 bytes per triangle
};

class TriangleMesh final : public SurfaceShape {
public:
    ~TriangleMesh() override;

    // Vertices nearly equal are welded, triangles without area and duplicates dropped; `report` (may be null) returns
    // what was repaired. The result is bit-identical for any `parallel`. Errors: NonFinite (names the vertex),
    // OutOfRange (an index, a material, a setting; more than 2^27 triangles), Degenerate (nothing left, or a number of
    // indices that is no multiple of three).
    static Result<std::shared_ptr<const TriangleMesh>> Create(const TriangleMeshSettings& settings,
                                                              MeshReport* report = nullptr,
                                                              const ParallelLoop& parallel = {});
    // The same mesh with its coordinates multiplied by `scale`, which may be non-uniform and mirror; front sides are
    // kept. Shares tree, vertices and materials with `mesh`; triangles keep their ids. Errors: NonFinite, OutOfRange
    // (the magnitude of a factor, multiplied by earlier scales, not 1e-6 to 1e6; a coordinate above 1e15 m).
    static Result<std::shared_ptr<const TriangleMesh>> Scaled(const TriangleMesh& mesh, const Vector3& scale);

    uint32_t TriangleIdEnd() const override;
    uint32_t TriangleCount() const override { return TriangleIdEnd(); }
    TriangleView GetTriangle(uint32_t id) const override;
    void GetTriangles(std::span<const uint32_t> ids, TriangleView* views) const override;
    bool CastRay(const SurfaceRay& ray, SurfaceHit& hit, float maxFraction = 1) const override;
    uint32_t CastRays(std::span<const SurfaceRay> rays, SurfaceHit* hits, const float* maxFractions) const override;
    bool IsHit(const SurfaceRay& ray, float maxFraction = 1) const override;
    size_t MemoryUsed() const override;

    uint32_t VertexCount() const;
    Vector3 Vertex(uint32_t id) const;
    const Vector3& Scale() const { return scale_; }
    float ActiveEdgeCosine() const { return activeEdgeCosine_; }
    // The number of triangle `id` in the settings' indices; only if keepSourceTriangles was set.
    bool HasSourceTriangles() const;
    uint32_t SourceTriangle(uint32_t id) const;

private:
    friend struct ShapeFileAccess;
    TriangleMesh();
    void SearchBox(const Bounds& box, void* context, BatchFunction found) const override;
    void SearchNear(const Bounds& box, const float& maxDistance, void* context, BatchFunction found) const override;
    void SearchRay(const SurfaceRay& ray, float maxFraction, void* context, HitFunction found) const override;
    Vector3 InTree(const Vector3& v) const;
    float PadFor(float largestOrigin) const;
    void LoadCorners(uint32_t begin, uint32_t end, Vec3<Wide<8>> (&corners)[3]) const;
    template <class Visitor>
    void Traverse(const SurfaceRay& ray, float maxFraction, Visitor&& visit) const;
    void FillView(uint32_t id, TriangleView& view) const;
    Vector3 NormalOf(uint32_t id) const;
    void Finish(MeshReport* report);

    std::shared_ptr<const MeshTree> tree_;
    std::vector<uint8_t> activeEdges_;  // one byte per triangle, of the scaled mesh
    Vector3 scale_ = Vector3::Ones();
    float activeEdgeCosine_ = 1;
    float treeExtent_ = 0;  // m: the largest coordinate, unscaled
    bool isScaled_ = false, isMirrored_ = false;
};

}  // namespace fulcrum
