#include <Fulcrum/Collision/NarrowPhase/PlaneContact.h>

#include <Fulcrum/Collision/NarrowPhase/ContactTolerances.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>
#include <Fulcrum/Collision/NarrowPhase/Polyhedron.h>
#include <Fulcrum/Collision/Shapes/SupportingFace.h>

#include <algorithm>

namespace fulcrum {

namespace {

// Vertices of a core near the plane, in the shape's frame.
struct NearVertices {
    FlatPoints<256> points;
    Vector3 positions[256];
    uint32_t names[256];
    Vector3 tangentU, tangentV;

    explicit NearVertices(const Vector3& down)
        : tangentU(Perpendicular(down)), tangentV(Cross<float>(down, tangentU)) {}
    void Add(const Vector3& vertex, uint32_t name, float separation) {
        positions[points.count] = vertex;
        names[points.count] = name;
        points.Add(Dot(tangentU, vertex), Dot(tangentV, vertex), separation);
    }
};

// Those of a polyhedron whose depth along `down` is at least `least`; `outside`: distance of the shape's center from
// the plane.
void AddVertices(const Polyhedron& core, const Vector3& down, float outside, float least, NearVertices& near) {
    const Wide<8> x(down.x()), y(down.y()), z(down.z()), lowest(least);
    for (int block = 0; block < core.laneCount; block += 8) {
        const Wide<8> depth =
            x * Wide<8>::Load(core.x + block) + y * Wide<8>::Load(core.y + block) + z * Wide<8>::Load(core.z + block);
        for (uint32_t bits = (depth >= lowest).ToBits(); bits != 0; bits &= bits - 1) {
            const int i = __builtin_ctz(bits);
            if (block + i >= core.vertexCount) break;
            near.Add(core.vertices[block + i], static_cast<uint32_t>(block + i), outside - depth[i] - core.radius);
        }
    }
}

// Manifold reduction: the deepest vertex and those of the face towards the plane first, since a tilted body will land
// on these; if they are fewer than four, the closest of the others. Maximizing the area over all vertices could choose
// points of two sides of a rod and miss the end that touches next.
int ChooseOfFace(const Polyhedron& core, const Vector3& down, const ContactTolerances& tolerances,
                 const NearVertices& near, int (&chosen)[4]) {
    const ConvexHull::Face& face = core.faces[FaceAlong(core, down)];
    const uint8_t* corners = core.indices + face.firstIndex;
    const float* separations = near.points.separation;
    const auto deepest = std::min_element(separations, separations + near.points.count) - separations;
    FlatPoints<256> points;
    int others[256], places[256], otherCount = 0;
    for (int i = 0; i < near.points.count; ++i) {
        const bool isCorner =
            std::find(corners, corners + face.cornerCount, near.names[i]) != corners + face.cornerCount;
        if (!isCorner && i != deepest) {
            others[otherCount++] = i;
            continue;
        }
        places[points.count] = i;
        points.Add(near.points.u[i], near.points.v[i], separations[i]);
    }
    int count = ChooseFour(points, tolerances.prefer, chosen, tolerances.Weights());
    for (int i = 0; i < count; ++i) chosen[i] = places[chosen[i]];
    const int missing = std::min(4 - count, otherCount);
    std::partial_sort(others, others + missing, others + otherCount, [&](int a, int b) {
        return separations[a] < separations[b] || (separations[a] == separations[b] && a < b);
    });
    for (int i = 0; i < missing; ++i) chosen[count++] = others[i];
    return count;
}

// The supporting face, edge or point of a curved core towards the plane.
void AddSupportingFace(const ConvexShape& shape, const Vector3& down, float outside, float least, NearVertices& near) {
    SupportingFace face;
    shape.FindSupportingFace(down, face);
    const auto add = [&](const Vector3& vertex, uint16_t name) {
        const float depth = Dot(down, vertex);
        if (depth >= least) near.Add(vertex, name, outside - depth - shape.ConvexRadius());
    };
    for (int i = 0; i < face.count; ++i) add(face.vertices[i], face.names[i]);
    if (face.hasAhead) add(face.ahead, face.aheadName);
}

}  // namespace

void CollidePlane(const Plane& plane, const ConvexShape& shape, const RelativePose& bInA,
                  const CollideSettings& settings, Manifold& manifold) {
    manifold.pointCount = 0;
    const float outside = plane.Distance(bInA.position), radius = shape.ConvexRadius();
    if (outside - shape.OuterRadius() > settings.speculativeDistance) return;

    // In the shape's frame, so that the core's vertices need not be rotated.
    const Vector3 down = InverseRotate(bInA.rotation, Vector3(-plane.Normal()));
    const float least = outside - (settings.speculativeDistance + radius);
    NearVertices near(down);
    const ContactTolerances tolerances(Max(0.0f, shape.InnerRadius() - radius), radius, settings);
    int chosen[4], count = 0;
    if (HasPolyhedralCore(shape.Type())) {
        PolyhedronStorage storage;
        const Polyhedron core = CoreOf(shape, storage);
        AddVertices(core, down, outside, least, near);
        if (near.points.count > 4 && core.faceCount > 0) count = ChooseOfFace(core, down, tolerances, near, chosen);
    } else {
        AddSupportingFace(shape, down, outside, least, near);
    }
    if (near.points.count == 0) return;
    if (count == 0) count = ChooseFour(near.points, tolerances.prefer, chosen, tolerances.Weights());
    manifold.normal = plane.Normal();
    for (int i = 0; i < count; ++i) {
        const Vector3 corner = bInA.Transform(near.positions[chosen[i]]);
        const float separation = near.points.separation[chosen[i]];
        const Vector3 onPlane = corner - plane.Normal() * (separation + radius);
        manifold.points[manifold.pointCount++] = {onPlane, separation, VertexFeature(false, near.names[chosen[i]])};
    }
}

void CollideWithPlane(const Plane& plane, const ConvexShape& shape, const RelativePose& planeInShape,
                      const CollideSettings& settings, Manifold& manifold) {
    CollidePlane(plane, shape, Inverse(planeInShape), settings, manifold);
    for (int i = 0; i < manifold.pointCount; ++i) {
        ManifoldPoint& point = manifold.points[i];
        point.positionOnA = planeInShape.Transform(point.positionOnA + manifold.normal * point.separation);
    }
    manifold.normal = -Rotate(planeInShape.rotation, manifold.normal);
}

}  // namespace fulcrum
