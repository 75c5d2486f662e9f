// Watertight ray-triangle test: a ray through an edge hits at least one of the two triangles that share it, because the
// sign of the edge function is the same for both. Used by the ray casts of meshes and height fields. Source: Woop,
// Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.
#pragma once

#include <Fulcrum/Math/Wide.h>

#include <cmath>

namespace fulcrum {

// The largest absolute value of three, to which the rounding of a ray's hit is proportional.
inline float LargestCoordinate(const Vector3& v) { return Max(Abs(v.x()), Max(Abs(v.y()), Abs(v.z()))); }

// A ray in a frame whose z axis runs along the ray's largest component and in which the ray is z itself, by shearing.
struct ShearedRay {
    Vector3 origin;
    int x, y, z;  // which axes
    float shearX, shearY, scale;

    ShearedRay() = default;  // not a ray yet
    // `displacement` is finite and not zero.
    ShearedRay(const Vector3& from, const Vector3& displacement) : origin(from) {
        const Vector3 size = displacement.cwiseAbs();
        z = size.x() >= size.y() ? (size.x() >= size.z() ? 0 : 2) : (size.y() >= size.z() ? 1 : 2);
        // Seen from the ray's origin, counter-clockwise is from x to y.
        const bool forward = displacement[z] >= 0;
        x = (z + (forward ? 2 : 1)) % 3;
        y = (z + (forward ? 1 : 2)) % 3;
        shearX = displacement[x] / displacement[z];
        shearY = displacement[y] / displacement[z];
        scale = 1.0f / displacement[z];
    }
};

// Ray-triangle intersections in lanes. Front faces have a positive determinant.
template <class Real>
struct TriangleHit {
    Real u, v, w;  // signs differ: missed
    Real determinant;
    Real height;  // fraction times determinant
};

// One corner in the sheared frame.
template <class Real>
struct ShearedCorner {
    Real x, y, z;
    ShearedCorner(const ShearedRay& ray, const Vec3<Real>& vertex) {
        const Real alongZ = vertex[ray.z] - Real(ray.origin[ray.z]);
        x = (vertex[ray.x] - Real(ray.origin[ray.x])) - Real(ray.shearX) * alongZ;
        y = (vertex[ray.y] - Real(ray.origin[ray.y])) - Real(ray.shearY) * alongZ;
        z = Real(ray.scale) * alongZ;
    }
};

// The functions of the edges opposite a, b and c.
template <class Real>
void EdgeFunctions(const ShearedCorner<Real>& a, const ShearedCorner<Real>& b, const ShearedCorner<Real>& c,
                   TriangleHit<Real>& hit) {
    hit.u = b.x * c.y - b.y * c.x;
    hit.v = c.x * a.y - c.y * a.x;
    hit.w = a.x * b.y - a.y * b.x;
}

template <class Real>
void Complete(const ShearedCorner<Real>& a, const ShearedCorner<Real>& b, const ShearedCorner<Real>& c,
              TriangleHit<Real>& hit) {
    hit.determinant = hit.u + hit.v + hit.w;
    hit.height = hit.u * a.z + hit.v * b.z + hit.w * c.z;
}

// The fraction at which the ray hits the triangle abc (counter-clockwise seen from the front); false: it does not
// between 0 and maxFraction, or lies in its plane. Exact to the sign where an edge function rounds to zero.
inline bool IntersectTriangle(const ShearedRay& ray, const Vector3& a, const Vector3& b, const Vector3& c,
                              bool fromBehind, float maxFraction, float& fraction, bool& isBackFace) {
    const ShearedCorner<float> p(ray, a), q(ray, b), r(ray, c);
    TriangleHit<float> m;
    EdgeFunctions(p, q, r, m);
    if ((m.u == 0) | (m.v == 0) | (m.w == 0)) {
        // Products of floats are exact in double, so that the differences have the right sign.
        m.u = static_cast<float>(double{q.x} * double{r.y} - double{q.y} * double{r.x});
        m.v = static_cast<float>(double{r.x} * double{p.y} - double{r.y} * double{p.x});
        m.w = static_cast<float>(double{p.x} * double{q.y} - double{p.y} * double{q.x});
    }
    const bool isFront = (m.u >= 0) & (m.v >= 0) & (m.w >= 0), isBack = (m.u <= 0) & (m.v <= 0) & (m.w <= 0);
    if (!(isFront | (isBack & fromBehind))) return false;
    Complete(p, q, r, m);
    if (m.determinant == 0) return false;
    fraction = m.height / m.determinant;
    isBackFace = m.determinant < 0;
    return fraction >= 0 && fraction <= maxFraction;
}

// The same for eight triangles at once, bit-identical: the lanes that are hit, their fractions and which are hit from
// behind.
struct TriangleHits {
    uint32_t bits, backFaces;
    alignas(32) float fraction[8];
};
inline void IntersectTriangles(const ShearedRay& ray, const Vec3<Wide<8>> (&corners)[3], bool fromBehind,
                               float maxFraction, TriangleHits& hits) {
    using Lanes = Wide<8>;
    const ShearedCorner<Lanes> p(ray, corners[0]), q(ray, corners[1]), r(ray, corners[2]);
    TriangleHit<Lanes> m;
    EdgeFunctions(p, q, r, m);
    const Lanes zero(0.0f);
    const auto isFront = (m.u >= zero) & (m.v >= zero) & (m.w >= zero);
    const auto isBack = (m.u <= zero) & (m.v <= zero) & (m.w <= zero);
    const auto isUnsure = (m.u == zero) | (m.v == zero) | (m.w == zero);
    hits.bits = isFront.ToBits() | (fromBehind ? isBack.ToBits() : 0u);
    const uint32_t unsure = isUnsure.ToBits();
    if ((hits.bits | unsure) == 0) return;
    Complete(p, q, r, m);
    const Lanes fraction = m.height / m.determinant;
    fraction.Store(hits.fraction);
    hits.backFaces = (m.determinant < zero).ToBits();
    hits.bits &= ((fraction >= zero) & (fraction <= Lanes(maxFraction))).ToBits() & ~unsure;
    for (uint32_t bits = unsure; bits != 0; bits &= bits - 1) {
        const int i = __builtin_ctz(bits);
        Vector3 corner[3];
        for (int k = 0; k < 3; ++k) corner[k] = Vector3(corners[k].x()[i], corners[k].y()[i], corners[k].z()[i]);
        bool isBackFace = false;
        const bool isHit = IntersectTriangle(ray, corner[0], corner[1], corner[2], fromBehind, maxFraction,
                                             hits.fraction[i], isBackFace);
        hits.bits |= (isHit ? 1u : 0u) << i;
        hits.backFaces = (hits.backFaces & ~(1u << i)) | (isBackFace ? 1u : 0u) << i;
    }
}

// Whether the ray is finite, within the coordinates that shapes may have, and not of length 0.
inline bool IsUsable(const Vector3& origin, const Vector3& displacement) {
    constexpr float kFar = 1e18f, kShort = 1e-30f;
    const Vector3 from = origin.cwiseAbs(), along = displacement.cwiseAbs();
    return from.x() <= kFar && from.y() <= kFar && from.z() <= kFar && along.x() <= kFar && along.y() <= kFar &&
           along.z() <= kFar && Max(along.x(), Max(along.y(), along.z())) >= kShort;
}

// 1 / displacement for slab tests; components below 1e-18 m are clamped to it, so that fractions stay finite.
inline Vector3 BoundedInverse(const Vector3& displacement) {
    Vector3 inverse;
    for (int axis = 0; axis < 3; ++axis)
        inverse[axis] = 1.0f / std::copysign(Max(Abs(displacement[axis]), 1e-18f), displacement[axis]);
    return inverse;
}

}  // namespace fulcrum
