#include <Fulcrum/Collision/NarrowPhase/TriangleFaceContact.h>

#include <Fulcrum/Collision/NarrowPhase/AxisProof.h>
#include <Fulcrum/Collision/NarrowPhase/Clipping.h>
#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>

#include <algorithm>

namespace fulcrum {

namespace {

// Each side adds one corner at most.
constexpr int kMostClipped = 16;
static_assert(kMostCorners + 3 <= kMostClipped);

struct ClippedFace {
    const Polyhedron& core;
    const uint8_t* corners;
    int cornerCount;
    int count;
    ClipVertex* current;
    ClipVertex buffers[2][kMostClipped];

    ClippedFace(const Polyhedron& p, int face)
        : core(p),
          corners(p.indices + p.faces[face].firstIndex),
          cornerCount(p.faces[face].cornerCount),
          count(cornerCount),
          current(buffers[0]) {
        for (int i = 0; i < count; ++i) current[i] = {core.vertices[corners[i]], static_cast<uint32_t>(i)};
    }
    void Clip(const TriangleInShape& triangle, const float (&offsets)[3], float slop) {
        float outside[kMostClipped];
        for (int k = 0; k < 3 && count > 0; ++k) {
            bool cuts = false;
            for (int i = 0; i < count; ++i) {
                outside[i] = Dot(triangle.outwards[k], current[i].position) - offsets[k];
                cuts |= outside[i] > slop;
            }
            if (!cuts) continue;
            ClipVertex* spare = buffers[current == buffers[0] ? 1 : 0];
            count = ClipBySide(current, count, outside, kSideLabel + static_cast<uint32_t>(k), slop, spare);
            current = spare;
        }
    }
    uint32_t Edge(uint32_t i) const {
        return EdgeName(corners[i], corners[i + 1 == static_cast<uint32_t>(cornerCount) ? 0 : i + 1]);
    }
    uint32_t Feature(int i) const {
        const auto crossing = [](uint32_t edge, uint32_t side) {
            return CrossingFeature(edge, EdgeName(side, side == 2 ? 0 : side + 1));
        };
        const uint32_t starts = current[i].label, ends = current[i == 0 ? count - 1 : i - 1].label;
        if (starts < kSideLabel && ends < kSideLabel) return VertexFeature(true, corners[starts]);
        if (starts < kSideLabel) return crossing(Edge(starts), ends - kSideLabel);
        if (ends < kSideLabel) return crossing(Edge(ends), starts - kSideLabel);
        // Two sides meet: a corner of the triangle, which begins the later of the two.
        const uint32_t low = std::min(starts, ends) - kSideLabel, high = std::max(starts, ends) - kSideLabel;
        return VertexFeature(false, low == 0 && high == 2 ? 0 : high);
    }
};

// As in FaceContact.cpp: how far inside all sides the middle of the deepest points lies.
float DiscRadius(const TriangleInShape& triangle, const float (&offsets)[3], const ClippedFace& face,
                 const float* separations, float deepEnough) {
    Vector3 middle = Vector3::Zero();
    float count = 0;
    for (int i = 0; i < face.count; ++i) {
        if (separations[i] > deepEnough) continue;
        middle += face.current[i].position;
        count += 1;
    }
    middle *= 1.0f / count;
    float radius = offsets[0] - Dot(triangle.outwards[0], middle);
    for (int k = 1; k < 3; ++k) radius = Min(radius, offsets[k] - Dot(triangle.outwards[k], middle));
    return radius;
}

// What the proof asks of a pair.
struct CentersAndRadii {
    Vector3 position;
    float inner;
    float InnerRadii() const { return inner; }
};

}  // namespace

FaceContact BuildTriangleFaceContact(const Polyhedron& core, int incidentFace, const TriangleInShape& triangle,
                                     float separation, const ContactTolerances& tolerances, Manifold& manifold) {
    float offsets[3];
    for (int k = 0; k < 3; ++k) offsets[k] = Dot(triangle.outwards[k], triangle.corners[k]);
    ClippedFace face(core, incidentFace);
    face.Clip(triangle, offsets, tolerances.prefer);
    FaceContact result{false, false, incidentFace};
    manifold.pointCount = 0;
    if (face.count == 0) return result;

    const Vector3& normal = triangle.normal;
    manifold.normal = -normal;
    const float offset = Dot(normal, triangle.corners[0]);
    float separations[kMostClipped], least = 0;
    int near[kMostClipped], nearCount = 0;
    for (int i = 0; i < face.count; ++i) {
        separations[i] = Dot(normal, face.current[i].position) - offset;
        if (i == 0 || separations[i] < least) least = separations[i];
        near[nearCount] = i;
        nearCount += separations[i] <= tolerances.reach ? 1 : 0;
    }
    result.touches = least <= separation + tolerances.prefer;
    if (result.touches) {
        const float radius =
            separation >= 0 ? 0 : DiscRadius(triangle, offsets, face, separations, least + tolerances.prefer);
        result.proven =
            NoBetterAxis(CentersAndRadii{triangle.middle, core.innerRadius}, manifold.normal, -separation, radius);
    }

    int chosen[4] = {0, 1, 2, 3};
    int count = nearCount;
    if (nearCount > 4) {
        FlatPoints<kMostClipped> points;
        const Vector3 u = Perpendicular(normal), v = Cross<float>(normal, u);
        for (int i = 0; i < nearCount; ++i)
            points.Add(Dot(u, face.current[near[i]].position), Dot(v, face.current[near[i]].position),
                       separations[near[i]]);
        count = ChooseFour(points, tolerances.prefer, chosen, kLeastWeightOnSurfaces);
    }
    manifold.pointCount = count;
    for (int i = 0; i < count; ++i) {
        const int c = near[chosen[i]];
        manifold.points[i] = {face.current[c].position + manifold.normal * core.radius, separations[c] - core.radius,
                              face.Feature(c)};
    }
    return result;
}

}  // namespace fulcrum
