// Convex hull of a point set: polygonal faces, in the center frame. Created from any points by Create (quickhull with
// merging of coplanar faces, HullBuilder); immutable afterwards.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

#include <span>
#include <vector>

namespace fulcrum {

struct Polyhedron;

struct ConvexHullSettings {
    int maxVertices = 64;    // 4..255; a hull with more is simplified to the farthest ones, inside the exact hull
    float convexRadius = 0;  // m, >= 0: the hull is shrunk by it and rounded again; 0 keeps sharp edges. Vertices,
                             // faces and edges are then those of the shrunk core; the mass is that of the sharp hull
};

class ConvexHull final : public ConvexShape {
public:
    ~ConvexHull() override;

    struct Face {
        uint16_t firstIndex;   // into Indices(): the corners, counter-clockwise seen from outside
        uint16_t cornerCount;  // >= 3
        Vector3 normal;        // unit, outwards
        float offset;          // the face's plane is normal . x = offset, offset > 0
    };
    struct Edge {             // each edge once
        uint8_t from, to;     // vertices
        uint8_t left, right;  // faces: `left` runs from -> to counter-clockwise
    };

    // Hull of at least 4 points that span a volume, coordinates in meters. Points are dropped and faces merged if that
    // moves the surface by less than about 2e-7 of the largest coordinates, or a thousandth of the thickness.
    // At most 255 faces: a hull with more is simplified too.
    // Errors: NonFinite, Degenerate (fewer than 4 points, coincident, collinear or coplanar: the message says which),
    // OutOfRange (maxVertices; a negative convexRadius or one that leaves no core; an inertia that is no normal float).
    static Result<std::shared_ptr<const ConvexHull>> Create(std::span<const Vector3> points,
                                                            const ConvexHullSettings& settings = {});

    Vector3 SupportCore(const Vector3& direction) const override;
    void FindSupportingFace(const Vector3& direction, SupportingFace& face) const override;

    std::span<const Vector3> Vertices() const;
    std::span<const Face> Faces() const;
    std::span<const Edge> Edges() const;
    std::span<const uint8_t> Indices() const;
    // The vertices by lanes: coordinate arrays x, y, z of PaddedVertexCount() floats each, 64-byte aligned. The padding
    // repeats vertex 0, so that a support search needs no tail.
    const float* LaneX() const { return lanes_.data()->values; }
    const float* LaneY() const { return LaneX() + paddedCount_; }
    const float* LaneZ() const { return LaneX() + 2 * paddedCount_; }
    int PaddedVertexCount() const { return paddedCount_; }  // a multiple of 16
    // The faces' normals and offsets in the same way; the padding repeats face 0.
    const float* NormalLaneX() const { return normalLanes_.data()->values; }
    const float* NormalLaneY() const { return NormalLaneX() + paddedFaceCount_; }
    const float* NormalLaneZ() const { return NormalLaneX() + 2 * paddedFaceCount_; }
    const float* OffsetLane() const { return NormalLaneX() + 3 * paddedFaceCount_; }
    int PaddedFaceCount() const { return paddedFaceCount_; }  // a multiple of 16

private:
    ConvexHull();
    friend class HullFinisher;                         // ConvexHull.cpp: fills a hull from the builder's mesh
    friend Polyhedron CoreOf(const ConvexHull& hull);  // reads the arrays without a call for each

    std::vector<Vector3> vertices_;
    std::vector<Face> faces_;
    std::vector<Edge> edges_;
    std::vector<uint8_t> indices_;
    struct alignas(64) LaneBlock {
        float values[16];
    };
    std::vector<LaneBlock> lanes_;
    int paddedCount_ = 0;
    std::vector<LaneBlock> normalLanes_;
    int paddedFaceCount_ = 0;
};

}  // namespace fulcrum
