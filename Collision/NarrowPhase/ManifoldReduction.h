// Manifold reduction: chooses at most four of many contact points, for depth and area. Used by the contact builders.
// Thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/LaneSearch.h>

#include <algorithm>

namespace fulcrum {

// Contact points projected onto the contact plane, and their separations. For lanes: the arrays are padded with copies
// of the first point to a multiple of eight.
template <int kMost>
struct FlatPoints {
    static_assert(kMost % 8 == 0);
    float u[kMost], v[kMost], separation[kMost];
    int count = 0;

    void Add(float pointU, float pointV, float pointSeparation) {
        u[count] = pointU;
        v[count] = pointV;
        separation[count++] = pointSeparation;
    }
};

// Of the points outside a triangle of three of them, the one that adds the largest weighted area; kMost if there is
// none.
template <int kMost>
int FarthestOutside(const FlatPoints<kMost>& points, const float (&weights)[kMost], const int (&corner)[4],
                    float nothing) {
    constexpr float kNearly = 0.99f;
    const auto area = [&](int a, int b, int c) {
        return (points.u[b] - points.u[a]) * (points.v[c] - points.v[a]) -
               (points.v[b] - points.v[a]) * (points.u[c] - points.u[a]);
    };
    const float side = area(corner[0], corner[1], corner[2]) < 0.0f ? -1.0f : 1.0f;
    float gains[kMost], most = nothing;
    for (int i = 0; i < points.count; ++i) {
        gains[i] = 0;
        for (int k = 0; k < 3; ++k)
            gains[i] = Max(gains[i], -side * area(corner[k], corner[(k + 1) % 3], i) * weights[i]);
        most = Max(most, gains[i]);
    }
    for (int i = 0; i < points.count; ++i)
        if (gains[i] > nothing && gains[i] >= kNearly * most) return i;
    return kMost;
}

// Weights of points that do not touch in ChooseFour.
struct PointWeights {
    float least = 1.0f;  // 0..1; 1: same weight as touching points
    float closing = 0;   // m, >= 0: approach of the shape within the step
    float tilt = 1e-4f;  // rad, halfway to the least weight
};
inline constexpr float kLeastPointWeight = 0.02f;
// For points on triangles of a surface, which lie in several planes. motion: m, towards the surface within the step; a
// body that rocks to rest moves by less than a tenth of its inner radius, m.
inline PointWeights WeightsOnSurfaces(float motion, float innerRadius) {
    return {kLeastPointWeight, Max(motion - 0.1f * innerRadius, 0.0f)};
}

// Writes the chosen indices in increasing order and returns how many: first a deepest point, then the point farthest
// from it, then those that span the largest area on each side of the line of the two; where all are on one side,
// another there. Distances and areas count less for points that do not touch yet, down to `weighting.least`: a point
// that the shape rests on must not lose to one farther out that does not touch, or the shape rocks. The weight depends
// on the angle by which the shape would have to tilt to touch, beyond what it comes closer within the step: for falling
// bodies these are the corners that touch next. Ties within `depthSlop` meters, or a hundredth of the distance or area,
// are resolved in favor of the first point, so that rounding and tiny motions do not change the choice.
template <int kMost>
int ChooseFour(FlatPoints<kMost>& points, float depthSlop, int (&chosen)[4], const PointWeights& weighting = {}) {
    constexpr float kNearly = 0.99f;
    const int count = points.count;
    if (count <= 4) {
        for (int i = 0; i < count; ++i) chosen[i] = i;
        return count;
    }
    const int blocks = kMost == 8 ? 1 : (count + 7) / 8;
    for (int i = count; i < 8 * blocks; ++i) {
        points.u[i] = points.u[0];
        points.v[i] = points.v[0];
        points.separation[i] = points.separation[0];
    }
    Wide<8> values[kMost / 8];
    Wide<8> best = values[0] = Wide<8>::Load(points.separation);
    for (int k = 1; k < blocks; ++k) best = Min(best, values[k] = Wide<8>::Load(points.separation + 8 * k));
    const Wide<8> deep(Smallest(best) + depthSlop);
    const int first = FirstWhere(values, blocks, [&](Wide<8> x) { return x <= deep; });

    const Wide<8> u0(points.u[first]), v0(points.v[first]);
    best = Wide<8>(0.0f);
    for (int k = 0; k < blocks; ++k) {
        const Wide<8> du = Wide<8>::Load(points.u + 8 * k) - u0, dv = Wide<8>::Load(points.v + 8 * k) - v0;
        best = Max(best, values[k] = du * du + dv * dv);
    }
    const float farthest = Largest(best);
    if (!(farthest > 0.0f)) {  // all at the same position
        chosen[0] = first;
        return 1;
    }
    Wide<8> weights[kMost / 8];
    std::fill_n(weights, blocks, Wide<8>(1.0f));
    float farthestWeighted = farthest;
    if (weighting.least < 1.0f) {
        const Wide<8> touching(Max(points.separation[first], 0.0f)),
            perTilt(1.0f / (weighting.tilt * Sqrt(farthest) + weighting.closing));
        best = Wide<8>(0.0f);
        for (int k = 0; k < blocks; ++k) {
            const Wide<8> above = Max(Wide<8>::Load(points.separation + 8 * k) - touching, Wide<8>(0.0f));
            weights[k] = Wide<8>(weighting.least) + Wide<8>(1 - weighting.least) / (Wide<8>(1.0f) + above * perTilt);
            best = Max(best, values[k] = values[k] * (weights[k] * weights[k]));
        }
        farthestWeighted = Largest(best);
    }
    const Wide<8> far(kNearly * farthestWeighted);
    const int second = FirstWhere(values, blocks, [&](Wide<8> x) { return x >= far; });

    const Wide<8> alongU(points.u[second] - points.u[first]), alongV(points.v[second] - points.v[first]);
    Wide<8> most(0.0f), least(0.0f);
    for (int k = 0; k < blocks; ++k) {
        const Wide<8> du = Wide<8>::Load(points.u + 8 * k) - u0, dv = Wide<8>::Load(points.v + 8 * k) - v0;
        values[k] = (alongU * dv - alongV * du) * weights[k];
        most = Max(most, values[k]);
        least = Min(least, values[k]);
    }
    const float nothing = 1e-6f * farthest;  // an area, against the square of the longest distance
    const float left = Largest(most), right = Smallest(least);
    int found = 0, pick[4] = {first, second, 0, 0};
    found = 2;
    if (left > nothing) {
        const Wide<8> wanted(kNearly * left);
        pick[found++] = FirstWhere(values, blocks, [&](Wide<8> x) { return x >= wanted; });
    }
    if (right < -nothing) {
        const Wide<8> wanted(kNearly * right);
        pick[found++] = FirstWhere(values, blocks, [&](Wide<8> x) { return x <= wanted; });
    }
    if (found == 3) {
        alignas(32) float weightOf[kMost];
        for (int k = 0; k < blocks; ++k) weights[k].Store(weightOf + 8 * k);
        const int fourth = FarthestOutside(points, weightOf, pick, nothing);
        if (fourth < kMost) pick[found++] = fourth;
    }
    for (int i = 0; i < found; ++i) {  // by insertion
        int at = i;
        for (; at > 0 && chosen[at - 1] > pick[i]; --at) chosen[at] = chosen[at - 1];
        chosen[at] = pick[i];
    }
    return found;
}

}  // namespace fulcrum
