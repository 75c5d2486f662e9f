// Manifold between a face of one box and the face of another that lies against it. Called by CollideBoxBox.
// Allocates nothing; thread-safe.
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

// Writes at most 4 points of the other box against face `face` (+x, -x, +y, -y, +z, -z) of A or B. False where the
// clipped face does not reach as deep as `separation`, that of the other core from the face's plane: another axis is
// the better one.
bool BuildBoxFaceContact(const BoxPair& pair, bool ofA, int face, float separation, const ContactTolerances& tolerances,
                         Manifold& manifold);

// The same along an axis that lies aslant to the faces, unit, from A towards B: what two edges give. The two faces that
// turn to it most are projected onto each other along it, so that there are points all around the edges' own: a body
// that turns within the step meets the other with its faces.
bool BuildBoxAxisContact(const BoxPair& pair, const Vector3& axis, float separation,
                         const ContactTolerances& tolerances, Manifold& manifold);

}  // namespace fulcrum
