#include <Fulcrum/Constraints/Joints/Path.h>

#include <Fulcrum/Math/ComputeApart.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace fulcrum {

namespace {

constexpr int kSearchesPerSegment = 16;

// The curve and its normal on a segment, and their derivatives with respect to u.
struct Curve {
    Vector3 position, first, second, normal, normalFirst;
};

Curve CurveAt(const PathPoint& p, const PathPoint& q, float u) {
    const float uu = u * u, uuu = uu * u;
    Curve c;
    c.position = p.position * (2 * uuu - 3 * uu + 1) + p.tangent * (uuu - 2 * uu + u) +
                 q.position * (3 * uu - 2 * uuu) + q.tangent * (uuu - uu);
    c.first =
        (p.position - q.position) * (6 * uu - 6 * u) + p.tangent * (3 * uu - 4 * u + 1) + q.tangent * (3 * uu - 2 * u);
    c.second = (p.position - q.position) * (12 * u - 6) + p.tangent * (6 * u - 4) + q.tangent * (6 * u - 2);
    c.normalFirst = q.normal - p.normal;
    c.normal = p.normal + c.normalFirst * u;
    return c;
}

std::string At(double t) { return " at t = " + std::to_string(t); }

}  // namespace

Path::Place Path::PlaceOf(double t) const {
    const double end = End(), laps = isClosed_ ? std::floor(t / end) : 0.0;
    const double inLap = std::clamp(t - laps * end, 0.0, end);
    const size_t segment = std::min(static_cast<size_t>(inLap), SegmentCount() - 1);
    return {segment, inLap - static_cast<double>(segment), laps};
}

double Path::Bounded(double t) const { return isClosed_ ? t : std::clamp(t, 0.0, End()); }

PathSample Path::Sample(double t) const {
    const DefaultFloats floats;
    const Place place = PlaceOf(t);
    const Curve c = CurveAt(points_[place.segment], PointAfter(place.segment), static_cast<float>(place.u));
    PathSample s;
    s.position = c.position;
    s.first = c.first;
    s.second = c.second;
    const float inverseSpeed = 1.0f / fulcrum::Length(c.first);
    s.tangent = c.first * inverseSpeed;
    const float along = Dot(c.normal, s.tangent);
    const Vector3 flat = c.normal - s.tangent * along;
    const float inverseFlat = 1.0f / fulcrum::Length(flat);
    s.normal = flat * inverseFlat;
    s.binormal = Cross(s.tangent, s.normal);
    const Vector3 bend = (c.second - s.tangent * Dot(c.second, s.tangent)) * (inverseSpeed * inverseSpeed);
    const float roll = (Dot(c.normalFirst, s.binormal) * inverseSpeed - along * Dot(bend, s.binormal)) * inverseFlat;
    s.turn = Cross(s.tangent, bend) + s.tangent * roll;
    return s;
}

// Gauss-Legendre quadrature of |P'|, five points on each of four subintervals. Source: Abramowitz and Stegun, table
// 25.4.
double Path::SegmentLength(size_t segment, double u) const {
    constexpr double kPlaces[5] = {0.0, -0.5384693101056831, 0.5384693101056831, -0.9061798459386640,
                                   0.9061798459386640};
    constexpr double kWeights[5] = {0.5688888888888889, 0.4786286704993665, 0.4786286704993665, 0.2369268850561891,
                                    0.2369268850561891};
    constexpr int kParts = 4;
    const double half = 0.5 * u / kParts;
    double sum = 0;
    for (int part = 0; part < kParts; ++part)
        for (int i = 0; i < 5; ++i) {
            const double at = half * (2 * part + 1 + kPlaces[i]);
            sum += kWeights[i] * static_cast<double>(fulcrum::Length(
                                     CurveAt(points_[segment], PointAfter(segment), static_cast<float>(at)).first));
        }
    return sum * half;
}

double Path::LengthAt(double t) const {
    const DefaultFloats floats;
    return ComputeApart([&] {
        const Place place = PlaceOf(t);
        const double before = place.segment == 0 ? 0.0 : lengths_[place.segment - 1];
        return place.laps * Length() + before + SegmentLength(place.segment, place.u);
    });
}

// Half the squared distance has the first derivative P' . (P - x) and the second P'' . (P - x) + |P'|^2. If the second
// is small or negative, near a center of curvature, its second term alone still gives a descent direction.
double Path::Closest(const Vector3& point, double from) const {
    const DefaultFloats floats;
    double t = Bounded(from);
    for (int i = 0; i < 16; ++i) {
        const Place place = PlaceOf(t);
        const Curve c = CurveAt(points_[place.segment], PointAfter(place.segment), static_cast<float>(place.u));
        const Vector3 away = c.position - point;
        const float square = Dot(c.first, c.first), slope = Dot(c.first, away);
        const float curvature = std::max(square + Dot(c.second, away), 0.25f * square);
        const double next = Bounded(t - static_cast<double>(std::clamp(slope / curvature, -0.25f, 0.25f)));
        const double step = std::fabs(next - t);
        t = next;
        if (step < 1e-6) break;
    }
    return t;
}

double Path::Closest(const Vector3& point) const {
    const DefaultFloats floats;
    double best = 0;
    float least = std::numeric_limits<float>::infinity();
    const int count = static_cast<int>(SegmentCount()) * kSearchesPerSegment;
    for (int i = 0; i <= count; ++i) {
        const double t = static_cast<double>(i) / kSearchesPerSegment;
        const float distance = LengthSquared(Vector3(Sample(t).position - point));
        if (distance < least) least = distance, best = t;
    }
    const double t = Closest(point, best);
    return isClosed_ ? t - End() * std::floor(t / End()) : t;
}

Path::Path(std::vector<PathPoint> points, bool isClosed) : points_(std::move(points)), isClosed_(isClosed) {}

Result<std::shared_ptr<const Path>> Path::Make(std::vector<PathPoint> points, bool isClosed) {
    if (points.size() < 2)
        return Error{ErrorCode::Degenerate,
                     "path has " + std::to_string(points.size()) + " points; it needs 2 or more"};
    for (size_t i = 0; i < points.size(); ++i)
        if (!IsFinite(points[i].position) || !IsFinite(points[i].tangent) || !IsFinite(points[i].normal))
            return Error{ErrorCode::NonFinite, "path point " + std::to_string(i) + " is not finite"};
    std::shared_ptr<Path> path(new Path(std::move(points), isClosed));
    for (size_t i = 0; i < path->SegmentCount(); ++i) {
        const double length = path->SegmentLength(i, 1.0);
        path->lengths_.push_back((i == 0 ? 0.0 : path->lengths_.back()) + length);
        for (int k = 0; k <= kSearchesPerSegment; ++k) {
            const float u = static_cast<float>(k) / kSearchesPerSegment;
            const Curve c = CurveAt(path->points_[i], path->PointAfter(i), u);
            const float speed = fulcrum::Length(c.first);
            if (!(static_cast<double>(speed) > 1e-3 * length))
                return Error{ErrorCode::Degenerate, "path stands still" +
                                                        At(static_cast<double>(i) + static_cast<double>(u)) +
                                                        "; points must differ and tangents must not be zero"};
            const float flat = fulcrum::Length(Cross(c.normal, Vector3(c.first * (1.0f / speed))));
            if (!(flat > 1e-3f))
                return Error{ErrorCode::Degenerate, "path normal is zero or along the path" +
                                                        At(static_cast<double>(i) + static_cast<double>(u))};
        }
    }
    return std::shared_ptr<const Path>(std::move(path));
}

Result<std::shared_ptr<const Path>> Path::Hermite(std::span<const PathPoint> points, bool isClosed) {
    const DefaultFloats floats;
    return Make({points.begin(), points.end()}, isClosed);
}

std::shared_ptr<const Path> Path::Straight(float length) {
    const DefaultFloats floats;
    const Vector3 whole(length, 0, 0);
    return Make({{whole * -0.5f, whole}, {whole * 0.5f, whole}}, false).Value();
}

Result<std::shared_ptr<const Path>> Path::CatmullRom(std::span<const Vector3> positions,
                                                     std::span<const Vector3> normals, bool isClosed) {
    const DefaultFloats floats;
    const size_t count = positions.size();
    if (normals.size() != count && normals.size() != 1)
        return Error{ErrorCode::OutOfRange, "path has " + std::to_string(normals.size()) +
                                                " normals; it needs one, or one for each of its " +
                                                std::to_string(count) + " points"};
    std::vector<PathPoint> points(count);
    for (size_t i = 0; i < count; ++i) {
        const bool isFirst = i == 0 && !isClosed, isLast = i + 1 == count && !isClosed;
        const Vector3& before = positions[isFirst ? 0 : (i + count - 1) % count];
        const Vector3& after = positions[isLast ? i : (i + 1) % count];
        points[i] = {positions[i], (after - before) * (isFirst || isLast ? 1.0f : 0.5f),
                     normals[normals.size() == 1 ? 0 : i]};
    }
    return Make(std::move(points), isClosed);
}

}  // namespace fulcrum
