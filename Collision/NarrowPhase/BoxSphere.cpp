// Pair function of a box and a sphere: the point of the box's core closest to the sphere's center.
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

void CollideBoxSphere(const PairQuery& query, Manifold& manifold) {
    const auto& box = static_cast<const Box&>(query.a);
    const auto& sphere = static_cast<const Sphere&>(query.b);
    const float rounding = box.ConvexRadius();
    const Vector3 half = box.HalfExtents() - Vector3::Constant(rounding);
    const Vector3 center = query.bInA.position;
    Vector3 closest = center.cwiseMax(-half).cwiseMin(half);
    Vector3 between = center - closest;
    const float squared = LengthSquared(between);
    const float reach = rounding + sphere.Radius() + query.settings.speculativeDistance;
    manifold.pointCount = 0;
    if (squared > reach * reach) return;

    float distance = Sqrt(squared);
    if (distance > 1e-6f * (half.x() + half.y() + half.z())) {
        manifold.normal = between * (1.0f / distance);
    } else {
        // The center is inside: use the nearest face.
        int axis = 0;
        for (int i = 1; i < 3; ++i)
            if (half[i] - Abs(center[i]) < half[axis] - Abs(center[axis])) axis = i;
        const float side = center[axis] < 0 ? -1.0f : 1.0f;
        manifold.normal = Vector3::Zero();
        manifold.normal[axis] = side;
        distance = Abs(center[axis]) - half[axis];
        closest[axis] = side * half[axis];
    }
    manifold.pointCount = 1;
    manifold.points[0] = {closest + manifold.normal * rounding, distance - rounding - sphere.Radius(),
                          VertexFeature(false, 0)};
}

}  // namespace fulcrum
