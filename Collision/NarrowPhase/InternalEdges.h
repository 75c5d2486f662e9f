// Removes ghost collisions with internal edges: a shape that slides over a surface must not bump into the edges between
// its triangles. Contacts with faces are accepted directly. Contacts with edges and corners are deferred until all
// faces are known; then
// - one at an edge or corner of a triangle with a face contact is dropped, since that contact covers it;
// - one at an active edge (SurfaceShape.h), or nearly along the face's normal, counts, the deepest first, and covers
//   its edge for those that follow;
// - one at an inactive edge is replaced by the contact with the triangle's face, if there is one.
// Used by SurfaceContact alone.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/SurfaceManifold.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

namespace fulcrum {

struct TriangleInShape;

class InternalEdgeFilter {
public:
    // A normal this near to that of a face may be that of an edge which counts as flat: 6 degrees, a little more than
    // what makes an edge active.
    static constexpr float kFlatCosine = 0.9945f;

    // facesAhead: contacts with edges do not replace those with the triangle's face, which the shape may reach within
    // the step.
    void Begin(bool facesAhead);
    void AddFace(const TriangleView& view, const Manifold& manifold);
    // Adds the closest feature of a triangle: its face, or one of its edges or corners. `axis`: unit, towards the
    // triangle, in the surface's frame; onFace: the contact with the face, if any.
    void AddNearest(const TriangleView& view, const Vector3& axis, bool overlaps, const Manifold& onFace,
                    const Manifold& nearest);
    // Adds points on the face for a shape that is deeper beyond an inactive edge or corner, over the neighbor. Returns
    // false, adding nothing, if it is ambiguous beyond which one.
    bool DeferToNeighbor(const TriangleView& view, const TriangleInShape& triangle, float slop, const Manifold& onFace);
    // Decides on the deferred contacts. Returns all accepted contacts.
    Array<SurfaceManifold>& Resolve();
    size_t MemoryUsed() const;  // bytes, besides the object itself

private:
    struct DeferredContact {
        SurfaceManifold contact;
        SurfaceManifold onFace;
        uint32_t vertices[2];  // ids; equal for a corner
        float separation;      // m, of the deepest point
        bool active;
        bool isOnFace;  // `contact` is onFace
    };

    void Defer(const TriangleView& view, const Vector3& axis, const Manifold& manifold, const Manifold& onFace);

    bool facesAhead_ = false;
    Array<DeferredContact> deferred_;
    Array<uint32_t> covered_;  // ids of the vertices of triangles with face contacts
    Array<SurfaceManifold> contacts_;
};

}  // namespace fulcrum
