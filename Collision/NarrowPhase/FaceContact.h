// Manifold between a face of one polyhedron (the reference face) and the incident feature of the other. Called by
// CollidePolyhedra and the libccd pair function. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/PolyhedronPair.h>

namespace fulcrum {

struct ReferenceFace {
    bool ofA;
    int index;
    float separation;  // m: of the other core from the face's plane, negative if below it
};

ReferenceFace MeasureFace(const PolyhedronPair& pair, bool ofA, int index);

struct FaceContact {
    bool isDeepest;    // the clipped feature is as deep as the other core
    bool proven;       // no axis separates the cores farther than this face's normal, within the tolerance
    int incidentFace;  // of the other core; 0 if it has no faces
};

// Writes the manifold, with the face's normal: the incident face, segment or point of the other core, clipped by the
// sides of the face; at most 4 of the points within tolerances.reach.
FaceContact BuildFaceContact(const PolyhedronPair& pair, const ReferenceFace& face, const ContactTolerances& tolerances,
                             Manifold& manifold);

// Adds points of the adjacent faces, within tolerances.reach along the normal, to a manifold of edges or vertices with
// one or two points. At most 4 points in all.
void AddFacesAhead(const PolyhedronPair& pair, const ContactTolerances& tolerances, Manifold& manifold);

}  // namespace fulcrum
