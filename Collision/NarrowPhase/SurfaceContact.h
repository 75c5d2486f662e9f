// Contacts of a convex shape with a surface of triangles: as many manifolds as there are directions to be pushed in,
// without those that only an edge between two triangles would make. Called by the Collide stage, from many threads at
// once, each with a SurfaceContacts of its own.
//
// Each triangle that the shape may reach is collided by itself. What lies before its face is a contact of the face.
// What is nearest to one of its edges or corners waits until all faces are known:
// - where a triangle with a contact of its face shares that edge or corner, its contact says it all;
// - an active one (SurfaceShape.h), or nearly the face's direction, pushes as it is found, the deepest first, and then
// counts
//   as known, too;
// - an inactive edge has no direction of its own: the shape meets the face, if it lies before it.
// Contacts in nearly the same direction, on the same material, become one manifold of at most four points.
//
// A thin body that lands on its edge tumbles so fast that within the step it comes down on what faced away as the step
// began, and its center ends up behind the surface. So the ball inside the shape is a contact of its own where the
// motion of its center takes it through a face: however the body turns, that ball is part of it. And what touched a
// face stays before it even if a heavier body presses its center through.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

#include <vector>

namespace fulcrum {

struct SurfaceManifold {
    Manifold manifold;
    uint32_t triangle;  // the one of the deepest point when it was found
    uint8_t material;   // index into the surface's palette
};

// Room that is used again from call to call, so that it need not be allocated.
class SurfaceContacts {
public:
    // Of the last call, in an order that depends on the shapes and poses alone.
    std::span<const SurfaceManifold> Manifolds() const { return {manifolds_.data(), manifoldCount_}; }
    // Of the surface, that were looked at.
    size_t TriangleCount() const { return views_.size(); }
    // Of the last call: what went wrong in libccd, where the method is Libccd.
    const CollideCounters& Counters() const { return counters_; }
    size_t MemoryUsed() const;  // bytes, besides the object itself

private:
    friend class SurfaceCollider;
    // An edge or corner of a triangle that waits.
    struct DeferredEdgeContact {
        SurfaceManifold contact;
        SurfaceManifold onFace;  // what lies before the face
        uint32_t triangle;       // index into views_
        uint32_t vertices[2];    // ids; the same twice for a corner
        float separation;        // m, of the deepest point
        bool active;
    };
    std::vector<uint32_t> ids_;
    std::vector<TriangleView> views_;
    std::vector<DeferredEdgeContact> deferred_;
    std::vector<uint32_t> known_;  // ids of vertices
    std::vector<SurfaceManifold> found_;
    std::vector<SurfaceManifold> manifolds_;
    size_t manifoldCount_ = 0;
    CollideCounters counters_;
};

struct SurfaceApproach {
    Vector3 motion =
        Vector3::Zero();  // m, of the shape's center relative to the surface within the step, in its center frame
    std::span<const uint32_t> touched;  // triangles that it touched in the last step
};

// Fills `contacts` with the manifolds of a and the triangles of b within settings.speculativeDistance, in a's center
// frame, as Collide does. One-sided triangles push to their front alone, and only what has its center of mass there or
// touched them. The method Libccd asks libccd about each triangle within reach; which of them count as faces, edges and
// corners, and what becomes one manifold, is decided as above.
void CollideSurface(const ConvexShape& a, const SurfaceShape& b, const RelativePose& bInA,
                    const CollideSettings& settings, const SurfaceApproach& approach, SurfaceContacts& contacts);

}  // namespace fulcrum
