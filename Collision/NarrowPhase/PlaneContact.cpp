#include <Fulcrum/Collision/NarrowPhase/PlaneContact.h>

#include <Fulcrum/Collision/NarrowPhase/ContactTolerances.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>
#include <Fulcrum/Collision/NarrowPhase/Polyhedron.h>

namespace fulcrum {

void CollidePlane(const Plane& plane, const ConvexShape& shape, const RelativePose& bInA, const CollideSettings& settings,
                  Manifold& manifold) {
    manifold.pointCount = 0;
    const float outside = plane.Distance(bInA.position);
    if (outside - shape.OuterRadius() > settings.speculativeDistance) return;
    PolyhedronStorage storage;
    const Polyhedron core = CoreOf(shape, storage);

    // The plane in the shape's frame: the core's vertices need no turning.
    const Vector3 down = InverseRotate(bInA.rotation, Vector3(-plane.Normal()));
    const Vector3 tangentU = Perpendicular(down), tangentV = Cross<float>(down, tangentU);
    const float reach = settings.speculativeDistance + core.radius;
    FlatPoints<256> points;
    uint8_t vertices[256];
    const Wide<8> x(down.x()), y(down.y()), z(down.z()), least(outside - reach);
    for (int block = 0; block < core.laneCount; block += 8) {
        const Wide<8> depth = x * Wide<8>::Load(core.x + block) + y * Wide<8>::Load(core.y + block) +
                              z * Wide<8>::Load(core.z + block);
        for (uint32_t bits = (depth >= least).ToBits(); bits != 0; bits &= bits - 1) {
            const int i = __builtin_ctz(bits);
            if (block + i >= core.vertexCount) break;
            const Vector3& vertex = core.vertices[block + i];
            vertices[points.count] = static_cast<uint8_t>(block + i);
            points.Add(Dot(tangentU, vertex), Dot(tangentV, vertex), outside - depth[i] - core.radius);
        }
    }
    if (points.count == 0) return;
    const ContactTolerances tolerances(core.innerRadius, core.radius, settings);
    int chosen[4];
    const int count = ChooseFour(points, tolerances.prefer, chosen);
    manifold.normal = plane.Normal();
    for (int i = 0; i < count; ++i) {
        const uint32_t vertex = vertices[chosen[i]];
        const Vector3 corner = bInA.Transform(core.vertices[vertex]);
        const float separation = points.separation[chosen[i]];
        const Vector3 onPlane = corner - plane.Normal() * (separation + core.radius);
        manifold.points[manifold.pointCount++] = {onPlane, separation, VertexFeature(false, vertex)};
    }
}

}  // namespace fulcrum
