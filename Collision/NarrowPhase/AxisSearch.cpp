#include <Fulcrum/Collision/NarrowPhase/AxisSearch.h>

#include <Fulcrum/Collision/NarrowPhase/FaceContact.h>

namespace fulcrum {

namespace {

// An edge and the arc between its faces' normals on the unit sphere (Gauss map): a full circle for a segment, half a
// circle for an edge of a flat polyhedron, with `outwards` in its middle.
struct EdgeArc {
    Vector3 from, along, left, right, outwards;
    bool circle, flat;
};

// Detects half circles.
void FindMiddle(EdgeArc& arc) {
    arc.flat = !arc.circle && Dot(arc.left, arc.right) < -0.9999f;
    if (arc.flat) arc.outwards = Normalized(Cross<float>(arc.along, arc.left));
}

// Not of unit length; zero for a circle.
Vector3 Middle(const EdgeArc& arc) { return arc.flat ? arc.outwards : Vector3(arc.left + arc.right); }

EdgeArc ArcOfA(const PolyhedronPair& pair, int i) {
    const ConvexHull::Edge& e = pair.a.edges[i];
    EdgeArc arc;
    arc.from = pair.a.vertices[e.from];
    arc.along = pair.a.vertices[e.to] - arc.from;
    arc.circle = pair.a.faceCount == 0;
    arc.left = arc.circle ? Vector3(Vector3::Zero()) : pair.a.faces[e.left].normal;
    arc.right = arc.circle ? Vector3(Vector3::Zero()) : pair.a.faces[e.right].normal;
    FindMiddle(arc);
    return arc;
}

// The arcs of B are mirrored, since the normals of B have the opposite sign in the difference B - A.
EdgeArc ArcOfB(const PolyhedronPair& pair, int i) {
    const ConvexHull::Edge& e = pair.b.edges[i];
    EdgeArc arc;
    arc.from = pair.VertexOfB(e.from);
    arc.along = pair.VertexOfB(e.to) - arc.from;
    arc.circle = pair.b.faceCount == 0;
    arc.left = arc.circle ? Vector3(Vector3::Zero()) : Vector3(-(pair.rotation * pair.b.faces[e.left].normal));
    arc.right = arc.circle ? Vector3(Vector3::Zero()) : Vector3(-(pair.rotation * pair.b.faces[e.right].normal));
    FindMiddle(arc);
    return arc;
}

// Two edges form a face of the Minkowski difference if their arcs cross. Source: D. Gregorius, The Separating Axis Test
// between Convex Polyhedra, GDC 2013.
bool ArcsCross(const EdgeArc& p, const EdgeArc& q) {
    if (p.flat || q.flat) {
        EdgeArc half = p.flat ? p : q;
        const EdgeArc& other = p.flat ? q : p;
        half.flat = false;
        half.right = half.outwards;
        if (ArcsCross(half, other)) return true;
        half.left = half.outwards;
        half.right = (p.flat ? p : q).right;
        return ArcsCross(half, other);
    }
    if (p.circle) return Dot(p.along, q.left) * Dot(p.along, q.right) < 0.0f;
    if (q.circle) return Dot(q.along, p.left) * Dot(q.along, p.right) < 0.0f;
    const Vector3 bxa = Cross<float>(p.right, p.left), dxc = Cross<float>(q.right, q.left);
    const float cba = Dot(q.left, bxa), dba = Dot(q.right, bxa), adc = Dot(p.left, dxc), bdc = Dot(p.right, dxc);
    return cba * dba < 0.0f && adc * bdc < 0.0f && cba * bdc > 0.0f;
}

void TryFacesOf(const PolyhedronPair& pair, bool ofA, FoundAxis& best) {
    const int count = ofA ? pair.a.faceCount : pair.b.faceCount;
    for (int i = 0; i < count; ++i) {
        const ReferenceFace face = MeasureFace(pair, ofA, i);
        if (face.separation <= best.separation) continue;
        best.separation = face.separation;
        best.axis = ofA ? pair.a.faces[i].normal : Vector3(-(pair.rotation * pair.b.faces[i].normal));
    }
}

void TryEdges(const PolyhedronPair& pair, FoundAxis& best) {
    for (int i = 0; i < pair.a.edgeCount; ++i) {
        const EdgeArc p = ArcOfA(pair, i);
        for (int j = 0; j < pair.b.edgeCount; ++j) {
            const EdgeArc q = ArcOfB(pair, j);
            if (!ArcsCross(p, q)) continue;
            const Vector3 n = Cross<float>(p.along, q.along);
            const float length = Length(n);
            if (length <= 1e-4f * Sqrt(LengthSquared(p.along) * LengthSquared(q.along))) continue;  // parallel
            const float side = Dot(n, Vector3(Middle(p) + Middle(q))) < 0.0f ? -1.0f : 1.0f;
            const Vector3 axis = n * (side / length);
            const float separation = Dot(axis, Vector3(q.from - p.from));
            if (separation <= best.separation) continue;
            best = {axis, separation};
        }
    }
}

}  // namespace

FoundAxis SearchAllAxes(const PolyhedronPair& pair) {
    FoundAxis best{Vector3(0, 1, 0), -std::numeric_limits<float>::infinity()};
    TryFacesOf(pair, true, best);
    TryFacesOf(pair, false, best);
    TryEdges(pair, best);
    return best;
}

}  // namespace fulcrum
