// Up to eight triangles of a surface by lanes, as the core of one convex shape meets them: which of them it may touch,
// and where they come closest to it. Used by SurfaceContact alone; lives on the stack of one call. The bits do not
// depend on the build's lanes.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Polyhedron.h>
#include <Fulcrum/Collision/Shapes/SurfaceShape.h>

namespace fulcrum {

using TriangleLanes = Wide<8>;

inline TriangleLanes Along(const Vec3<TriangleLanes>& a, const Vec3<TriangleLanes>& b) {
    return Dot<TriangleLanes>(a, b);
}

// The shape, seen from the surface.
struct SurfaceProbe {
    const ConvexShape& shape;
    const Polyhedron* core;  // null: curved, known by its support function alone
    Matrix3 axes;            // of the surface, in the shape's frame
    Vector3 center;          // of the shape, in the surface's frame
    float reach;             // m: how far apart the shapes may be
    bool twoSided;           // what the surface is

    // How far the core extends along each of the directions, which are the surface's and of any length; 0 where `lanes`
    // says that nobody asks.
    TriangleLanes Extent(const Vec3<TriangleLanes>& direction, uint32_t lanes) const;
};

struct TriangleBatch {
    int count;
    // In the surface's frame, about the shape's center, m. The normals point to the side of that.
    Vec3<TriangleLanes> corners[3];
    Vec3<TriangleLanes> normal;
    Vec3<TriangleLanes>
        outwards[3];           // through side i, from corner i to the next, in the face's plane and as long as the side
    TriangleLanes length[3];   // of the sides, m
    TriangleLanes beyond[3];   // how far the shape's center is outside of each side, times its length
    TriangleLanes height;      // of the center above the face, m; negative: behind a one-sided one
    TriangleLanes separation;  // of the core from the face's plane, m
    Vec3<TriangleLanes> closest;  // the point of the triangle that lies closest to the center
    TriangleLanes distance;       // its distance, m

    // Sets it up for views[0 .. count), 1 to 8, and returns which of them the shape may reach, a bit each. Those that
    // it leaves out are certainly farther from it than that, or one-sided with its center behind. Bits of `reversed`:
    // two-sided ones whose back faces the shape.
    uint32_t FindInReach(const SurfaceProbe& probe, const TriangleView* views, int viewCount, uint32_t& reversed);

    // One of those in the shape's frame: its corners and the unit vectors outwards of its sides, in the order of its
    // view, which may have been reversed.
    void Extract(int lane, bool isReversed, const Matrix3& axes, Vector3 (&itsCorners)[3],
                 Vector3 (&itsOutwards)[3]) const;

private:
    void Load(const SurfaceProbe& probe, const TriangleView* views);
    void FindClosest();
};

}  // namespace fulcrum
