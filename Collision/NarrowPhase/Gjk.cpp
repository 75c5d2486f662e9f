#include <Fulcrum/Collision/NarrowPhase/Gjk.h>

namespace fulcrum {

namespace {

// Each of these finds the point of a simplex that lies closest to the origin and keeps only the vertices that span it.
// Source: C. Ericson, Real-Time Collision Detection, 5.1, with the origin as the query point.
Vector3 ClosestOnSegment(Simplex& s) {
    const Vector3 a = s.vertices[0].w, ab = s.vertices[1].w - a;
    const float along = -Dot(a, ab), length = Dot(ab, ab);
    if (along <= 0.0f) {  // also where both ends are one point
        s.count = 1;
        return a;
    }
    if (along >= length) {
        s.vertices[0] = s.vertices[1];
        s.count = 1;
        return s.vertices[0].w;
    }
    return a + ab * (along / length);
}

void Keep(Simplex& s, int i) {
    s.vertices[0] = s.vertices[i];
    s.count = 1;
}

void Keep(Simplex& s, int i, int j) {
    const MinkowskiVertex vi = s.vertices[i], vj = s.vertices[j];
    s.vertices[0] = vi;
    s.vertices[1] = vj;
    s.count = 2;
}

// Of a triangle whose corners lie on a line.
Vector3 ClosestOnEdges(Simplex& s) {
    static constexpr int kEdges[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    Simplex best = s;
    Vector3 closest = s.vertices[0].w;
    for (const auto& ends : kEdges) {
        Simplex edge = s;
        Keep(edge, ends[0], ends[1]);
        const Vector3 point = ClosestOnSegment(edge);
        if (best.count < 3 && LengthSquared(point) >= LengthSquared(closest)) continue;
        best = edge;
        closest = point;
    }
    s = best;
    return closest;
}

Vector3 ClosestOnTriangle(Simplex& s) {
    const Vector3 a = s.vertices[0].w, b = s.vertices[1].w, c = s.vertices[2].w;
    const Vector3 ab = b - a, ac = c - a;
    const float d1 = -Dot(ab, a), d2 = -Dot(ac, a);
    if (d1 <= 0.0f && d2 <= 0.0f) return Keep(s, 0), a;
    const float d3 = -Dot(ab, b), d4 = -Dot(ac, b);
    if (d3 >= 0.0f && d4 <= d3) return Keep(s, 1), b;
    const float d5 = -Dot(ab, c), d6 = -Dot(ac, c);
    if (d6 >= 0.0f && d5 <= d6) return Keep(s, 2), c;
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0f && d1 >= 0.0f && d3 <= 0.0f) return Keep(s, 0, 1), Vector3(a + ab * (d1 / (d1 - d3)));
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0f && d2 >= 0.0f && d6 <= 0.0f) return Keep(s, 0, 2), Vector3(a + ac * (d2 / (d2 - d6)));
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0.0f && d4 >= d3 && d5 >= d6)
        return Keep(s, 1, 2), Vector3(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
    // Inside: the foot of the origin on the plane is more exact than the sum of the weighted corners.
    const Vector3 n = Cross<float>(ab, ac);
    const float square = Dot(n, n);
    if (square <= 1e-12f * Dot(ab, ab) * Dot(ac, ac)) return ClosestOnEdges(s);
    return n * (Dot(n, a) / square);
}

Vector3 ClosestInTetrahedron(Simplex& s) {
    static constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
    Simplex best = s;
    Vector3 closest = Vector3::Zero();
    float bestDistance = 0;
    for (const auto& face : kFaces) {
        const Vector3 &a = s.vertices[face[0]].w, &b = s.vertices[face[1]].w, &c = s.vertices[face[2]].w;
        const Vector3 n = Cross<float>(Vector3(b - a), Vector3(c - a));
        const Vector3 ad = s.vertices[face[3]].w - a;
        const float opposite = Dot(n, ad), origin = -Dot(n, a);
        // A flat tetrahedron has no inside: each of its faces counts.
        const bool flat = opposite * opposite <= 1e-10f * Dot(n, n) * Dot(ad, ad);
        if (!flat && origin * opposite > 0.0f) continue;
        Simplex triangle = s;
        triangle.count = 3;
        for (int i = 0; i < 3; ++i) triangle.vertices[i] = s.vertices[face[i]];
        const Vector3 point = ClosestOnTriangle(triangle);
        const float distance = LengthSquared(point);
        if (best.count == 4 || distance < bestDistance) {
            best = triangle;
            closest = point;
            bestDistance = distance;
        }
    }
    s = best;
    return closest;
}

Vector3 ClosestOn(Simplex& s) {
    switch (s.count) {
        case 1: return s.vertices[0].w;
        case 2: return ClosestOnSegment(s);
        case 3: return ClosestOnTriangle(s);
        default: return ClosestInTetrahedron(s);
    }
}

bool Contains(const Simplex& s, const MinkowskiVertex& v) {
    for (int i = 0; i < s.count; ++i)
        if (s.vertices[i].a == v.a && s.vertices[i].b == v.b) return true;
    return false;
}

}  // namespace

GjkResult Gjk(const PolyhedronPair& pair, const Vector3& start, float reach) {
    constexpr int kMaxIterations = 40;
    const float touching = 1e-6f * pair.Size() + 1e-12f;
    GjkResult result{GjkResult::Status::Apart, start, 0, {}};
    Simplex& simplex = result.simplex;
    Vector3 axis = start;
    float distance = -1;  // of the closest point so far; negative: none yet
    float gap = 0;        // by which the axis found last fails to separate the cores as far as that
    for (int i = 0; i < kMaxIterations; ++i) {
        const MinkowskiVertex vertex = pair.Support(axis);
        const float bound = Dot(axis, vertex.w);
        if (bound > reach) {
            result.status = GjkResult::Status::BeyondReach;
            result.axis = axis;
            result.separation = bound;
            return result;
        }
        gap = distance - bound;
        if (distance >= 0 && (gap <= 1e-6f * distance || Contains(simplex, vertex))) break;
        Simplex next = simplex;
        next.vertices[next.count++] = vertex;
        const Vector3 closest = ClosestOn(next);
        const float closer = Length(closest);
        if (closer <= touching || next.count == 4) {
            result.status = GjkResult::Status::Overlapping;
            simplex = next;
            return result;
        }
        // Rounding stops the descent: this is as close as it gets. The last vertex may still turn the axis a little.
        const bool last = distance >= 0 && closer >= distance;
        if (last && closer > distance * 1.000001f) break;
        simplex = next;
        distance = closer;
        axis = closest * (1.0f / closer);
        if (last) {
            gap = distance - pair.SeparationAlong(axis);
            break;
        }
    }
    result.axis = axis;
    result.separation = distance;
    // So close that the direction is lost in rounding: the axis does not separate the cores as far as they seem apart.
    if (gap > 100 * touching && distance < 1000 * touching) result.status = GjkResult::Status::Overlapping;
    return result;
}

}  // namespace fulcrum
