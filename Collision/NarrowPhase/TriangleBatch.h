// Up to eight triangles of a surface, in lanes, against one convex shape: separating axis tests that cull those out of
// reach, and the closest points. Used by SurfaceContact alone; lives on the stack of one call. The bits do not depend
// on the build's lanes.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Polyhedron.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

namespace fulcrum {

using TriangleLanes = Wide<8>;

inline TriangleLanes Along(const Vec3<TriangleLanes>& a, const Vec3<TriangleLanes>& b) {
    return Dot<TriangleLanes>(a, b);
}

// The shape in the surface's frame.
struct SurfaceProbe {
    const ConvexShape& shape;
    const Polyhedron* core;  // null: curved, given only by its support function
    Matrix3 axes;            // of the surface, in the shape's frame
    Vector3 center;          // of the shape, in the surface's frame
    float reach;             // m: largest separation of contacts
    bool twoSided;           // whether the surface is two-sided

    // Support values of the core along directions in the surface's frame, of any length; only for the set bits of
    // `lanes`, others may be 0.
    TriangleLanes Extent(const Vec3<TriangleLanes>& direction, uint32_t lanes) const;
};

struct TriangleBatch {
    int count;
    // In the surface's frame, relative to the shape's center, m. The normals point to its side.
    Vec3<TriangleLanes> corners[3];
    Vec3<TriangleLanes> normal;
    Vec3<TriangleLanes> outwards[3];  // outward normal of side i, from corner i to the next; as long as the side
    TriangleLanes length[3];          // of the sides, m
    TriangleLanes beyond[3];      // signed distance of the shape's center outside of each side, times the side's length
    TriangleLanes height;         // of the center above the face, m; negative: behind a one-sided one
    TriangleLanes separation;     // of the core from the face's plane, m
    Vec3<TriangleLanes> closest;  // the point of the triangle that lies closest to the center
    TriangleLanes distance;       // its distance, m

    // Loads views[0 .. count), 1 to 8, and returns a bit for each that the shape may reach. The others are certainly
    // out of reach, or one-sided with the shape's center behind. Bits of `reversed`: two-sided ones whose back faces
    // the shape.
    uint32_t FindInReach(const SurfaceProbe& probe, const TriangleView* views, int viewCount, uint32_t& reversed);

    // A triangle in the shape's frame: its corners and the unit outward normals of its sides, in the order of its
    // (possibly reversed) view.
    void Extract(int lane, bool isReversed, const Matrix3& axes, Vector3 (&itsCorners)[3],
                 Vector3 (&itsOutwards)[3]) const;

private:
    void Load(const SurfaceProbe& probe, const TriangleView* views);
    void FindClosest();
};

}  // namespace fulcrum
