// Two polyhedra and the pose of one in the other's frame: the Minkowski difference B - A that GJK, EPA and the contact
// builders work on. Its signed distance from the origin is the separation of the two. Used by the narrow phase alone.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/ContactTolerances.h>
#include <Fulcrum/Collision/NarrowPhase/Polyhedron.h>

namespace fulcrum {

// A vertex of the Minkowski difference: vertex b of B minus vertex a of A, in A's frame.
struct MinkowskiVertex {
    using Real = float;

    Vector3 w;
    uint8_t a, b;
    bool SameAs(const MinkowskiVertex& v) const { return a == v.a && b == v.b; }
};

struct PolyhedronPair {
    using Vertex = MinkowskiVertex;

    Polyhedron a, b;
    Matrix3 rotation;  // B's axes in A's frame
    Vector3 position;  // B's center in A's frame

    PolyhedronPair(const Polyhedron& coreA, const Polyhedron& coreB, const RelativePose& bInA)
        : a(coreA), b(coreB), rotation(ToMatrix(bInA.rotation)), position(bInA.position) {}

    Vector3 VertexOfB(int i) const { return rotation * b.vertices[i] + position; }
    Vector3 DirectionInB(const Vector3& n) const { return rotation.TransposeMultiply(n); }
    float InnerRadii() const { return a.innerRadius + b.innerRadius; }
    float RadiusSum() const { return a.radius + b.radius; }
    // The scale of rounding errors, m.
    float Size() const { return Abs(position.x()) + Abs(position.y()) + Abs(position.z()) + a.size + b.size; }
    // The tolerance of EPA's depth, m.
    float DepthTolerance() const { return 1e-6f * Size() + 1e-12f; }

    ContactTolerances Tolerances(const CollideSettings& settings) const {
        return ContactTolerances(a.size + b.size, RadiusSum(), settings);
    }

    // The vertex of the difference that lies least far along n (support function).
    MinkowskiVertex Support(const Vector3& n) const {
        const int ia = FarthestVertex(a, n).index;
        const int ib = FarthestVertex(b, -DirectionInB(n)).index;
        return {VertexOfB(ib) - a.vertices[ia], static_cast<uint8_t>(ia), static_cast<uint8_t>(ib)};
    }
    // Separation of the cores along the unit vector n: negative if their projections overlap.
    float SeparationAlong(const Vector3& n) const {
        return Dot(n, position) - FarthestVertex(b, -DirectionInB(n)).value - FarthestVertex(a, n).value;
    }
};

// The same in double, for cores of so different sizes that floats cannot resolve the closest points of their
// difference.
struct PrecisePolyhedronPair {
    struct Vertex {
        using Real = double;

        Position w;
        uint8_t a, b;
        bool SameAs(const Vertex& v) const { return a == v.a && b == v.b; }
    };

    const PolyhedronPair& pair;

    Vertex Support(const Vector3& n) const {
        const MinkowskiVertex v = pair.Support(n);
        const Position onB = pair.b.vertices[v.b].cast<double>(), onA = pair.a.vertices[v.a].cast<double>();
        const Matrix3& r = pair.rotation;
        const Position rotated =
            r.x.cast<double>() * onB.x() + r.y.cast<double>() * onB.y() + r.z.cast<double>() * onB.z();
        return {rotated + pair.position.cast<double>() - onA, v.a, v.b};
    }
    float SeparationAlong(const Vector3& n) const {
        return static_cast<float>(Dot<double>(n.cast<double>(), Support(n).w));
    }
    float Size() const { return pair.Size(); }
    float DepthTolerance() const { return pair.DepthTolerance(); }
};

}  // namespace fulcrum
