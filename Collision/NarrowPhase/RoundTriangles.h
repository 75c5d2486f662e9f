// Contacts of a sphere or a capsule with single triangles, in closed form: of its core, a point or a segment, with the
// triangle's face, or else with the nearest side. Called by SurfaceContact for a batch of triangles. Thread-safe.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Manifold.h>
#include <Fulcrum/Collision/NarrowPhase/TriangleBatch.h>

namespace fulcrum {

// Contact of a ball of `radius` m at the frame's origin with B, whose closest point is at `distance` m along the unit
// vector `normal`.
void WriteBallContact(const Vector3& normal, float distance, float radius, Manifold& manifold);

// Contacts of the core of a capsule, the segment from (0, -halfHeight, 0) to (0, halfHeight, 0) in the shape's frame,
// with the triangles of a batch. Bit i, or lane i, is triangle i.
struct SegmentContact {
    SegmentContact(const SurfaceProbe& probe, const TriangleBatch& batch, uint32_t asked, float slop);

    uint32_t crossing;  // an end of the segment is behind the face: nothing else is set
    uint32_t before;    // the interval from .. to of it projects onto the face
    uint32_t onFace;    // and that is its closest feature, to within the slop
    uint32_t onSide;    // others with a side within reach; closest at `at` along the segment

    // Two points, or one, along the face's normal; in the shape's frame. Features are those of any two polyhedra.
    void WriteFaceContact(int triangle, const Vector3& normal, Manifold& manifold) const;
    // With the nearest side. `vertexOf`: vertex ids of the corners.
    void WriteSideContact(int triangle, const uint32_t (&vertexOf)[3], Manifold& manifold) const;
    // The direction to the nearest side, unit, in the surface's frame.
    Vector3 Axis(int triangle) const;

private:
    using Lanes = TriangleLanes;
    void Clip(const TriangleBatch& batch, float slop);
    void FindSide(const TriangleBatch& batch, uint32_t asked);
    bool WriteParallel(int triangle, const Vector3& normal, uint32_t feature, Manifold& manifold) const;

    const SurfaceProbe& probe_;
    const TriangleBatch& batch_;
    float halfHeight_, radius_;
    Vector3 half_;                  // from the middle to the end, in the surface's frame
    Lanes lowHeight_, highHeight_;  // of the ends above the face
    Lanes from_, to_;               // 0 .. 1 along the segment
    Lanes fromSide_, toSide_;       // the sides that cut it there; -1: end of the segment
    Lanes side_;                    // the nearest
    Lanes at_, sideAt_;             // 0 .. 1 along the segment and that side
    Lanes squared_;                 // the distance's
    Vec3<Lanes> between_;           // from the segment to the side
};

}  // namespace fulcrum
