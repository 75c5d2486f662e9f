#include <Fulcrum/Collision/NarrowPhase/AxisContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisProof.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/Segments.h>

namespace fulcrum {

namespace {

// One or two vertices of a core that lie farthest along a direction. If there are more, two are enough.
struct SupportingEdge {
    uint8_t vertices[2];
    int count = 0;
};

SupportingEdge FindSupportingEdge(const Polyhedron& p, const Vector3& direction, float tolerance) {
    SupportingEdge edge;
    const Extreme extreme = FarthestVertex(p, direction);
    edge.vertices[edge.count++] = static_cast<uint8_t>(extreme.index);
    float second = extreme.value - tolerance;
    for (int i = 0; i < p.vertexCount; ++i) {
        const float value = Dot(direction, p.vertices[i]);
        if (i == extreme.index || value < second) continue;
        second = value;
        edge.vertices[1] = static_cast<uint8_t>(i);
        edge.count = 2;
    }
    if (edge.count == 2 && edge.vertices[0] > edge.vertices[1]) std::swap(edge.vertices[0], edge.vertices[1]);
    if (edge.count == 1) edge.vertices[1] = edge.vertices[0];
    return edge;
}

Segment SegmentOfA(const PolyhedronPair& pair, const uint8_t (&v)[2]) {
    return {pair.a.vertices[v[0]], pair.a.vertices[v[1]]};
}
Segment SegmentOfB(const PolyhedronPair& pair, const uint8_t (&v)[2]) {
    return {pair.VertexOfB(v[0]), pair.VertexOfB(v[1])};
}

uint32_t FeatureOf(const SupportingEdge& a, const SupportingEdge& b) {
    if (a.count == 1) return VertexFeature(true, a.vertices[0]);
    if (b.count == 1) return VertexFeature(false, b.vertices[0]);
    return CrossingFeature(EdgeName(a.vertices[0], a.vertices[1]), EdgeName(b.vertices[0], b.vertices[1]));
}

void AddPoint(const PolyhedronPair& pair, const Vector3& onCoreA, float separation, uint32_t feature,
              Manifold& manifold) {
    ManifoldPoint& point = manifold.points[manifold.pointCount++];
    point.positionOnA = onCoreA + manifold.normal * pair.a.radius;
    point.separation = separation - pair.RadiusSum();
    point.feature = feature;
}

// Two points where nearly parallel edges lie side by side. The axis is the manifold's normal.
bool AddParallelEdges(const PolyhedronPair& pair, const Segment& onA, const Segment& onB, uint32_t feature, float reach,
                      Manifold& manifold) {
    const CommonLength common(onA, onB);
    if (!common.exists) return false;
    for (int i = 0; i < 2; ++i) {
        const float separation = common.SeparationAlong(manifold.normal, i);
        if (separation <= reach)
            AddPoint(pair, common.onP[i], separation, feature + static_cast<uint32_t>(i), manifold);
    }
    return manifold.pointCount > 0;
}

// Whether the face contact of a face of A, nearly perpendicular to the axis, is as deep as the axis: then B's
// supporting edge crosses the face, though it may be deeper beyond the face's sides.
bool RestsOn(const PolyhedronPair& pair, const ReferenceFace& face, const KnownAxis& known,
             const ContactTolerances& tolerances, const Manifold& manifold) {
    if (!face.ofA || Dot(pair.a.faces[face.index].normal, known.axis) < tolerances.faceOfACosine) return false;
    float least = manifold.points[0].separation;
    for (int i = 1; i < manifold.pointCount; ++i) least = Min(least, manifold.points[i].separation);
    return least + pair.RadiusSum() <= known.separation + tolerances.prefer;
}

// Builds the contact of the best face whose normal is nearly as good as the axis, if any.
bool TryFaces(const PolyhedronPair& pair, const KnownAxis& known, const ContactTolerances& tolerances, PairCache& cache,
              Manifold& manifold) {
    ReferenceFace faces[2];
    int count = 0;
    const float enough = known.separation - tolerances.prefer;
    if (pair.a.faceCount > 0) {
        const ReferenceFace face = MeasureFace(pair, true, FaceAlong(pair.a, known.axis));
        const bool isAligned = Dot(pair.a.faces[face.index].normal, known.axis) >= tolerances.faceOfACosine;
        if (face.separation >= enough || isAligned) faces[count++] = face;
    }
    if (pair.b.faceCount > 0) {
        const ReferenceFace face = MeasureFace(pair, false, FaceAlong(pair.b, -pair.DirectionInB(known.axis)));
        if (face.separation >= enough) faces[count++] = face;
    }
    if (count == 2) {
        const float bias = cache.kind == PairCache::Kind::FaceOfB ? -tolerances.prefer : tolerances.prefer;
        if (faces[1].separation > faces[0].separation + bias) std::swap(faces[0], faces[1]);
    }
    for (int i = 0; i < count; ++i) {
        const FaceContact contact = BuildFaceContact(pair, faces[i], tolerances, manifold);
        if (manifold.pointCount == 0 || !(contact.isDeepest || RestsOn(pair, faces[i], known, tolerances, manifold)))
            continue;
        cache.kind = faces[i].ofA ? PairCache::Kind::FaceOfA : PairCache::Kind::FaceOfB;
        cache.indexA = static_cast<uint16_t>(faces[i].ofA ? faces[i].index : contact.incidentFace);
        cache.indexB = static_cast<uint16_t>(faces[i].ofA ? contact.incidentFace : faces[i].index);
        return true;
    }
    return false;
}

// The point where two crossing edges come closest. The normal is perpendicular to both.
void BuildCrossing(const PolyhedronPair& pair, const Segment& onA, const Segment& onB, const Vector3& normal,
                   uint32_t feature, float reach, Manifold& manifold) {
    const ClosestParameters closest = ClosestOnSegments(onA, onB);
    const Vector3 x = onA.At(closest.s);
    const float separation = Dot(normal, Vector3(onB.from - onA.from));
    manifold.normal = normal;
    manifold.pointCount = 0;
    if (separation <= reach) AddPoint(pair, x, separation, feature, manifold);
}

// Unit vector perpendicular to both edges, on the side of `towards`; zero where they are nearly parallel.
Vector3 CrossingNormal(const Segment& onA, const Segment& onB, const Vector3& towards) {
    if (NearlyParallel(onA, onB)) return Vector3::Zero();
    const Vector3 n = Normalized(Cross<float>(Vector3(onA.to - onA.from), Vector3(onB.to - onB.from)));
    return Dot(n, towards) < 0.0f ? Vector3(-n) : n;
}

// The manifold of edges and vertices.
void BuildFromEdges(const PolyhedronPair& pair, const KnownAxis& known, const ContactTolerances& tolerances,
                    PairCache& cache, Manifold& manifold) {
    manifold.normal = known.axis;
    manifold.pointCount = 0;
    cache.RememberAxis(PairCache::Kind::Axis, known.axis);
    if (known.separation > tolerances.reach) return;

    const SupportingEdge edgeA = FindSupportingEdge(pair.a, known.axis, known.tolerance);
    const SupportingEdge edgeB = FindSupportingEdge(pair.b, -pair.DirectionInB(known.axis), known.tolerance);
    const Segment onA = SegmentOfA(pair, edgeA.vertices), onB = SegmentOfB(pair, edgeB.vertices);
    const uint32_t feature = FeatureOf(edgeA, edgeB);
    if (edgeA.count == 2 && edgeB.count == 2) {
        const Vector3 crossing = CrossingNormal(onA, onB, known.axis);
        if (crossing == Vector3::Zero()) {
            if (AddParallelEdges(pair, onA, onB, feature, tolerances.reach, manifold)) return;
        } else if (Abs(pair.SeparationAlong(crossing) - known.separation) <= known.tolerance) {
            BuildCrossing(pair, onA, onB, crossing, feature, tolerances.reach, manifold);
            cache.kind = PairCache::Kind::EdgePair;
            cache.indexA = static_cast<uint16_t>(EdgeName(edgeA.vertices[0], edgeA.vertices[1]));
            cache.indexB = static_cast<uint16_t>(EdgeName(edgeB.vertices[0], edgeB.vertices[1]));
            return;
        }
    }
    // A vertex is involved. If the cores are apart, the direction between the closest points is the better axis.
    const ClosestParameters closest = ClosestOnSegments(onA, onB);
    const Vector3 x = onA.At(closest.s), between = onB.At(closest.t) - x;
    const float distance = Length(between);
    float separation = known.separation;
    if (separation > known.tolerance && distance <= separation + known.tolerance) {
        manifold.normal = between * (1.0f / distance);
        separation = distance;
    }
    if (separation <= tolerances.reach) AddPoint(pair, x, separation, feature, manifold);
}

}  // namespace

void BuildContactFromAxis(const PolyhedronPair& pair, const KnownAxis& known, const ContactTolerances& tolerances,
                          PairCache& cache, Manifold& manifold) {
    if (TryFaces(pair, known, tolerances, cache, manifold)) return;
    BuildFromEdges(pair, known, tolerances, cache, manifold);
    AddFacesAhead(pair, tolerances, manifold);
}

EdgeContact TryCachedEdges(const PolyhedronPair& pair, const ContactTolerances& tolerances, const PairCache& cache,
                           Manifold& manifold) {
    const uint8_t a[2] = {static_cast<uint8_t>(cache.indexA), static_cast<uint8_t>(cache.indexA >> 8)};
    const uint8_t b[2] = {static_cast<uint8_t>(cache.indexB), static_cast<uint8_t>(cache.indexB >> 8)};
    EdgeContact result;
    const Segment onA = SegmentOfA(pair, a), onB = SegmentOfB(pair, b);
    const Vector3 normal = CrossingNormal(onA, onB, cache.Axis());
    if (normal == Vector3::Zero()) return result;
    const Vector3 normalInB = pair.DirectionInB(normal);
    const float farA = FarthestVertex(pair.a, normal).value, farB = FarthestVertex(pair.b, -normalInB).value;
    const float separation = Dot(normal, pair.position) - farB - farA;
    result.beyondReach = separation > tolerances.reach;
    if (result.beyondReach) return result;
    // A third vertex is nearly as far: a face is nearly perpendicular to the axis, and a face contact is preferred.
    if (CountBeyond(pair.a, normal, farA - tolerances.prefer) > 2) return result;
    if (CountBeyond(pair.b, -normalInB, farB - tolerances.prefer) > 2) return result;
    // The edges must still be the supporting features along their axis, and cross well within both.
    if (Abs(Dot(normal, Vector3(onB.from - onA.from)) - separation) > 1e-5f * pair.Size()) return result;
    const ClosestParameters closest = ClosestOnSegments(onA, onB);
    const Vector3 dA = onA.to - onA.from, dB = onB.to - onB.from;
    const float lengthA = Length(dA), lengthB = Length(dB);
    const float sine = Length(Cross<float>(dA, dB)) / (lengthA * lengthB);
    const float inside = Min(Min(closest.s, 1 - closest.s) * lengthA, Min(closest.t, 1 - closest.t) * lengthB) * sine;
    result.proven = NoBetterAxis(pair.position, pair.InnerRadii(), normal, -separation, inside) && inside > 0;
    if (!result.proven) return result;
    BuildCrossing(pair, onA, onB, normal, CrossingFeature(cache.indexA, cache.indexB), tolerances.reach, manifold);
    AddFacesAhead(pair, tolerances, manifold);
    return result;
}

}  // namespace fulcrum
