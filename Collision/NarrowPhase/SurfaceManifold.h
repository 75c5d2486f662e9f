// Manifolds of a convex shape with triangles of a surface, and their merging by direction. Used by SurfaceContact
// alone.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Manifold.h>
#include <Fulcrum/Math/Memory.h>

namespace fulcrum {

struct SurfaceManifold {
    Manifold manifold;
    uint32_t triangle;  // that of the first, deepest contact
    uint8_t material;   // index into the surface's palette
};

// The smallest separation of its points (at least one), m.
inline float DeepestSeparation(const Manifold& manifold) {
    float least = manifold.points[0].separation;
    for (int i = 1; i < manifold.pointCount; ++i) {
        const float separation = manifold.points[i].separation;
        least = separation < least ? separation : least;
    }
    return least;
}

// Appends a slot, reusing one that exists.
SurfaceManifold& AppendManifold(Array<SurfaceManifold>& manifolds, size_t& count);

// Writes manifolds[0 .. count): contacts in nearly the same direction and on the same material become one manifold,
// with the normal of the deepest and at most four of their points. Changes `contacts`. innerRadius: m, of the shape.
// motion: m, of the shape relative to the surface within the step.
void MergeContacts(Array<SurfaceManifold>& contacts, float innerRadius, const Vector3& motion,
                   Array<SurfaceManifold>& manifolds, size_t& count);

}  // namespace fulcrum
