// Clips a polygon by the sides of another (Sutherland and Hodgman, Reentrant Polygon Clipping, CACM 17(1), 1974),
// keeping track of which edges each new vertex comes from. Used by the contact builders. Allocates nothing;
// thread-safe.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <cstdint>

namespace fulcrum {

// A vertex of the polygon being clipped and the label of the edge that starts at it: the number of an edge of the
// clipped polygon, or kSideLabel + the number of a side of the clipping one. The labels of the two edges that meet in a
// vertex name it, and stay the same while the same features touch.
struct ClipVertex {
    Vector3 position;
    uint32_t label;
};
inline constexpr uint32_t kSideLabel = 256;

// The plane through one side of the clipping polygon: inside is normal . x <= offset.
struct ClipSide {
    Vector3 normal;  // unit
    float offset;
};

// The one through the side from a corner of a face to the next, at right angles to the face. A side of length 0 (of a
// box whose convex radius is its half extent) clips nothing.
inline ClipSide SideOfFace(const Vector3& from, const Vector3& to, const Vector3& faceNormal) {
    const Vector3 outwards = Cross<float>(Vector3(to - from), faceNormal);
    const float length = Length(outwards);
    const Vector3 normal = outwards * (length > 1e-12f ? 1.0f / length : 0.0f);
    return {normal, Dot(normal, from)};
}

// Clips the convex polygon `in` by a side, to within `slop`. `outside`: how far each vertex lies beyond it; `label`: of
// the side. Returns the number of vertices written to `out`.
inline int ClipBySide(const ClipVertex* in, int count, const float* outside, uint32_t label, float slop,
                      ClipVertex* out) {
    int written = 0;
    const ClipVertex* current = &in[count - 1];
    float currentOutside = outside[count - 1];
    for (int i = 0; i < count; ++i) {
        const ClipVertex* next = &in[i];
        const float nextOutside = outside[i];
        const bool currentKept = currentOutside <= slop, nextKept = nextOutside <= slop;
        if (currentKept != nextKept) {
            float t = currentOutside / (currentOutside - nextOutside);
            t = t < 0.0f ? 0.0f : (t > 1.0f ? 1.0f : t);
            out[written].position = current->position + (next->position - current->position) * t;
            out[written++].label = currentKept ? label : current->label;
        }
        if (nextKept) out[written++] = *next;
        current = next;
        currentOutside = nextOutside;
    }
    return written;
}

// The same for a segment, whose ends have the labels 0 and 1. A cut end gets the side's label.
inline int ClipSegmentBySide(ClipVertex* ends, const ClipSide& side, uint32_t label, float slop) {
    const float outside0 = Dot(side.normal, ends[0].position) - side.offset;
    const float outside1 = Dot(side.normal, ends[1].position) - side.offset;
    if (outside0 > slop && outside1 > slop) return 0;
    if (outside0 <= slop && outside1 <= slop) return 2;
    float t = outside0 / (outside0 - outside1);
    t = t < 0.0f ? 0.0f : (t > 1.0f ? 1.0f : t);
    const int cut = outside0 > slop ? 0 : 1;
    ends[cut].position = ends[0].position + (ends[1].position - ends[0].position) * t;
    ends[cut].label = label;
    return 2;
}

}  // namespace fulcrum
