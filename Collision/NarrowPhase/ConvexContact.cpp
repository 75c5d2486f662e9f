#include <Fulcrum/Collision/NarrowPhase/ConvexContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisProof.h>
#include <Fulcrum/Collision/NarrowPhase/Clipping.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/PointsAhead.h>
#include <Fulcrum/Collision/NarrowPhase/Segments.h>
#include <Fulcrum/Collision/Shapes/SupportingFace.h>

#include <algorithm>

namespace fulcrum {

namespace {

constexpr int kMostClipped = 2 * SupportingFace::kMaxVertices;

// What of A, or of B, faces `direction`; all in A's frame.
void FindFace(const SupportPair& pair, bool ofA, const Vector3& direction, SupportingFace& face) {
    if (ofA) return pair.a.FindSupportingFace(direction, face);
    pair.b.FindSupportingFace(pair.DirectionInB(direction), face);
    for (int i = 0; i < face.count; ++i) face.vertices[i] = pair.PointOfB(face.vertices[i]);
    if (face.count > 2) face.normal = pair.rotation * face.normal;
}

struct ReferenceSide {
    bool ofA;
    SupportingFace face;
    Vector3 axis;      // from A towards B: the face's normal, or against it
    float separation;  // m, of the cores along the axis
};

ReferenceSide MakeReference(const SupportPair& pair, bool ofA, const SupportingFace& face) {
    ReferenceSide reference{ofA, face, ofA ? face.normal : Vector3(-face.normal), 0};
    reference.separation = pair.SeparationAlong(reference.axis);
    return reference;
}

// The plane through side i of the face, from vertex i to the next.
ClipSide SideOf(const SupportingFace& face, int i) {
    const Vector3& from = face.vertices[i];
    const Vector3 outwards = Cross<float>(Vector3(face.vertices[i + 1 == face.count ? 0 : i + 1] - from), face.normal);
    const float length = Length(outwards);
    // A side of no length cuts nothing off.
    const Vector3 normal = outwards * (length > 1e-12f ? 1.0f / length : 0.0f);
    return {normal, Dot(normal, from)};
}

// The other core's feature that faces the reference, and what clipping leaves of it.
struct Clipped {
    SupportingFace incident;
    ClipVertex buffers[2][kMostClipped];
    ClipVertex* current = buffers[0];
    int count = 0;

    void Clip(const SupportingFace& reference, float slop);
    uint32_t Feature(int i, const ReferenceSide& reference) const;
};

void Clipped::Clip(const SupportingFace& reference, float slop) {
    count = incident.count;
    for (int i = 0; i < count; ++i) current[i] = {incident.vertices[i], static_cast<uint32_t>(i)};
    if (incident.count == 1) current[1] = current[0];
    ClipVertex* spare = buffers[1];
    float outside[kMostClipped];
    for (int k = 0; k < reference.count && count > 0; ++k) {
        const ClipSide side = SideOf(reference, k);
        const uint32_t label = kSideLabel + static_cast<uint32_t>(k);
        if (incident.count <= 2) {
            if (ClipSegmentBySide(current, side, label, slop) == 0) count = 0;
            continue;
        }
        bool cuts = false;
        for (int i = 0; i < count; ++i) {
            outside[i] = Dot(side.normal, current[i].position) - side.offset;
            cuts |= outside[i] > slop;
        }
        if (!cuts) continue;
        count = ClipBySide(current, count, outside, label, slop, spare);
        std::swap(current, spare);
    }
}

// The edge from vertex i of a face to the next, by their names.
uint32_t NameOfEdge(const SupportingFace& face, uint32_t i) {
    const uint32_t from = face.names[i], to = face.names[i + 1 == static_cast<uint32_t>(face.count) ? 0 : i + 1];
    return from < to ? from | to << 16 : to | from << 16;
}

uint32_t Clipped::Feature(int i, const ReferenceSide& reference) const {
    const auto crossing = [&](uint32_t incidentEdge, uint32_t side) {
        const uint32_t referenceEdge = NameOfEdge(reference.face, side);
        return reference.ofA ? CrossingFeature(referenceEdge, incidentEdge)
                             : CrossingFeature(incidentEdge, referenceEdge);
    };
    const uint32_t starts = current[i].label;
    if (incident.count <= 2) {
        if (starts < kSideLabel) return VertexFeature(!reference.ofA, incident.names[starts]);
        return crossing(NameOfEdge(incident, 0), starts - kSideLabel);
    }
    const uint32_t ends = current[i == 0 ? count - 1 : i - 1].label;
    if (starts < kSideLabel && ends < kSideLabel) return VertexFeature(!reference.ofA, incident.names[starts]);
    if (starts < kSideLabel) return crossing(NameOfEdge(incident, starts), ends - kSideLabel);
    if (ends < kSideLabel) return crossing(NameOfEdge(incident, ends), starts - kSideLabel);
    // Two sides meet: a corner of the reference face, which begins the later of the two.
    const uint32_t low = std::min(starts, ends) - kSideLabel, high = std::max(starts, ends) - kSideLabel;
    const bool wraps = low == 0 && high + 1 == static_cast<uint32_t>(reference.face.count);
    return VertexFeature(reference.ofA, reference.face.names[wraps ? 0 : high]);
}

// How far inside all sides of the face the middle of the deepest points lies: a disc of that radius about it, in the
// reference face's plane, belongs to the Minkowski difference.
float DiscRadius(const ReferenceSide& reference, const Clipped& clipped, float offset, float deepEnough) {
    Vector3 middle = Vector3::Zero();
    float count = 0;
    for (int i = 0; i < clipped.count; ++i) {
        if (Dot(reference.face.normal, clipped.current[i].position) - offset > deepEnough) continue;
        middle += clipped.current[i].position;
        count += 1;
    }
    middle *= 1.0f / count;
    float radius = std::numeric_limits<float>::infinity();
    for (int k = 0; k < reference.face.count; ++k) {
        const ClipSide side = SideOf(reference.face, k);
        if (side.normal != Vector3::Zero()) radius = Min(radius, side.offset - Dot(side.normal, middle));
    }
    return radius;
}

struct Built {
    bool touches = false;  // what clipping left reaches as deep as the other core
    bool proven = false;   // no axis separates the cores by more than the face does
};

Built BuildFromFace(const SupportPair& pair, const ReferenceSide& reference, const ContactTolerances& tolerances,
                    Manifold& manifold) {
    const Vector3& normal = reference.face.normal;
    Clipped clipped;
    FindFace(pair, !reference.ofA, Vector3(-normal), clipped.incident);
    clipped.Clip(reference.face, tolerances.prefer);
    Built built;
    manifold.normal = reference.axis;
    manifold.pointCount = 0;
    if (clipped.count == 0) return built;

    const float offset = Dot(normal, reference.face.vertices[0]);
    const Vector3 tangentU = Perpendicular(normal), tangentV = Cross<float>(normal, tangentU);
    FlatPoints<kMostClipped> points;
    int near[kMostClipped];
    float least = 0;
    for (int i = 0; i < clipped.count; ++i) {
        const Vector3& x = clipped.current[i].position;
        const float separation = Dot(normal, x) - offset;
        if (i == 0 || separation < least) least = separation;
        if (separation > tolerances.reach) continue;
        near[points.count] = i;
        points.Add(Dot(tangentU, x), Dot(tangentV, x), separation);
    }
    built.touches = least <= reference.separation + tolerances.prefer;
    if (built.touches) {
        const float depth = -reference.separation;
        const float radius = depth <= 0 ? 0 : DiscRadius(reference, clipped, offset, least + tolerances.prefer);
        built.proven = NoBetterAxis(pair, reference.axis, depth, radius);
    }
    int chosen[4];
    manifold.pointCount = ChooseFour(points, tolerances.prefer, chosen);
    for (int i = 0; i < manifold.pointCount; ++i) {
        const int c = chosen[i];
        const Vector3& x = clipped.current[near[c]].position;
        ManifoldPoint& point = manifold.points[i];
        const Vector3 onCore = reference.ofA ? Vector3(x - normal * points.separation[c]) : x;
        point.positionOnA = onCore + manifold.normal * pair.a.ConvexRadius();
        point.separation = points.separation[c] - pair.RadiusSum();
        point.feature = clipped.Feature(near[c], reference);
    }
    return built;
}

void Remember(PairCache::Kind kind, const Vector3& axis, PairCache& cache) {
    cache.kind = kind;
    for (int i = 0; i < 3; ++i) cache.axis[i] = axis[i];
}

// The best face that is nearly as good an axis as the known one, if any.
bool TryFaces(const SupportPair& pair, const KnownContact& known, const SupportingFace& faceA,
              const SupportingFace& faceB, const ContactTolerances& tolerances, PairCache& cache, Manifold& manifold) {
    ReferenceSide references[2];
    int order[2] = {0, 1}, count = 0;
    const float enough = known.separation - tolerances.prefer;
    if (faceA.count > 2) {
        references[count] = MakeReference(pair, true, faceA);
        if (references[count].separation >= enough) ++count;
    }
    if (faceB.count > 2) {
        references[count] = MakeReference(pair, false, faceB);
        if (references[count].separation >= enough) ++count;
    }
    if (count == 2) {
        const float bias = cache.kind == PairCache::Kind::FaceOfB ? -tolerances.prefer : tolerances.prefer;
        if (references[1].separation > references[0].separation + bias) std::swap(order[0], order[1]);
    }
    for (int i = 0; i < count; ++i) {
        const ReferenceSide& reference = references[order[i]];
        if (!BuildFromFace(pair, reference, tolerances, manifold).touches || manifold.pointCount == 0) continue;
        const Vector3& normal = reference.face.normal;
        Remember(reference.ofA ? PairCache::Kind::FaceOfA : PairCache::Kind::FaceOfB,
                 reference.ofA ? normal : pair.DirectionInB(normal), cache);
        return true;
    }
    return false;
}

// The edge of the face that lies farthest along the axis, if it leans less than about a degree.
bool EdgeAcross(const SupportingFace& face, const Vector3& axis, float slop, Segment& edge, uint32_t& name) {
    constexpr float kLean = 0.02f;
    bool found = false;
    float longest = 0, most = Dot(axis, face.vertices[0]);
    for (int i = 1; i < face.count; ++i) most = Max(most, Dot(axis, face.vertices[i]));
    for (int i = 0; i < face.count; ++i) {
        const int next = i + 1 == face.count ? 0 : i + 1;
        const Vector3 along = face.vertices[next] - face.vertices[i];
        const float length = Length(along), lean = Abs(Dot(axis, along));
        const float height = Max(Dot(axis, face.vertices[i]), Dot(axis, face.vertices[next]));
        if (height < most - slop || lean > kLean * length || length <= longest) continue;
        edge = {face.vertices[i], face.vertices[next]};
        name = NameOfEdge(face, static_cast<uint32_t>(i));
        longest = length;
        found = true;
    }
    return found;
}

void AddPoint(const SupportPair& pair, const Vector3& onCoreA, float separation, uint32_t feature, Manifold& manifold) {
    ManifoldPoint& point = manifold.points[manifold.pointCount++];
    point.positionOnA = onCoreA + manifold.normal * pair.a.ConvexRadius();
    point.separation = separation - pair.RadiusSum();
    point.feature = feature;
}

// Two points where two edges lie side by side.
bool TryParallelEdges(const SupportPair& pair, const SupportingFace& faceA, const SupportingFace& faceB,
                      const KnownContact& known, const ContactTolerances& tolerances, Manifold& manifold) {
    if (faceA.count < 2 || faceB.count < 2) return false;
    Segment onA, onB;
    uint32_t nameA = 0, nameB = 0;
    if (!EdgeAcross(faceA, known.axis, tolerances.prefer, onA, nameA)) return false;
    if (!EdgeAcross(faceB, Vector3(-known.axis), tolerances.prefer, onB, nameB)) return false;
    float from, to;
    if (!NearlyParallel(onA, onB) || !CommonLength(onA, onB, from, to)) return false;
    const Vector3 along = onB.to - onB.from;
    const float scale = 1.0f / Dot(along, along);
    // The known point is the deepest; both ends of the common length must tell the same depth, or the edges are not it.
    float separations[2], least = 0;
    Vector3 ends[2];
    for (int i = 0; i < 2; ++i) {
        ends[i] = onA.At(i == 0 ? from : to);
        const Vector3 beside = onB.from + along * (Dot(along, Vector3(ends[i] - onB.from)) * scale);
        separations[i] = Dot(known.axis, Vector3(beside - ends[i]));
        least = i == 0 ? separations[0] : Min(least, separations[1]);
    }
    if (Abs(least - known.separation) > tolerances.prefer) return false;
    const uint32_t feature = CrossingFeature(nameA, nameB) & ~1u;
    for (int i = 0; i < 2; ++i)
        if (separations[i] <= tolerances.reach)
            AddPoint(pair, ends[i], separations[i], feature + static_cast<uint32_t>(i), manifold);
    return manifold.pointCount > 0;
}

// To the points of edges or vertices, those of the faces beside them that lie within reach along the manifold's normal.
void AddFacesAhead(const SupportPair& pair, const SupportingFace& faceA, const SupportingFace& faceB,
                   const ContactTolerances& tolerances, Manifold& manifold) {
    if (!tolerances.facesAhead || manifold.pointCount == 0) return;
    const Vector3 n = manifold.normal;
    const float cosineA = faceA.count > 2 ? Dot(faceA.normal, n) : 0,
                cosineB = faceB.count > 2 ? -Dot(faceB.normal, n) : 0;
    const float cosine = Max(cosineA, cosineB);
    if (!(cosine > kLeastCosineAhead)) return;
    const bool ofA = cosineA >= cosineB;
    const SupportingFace& reference = ofA ? faceA : faceB;
    const ReferenceSide side{ofA, reference, n, 0};
    Clipped clipped;
    clipped.incident = ofA ? faceB : faceA;
    clipped.Clip(reference, tolerances.prefer);
    const float offset = Dot(reference.normal, reference.vertices[0]);
    const auto pointAt = [&](int i) {
        const Vector3& x = clipped.current[i].position;
        const float separation = (Dot(reference.normal, x) - offset) / cosine;
        const Vector3 onCore = ofA ? Vector3(x - n * separation) : x;
        return ManifoldPoint{onCore + n * pair.a.ConvexRadius(), separation - pair.RadiusSum(),
                             clipped.Feature(i, side)};
    };
    AddPointsAhead<kMostClipped>(clipped.count, pointAt, tolerances.reach - pair.RadiusSum(), tolerances.Apart(),
                                 tolerances.prefer, manifold);
}

}  // namespace

void BuildConvexContact(const SupportPair& pair, const KnownContact& known, const ContactTolerances& tolerances,
                        PairCache& cache, Manifold& manifold) {
    SupportingFace faceA, faceB;
    FindFace(pair, true, known.axis, faceA);
    FindFace(pair, false, Vector3(-known.axis), faceB);
    if (TryFaces(pair, known, faceA, faceB, tolerances, cache, manifold)) return;
    manifold.normal = known.axis;
    manifold.pointCount = 0;
    Remember(PairCache::Kind::Axis, known.axis, cache);
    if (known.separation > tolerances.reach) return;
    if (!TryParallelEdges(pair, faceA, faceB, known, tolerances, manifold))
        AddPoint(pair, known.onA, known.separation, VertexFeature(true, 0), manifold);
    AddFacesAhead(pair, faceA, faceB, tolerances, manifold);
}

CachedFace TryCachedFace(const SupportPair& pair, const ContactTolerances& tolerances, const PairCache& cache,
                         Manifold& manifold) {
    const bool ofA = cache.kind == PairCache::Kind::FaceOfA;
    const Vector3 stored(cache.axis[0], cache.axis[1], cache.axis[2]);
    SupportingFace face;
    FindFace(pair, ofA, ofA ? stored : Vector3(pair.rotation * stored), face);
    CachedFace result{false, ofA ? stored : Vector3(-(pair.rotation * stored))};
    if (face.count < 3) return result;
    const ReferenceSide reference = MakeReference(pair, ofA, face);
    if (reference.separation > tolerances.reach) {
        manifold.normal = reference.axis;
        manifold.pointCount = 0;
        result.done = true;
        return result;
    }
    const Built built = BuildFromFace(pair, reference, tolerances, manifold);
    result.done = built.touches && built.proven && manifold.pointCount > 0;
    return result;
}

}  // namespace fulcrum
