// Two polyhedra and the pose of one in the other's frame: the Minkowski difference B - A that GJK, EPA and the contact
// builders walk on. Its signed distance from the origin is the separation of the two. Used by the narrow phase alone.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/NarrowPhase/Polyhedron.h>

namespace fulcrum {

// A vertex of the Minkowski difference: vertex b of B minus vertex a of A, in A's frame.
struct MinkowskiVertex {
    Vector3 w;
    uint8_t a, b;
};

struct PolyhedronPair {
    Polyhedron a, b;
    Matrix3 rotation;  // B's axes in A's frame
    Vector3 position;  // B's centre in A's frame

    PolyhedronPair(const Polyhedron& coreA, const Polyhedron& coreB, const RelativePose& bInA)
        : a(coreA), b(coreB), rotation(ToMatrix(bInA.rotation)), position(bInA.position) {}

    Vector3 VertexOfB(int i) const { return rotation * b.vertices[i] + position; }
    Vector3 DirectionInB(const Vector3& n) const { return rotation.TransposeMultiply(n); }
    float RadiusSum() const { return a.radius + b.radius; }
    // The scale that rounding errors are measured against, m.
    float Size() const {
        return Abs(position.x()) + Abs(position.y()) + Abs(position.z()) + a.innerRadius + b.innerRadius;
    }

    // The vertex that lies least far along n: the one that says how far the cores are separated along n.
    MinkowskiVertex Support(const Vector3& n) const {
        const int ia = FarthestVertex(a, n).vertex;
        const int ib = FarthestVertex(b, -DirectionInB(n)).vertex;
        return {VertexOfB(ib) - a.vertices[ia], static_cast<uint8_t>(ia), static_cast<uint8_t>(ib)};
    }
    // Separation of the cores along the unit vector n: negative where their shadows on n overlap.
    float SeparationAlong(const Vector3& n) const {
        return Dot(n, position) - FarthestVertex(b, -DirectionInB(n)).value - FarthestVertex(a, n).value;
    }
};

// Tolerances of one query, from the settings and the sizes of the shapes.
struct ContactTolerances {
    float reach;    // m: the cores' separation up to which there are points
    float prefer;   // m: a face contact is taken where its separation is at most this much below the best axis
    float feature;  // m: vertices this close to the extreme one belong to the supporting feature

    ContactTolerances(const PolyhedronPair& pair, const CollideSettings& settings)
        : reach(settings.speculativeDistance + pair.RadiusSum()) {
        const float size = pair.a.innerRadius + pair.b.innerRadius + pair.RadiusSum();
        prefer = Min(0.02f * settings.speculativeDistance, 0.002f * size);
        feature = 1e-4f * size;
    }
};

}  // namespace fulcrum
