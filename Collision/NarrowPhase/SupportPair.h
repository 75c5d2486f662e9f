// Two convex shapes given by their support functions, and the pose of one in the other's frame: the Minkowski
// difference B - A of their cores, for GJK and EPA. Used by the narrow phase and the queries; lives on the stack of one
// call.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>
#include <Fulcrum/Math/Matrix.h>
#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

// A point of B's core minus a point of A's, in A's frame. In double: simplices of curved cores become ever thinner, too
// thin for float to give the axis.
struct SupportVertex {
    using Real = double;

    Position w;
    Vector3 onA, onB;
    bool SameAs(const SupportVertex& v) const { return onA == v.onA && onB == v.onB; }
};

struct SupportPair {
    using Vertex = SupportVertex;

    const ConvexShape& a;
    const ConvexShape& b;
    Matrix3 rotation;  // B's axes in A's frame
    Vector3 position;  // B's center in A's frame

    SupportPair(const ConvexShape& shapeA, const ConvexShape& shapeB, const RelativePose& bInA)
        : a(shapeA), b(shapeB), rotation(ToMatrix(bInA.rotation)), position(bInA.position) {}

    Vector3 DirectionInB(const Vector3& n) const { return rotation.TransposeMultiply(n); }
    Vector3 PointOfB(const Vector3& local) const { return rotation * local + position; }
    float RadiusSum() const { return a.ConvexRadius() + b.ConvexRadius(); }
    // Sum of the radii of the balls inside the two cores, m.
    float InnerRadii() const {
        return Max(0.0f, a.InnerRadius() - a.ConvexRadius()) + Max(0.0f, b.InnerRadius() - b.ConvexRadius());
    }
    // The scale of rounding errors, m.
    float Size() const { return Abs(position.x()) + Abs(position.y()) + Abs(position.z()) + InnerRadii(); }
    // The tolerance of EPA's depth, m: for curved cores it only converges. Of a small shape on a large one it follows
    // the small one, down to the rounding errors of the large one.
    float DepthTolerance() const {
        constexpr float kTolerance = 3e-5f, kRounding = 1e-6f;
        const float smaller = 32 * Min(a.OuterRadius(), b.OuterRadius()), size = Size();
        return Max(kTolerance * Min(size, smaller), kRounding * size) + 1e-12f;
    }

    // The point of the difference that lies least far along n (support function).
    SupportVertex Support(const Vector3& n) const {
        const Vector3 onA = a.SupportCore(n), onB = PointOfB(b.SupportCore(-DirectionInB(n)));
        return {onB.cast<double>() - onA.cast<double>(), onA, onB};
    }
    // Separation of the cores along the unit vector n: negative if their projections overlap.
    float SeparationAlong(const Vector3& n) const {
        const Vector3 inB = DirectionInB(n);
        return Dot(n, position) + Dot(inB, b.SupportCore(-inB)) - Dot(n, a.SupportCore(n));
    }
};

}  // namespace fulcrum
