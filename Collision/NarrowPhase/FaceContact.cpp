#include <Fulcrum/Collision/NarrowPhase/FaceContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisProof.h>
#include <Fulcrum/Collision/NarrowPhase/Clipping.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/PointsAhead.h>

#include <algorithm>

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
            const Matrix3& r = pair.rotation;
            rotation = {Vector3(r.x.x(), r.y.x(), r.z.x()), Vector3(r.x.y(), r.y.y(), r.z.y()),
                        Vector3(r.x.z(), r.y.z(), r.z.z())};
            position = -r.TransposeMultiply(pair.position);
        }
    }
    Vector3 IncidentVertex(int i) const { return rotation * incident.vertices[i] + position; }
};

// The planes through the sides of the reference face, side i from corner i to the next.
struct FaceSides {
    ClipSide planes[256];

    explicit FaceSides(const FaceView& view) {
        const int count = view.face.cornerCount;
        for (int i = 0; i < count; ++i) {
            const Vector3& from = view.reference.vertices[view.corners[i]];
            const Vector3& to = view.reference.vertices[view.corners[i + 1 == count ? 0 : i + 1]];
            const Vector3 outwards = Cross<float>(Vector3(to - from), view.face.normal);
            const float length = Length(outwards);
            // A box rounded to its middle plane has sides of no length, which cut nothing off.
            planes[i].normal = outwards * (length > 1e-12f ? 1.0f / length : 0.0f);
            planes[i].offset = Dot(planes[i].normal, from);
        }
    }
    const ClipSide& operator[](int i) const { return planes[i]; }
};

// The other polyhedron's feature that faces the reference, and what clipping leaves of it.
class ClippedFeature {
public:
    ClippedFeature(const FaceView& view, const FaceSides& sides, float slop);

    int Count() const { return count_; }
    int IncidentFace() const { return incidentFace_; }
    const ClipVertex& operator[](int i) const { return current_[i]; }
    uint32_t Feature(int i, bool referenceOfA) const;

private:
    void ClipPolygon(const FaceSides& sides, float slop);
    void ClipSegment(const FaceSides& sides, float slop);
    uint32_t IncidentCorner(uint32_t i) const { return corners_ != nullptr ? corners_[i] : i; }
    uint32_t IncidentEdge(uint32_t i) const {
        return EdgeName(IncidentCorner(i), IncidentCorner(i + 1 == static_cast<uint32_t>(cornerCount_) ? 0 : i + 1));
    }

    const FaceView& view_;
    const uint8_t* corners_ = nullptr;  // of the incident face
    int cornerCount_ = 0;
    int incidentFace_ = 0;
    int count_ = 0;
    ClipVertex* current_ = first_;
    ClipVertex first_[kMaxClipVertices];
    ClipVertex second_[kMaxClipVertices];
};

ClippedFeature::ClippedFeature(const FaceView& view, const FaceSides& sides, float slop) : view_(view) {
    const Polyhedron& incident = view.incident;
    if (incident.faceCount > 0) {
        incidentFace_ = FaceAlong(incident, -view.rotation.TransposeMultiply(view.face.normal));
        const ConvexHull::Face& face = incident.faces[incidentFace_];
        corners_ = incident.indices + face.firstIndex;
        cornerCount_ = face.cornerCount;
    } else {
        cornerCount_ = incident.vertexCount;
    }
    count_ = cornerCount_;
    for (int i = 0; i < count_; ++i) {
        first_[i].position = view.IncidentVertex(static_cast<int>(IncidentCorner(i)));
        first_[i].label = static_cast<uint32_t>(i);
    }
    if (count_ > 2) ClipPolygon(sides, slop);
    else ClipSegment(sides, slop);
}

void ClippedFeature::ClipPolygon(const FaceSides& sides, float slop) {
    ClipVertex* spare = second_;
    float outside[kMaxClipVertices];
    for (int k = 0; k < view_.face.cornerCount && count_ > 0; ++k) {
        bool cuts = false;
        for (int i = 0; i < count_; ++i) {
            outside[i] = Dot(sides[k].normal, current_[i].position) - sides[k].offset;
            cuts |= outside[i] > slop;
        }
        if (!cuts) continue;
        count_ = ClipBySide(current_, count_, outside, kSideLabel + static_cast<uint32_t>(k), slop, spare);
        std::swap(current_, spare);
    }
}

void ClippedFeature::ClipSegment(const FaceSides& sides, float slop) {
    if (count_ == 1) current_[1] = current_[0];
    int left = 2;
    for (int k = 0; k < view_.face.cornerCount && left > 0; ++k)
        left = ClipSegmentBySide(current_, sides[k], kSideLabel + static_cast<uint32_t>(k), slop);
    count_ = left == 0 ? 0 : count_;
}

uint32_t ClippedFeature::Feature(int i, bool referenceOfA) const {
    const uint32_t starts = current_[i].label;
    const auto crossing = [&](uint32_t incidentEdge, uint32_t side) {
        const uint32_t next = side + 1 == view_.face.cornerCount ? 0 : side + 1;
        const uint32_t referenceEdge = EdgeName(view_.corners[side], view_.corners[next]);
        return referenceOfA ? CrossingFeature(referenceEdge, incidentEdge)
                            : CrossingFeature(incidentEdge, referenceEdge);
    };
    if (cornerCount_ <= 2) {  // ends of a segment
        if (starts < kSideLabel) return VertexFeature(!referenceOfA, starts);
        return crossing(EdgeName(0, 1), starts - kSideLabel);
    }
    const uint32_t ends = current_[i == 0 ? count_ - 1 : i - 1].label;
    if (starts < kSideLabel && ends < kSideLabel) return VertexFeature(!referenceOfA, IncidentCorner(starts));
    if (starts < kSideLabel) return crossing(IncidentEdge(starts), ends - kSideLabel);
    if (ends < kSideLabel) return crossing(IncidentEdge(ends), starts - kSideLabel);
    // Two sides meet: a corner of the reference face, which begins the later of the two.
    const uint32_t low = std::min(starts, ends) - kSideLabel, high = std::max(starts, ends) - kSideLabel;
    const bool wraps = low == 0 && high + 1 == view_.face.cornerCount;
    return VertexFeature(referenceOfA, view_.corners[wraps ? 0 : high]);
}

// How far inside all sides of the face the middle of the deepest points lies: a disc of that radius about it, in the
// reference face's plane, belongs to the Minkowski difference.
float DiscRadius(const FaceView& view, const FaceSides& sides, const ClippedFeature& feature, float deepEnough) {
    Vector3 middle = Vector3::Zero();
    float count = 0;
    for (int i = 0; i < feature.Count(); ++i) {
        if (Dot(view.face.normal, feature[i].position) - view.face.offset > deepEnough) continue;
        middle += feature[i].position;
        count += 1;
    }
    middle *= 1.0f / count;
    float radius = sides[0].offset - Dot(sides[0].normal, middle);
    for (int k = 1; k < view.face.cornerCount; ++k)
        radius = Min(radius, sides[k].offset - Dot(sides[k].normal, middle));
    return radius;
}

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
    const FaceSides sides(view);
    const ClippedFeature feature(view, sides, tolerances.prefer);
    FaceContact result{false, false, feature.IncidentFace()};
    manifold.pointCount = 0;
    if (feature.Count() == 0) return result;

    const Vector3 normal = view.face.normal;
    manifold.normal = face.ofA ? normal : Vector3(-(pair.rotation * normal));
    FlatPoints<kMaxClipVertices> points;
    int near[kMaxClipVertices];
    const Vector3 tangentU = Perpendicular(normal), tangentV = Cross<float>(normal, tangentU);
    float least = 0;
    for (int i = 0; i < feature.Count(); ++i) {
        const float separation = Dot(normal, feature[i].position) - view.face.offset;
        if (i == 0 || separation < least) least = separation;
        if (separation > tolerances.reach) continue;
        near[points.count] = i;
        points.Add(Dot(tangentU, feature[i].position), Dot(tangentV, feature[i].position), separation);
    }
    result.touches = least <= face.separation + tolerances.prefer;
    if (result.touches) {
        const float radius = face.separation >= 0 ? 0 : DiscRadius(view, sides, feature, least + tolerances.prefer);
        result.proven = NoBetterAxis(pair, manifold.normal, -face.separation, radius);
    }

    int chosen[4];
    const int count = ChooseFour(points, tolerances.prefer, chosen);
    manifold.pointCount = count;
    for (int i = 0; i < count; ++i) {
        const int c = chosen[i];
        const Vector3& x = feature[near[c]].position;
        ManifoldPoint& point = manifold.points[i];
        const Vector3 onCore =
            face.ofA ? Vector3(x - normal * points.separation[c]) : Vector3(pair.rotation * x + pair.position);
        point.positionOnA = onCore + manifold.normal * pair.a.radius;
        point.separation = points.separation[c] - pair.RadiusSum();
        point.feature = feature.Feature(near[c], face.ofA);
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
    const FaceSides sides(view);
    const ClippedFeature feature(view, sides, tolerances.prefer);
    // Points of the clipped feature, projected along n.
    const auto pointAt = [&](int i) {
        const Vector3& x = feature[i].position;
        const float separation = (Dot(view.face.normal, x) - view.face.offset) / cosine;
        const Vector3 onCore = face.ofA ? Vector3(x - n * separation) : Vector3(pair.rotation * x + pair.position);
        return ManifoldPoint{onCore + n * pair.a.radius, separation - pair.RadiusSum(), feature.Feature(i, face.ofA)};
    };
    AddPointsAhead<kMaxClipVertices>(feature.Count(), pointAt, tolerances.reach - pair.RadiusSum(), tolerances.Apart(),
                                     tolerances.prefer, manifold);
}

}  // namespace fulcrum
