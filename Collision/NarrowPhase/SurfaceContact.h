// Contacts of a convex shape with a surface of triangles: one manifold per contact normal and material, without
// contacts of internal edges (InternalEdges.h). Called by the Collide stage, from many threads at once, each with a
// SurfaceContacts of its own.
//
// Each triangle within reach is collided separately. Contacts with nearly the same normal, on the same material, are
// merged into one manifold of at most four points (SurfaceManifold.h). Fast bodies get an additional one for their
// inner ball (InnerBall.h). A face touched in the last step, or a neighbor of it, still pushes to its front if the
// center was forced through it (tunneled).
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/NarrowPhase/InternalEdges.h>

namespace fulcrum {

// Results and buffers, which are reused from call to call.
class SurfaceContacts {
public:
    // Results of the last call, in an order that depends only on shapes and poses.
    std::span<const SurfaceManifold> Manifolds() const { return {manifolds_.data(), manifoldCount_}; }
    // Triangles of the surface that were tested.
    size_t TriangleCount() const { return views_.size(); }
    // libccd's failures in the last call, with the method Libccd.
    const CollideCounters& Counters() const { return counters_; }
    size_t MemoryUsed() const;  // bytes, besides the object itself

private:
    friend class SurfaceCollider;

    Array<uint32_t> ids_;
    Array<TriangleView> views_;
    Array<TriangleView> touched_;  // in the last step
    InternalEdgeFilter filter_;
    Array<SurfaceManifold> manifolds_;
    size_t manifoldCount_ = 0;
    CollideCounters counters_;
};

struct SurfaceApproach {
    Vector3 motion =
        Vector3::Zero();  // m, of the shape's center relative to the surface within the step, in its center frame
    std::span<const uint32_t> touched;  // ids of triangles with contacts in the last step
};

// Fills `contacts` with the manifolds of a and the triangles of b within settings.speculativeDistance, in a's center
// frame, as Collide does. One-sided triangles only push to their front, and only shapes whose center of mass is there,
// or that touched them or a neighbor in the last step. With the method Libccd, libccd computes the contact with each
// triangle within reach; classification as face, edge or corner and merging are as above.
void CollideSurface(const ConvexShape& a, const SurfaceShape& b, const RelativePose& bInA,
                    const CollideSettings& settings, const SurfaceApproach& approach, SurfaceContacts& contacts);

}  // namespace fulcrum
