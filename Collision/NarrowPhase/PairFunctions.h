// The pair functions that the pair table names. Each writes the manifold of its two shapes, in the first one's frame.
// Called by Collide; thread-safe; none but the libccd ones allocates.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Shapes/Plane.h>

namespace fulcrum {

// The arguments of a pair function besides the manifold.
struct PairQuery {
    const ConvexShape& a;
    const ConvexShape& b;
    const RelativePose& bInA;
    const CollideSettings& settings;
    PairCache& cache;
    CollideCounters& counters;
};

using PairFunction = void (*)(const PairQuery& query, Manifold& manifold);

void CollideSphereSphere(const PairQuery& query, Manifold& manifold);
void CollideCapsuleSphere(const PairQuery& query, Manifold& manifold);
void CollideCapsuleCapsule(const PairQuery& query, Manifold& manifold);
void CollideBoxSphere(const PairQuery& query, Manifold& manifold);
void CollideBoxBox(const PairQuery& query, Manifold& manifold);
// Any two of sphere, capsule, box, hull and triangle of which one at least is a box, a hull or a triangle.
void CollidePolyhedra(const PairQuery& query, Manifold& manifold);
// Any two; the only one for curved cores.
void CollideConvex(const PairQuery& query, Manifold& manifold);
// Any two, by libccd: what NarrowPhaseMethod::Libccd calls in place of the table.
void CollideLibccd(const PairQuery& query, Manifold& manifold);
// The shape (A) and a half space, by libccd: the half space is replaced by a block larger than the shape.
void CollideWithPlaneByLibccd(const Plane& plane, const ConvexShape& shape, const RelativePose& planeInShape,
                              const CollideSettings& settings, PairCache& cache, Manifold& manifold,
                              CollideCounters& counters);

}  // namespace fulcrum
