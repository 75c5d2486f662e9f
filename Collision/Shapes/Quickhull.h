// Triangulated convex hull of points. Called by HullBuilder, which merges the triangles into polygons. Serial, pure.
// Points are rounded to a grid of 2^40 steps per half extent, where every orientation test is exact in integers of 128
// bits. So the mesh is closed and convex at every step for any input, without special cases.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Math/Vector.h>

#include <cstdint>
#include <span>
#include <vector>

namespace fulcrum {

// Positive if d is on the side of the plane (a, b, c) from which a, b, c are counter-clockwise, 0 in the plane, else
// negative. Exact. Coordinates: integers of at most 2^40.
int ExactOrientation(const Position& a, const Position& b, const Position& c, const Position& d);

// Normal (b - a) x (c - a), each component correctly rounded. Coordinates as above.
Position ExactNormal(const Position& a, const Position& b, const Position& c);

struct TriangleHull {
    struct Triangle {
        int corner[3];    // points, counter-clockwise seen from outside
        int neighbor[3];  // the triangle across the edge corner[i] -> corner[i + 1]
        Position normal;  // unit, outwards
        double area;      // twice the area, in grid steps squared
    };
    std::vector<Position> gridPoints;  // the input on the grid: integers
    std::vector<int> vertices;         // points, in the order in which the hull grew
    std::vector<Triangle> triangles;
    double gridStep = 0;   // m
    double tolerance = 0;  // m; if the number of vertices was not limited, no point is farther outside any triangle
    double thickness = 0;  // m, of the first tetrahedron: about the points' smallest extent
};

struct QuickhullSettings {
    int maxVertices =
        255;  // >= 4: growing stops there, so that the hull is the best of so many vertices found greedily
    double inputRounding = 0x1p-24;  // relative error of the input's coordinates: float
};

// Grows a tetrahedron by the point that lies farthest outside until none is outside by more than the tolerance,
// 3 inputRounding (|x| + |y| + |z|) with the largest coordinates, but at most a thousandth of the thickness.
// Points: finite. Error: Degenerate (the message says why).
// Source: Barber, Dobkin, Huhdanpaa, "The quickhull algorithm for convex hulls", 1996; without its merging.
Result<TriangleHull> Quickhull(std::span<const Position> points, const QuickhullSettings& settings = {});

}  // namespace fulcrum
