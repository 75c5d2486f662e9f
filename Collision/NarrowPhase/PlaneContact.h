// The contact of a half space with a convex shape, in closed form. Called for pairs of which one is a Plane.
// Thread-safe, allocates nothing.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Shapes/Plane.h>

namespace fulcrum {

// Writes the manifold of the plane (A) and the shape (B), `bInA` being the pose of the shape's center frame in the
// plane's frame. The normal is the plane's. At most 4 points, chosen for area and depth of all vertices of the core
// (Polyhedron.h) that lie within the speculative distance; for a curved core, of those of its supporting face, edge or
// point.
void CollidePlane(const Plane& plane, const ConvexShape& shape, const RelativePose& bInA,
                  const CollideSettings& settings, Manifold& manifold);

// The same with the shape as A and the plane as B.
void CollideWithPlane(const Plane& plane, const ConvexShape& shape, const RelativePose& planeInShape,
                      const CollideSettings& settings, Manifold& manifold);

}  // namespace fulcrum
