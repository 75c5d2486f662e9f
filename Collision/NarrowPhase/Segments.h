// Closest points of two segments, either of which may be a point. Used by the contact builders and the capsules.
#pragma once

#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

struct Segment {
    Vector3 from, to;
    Vector3 At(float t) const { return from + (to - from) * t; }
};

struct ClosestParameters {
    float s, t;  // along the first and the second segment, 0 .. 1
};

// Source: C. Ericson, Real-Time Collision Detection, 5.1.9.
inline ClosestParameters ClosestOnSegments(const Segment& p, const Segment& q) {
    const Vector3 d1 = p.to - p.from, d2 = q.to - q.from, r = p.from - q.from;
    const float a = Dot(d1, d1), e = Dot(d2, d2), f = Dot(d2, r), c = Dot(d1, r), b = Dot(d1, d2);
    const float tiny = 1e-20f;
    if (a <= tiny) return {0.0f, e <= tiny ? 0.0f : Clamp(f / e, 0.0f, 1.0f)};
    if (e <= tiny) return {Clamp(-c / a, 0.0f, 1.0f), 0.0f};
    const float across = a * e - b * b;
    float s = across > 1e-6f * a * e ? Clamp((b * f - c * e) / across, 0.0f, 1.0f) : 0.0f;
    float t = (b * s + f) / e;
    if (t < 0.0f) {
        t = 0.0f;
        s = Clamp(-c / a, 0.0f, 1.0f);
    } else if (t > 1.0f) {
        t = 1.0f;
        s = Clamp((b - c) / a, 0.0f, 1.0f);
    }
    return {s, t};
}

// Segments at less than this angle (about one degree) touch along their common length. Scalar: capsules on triangles
// call it for the few triangles that they touch at a side.
inline bool NearlyParallel(const Segment& p, const Segment& q) {
    constexpr float kSineSquared = 0.02f * 0.02f;
    const Vector3 d1 = p.to - p.from, d2 = q.to - q.from;
    return LengthSquared(Cross<float>(d1, d2)) <= kSineSquared * LengthSquared(d1) * LengthSquared(d2);
}

// The point on the line through q that is closest to x.
inline Vector3 ClosestOnLine(const Segment& q, const Vector3& x) {
    const Vector3 d = q.to - q.from;
    return q.from + d * (Dot(d, Vector3(x - q.from)) * (1.0f / Dot(d, d)));
}

// The interval along which two nearly parallel segments p and q are side by side.
struct CommonLength {
    bool exists;     // otherwise there is no common length, and nothing else is set
    float at[2];     // its ends, along p, 0 .. 1
    Vector3 onP[2];  // the same as points
    Vector3 onQ[2];  // and the points of q's line that are closest to those

    CommonLength(const Segment& p, const Segment& q) {
        const Vector3 d = p.to - p.from;
        const float scale = 1.0f / Dot(d, d);
        const float t0 = Dot(d, Vector3(q.from - p.from)) * scale, t1 = Dot(d, Vector3(q.to - p.from)) * scale;
        at[0] = Max(0.0f, Min(t0, t1));
        at[1] = Min(1.0f, Max(t0, t1));
        exists = at[0] < at[1];
        if (!exists) return;
        for (int i = 0; i < 2; ++i) {
            onP[i] = p.At(at[i]);
            onQ[i] = ClosestOnLine(q, onP[i]);
        }
    }
    float SeparationAlong(const Vector3& axis, int i) const { return Dot(axis, Vector3(onQ[i] - onP[i])); }
};

}  // namespace fulcrum
