#include <Fulcrum/Collision/Shapes/Triangle.h>

#include <Fulcrum/Collision/Shapes/MassProperties.h>
#include <Fulcrum/Collision/Shapes/SizeChecks.h>
#include <Fulcrum/Collision/Shapes/SupportingFace.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

constexpr double kNominalThickness = 0.001;  // m

// A plate about its centroid: over the triangle, the mean of x x^T is the sum of those of the corners / 12.
SolidMass PlateMass(const Position (&corners)[3], const Position& center, const Position& normal, double area,
                    double thickness) {
    SolidMass solid;
    solid.volume = area * thickness;
    solid.center = center;
    Covariance c;
    for (const Position& corner : corners) AddOuterProduct(c, corner, solid.volume / 12);
    AddOuterProduct(c, normal, solid.volume * thickness * thickness / 12);
    solid.inertia = InertiaOf(c);
    return solid;
}

}  // namespace

Result<std::shared_ptr<const Triangle>> Triangle::Create(const Vector3& a, const Vector3& b, const Vector3& c,
                                                         float radius) {
    const DefaultFloats floats;
    const Vector3 given[3] = {a, b, c};
    for (int i = 0; i < 3; ++i)
        if (!IsFinite(given[i])) return Error{ErrorCode::NonFinite, Message("corner %c is not finite", 'a' + i)};
    if (const Status size = CheckSizeOrZero("radius", radius); !size) return size.GetError();

    const Position center = (a.cast<double>() + b.cast<double>() + c.cast<double>()) * (1.0 / 3);
    Position corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = given[i].cast<double>() - center;
    const Position ab = corners[1] - corners[0], ac = corners[2] - corners[0], bc = corners[2] - corners[1];
    const Position cross = Cross<double>(ab, ac);
    const double twiceArea = std::sqrt(Dot<double>(cross, cross));
    const double longest = std::max({Dot<double>(ab, ab), Dot<double>(ac, ac), Dot<double>(bc, bc)});
    // The smallest height must be more than the rounding of the coordinates.
    if (!(twiceArea > 1e-5 * longest)) {
        return Error{ErrorCode::Degenerate,
                     Message("the corners lie on a line: the triangle is %g m long and %g m high", std::sqrt(longest),
                             longest > 0 ? twiceArea / std::sqrt(longest) : 0.0)};
    }
    const Position normal = cross * (1 / twiceArea);
    const double thickness = radius > 0 ? 2 * double{radius} : kNominalThickness;
    const Result<MassProperties> mass = ToMassProperties(PlateMass(corners, center, normal, twiceArea / 2, thickness));
    if (!mass) return mass.GetError();

    const std::shared_ptr<Triangle> triangle(new Triangle);
    triangle->mass_ = mass.Value();
    triangle->normal_ = normal.cast<float>();
    for (int i = 0; i < 3; ++i) triangle->corners_[i] = corners[i].cast<float>();
    triangle->Complete(radius);
    return std::shared_ptr<const Triangle>(triangle);
}

void Triangle::Complete(float radius) {
    convexRadius_ = innerRadius_ = radius;
    for (const Vector3& corner : corners_) {
        bounds_.Include(Vector3(corner - Vector3::Constant(radius)));
        bounds_.Include(Vector3(corner + Vector3::Constant(radius)));
        outerRadius_ = std::max(outerRadius_, Length(corner) + radius);
    }
}

Vector3 Triangle::SupportCore(const Vector3& direction) const {
    const float a = Dot(direction, corners_[0]), b = Dot(direction, corners_[1]), c = Dot(direction, corners_[2]);
    return corners_[a >= b && a >= c ? 0 : b >= c ? 1 : 2];
}

void Triangle::FindSupportingFace(const Vector3& direction, SupportingFace& face) const {
    const bool front = Dot(direction, normal_) >= 0;
    face.count = 0;
    for (int i = 0; i < 3; ++i) {
        const int corner = front ? i : 2 - i;
        face.Add(corners_[corner], corner);
    }
    face.normal = front ? normal_ : Vector3(-normal_);
}

}  // namespace fulcrum
