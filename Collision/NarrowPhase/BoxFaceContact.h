// Manifold between a face of one box and the incident face of another. Called by CollideBoxBox. Allocates nothing;
// thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/ContactTolerances.h>
#include <Fulcrum/Math/Matrix.h>

namespace fulcrum {

// The cores of two boxes, the second in the frame of the first.
struct BoxPair {
    Vector3 halfA, halfB;
    float radiusA, radiusB;
    Matrix3 rotation;     // B's axes in A's frame
    Matrix3 transposed;   // A's axes in B's frame
    Vector3 position;     // B's center in A's frame
    Vector3 positionInB;  // the same vector in B's frame
};

// Writes at most 4 points of the other box against face `face` (+x, -x, +y, -y, +z, -z) of A or B. Returns false if the
// clipped face is not as deep as `separation`, that of the other core from the face's plane: another axis is better
// then.
bool BuildBoxFaceContact(const BoxPair& pair, bool ofA, int face, float separation, const ContactTolerances& tolerances,
                         Manifold& manifold);

// The same for the axis of two edges (unit, from A towards B). The two faces most nearly perpendicular to it are
// projected onto each other along it. This gives points around that of the edges: a body that turns within the step
// lands on its faces.
bool BuildBoxAxisContact(const BoxPair& pair, const Vector3& axis, float separation,
                         const ContactTolerances& tolerances, Manifold& manifold);

}  // namespace fulcrum
