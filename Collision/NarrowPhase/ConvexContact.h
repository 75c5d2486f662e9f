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

// Calls visit(axis) with the line between the centers and with the axes of both shapes, to both sides: where a search
// gives up, one of them is a start to polish.
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

// Turns the axis to where it separates the cores the farthest nearby, or overlaps them the least, and finds the point.
void Polish(const SupportPair& pair, KnownContact& known);

// Writes the manifold and the cache: a face contact if a face normal is nearly as good an axis, otherwise parallel
// edges, or the known point.
void BuildConvexContact(const SupportPair& pair, const KnownContact& known, const ContactTolerances& tolerances,
                        PairCache& cache, Manifold& manifold);

// The points of A's supporting feature over the face of B that faces it, along that face's normal `-axis`, be it
// deepest there or beside it. Without points where B has no such face.
void BuildOverFaceOfB(const SupportPair& pair, const Vector3& axis, const ContactTolerances& tolerances,
                      Manifold& manifold);

// The face that touched in the last step (cache.kind FaceOfA or FaceOfB, cache.axis its normal in its own shape's
// frame), if it is proven to be the closest feature still; writes the manifold then. `axis`: the best guess otherwise.
struct CachedFace {
    bool done;
    Vector3 axis;
};
CachedFace TryCachedFace(const SupportPair& pair, const ContactTolerances& tolerances, const PairCache& cache,
                         Manifold& manifold);

}  // namespace fulcrum
