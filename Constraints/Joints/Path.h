// A smooth curve through points, open or closed, with a frame along it: tangent, normal and their cross product. Made
// by the user, shared by path joints, which sample it. Immutable: any number of threads.
//
//   t    parameter: segment number plus fraction along the segment, 0..segments; closed paths wrap around
//   P    on a segment, with u = t - its number, the cubic of Hermite between points p0, p1 with derivatives m0, m1:
//        P(u) = (2u^3 - 3u^2 + 1) p0 + (u^3 - 2u^2 + u) m0 + (3u^2 - 2u^3) p1 + (u^3 - u^2) m1
//   T    P' / |P'|;   N  the interpolated normal, orthogonalized against T, of length 1;   B  T x N
//   turn rate at which the frame turns per meter, as a rotation vector: T x T_s + (B . N_s) T, with _s = d/ds = d/dt /
//   |P'|
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Math/Vector.h>

#include <memory>
#include <span>
#include <vector>

namespace fulcrum {

struct PathPoint {
    Vector3 position;                   // m
    Vector3 tangent;                    // m per segment: dP/dt, not zero
    Vector3 normal = Vector3(0, 1, 0);  // not parallel to the tangent; its length is its weight in interpolation
};

// All in the path's own space.
struct PathSample {
    Vector3 position;                   // m
    Vector3 first, second;              // dP/dt, d2P/dt2, m
    Vector3 tangent, normal, binormal;  // unit
    Vector3 turn;                       // rad/m
};

class Path {
public:
    // At least two points. Errors: NonFinite; Degenerate: too few points, or a place where the tangent vanishes or is
    // parallel to the normal.
    static Result<std::shared_ptr<const Path>> Hermite(std::span<const PathPoint> points, bool isClosed);
    // Through the positions, with tangents half the difference of the next and previous point (uniform Catmull-Rom); at
    // open ends along the first and last chord. normals: one per point, or one for all.
    static Result<std::shared_ptr<const Path>> CatmullRom(std::span<const Vector3> positions,
                                                          std::span<const Vector3> normals, bool isClosed);

    // Along x, from -length / 2 to length / 2, with the normal y. length: m, > 0, finite.
    static std::shared_ptr<const Path> Straight(float length);

    bool IsClosed() const { return isClosed_; }
    std::span<const PathPoint> Points() const { return points_; }
    // t at the end of the path: the number of segments.
    double End() const { return static_cast<double>(SegmentCount()); }
    double Length() const { return lengths_.back(); }  // m

    PathSample Sample(double t) const;
    // Arc length from t = 0, m; on closed paths whole laps are included.
    double LengthAt(double t) const;
    // t of a point of the path nearest to `point`: the local minimum near t = `from` by Newton's method, or the global
    // one.
    double Closest(const Vector3& point, double from) const;
    double Closest(const Vector3& point) const;

private:
    struct Place {
        size_t segment;
        double u;     // 0..1
        double laps;  // whole
    };

    Path(std::vector<PathPoint> points, bool isClosed);
    static Result<std::shared_ptr<const Path>> Make(std::vector<PathPoint> points, bool isClosed);
    size_t SegmentCount() const { return points_.size() - (isClosed_ ? 0 : 1); }
    const PathPoint& PointAfter(size_t i) const { return points_[i + 1 < points_.size() ? i + 1 : 0]; }
    Place PlaceOf(double t) const;
    double Bounded(double t) const;
    double SegmentLength(size_t segment, double u) const;

    std::vector<PathPoint> points_;
    std::vector<double> lengths_;  // arc length from the start to the end of each segment, m
    bool isClosed_;
};

}  // namespace fulcrum
