// Manifolds of shapes given by support functions and supporting faces, from a known axis of separation or least
// penetration. Called by CollideConvex and, for curved cores, by the libccd pair function. Allocates nothing;
// thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/ContactTolerances.h>
#include <Fulcrum/Collision/NarrowPhase/SimplexSearch.h>
#include <Fulcrum/Collision/NarrowPhase/SupportPair.h>

namespace fulcrum {

// The deepest contact of two cores.
struct KnownContact {
    Vector3 axis;      // unit, from A towards B
    float separation;  // m, of the cores along it
    Vector3 onA;       // the point of A's core that lies closest to B's, or deepest in it, m
};

// The contact of two cores that overlap: GJK's `simplex` around the origin, and the best guess of the axis.
KnownContact FindDepth(const SupportPair& pair, const Simplex<SupportVertex>& simplex, const Vector3& guess);

// Calls visit(axis) with the center line and the axes of both shapes, in both directions: candidates to polish if a
// search fails.
template <class Visitor>
void VisitPlainAxes(const SupportPair& pair, const Visitor& visit) {
    visit(Normalized(pair.position));
    for (int i = 0; i < 3; ++i) {
        const Vector3 ofA = Vector3::Unit(i), ofB = pair.rotation * ofA;
        for (const float sign : {1.0f, -1.0f}) {
            visit(Vector3(ofA * sign));
            visit(Vector3(ofB * sign));
        }
    }
}

// Rotates the axis to the nearest local maximum of the separation, and finds the contact point.
void Polish(const SupportPair& pair, KnownContact& known);

// Writes the manifold and the cache: a face contact if a face normal is nearly as good an axis, otherwise parallel
// edges, or the known point.
void BuildConvexContact(const SupportPair& pair, const KnownContact& known, const ContactTolerances& tolerances,
                        PairCache& cache, Manifold& manifold);

// The points of A's supporting feature over the facing face of B, along that face's normal `-axis`, whether A is
// deepest over it or beside it. No points if B has no such face.
void BuildOverFaceOfB(const SupportPair& pair, const Vector3& axis, const ContactTolerances& tolerances,
                      Manifold& manifold);

// The face that touched in the last step (cache.kind FaceOfA or FaceOfB, cache.axis its normal in its own shape's
// frame), if it is proven to be still the closest feature; then writes the manifold. `axis`: the best guess otherwise.
struct CachedFace {
    bool done;
    Vector3 axis;
};
CachedFace TryCachedFace(const SupportPair& pair, const ContactTolerances& tolerances, const PairCache& cache,
                         Manifold& manifold);

}  // namespace fulcrum
