// Contacts of a convex shape with a surface of triangles: as many manifolds as there are directions to be pushed in,
// without those that only an edge between two triangles would make (InternalEdges.h). Called by the Collide stage, from
// many threads at once, each with a SurfaceContacts of its own.
//
// Each triangle that the shape may reach is collided by itself. Contacts in nearly the same direction, on the same
// material, become one manifold of at most four points (SurfaceManifold.h). Fast bodies get one for the ball inside
// them besides (InnerBall.h). What touched a face stays before it even if a heavier body presses its center through.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/NarrowPhase/InternalEdges.h>

namespace fulcrum {

// Buffers that are used again from call to call, so that they need not be allocated.
class SurfaceContacts {
public:
    // Of the last call, in an order that depends on the shapes and poses alone.
    std::span<const SurfaceManifold> Manifolds() const { return {manifolds_.data(), manifoldCount_}; }
    // Of the surface, that were tested.
    size_t TriangleCount() const { return views_.size(); }
    size_t MemoryUsed() const;  // bytes, besides the object itself

private:
    friend class SurfaceCollider;

    std::vector<uint32_t> ids_;
    std::vector<TriangleView> views_;
    InternalEdgeFilter filter_;
    std::vector<SurfaceManifold> manifolds_;
    size_t manifoldCount_ = 0;
};

struct SurfaceApproach {
    Vector3 motion =
        Vector3::Zero();  // m, of the shape's center relative to the surface within the step, in its center frame
    std::span<const uint32_t> touched;  // triangles that it touched in the last step
};

// Fills `contacts` with the manifolds of a and the triangles of b within settings.speculativeDistance, in a's center
// frame, as Collide does. One-sided triangles push to their front alone, and only what has its center of mass there or
// touched them.
void CollideSurface(const ConvexShape& a, const SurfaceShape& b, const RelativePose& bInA,
                    const CollideSettings& settings, const SurfaceApproach& approach, SurfaceContacts& contacts);

}  // namespace fulcrum
