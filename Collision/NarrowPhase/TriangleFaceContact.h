// BuildFaceContact for the triangles of a surface as reference faces, in the frame of the shape, where the shape's
// vertices need no transformation. Called by SurfaceContact. Thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/FaceContact.h>

namespace fulcrum {

// A triangle in the frame of a shape, m.
struct TriangleInShape {
    Vector3 corners[3];
    Vector3 normal;       // unit, to the shape's side
    Vector3 outwards[3];  // unit, at right angles to side i, from corner i to the next, and to the normal
    Vector3 middle;       // the centroid
};

// `separation`: of the core from the face's plane, m. Faces of the core that have more than kMostCorners corners are
// for BuildFaceContact.
inline constexpr int kMostCorners = 12;
FaceContact BuildTriangleFaceContact(const Polyhedron& core, int incidentFace, const TriangleInShape& triangle,
                                     float separation, const ContactTolerances& tolerances, Manifold& manifold);

}  // namespace fulcrum
