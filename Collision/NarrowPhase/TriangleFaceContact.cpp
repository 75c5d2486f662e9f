#include <Fulcrum/Collision/NarrowPhase/TriangleFaceContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisProof.h>
#include <Fulcrum/Collision/NarrowPhase/ClippedFeature.h>

namespace fulcrum {

namespace {

// Each side adds one corner at most.
constexpr int kMostClipped = 16;
static_assert(kMostCorners + 3 <= kMostClipped);

}  // namespace

FaceContact BuildTriangleFaceContact(const Polyhedron& core, int incidentFace, const TriangleInShape& triangle,
                                     float separation, const ContactTolerances& tolerances, Manifold& manifold) {
    ClipSide sides[3];
    for (int k = 0; k < 3; ++k) sides[k] = {triangle.outwards[k], Dot(triangle.outwards[k], triangle.corners[k])};
    const ConvexHull::Face& face = core.faces[incidentFace];
    const FaceNames incident{core.indices + face.firstIndex, face.cornerCount}, reference{nullptr, 3};
    ClippedFeature<kMostClipped> clipped;
    clipped.Clip(
        face.cornerCount, [&](int i) { return core.vertices[incident.corners[i]]; }, sides, 3, tolerances.prefer);
    FaceContact result{false, false, incidentFace};
    manifold.pointCount = 0;
    if (clipped.Count() == 0) return result;

    const Vector3& normal = triangle.normal;
    manifold.normal = -normal;
    const float least = clipped.MeasureSeparations(normal, Dot(normal, triangle.corners[0]));
    result.isDeepest = least <= separation + tolerances.prefer;
    if (result.isDeepest) {
        const float radius = separation >= 0 ? 0 : clipped.DiscRadius(sides, 3, least + tolerances.prefer);
        result.proven = NoBetterAxis(triangle.middle, core.innerRadius, manifold.normal, -separation, radius);
    }

    int chosen[4];
    manifold.pointCount =
        clipped.ChooseFourWithin(tolerances.reach, normal, tolerances.prefer, chosen,
                                 WeightsOnSurfaces(tolerances.closing, core.innerRadius + core.radius));
    for (int i = 0; i < manifold.pointCount; ++i) {
        const int c = chosen[i];
        manifold.points[i] = {clipped[c] + manifold.normal * core.radius, clipped.Separation(c) - core.radius,
                              clipped.FeatureOf(c, incident, reference, false)};
    }
    return result;
}

}  // namespace fulcrum
