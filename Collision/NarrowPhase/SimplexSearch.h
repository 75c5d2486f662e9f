// The point of a simplex that lies closest to the origin. Used by GJK over any kind of pair: a vertex is any struct
// with a member `w`, a point of the Minkowski difference in float or double (its `Real`), and a function SameAs.
// Allocates nothing; thread-safe.
#pragma once

#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

template <class Vertex>
struct Simplex {
    Vertex vertices[4];
    int count = 0;
};

template <class Real>
inline Real LengthSquaredOf(const Vec3<Real>& v) {
    return Dot<Real>(v, v);
}

// Squared sines below these count as zero within rounding: of a triangle's angle, and of the angle between a
// tetrahedron's face and the fourth vertex. A body at rest on a ground of kilometers makes simplices as flat as 1e-5.
template <class Real>
inline constexpr Real kFlatTriangle = sizeof(Real) == sizeof(double) ? Real(1e-24) : Real(1e-12f);
template <class Real>
inline constexpr Real kFlatTetrahedron = sizeof(Real) == sizeof(double) ? Real(1e-20) : Real(1e-10f);

// Each of these returns that point and keeps only the vertices that span it. Source: C. Ericson, Real-Time Collision
// Detection, 5.1, with the origin as the query point.
template <class Vertex>
inline Vec3<typename Vertex::Real> ClosestOnSegment(Simplex<Vertex>& s) {
    using Real = typename Vertex::Real;
    const Vec3<Real> a = s.vertices[0].w, ab = s.vertices[1].w - a;
    const Real along = -Dot<Real>(a, ab), length = Dot<Real>(ab, ab);
    if (along <= 0) {  // also where both ends are one point
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

template <class Vertex>
inline void Keep(Simplex<Vertex>& s, int i) {
    s.vertices[0] = s.vertices[i];
    s.count = 1;
}

template <class Vertex>
inline void Keep(Simplex<Vertex>& s, int i, int j) {
    const Vertex vi = s.vertices[i], vj = s.vertices[j];
    s.vertices[0] = vi;
    s.vertices[1] = vj;
    s.count = 2;
}

// Of a triangle whose corners lie on a line.
template <class Vertex>
inline Vec3<typename Vertex::Real> ClosestOnEdges(Simplex<Vertex>& s) {
    using Real = typename Vertex::Real;
    static constexpr int kEdges[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    Simplex<Vertex> best = s;
    Vec3<Real> closest = s.vertices[0].w;
    for (const auto& ends : kEdges) {
        Simplex<Vertex> edge = s;
        Keep(edge, ends[0], ends[1]);
        const Vec3<Real> point = ClosestOnSegment(edge);
        if (best.count < 3 && LengthSquaredOf<Real>(point) >= LengthSquaredOf<Real>(closest)) continue;
        best = edge;
        closest = point;
    }
    s = best;
    return closest;
}

template <class Vertex>
inline Vec3<typename Vertex::Real> ClosestOnTriangle(Simplex<Vertex>& s) {
    using Real = typename Vertex::Real;
    const Vec3<Real> a = s.vertices[0].w, b = s.vertices[1].w, c = s.vertices[2].w;
    const Vec3<Real> ab = b - a, ac = c - a;
    const Real d1 = -Dot<Real>(ab, a), d2 = -Dot<Real>(ac, a);
    if (d1 <= 0 && d2 <= 0) return Keep(s, 0), a;
    const Real d3 = -Dot<Real>(ab, b), d4 = -Dot<Real>(ac, b);
    if (d3 >= 0 && d4 <= d3) return Keep(s, 1), b;
    const Real d5 = -Dot<Real>(ab, c), d6 = -Dot<Real>(ac, c);
    if (d6 >= 0 && d5 <= d6) return Keep(s, 2), c;
    const Real vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return Keep(s, 0, 1), Vec3<Real>(a + ab * (d1 / (d1 - d3)));
    const Real vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return Keep(s, 0, 2), Vec3<Real>(a + ac * (d2 / (d2 - d6)));
    const Real va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6)
        return Keep(s, 1, 2), Vec3<Real>(b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
    // Inside: projecting the origin onto the plane is more accurate than barycentric weights.
    const Vec3<Real> n = Cross<Real>(ab, ac);
    const Real square = Dot<Real>(n, n);
    if (square <= kFlatTriangle<Real> * Dot<Real>(ab, ab) * Dot<Real>(ac, ac)) return ClosestOnEdges(s);
    return n * (Dot<Real>(n, a) / square);
}

template <class Vertex>
inline Vec3<typename Vertex::Real> ClosestInTetrahedron(Simplex<Vertex>& s) {
    using Real = typename Vertex::Real;
    static constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
    Simplex<Vertex> best = s;
    Vec3<Real> closest = Vec3<Real>::Zero();
    Real bestDistance = 0;
    for (const auto& face : kFaces) {
        const Vec3<Real>&a = s.vertices[face[0]].w, &b = s.vertices[face[1]].w, &c = s.vertices[face[2]].w;
        const Vec3<Real> n = Cross<Real>(Vec3<Real>(b - a), Vec3<Real>(c - a));
        const Vec3<Real> ad = s.vertices[face[3]].w - a;
        const Real opposite = Dot<Real>(n, ad), origin = -Dot<Real>(n, a);
        // If the tetrahedron is flat, all faces are tested.
        const bool flat = opposite * opposite <= kFlatTetrahedron<Real> * Dot<Real>(n, n) * Dot<Real>(ad, ad);
        if (!flat && origin * opposite > 0) continue;
        Simplex<Vertex> triangle = s;
        triangle.count = 3;
        for (int i = 0; i < 3; ++i) triangle.vertices[i] = s.vertices[face[i]];
        const Vec3<Real> point = ClosestOnTriangle(triangle);
        const Real distance = LengthSquaredOf<Real>(point);
        if (best.count == 4 || distance < bestDistance) {
            best = triangle;
            closest = point;
            bestDistance = distance;
        }
    }
    s = best;
    return closest;
}

template <class Vertex>
inline Vec3<typename Vertex::Real> ClosestOn(Simplex<Vertex>& s) {
    switch (s.count) {
        case 1: return s.vertices[0].w;
        case 2: return ClosestOnSegment(s);
        case 3: return ClosestOnTriangle(s);
        default: return ClosestInTetrahedron(s);
    }
}

template <class Vertex>
inline bool Contains(const Simplex<Vertex>& s, const Vertex& v) {
    for (int i = 0; i < s.count; ++i)
        if (s.vertices[i].SameAs(v)) return true;
    return false;
}

}  // namespace fulcrum
