// The base of TriangleMesh and HeightField: triangle queries for contacts, ray casts and shape casts, all in the
// shape's own frame, which is the user's. Const functions may run on any number of threads at once and allocate
// nothing. The order in which triangles are found depends only on the shape's data.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

#include <memory>
#include <span>
#include <type_traits>
#include <vector>

namespace fulcrum {

// Material of some triangles of a surface. A triangle refers to an entry of its shape's palette.
struct SurfaceMaterial {
    float friction = 0.5f;  // >= 0
    float restitution = 0;  // 0 .. 1
};

struct TriangleView {
    Vector3 vertices[3];    // m; counter-clockwise seen from the front
    Vector3 normal;         // unit, to the front
    uint32_t vertexIds[3];  // of the shape's vertices: triangles that share a vertex share its id
    uint32_t id;
    // Bit i: contacts on the edge from vertex i to vertex (i + 1) % 3 may have normals other than the face's. Set for
    // open boundaries, for edges of more than two triangles and for convex edges above the shape's angle; on two-sided
    // shapes for concave ones too.
    uint8_t activeEdges;
    uint8_t material;  // index into Materials(), unless that is empty
};

// From `origin` to origin + displacement.
struct SurfaceRay {
    Vector3 origin;          // m
    Vector3 displacement;    // m; zero hits nothing
    bool backFaces = false;  // whether one-sided triangles are hit from behind, too
};

inline constexpr uint32_t kNoTriangle = ~0u;

struct SurfaceHit {
    float fraction = 1;  // of the displacement, 0 .. 1
    uint32_t triangle = kNoTriangle;
    Vector3 normal = Vector3::Zero();  // unit; the face's, reversed if hit from behind
    bool isBackFace = false;
};

class SurfaceShape : public Shape {
public:
    ~SurfaceShape() override;

    // Ids are below this. A mesh has a triangle for each id; a height field has none for holes.
    virtual uint32_t TriangleIdEnd() const = 0;
    virtual uint32_t TriangleCount() const = 0;
    // `id`: from VisitTriangles, FindTriangles or a cast.
    virtual TriangleView GetTriangle(uint32_t id) const = 0;
    // Writes the triangle of each id to `views`, of the same length.
    virtual void GetTriangles(std::span<const uint32_t> ids, TriangleView* views) const = 0;

    // Calls visit(uint32_t id) for every triangle whose bounding box overlaps `box`: touching counts. The triangle
    // itself may be outside `box`. Bounds may be infinite; empty or NaN ones find nothing.
    template <class Visitor>
    void VisitTriangles(const Bounds& box, Visitor&& visit) const;
    // The same for the triangles whose bounding boxes are within `maxDistance` m of `box`, those in nearer parts of the
    // surface mostly first. The visitor may lower maxDistance as it finds what it looks for; below 0 ends the search.
    template <class Visitor>
    void VisitTrianglesNear(const Bounds& box, const float& maxDistance, Visitor&& visit) const;
    // Writes the ids to `ids`. Returns their number, which may be larger than ids.size(): then only the first ones are
    // written.
    uint32_t FindTriangles(const Bounds& box, std::span<uint32_t> ids) const;

    // The closest hit with a fraction of at most `maxFraction`; ties are resolved by the lowest id. A ray never passes
    // between two triangles that share an edge or a vertex. Returns false, leaving `hit` unchanged, if there is none.
    // Rays that are not finite, or of more than 1e18 m, hit nothing.
    virtual bool CastRay(const SurfaceRay& ray, SurfaceHit& hit, float maxFraction = 1) const = 0;
    // The same for up to kMostRays rays, cheaper if they are close together: hits[i] for rays[i] up to maxFractions[i].
    // Returns the bits of those that hit.
    static constexpr int kMostRays = 32;
    virtual uint32_t CastRays(std::span<const SurfaceRay> rays, SurfaceHit* hits, const float* maxFractions) const;
    // Whether there is any.
    virtual bool IsHit(const SurfaceRay& ray, float maxFraction = 1) const = 0;
    // Calls visit(const SurfaceHit&) for every hit with a fraction of at most `maxFraction`, in no particular order,
    // until it returns false. A ray through a shared edge may hit both triangles.
    template <class Visitor>
    void CastRayAll(const SurfaceRay& ray, Visitor&& visit, float maxFraction = 1) const;

    // Two-sided triangles collide and are hit from both sides; one-sided ones only from the front.
    bool IsTwoSided() const { return isTwoSided_; }
    // The palette; empty if the body's material is used everywhere.
    std::span<const SurfaceMaterial> Materials() const;
    // In bytes; data shared by instances are counted in each.
    virtual size_t MemoryUsed() const = 0;

protected:
    using Shape::Shape;

    // Called with the ids found in one leaf, 1 .. kMaxBatch.
    static constexpr int kMaxBatch = 16;
    using BatchFunction = void (*)(void* context, const uint32_t* ids, int count);
    using HitFunction = bool (*)(void* context, const SurfaceHit& hit);
    template <class Visitor>
    static void VisitEach(void* context, const uint32_t* ids, int count);
    virtual void SearchBox(const Bounds& box, void* context, BatchFunction found) const = 0;
    virtual void SearchRay(const SurfaceRay& ray, float maxFraction, void* context, HitFunction found) const = 0;
    // Reads maxDistance anew after each call of `found`.
    virtual void SearchNear(const Bounds& box, const float& maxDistance, void* context, BatchFunction found) const = 0;

    // Keeps the closest of the hits of a traversal.
    struct ClosestHit {
        float fraction;
        uint32_t triangle = kNoTriangle;
        bool isBackFace = false;
        // Returns the new largest fraction.
        float Take(uint32_t id, float at, bool isBack) {
            if (at < fraction || (at == fraction && id < triangle)) *this = {at, id, isBack};
            return fraction;
        }
        SurfaceHit ToHit(const Vector3& normal) const {
            return {fraction, triangle, isBackFace ? Vector3(-normal) : normal, isBackFace};
        }
    };

    // Errors: NonFinite, Negative, OutOfRange (a restitution above 1, more than 255 materials).
    static Status CheckMaterials(std::span<const SurfaceMaterial> materials);

    std::vector<SurfaceMaterial> materials_;
    bool isTwoSided_ = false;
};

template <class Visitor>
void SurfaceShape::VisitEach(void* context, const uint32_t* ids, int count) {
    auto& visit = *static_cast<Visitor*>(context);
    for (int i = 0; i < count; ++i) visit(ids[i]);
}

template <class Visitor>
void SurfaceShape::VisitTriangles(const Bounds& box, Visitor&& visit) const {
    SearchBox(box, const_cast<void*>(static_cast<const void*>(&visit)), VisitEach<std::remove_reference_t<Visitor>>);
}

template <class Visitor>
void SurfaceShape::VisitTrianglesNear(const Bounds& box, const float& maxDistance, Visitor&& visit) const {
    SearchNear(box, maxDistance, const_cast<void*>(static_cast<const void*>(&visit)),
               VisitEach<std::remove_reference_t<Visitor>>);
}

template <class Visitor>
void SurfaceShape::CastRayAll(const SurfaceRay& ray, Visitor&& visit, float maxFraction) const {
    SearchRay(ray, maxFraction, const_cast<void*>(static_cast<const void*>(&visit)),
              [](void* context, const SurfaceHit& hit) -> bool {
                  return (*static_cast<std::remove_reference_t<Visitor>*>(context))(hit);
              });
}

}  // namespace fulcrum
