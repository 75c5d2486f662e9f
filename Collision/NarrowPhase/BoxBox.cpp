// Pair function of two boxes: the separating axis test over their 15 axes, in lanes, then the contact of the best face,
// or of two edges if their axis is clearly better. Source of the axes: S. Gottschalk, M. Lin, D. Manocha, OBBTree,
// SIGGRAPH 1996.
#include <Fulcrum/Collision/NarrowPhase/BoxFaceContact.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>

namespace fulcrum {

namespace {

using Four = Wide<4>;

Four FourOf(float a, float b, float c) { return Four::Of(Four::Float{a, b, c, a}); }
Four FourOf(const Vector3& v) { return FourOf(v.x(), v.y(), v.z()); }

BoxPair MakePair(const Box& a, const Box& b, const RelativePose& bInA) {
    BoxPair pair;
    pair.radiusA = a.ConvexRadius();
    pair.radiusB = b.ConvexRadius();
    pair.halfA = a.HalfExtents() - Vector3::Constant(pair.radiusA);
    pair.halfB = b.HalfExtents() - Vector3::Constant(pair.radiusB);
    pair.rotation = ToMatrix(bInA.rotation);
    const Matrix3& r = pair.rotation;
    pair.transposed = r.Transposed();
    pair.position = bInA.position;
    pair.positionInB = r.TransposeMultiply(bInA.position);
    return pair;
}

// Separation along the axis of one face, of A or B, on the side where the other box's center is.
float FaceSeparation(const BoxPair& pair, bool ofA, int axis) {
    const Vector3& column = ofA ? (&pair.transposed.x)[axis] : (&pair.rotation.x)[axis];
    const Vector3& half = ofA ? pair.halfA : pair.halfB;
    const Vector3& other = ofA ? pair.halfB : pair.halfA;
    const float along = ofA ? pair.position[axis] : pair.positionInB[axis];
    return Abs(along) - half[axis] -
           (Abs(column.x()) * other.x() + Abs(column.y()) * other.y() + Abs(column.z()) * other.z());
}

struct BestFace {
    float separation;
    bool ofA;
    int axis;
};

// The six face axes, three at once. Ties prefer A's, or the cached one.
BestFace FindBestFace(const BoxPair& pair, const PairCache& cache, float prefer) {
    const Matrix3 &r = pair.rotation, &t = pair.transposed;
    const Four halfA = FourOf(pair.halfA), halfB = FourOf(pair.halfB);
    const Four ofA = Abs(FourOf(pair.position)) - halfA -
                     (Abs(FourOf(r.x)) * Four(pair.halfB.x()) + Abs(FourOf(r.y)) * Four(pair.halfB.y()) +
                      Abs(FourOf(r.z)) * Four(pair.halfB.z()));
    const Four ofB = Abs(FourOf(pair.positionInB)) - halfB -
                     (Abs(FourOf(t.x)) * Four(pair.halfA.x()) + Abs(FourOf(t.y)) * Four(pair.halfA.y()) +
                      Abs(FourOf(t.z)) * Four(pair.halfA.z()));
    int a = ofA[1] > ofA[0] ? 1 : 0, b = ofB[1] > ofB[0] ? 1 : 0;
    if (ofA[2] > ofA[a]) a = 2;
    if (ofB[2] > ofB[b]) b = 2;
    BestFace best{ofA[a], true, a};
    if (ofB[b] > ofA[a] + prefer) best = {ofB[b], false, b};
    if (cache.kind == PairCache::Kind::FaceOfA) {
        const int axis = cache.indexA / 2;
        if (ofA[axis] >= Max(ofA[a], ofB[b]) - prefer) best = {ofA[axis], true, axis};
    } else if (cache.kind == PairCache::Kind::FaceOfB) {
        const int axis = cache.indexB / 2;
        if (ofB[axis] >= Max(ofA[a], ofB[b]) - prefer) best = {ofB[axis], false, axis};
    }
    return best;
}

struct BestEdges {
    float separation;
    int axisA, axisB;
};

// The nine cross products of an axis of A and one of B: three at once, those of one axis i of A. With the rows R_i of
// the rotation, i, j, k cyclic, and m, n the two cyclic successors of B's axis: distance |p_k R_j - p_j R_k|, reach of
// A a_j |R_k| + a_k |R_j|, of B b_m |R_in| + b_n |R_im|, all over the length of the product, sqrt(R_j^2 + R_k^2).
BestEdges FindBestEdges(const BoxPair& pair) {
    const Matrix3& t = pair.transposed;
    const Vector3* rows = &t.x;
    const Vector3 &p = pair.position, &a = pair.halfA, &b = pair.halfB;
    const Four bm = FourOf(b.y(), b.z(), b.x()), bn = FourOf(b.z(), b.x(), b.y());
    BestEdges best{-std::numeric_limits<float>::infinity(), 0, 0};
    for (int i = 0; i < 3; ++i) {
        const int j = i == 2 ? 0 : i + 1, k = i == 0 ? 2 : i - 1;
        const Four rowJ = FourOf(rows[j]), rowK = FourOf(rows[k]);
        const Four rowM = FourOf(rows[i].y(), rows[i].z(), rows[i].x()),
                   rowN = FourOf(rows[i].z(), rows[i].x(), rows[i].y());
        const Four distance = Abs(Four(p[k]) * rowJ - Four(p[j]) * rowK);
        const Four reachA = Four(a[j]) * Abs(rowK) + Four(a[k]) * Abs(rowJ);
        const Four reachB = bm * Abs(rowN) + bn * Abs(rowM);
        const Four squared = rowJ * rowJ + rowK * rowK;
        // Nearly parallel edges have no usable cross product; the face axes cover them.
        const Four separation = Select(squared > Four(1e-4f), (distance - reachA - reachB) / Sqrt(squared),
                                       Four(-std::numeric_limits<float>::infinity()));
        for (int n = 0; n < 3; ++n)
            if (separation[n] > best.separation) best = {separation[n], i, n};
    }
    return best;
}

Vector3 EdgeAxis(const BoxPair& pair, int axisA, int axisB) {
    Vector3 unit = Vector3::Zero();
    unit[axisA] = 1;
    const Vector3 n = Normalized(Cross<float>(unit, (&pair.rotation.x)[axisB]));
    return Dot(n, pair.position) < 0.0f ? Vector3(-n) : n;
}

// One test of the axis that separated the boxes in the last step.
bool StillApart(const BoxPair& pair, const PairCache& cache, float reach) {
    switch (cache.kind) {
        case PairCache::Kind::FaceOfA: return FaceSeparation(pair, true, cache.indexA / 2) > reach;
        case PairCache::Kind::FaceOfB: return FaceSeparation(pair, false, cache.indexB / 2) > reach;
        default: return false;
    }
}

void Remember(PairCache& cache, PairCache::Kind kind, int indexA, int indexB) {
    cache.kind = kind;
    cache.indexA = static_cast<uint16_t>(indexA);
    cache.indexB = static_cast<uint16_t>(indexB);
}

}  // namespace

void CollideBoxBox(const PairQuery& query, Manifold& manifold) {
    const BoxPair pair = MakePair(static_cast<const Box&>(query.a), static_cast<const Box&>(query.b), query.bInA);
    const ContactTolerances tolerances(pair.halfA.minCoeff() + pair.halfB.minCoeff(), pair.radiusA + pair.radiusB,
                                       query.settings);
    PairCache& cache = query.cache;
    manifold.pointCount = 0;
    if (StillApart(pair, cache, tolerances.reach)) return;

    const BestFace face = FindBestFace(pair, cache, tolerances.prefer);
    const float along = face.ofA ? pair.position[face.axis] : -pair.positionInB[face.axis];
    const int faceIndex = 2 * face.axis + (along < 0.0f ? 1 : 0);
    const auto rememberFace = [&] {
        Remember(cache, face.ofA ? PairCache::Kind::FaceOfA : PairCache::Kind::FaceOfB, faceIndex, faceIndex);
    };
    if (face.separation > tolerances.reach) return rememberFace();

    const BestEdges edges = FindBestEdges(pair);
    if (edges.separation > tolerances.reach)
        return Remember(cache, PairCache::Kind::EdgePair, edges.axisA, edges.axisB);
    if (edges.separation > face.separation + tolerances.prefer) {
        if (BuildBoxAxisContact(pair, EdgeAxis(pair, edges.axisA, edges.axisB), edges.separation, tolerances, manifold))
            return Remember(cache, PairCache::Kind::EdgePair, edges.axisA, edges.axisB);
    } else if (BuildBoxFaceContact(pair, face.ofA, faceIndex, face.separation, tolerances, manifold)) {
        return rememberFace();
    }
    // Corners or parallel edges come closest: handled by the general function, whose cache differs.
    cache = {};
    CollidePolyhedra(query, manifold);
    cache = {};
}

}  // namespace fulcrum
