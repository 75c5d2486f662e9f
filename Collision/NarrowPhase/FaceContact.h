// Manifold between a face of one polyhedron and what the other holds against it. Called by CollidePolyhedra and the
// libccd pair function. Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/PolyhedronPair.h>

namespace fulcrum {

struct ReferenceFace {
    bool ofA;
    int index;
    float separation;  // m: of the other core from the face's plane, negative where it dips below
};

ReferenceFace MeasureFace(const PolyhedronPair& pair, bool ofA, int index);

struct FaceContact {
    bool touches;      // the clipped feature's deepest point lies as deep as the other core reaches
    bool proven;       // no axis separates the cores by more than this face does, within the tolerance
    int incidentFace;  // of the other core; 0 where it has none
};

// Writes the manifold, with the face's normal as its normal: the incident face, segment or point of the other core,
// clipped by the sides of the face, of it what lies within tolerances.reach, at most 4 points.
FaceContact BuildFaceContact(const PolyhedronPair& pair, const ReferenceFace& face, const ContactTolerances& tolerances,
                             Manifold& manifold);

// To the one or two points of a manifold that edges or vertices gave, adds those of the faces beside them that lie
// within tolerances.reach along its normal. At most 4 points in all.
void AddFacesAhead(const PolyhedronPair& pair, const ContactTolerances& tolerances, Manifold& manifold);

}  // namespace fulcrum
