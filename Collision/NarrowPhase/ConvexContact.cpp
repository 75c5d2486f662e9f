#include <Fulcrum/Collision/NarrowPhase/ConvexContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisProof.h>
#include <Fulcrum/Collision/NarrowPhase/ClippedFeature.h>
#include <Fulcrum/Collision/NarrowPhase/PointsAhead.h>
#include <Fulcrum/Collision/NarrowPhase/Segments.h>
#include <Fulcrum/Collision/Shapes/SupportingFace.h>

namespace fulcrum {

namespace {

constexpr int kMostClipped = 2 * SupportingFace::kMaxVertices;

// The supporting face of A, or of B, along `direction`; all in A's frame.
void FindFace(const SupportPair& pair, bool ofA, const Vector3& direction, SupportingFace& face) {
    if (ofA) return pair.a.FindSupportingFace(direction, face);
    pair.b.FindSupportingFace(pair.DirectionInB(direction), face);
    for (int i = 0; i < face.count; ++i) face.vertices[i] = pair.PointOfB(face.vertices[i]);
    if (face.hasAhead) face.ahead = pair.PointOfB(face.ahead);
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

// Names of a face's vertices and edges, edge i from vertex i to the next.
struct SupportingFaceNames {
    const SupportingFace& face;
    uint32_t count = static_cast<uint32_t>(face.count);

    uint32_t Vertex(uint32_t i) const { return face.names[i]; }
    uint32_t Edge(uint32_t i) const {
        const uint32_t from = face.names[i], to = face.names[i + 1 == count ? 0 : i + 1];
        return from < to ? from | to << 16 : to | from << 16;
    }
};

// A reference face's sides, and the other core's incident feature clipped by them.
struct FaceClip {
    const SupportingFace &reference, &incident;
    ClipSide sides[SupportingFace::kMaxVertices];
    ClippedFeature<kMostClipped> clipped;

    FaceClip(const SupportingFace& referenceFace, const SupportingFace& incidentFeature, float slop)
        : reference(referenceFace), incident(incidentFeature) {
        for (int i = 0; i < reference.count; ++i)
            sides[i] = SideOfFace(reference.vertices[i], reference.vertices[i + 1 == reference.count ? 0 : i + 1],
                                  reference.normal);
        clipped.Clip(
            incident.count, [&](int i) { return incident.vertices[i]; }, sides, reference.count, slop);
    }
    bool IsInside(const Vector3& point, float slop) const {
        for (int i = 0; i < reference.count; ++i)
            if (Dot(sides[i].normal, point) - sides[i].offset > slop) return false;
        return true;
    }
    uint32_t FeatureOf(int i, bool referenceOfA) const {
        return clipped.FeatureOf(i, SupportingFaceNames{incident}, SupportingFaceNames{reference}, referenceOfA);
    }
};

struct Built {
    bool isDeepest = false;  // the clipped feature is as deep as the other core
    bool proven = false;     // no axis separates the cores by more than the face does
};

Built BuildFromFace(const SupportPair& pair, const ReferenceSide& reference, const ContactTolerances& tolerances,
                    Manifold& manifold) {
    const Vector3& normal = reference.face.normal;
    SupportingFace incident;
    FindFace(pair, !reference.ofA, Vector3(-normal), incident);
    FaceClip clip(reference.face, incident, tolerances.prefer);
    auto& clipped = clip.clipped;
    Built built;
    manifold.normal = reference.axis;
    manifold.pointCount = 0;
    if (clipped.Count() == 0) return built;

    const float least = clipped.MeasureSeparations(normal, Dot(normal, reference.face.vertices[0]));
    built.isDeepest = least <= reference.separation + tolerances.prefer;
    if (built.isDeepest) {
        const float depth = -reference.separation;
        const float radius =
            depth <= 0 ? 0 : clipped.DiscRadius(clip.sides, reference.face.count, least + tolerances.prefer);
        built.proven = NoBetterAxis(pair.position, pair.InnerRadii(), reference.axis, depth, radius);
    }
    int chosen[4];
    manifold.pointCount = clipped.ChooseFourWithin(tolerances.reach, normal, tolerances.prefer, chosen);
    const auto pointAt = [&](const Vector3& x, float separation, uint32_t feature) {
        const Vector3 onCore = reference.ofA ? Vector3(x - normal * separation) : x;
        return ManifoldPoint{onCore + manifold.normal * pair.a.ConvexRadius(), separation - pair.RadiusSum(), feature};
    };
    for (int i = 0; i < manifold.pointCount; ++i) {
        const int c = chosen[i];
        manifold.points[i] = pointAt(clipped[c], clipped.Separation(c), clip.FeatureOf(c, reference.ofA));
    }
    if (incident.hasAhead && manifold.pointCount == 1 && clip.IsInside(incident.ahead, tolerances.prefer)) {
        const float separation = Dot(normal, Vector3(incident.ahead - reference.face.vertices[0]));
        if (separation <= tolerances.reach)
            manifold.points[manifold.pointCount++] =
                pointAt(incident.ahead, separation, VertexFeature(!reference.ofA, incident.aheadName));
    }
    return built;
}

// Builds the contact of the best face whose normal is nearly as good as the known axis, if any.
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
        if (!BuildFromFace(pair, reference, tolerances, manifold).isDeepest || manifold.pointCount == 0) continue;
        const Vector3& normal = reference.face.normal;
        cache.RememberAxis(reference.ofA ? PairCache::Kind::FaceOfA : PairCache::Kind::FaceOfB,
                           reference.ofA ? normal : pair.DirectionInB(normal));
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
        name = SupportingFaceNames{face}.Edge(static_cast<uint32_t>(i));
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

// Two points along parallel edges.
bool TryParallelEdges(const SupportPair& pair, const SupportingFace& faceA, const SupportingFace& faceB,
                      const KnownContact& known, const ContactTolerances& tolerances, Manifold& manifold) {
    if (faceA.count < 2 || faceB.count < 2) return false;
    Segment onA, onB;
    uint32_t nameA = 0, nameB = 0;
    if (!EdgeAcross(faceA, known.axis, tolerances.prefer, onA, nameA)) return false;
    if (!EdgeAcross(faceB, Vector3(-known.axis), tolerances.prefer, onB, nameB)) return false;
    if (!NearlyParallel(onA, onB)) return false;
    const CommonLength common(onA, onB);
    if (!common.exists) return false;
    // The known point is the deepest: if neither end of the common length is as deep, these are not the edges that
    // touch.
    const float separations[2] = {common.SeparationAlong(known.axis, 0), common.SeparationAlong(known.axis, 1)};
    const float least = Min(separations[0], separations[1]);
    if (Abs(least - known.separation) > tolerances.prefer) return false;
    const uint32_t feature = CrossingFeature(nameA, nameB) & ~1u;
    for (int i = 0; i < 2; ++i)
        if (separations[i] <= tolerances.reach)
            AddPoint(pair, common.onP[i], separations[i], feature + static_cast<uint32_t>(i), manifold);
    return manifold.pointCount > 0;
}

// Adds points of the adjacent faces, within reach along the normal, to a manifold of edges or vertices.
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
    const FaceClip clip(reference, ofA ? faceB : faceA, tolerances.prefer);
    const float offset = Dot(reference.normal, reference.vertices[0]);
    const auto pointAt = [&](int i) {
        const Vector3& x = clip.clipped[i];
        const float separation = (Dot(reference.normal, x) - offset) / cosine;
        const Vector3 onCore = ofA ? Vector3(x - n * separation) : x;
        return ManifoldPoint{onCore + n * pair.a.ConvexRadius(), separation - pair.RadiusSum(), clip.FeatureOf(i, ofA)};
    };
    AddPointsAhead<kMostClipped>(clip.clipped.Count(), pointAt, tolerances.reach - pair.RadiusSum(), tolerances.Apart(),
                                 tolerances.prefer, {}, manifold);
}

// The edge that faces the other shape, also if the shape must tip over first; false if there is none.
bool EdgeOf(const SupportingFace& face, Segment& edge, uint32_t (&names)[2]) {
    const bool isPoint = face.count == 1;
    if (!(face.count == 2 || (isPoint && face.hasAhead))) return false;
    edge = {face.vertices[0], isPoint ? face.ahead : face.vertices[1]};
    names[0] = face.names[0];
    names[1] = isPoint ? face.aheadName : face.names[1];
    return true;
}

// Adds the ends of two edges that lie side by side, within reach, to a contact of one point: of nearly parallel
// cylinders and tapered capsules one end touches, and the other may after a small rotation.
void AddEndsAhead(const SupportPair& pair, const SupportingFace& faceA, const SupportingFace& faceB,
                  const ContactTolerances& tolerances, Manifold& manifold) {
    if (!tolerances.facesAhead || manifold.pointCount != 1) return;
    Segment edges[2];
    uint32_t names[2][2];
    if (!EdgeOf(faceA, edges[0], names[0]) || !EdgeOf(faceB, edges[1], names[1])) return;
    // Beside the other edge by more than half of this radius, an end passes.
    const float radius = Min(pair.a.InnerRadius(), pair.b.InnerRadius());
    constexpr int kEnds = 4;
    ManifoldPoint ends[kEnds];
    int count = 0;
    for (int i = 0; i < kEnds; ++i) {
        const int own = i / 2;
        const Vector3 end = i % 2 == 0 ? edges[own].from : edges[own].to;
        const Segment& other = edges[1 - own];
        const Vector3 along = other.to - other.from;
        const float t = Dot(along, Vector3(end - other.from)) / LengthSquared(along);
        if (!(t >= 0 && t <= 1)) continue;
        const Vector3 between = other.At(t) - end;
        const float gap = Dot(manifold.normal, between) * (own == 0 ? 1.0f : -1.0f);
        const float square = Max(LengthSquared(between) - gap * gap, 0.0f);
        if (square > 0.25f * radius * radius) continue;
        // The surfaces are round beside their edges.
        const float separation = gap + radius - Sqrt(radius * radius - square);
        const Vector3 onCore = own == 0 ? end : Vector3(end - manifold.normal * separation);
        ends[count++] = {onCore + manifold.normal * pair.a.ConvexRadius(), separation - pair.RadiusSum(),
                         VertexFeature(own == 0, 0x100 + names[own][i % 2])};
    }
    AddPointsAhead<8>(
        count, [&](int i) { return ends[i]; }, tolerances.reach - pair.RadiusSum(), tolerances.Apart(),
        tolerances.prefer, {}, manifold);
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
    cache.RememberAxis(PairCache::Kind::Axis, known.axis);
    if (known.separation > tolerances.reach) return;
    if (!TryParallelEdges(pair, faceA, faceB, known, tolerances, manifold))
        AddPoint(pair, known.onA, known.separation, VertexFeature(true, 0), manifold);
    AddFacesAhead(pair, faceA, faceB, tolerances, manifold);
    AddEndsAhead(pair, faceA, faceB, tolerances, manifold);
}

void BuildOverFaceOfB(const SupportPair& pair, const Vector3& axis, const ContactTolerances& tolerances,
                      Manifold& manifold) {
    manifold.pointCount = 0;
    SupportingFace face;
    FindFace(pair, false, Vector3(-axis), face);
    if (face.count > 2) BuildFromFace(pair, MakeReference(pair, false, face), tolerances, manifold);
}

CachedFace TryCachedFace(const SupportPair& pair, const ContactTolerances& tolerances, const PairCache& cache,
                         Manifold& manifold) {
    const bool ofA = cache.kind == PairCache::Kind::FaceOfA;
    const Vector3 stored = cache.Axis();
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
    result.done = built.isDeepest && built.proven && manifold.pointCount > 0;
    return result;
}

}  // namespace fulcrum
