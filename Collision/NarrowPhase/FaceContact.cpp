#include <Fulcrum/Collision/NarrowPhase/FaceContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisProof.h>
#include <Fulcrum/Collision/NarrowPhase/ClippedFeature.h>
#include <Fulcrum/Collision/NarrowPhase/PointsAhead.h>

namespace fulcrum {

namespace {

// The pair as seen from the reference face's polyhedron: its own frame, and the other's pose in it.
struct FaceView {
    const Polyhedron& reference;
    const Polyhedron& incident;
    Matrix3 rotation;  // the incident polyhedron's axes
    Vector3 position;  // its center
    const ConvexHull::Face& face;
    const uint8_t* corners;

    FaceView(const PolyhedronPair& pair, const ReferenceFace& f)
        : reference(f.ofA ? pair.a : pair.b),
          incident(f.ofA ? pair.b : pair.a),
          face(reference.faces[f.index]),
          corners(reference.indices + face.firstIndex) {
        if (f.ofA) {
            rotation = pair.rotation;
            position = pair.position;
        } else {
            rotation = pair.rotation.Transposed();
            position = -pair.rotation.TransposeMultiply(pair.position);
        }
    }
    // Corner of the reference face; the index wraps around.
    const Vector3& Corner(int i) const { return reference.vertices[corners[i == face.cornerCount ? 0 : i]]; }
    FaceNames Names() const { return {corners, face.cornerCount}; }
    Vector3 IncidentVertex(int i) const { return rotation * incident.vertices[i] + position; }
};

constexpr int kMostSides = 255, kMostClipped = 512;
using Clipped = ClippedFeature<kMostClipped>;

// The reference face's sides, and the other polyhedron's incident feature clipped by them.
struct FaceClip {
    ClipSide sides[kMostSides];
    int sideCount;
    int incidentFace = 0;  // 0 if the other has no faces
    FaceNames names;       // of the incident feature
    Clipped clipped;

    FaceClip(const FaceView& view, float slop) : sideCount(view.face.cornerCount) {
        for (int i = 0; i < sideCount; ++i) sides[i] = SideOfFace(view.Corner(i), view.Corner(i + 1), view.face.normal);
        const Polyhedron& incident = view.incident;
        names = {nullptr, static_cast<uint32_t>(incident.vertexCount)};
        if (incident.faceCount > 0) {
            incidentFace = FaceAlong(incident, -view.rotation.TransposeMultiply(view.face.normal));
            const ConvexHull::Face& face = incident.faces[incidentFace];
            names = {incident.indices + face.firstIndex, face.cornerCount};
        }
        clipped.Clip(
            static_cast<int>(names.count),
            [&](int i) { return view.IncidentVertex(static_cast<int>(names.Vertex(static_cast<uint32_t>(i)))); }, sides,
            sideCount, slop);
    }
    uint32_t FeatureOf(int i, const FaceView& view, bool referenceOfA) const {
        return clipped.FeatureOf(i, names, view.Names(), referenceOfA);
    }
};

}  // namespace

ReferenceFace MeasureFace(const PolyhedronPair& pair, bool ofA, int index) {
    if (ofA) {
        const ConvexHull::Face& face = pair.a.faces[index];
        const Extreme e = FarthestVertex(pair.b, -pair.DirectionInB(face.normal));
        return {true, index, Dot(face.normal, pair.position) - e.value - face.offset};
    }
    const ConvexHull::Face& face = pair.b.faces[index];
    const Extreme e = FarthestVertex(pair.a, -(pair.rotation * face.normal));
    return {false, index, -Dot(face.normal, pair.rotation.TransposeMultiply(pair.position)) - e.value - face.offset};
}

FaceContact BuildFaceContact(const PolyhedronPair& pair, const ReferenceFace& face, const ContactTolerances& tolerances,
                             Manifold& manifold) {
    const FaceView view(pair, face);
    FaceClip clip(view, tolerances.prefer);
    Clipped& clipped = clip.clipped;
    FaceContact result{false, false, clip.incidentFace};
    manifold.pointCount = 0;
    if (clipped.Count() == 0) return result;

    const Vector3 normal = view.face.normal;
    manifold.normal = face.ofA ? normal : Vector3(-(pair.rotation * normal));
    const float least = clipped.MeasureSeparations(normal, view.face.offset);
    result.isDeepest = least <= face.separation + tolerances.prefer;
    if (result.isDeepest) {
        const float radius =
            face.separation >= 0 ? 0 : clipped.DiscRadius(clip.sides, clip.sideCount, least + tolerances.prefer);
        result.proven = NoBetterAxis(pair.position, pair.InnerRadii(), manifold.normal, -face.separation, radius);
    }

    int chosen[4];
    manifold.pointCount =
        clipped.ChooseFourWithin(tolerances.reach, normal, tolerances.prefer, chosen, tolerances.Weights());
    for (int i = 0; i < manifold.pointCount; ++i) {
        const int c = chosen[i];
        const Vector3& x = clipped[c];
        const float separation = clipped.Separation(c);
        const Vector3 onCore = face.ofA ? Vector3(x - normal * separation) : Vector3(pair.rotation * x + pair.position);
        manifold.points[i] = {onCore + manifold.normal * pair.a.radius, separation - pair.RadiusSum(),
                              clip.FeatureOf(c, view, face.ofA)};
    }
    return result;
}

void AddFacesAhead(const PolyhedronPair& pair, const ContactTolerances& tolerances, Manifold& manifold) {
    if (!tolerances.facesAhead || manifold.pointCount == 0 || manifold.pointCount > 2) return;
    const Vector3 n = manifold.normal;
    float cosine = kLeastCosineAhead;
    ReferenceFace face{false, -1, 0};
    for (const bool ofA : {true, false}) {
        const Polyhedron& p = ofA ? pair.a : pair.b;
        if (p.faceCount == 0) continue;
        const Vector3 towards = ofA ? n : Vector3(-pair.DirectionInB(n));
        const int index = FaceAlong(p, towards);
        const float cosineOfThis = Dot(p.faces[index].normal, towards);
        if (!(cosineOfThis > cosine)) continue;
        cosine = cosineOfThis;
        face = {ofA, index, 0};
    }
    if (face.index < 0) return;

    const FaceView view(pair, face);
    const FaceClip clip(view, tolerances.prefer);
    // Points of the clipped feature, projected along n.
    const auto pointAt = [&](int i) {
        const Vector3& x = clip.clipped[i];
        const float separation = (Dot(view.face.normal, x) - view.face.offset) / cosine;
        const Vector3 onCore = face.ofA ? Vector3(x - n * separation) : Vector3(pair.rotation * x + pair.position);
        return ManifoldPoint{onCore + n * pair.a.radius, separation - pair.RadiusSum(),
                             clip.FeatureOf(i, view, face.ofA)};
    };
    AddPointsAhead<kMostClipped>(clip.clipped.Count(), pointAt, tolerances.reach - pair.RadiusSum(), tolerances.Apart(),
                                 tolerances.prefer, tolerances.Weights(), manifold);
}

}  // namespace fulcrum
