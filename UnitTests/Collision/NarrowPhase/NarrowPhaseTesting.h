// Helpers of the narrow phase's tests: shapes, random poses and reference measures in double that use only the shapes'
// support functions.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/CustomConvex.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <cmath>
#include <string>
#include <vector>

namespace fulcrum::testing {

using ConvexPtr = std::shared_ptr<const ConvexShape>;

struct NamedShape {
    std::string name;
    ConvexPtr shape;
};

inline ConvexPtr MakeSphere(float radius) { return Sphere::Create(radius).Value(); }
inline ConvexPtr MakeBox(const Vector3& half, float radius = 0) { return Box::Create(half, radius).Value(); }
inline ConvexPtr MakeCapsule(float halfHeight, float radius) { return Capsule::Create(halfHeight, radius).Value(); }
inline ConvexPtr MakeHull(const std::vector<Vector3>& points) { return ConvexHull::Create(points).Value(); }

// Points on a sphere by the golden angle.
inline ConvexPtr MakeRoundHull(int count, float radius) {
    std::vector<Vector3> points;
    for (int i = 0; i < count; ++i) {
        const double y = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - y * y), angle = i * 2.399963229728653;
        points.push_back(Vector3(Position(r * std::cos(angle), y, r * std::sin(angle)).cast<float>() * radius));
    }
    return MakeHull(points);
}

// A custom shape that is curved everywhere, so that GJK and EPA only converge.
class Ellipsoid final : public CustomConvex {
public:
    explicit Ellipsoid(const Vector3& radii) : radii_(radii) {}
    const Vector3& Radii() const { return radii_; }
    Vector3 FarthestPoint(const Vector3& d) const override {
        const Vector3 scaled = d.cwiseProduct(radii_);
        return scaled.cwiseProduct(radii_) * (1.0f / Length(scaled));
    }

private:
    Vector3 radii_;
};
inline ConvexPtr MakeEllipsoid(const Vector3& radii) { return CreateCustom<Ellipsoid>(radii).Value(); }

// A prism along y over a regular polygon: many parallel and perpendicular features.
inline ConvexPtr MakePrism(int sides, float radius, float halfHeight) {
    std::vector<Vector3> points;
    for (int i = 0; i < 2 * sides; ++i) {
        const double angle = 6.283185307179586 * (i / 2) / sides;
        points.push_back(Vector3(static_cast<float>(radius * std::cos(angle)), i % 2 == 0 ? halfHeight : -halfHeight,
                                 static_cast<float>(radius * std::sin(angle))));
    }
    return MakeHull(points);
}

// Exact to rounding in double: how far the whole shapes are apart along n.
inline double SeparationAlong(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, const Vector3& n) {
    const Quaternion& q = bInA.rotation;
    const Mat3<double> rotation = ToMatrix(Quat<double>{q.x, q.y, q.z, q.w});
    const Position unit = n.cast<double>() * (1 / std::sqrt(n.cast<double>().squaredNorm()));
    const Position onA = a.SupportCore(n).cast<double>();
    const Position inB = b.SupportCore(Vector3(rotation.TransposeMultiply(-unit).cast<float>())).cast<double>();
    const Position onB = rotation * inB + bInA.position.cast<double>();
    return Dot<double>(unit, Position(onB - onA)) - a.ConvexRadius() - b.ConvexRadius();
}

inline float DeepestSeparation(const Manifold& manifold) {
    float least = std::numeric_limits<float>::infinity();
    for (int i = 0; i < manifold.pointCount; ++i) least = std::min(least, manifold.points[i].separation);
    return least;
}

inline Manifold CollideOnce(const ConvexPtr& a, const ConvexPtr& b, const RelativePose& bInA, PairCache& cache,
                            const CollideSettings& settings = {}) {
    Manifold manifold;
    CollideCounters counters;
    Collide(*a, *b, bInA, settings, cache, manifold, counters);
    return manifold;
}
inline Manifold CollideCold(const ConvexPtr& a, const ConvexPtr& b, const RelativePose& bInA,
                            const CollideSettings& settings = {}) {
    PairCache cache;
    return CollideOnce(a, b, bInA, cache, settings);
}

}  // namespace fulcrum::testing
