#include <Fulcrum/Collision/Shapes/RoundShapes.h>

#include <Fulcrum/Collision/Shapes/Revolution.h>
#include <Fulcrum/Collision/Shapes/SizeChecks.h>
#include <Fulcrum/Collision/Shapes/SupportingFace.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

// A direction's unit vector in the x-z plane, and its component along that.
struct Azimuth {
    float x, z, across;

    explicit Azimuth(const Vector3& direction)
        : x(1), z(0), across(std::sqrt(direction.x() * direction.x() + direction.z() * direction.z())) {
        if (!(across > 0)) return;
        x = direction.x() / across;
        z = direction.z() / across;
    }
};

Bounds BoundsAboutY(float radius, float bottom, float top) {
    Bounds bounds;
    bounds.lower = Vector3(-radius, bottom, -radius);
    bounds.upper = Vector3(radius, top, radius);
    return bounds;
}

}  // namespace

Result<std::shared_ptr<const TaperedCapsule>> TaperedCapsule::Create(float halfHeight, float topRadius,
                                                                     float bottomRadius) {
    const DefaultFloats floats;
    if (const Status size = CheckSize("halfHeight", halfHeight); !size) return size.GetError();
    if (const Status size = CheckSize("topRadius", topRadius); !size) return size.GetError();
    if (const Status size = CheckSize("bottomRadius", bottomRadius); !size) return size.GetError();
    const double h = halfHeight, top = topRadius, bottom = bottomRadius;
    if (std::fabs(top - bottom) >= 2 * h) {
        return Error{
            ErrorCode::Degenerate,
            Message("the ball of %s %g m lies inside the other: make halfHeight larger than half the difference of the "
                    "radii, %g m, or use a Sphere of radius %g m",
                    top < bottom ? "topRadius" : "bottomRadius", std::min(top, bottom), std::fabs(top - bottom) / 2,
                    std::max(top, bottom))};
    }
    // The cone that touches both balls does so where their normals have the slope `sine`.
    const double sine = (bottom - top) / (2 * h), cosine = std::sqrt(1 - sine * sine);
    const double low = -h + bottom * sine, high = h + top * sine;
    const RevolutionPiece pieces[3] = {BallSlice(-h - bottom, low, -h, bottom),
                                       Frustum(low, high, bottom * cosine, top * cosine),
                                       BallSlice(high, h + top, h, top)};
    const SolidMass solid = RevolutionMass(pieces);
    const Result<MassProperties> mass = ToMassProperties(solid);
    if (!mass) return mass.GetError();

    const std::shared_ptr<TaperedCapsule> capsule(new TaperedCapsule);
    const double center = solid.center.y();
    capsule->mass_ = mass.Value();
    capsule->halfHeight_ = halfHeight;
    capsule->topRadius_ = topRadius;
    capsule->bottomRadius_ = bottomRadius;
    capsule->convexRadius_ = std::min(topRadius, bottomRadius);
    capsule->ballRadius_ = std::max(topRadius, bottomRadius) - capsule->convexRadius_;
    const bool ballOnTop = topRadius > bottomRadius;
    capsule->ballY_ = static_cast<float>((ballOnTop ? h : -h) - center);
    capsule->pointY_ = static_cast<float>((ballOnTop ? -h : h) - center);
    capsule->bounds_ = BoundsAboutY(std::max(topRadius, bottomRadius), static_cast<float>(-h - bottom - center),
                                    static_cast<float>(h + top - center));
    // The hull of two balls is the union of the balls in between.
    capsule->innerRadius_ = static_cast<float>(bottom + (top - bottom) * (center + h) / (2 * h));
    capsule->outerRadius_ = static_cast<float>(std::max(h + top - center, h + bottom + center));
    return std::shared_ptr<const TaperedCapsule>(capsule);
}

Vector3 TaperedCapsule::SupportCore(const Vector3& direction) const {
    const float length = Length(direction);
    if (direction.y() * ballY_ + length * ballRadius_ < direction.y() * pointY_) return Vector3(0, pointY_, 0);
    return Vector3(0, ballY_, 0) + direction * (length > 0 ? ballRadius_ / length : 0.0f);
}

void TaperedCapsule::FindSupportingFace(const Vector3& direction, SupportingFace& face) const {
    // The line from the ball to the point is an edge only if the direction is its normal; if it leans by more than a
    // degree or two, the line would cut into the ball.
    constexpr float kLean = 0.03f;
    const Vector3 onBall = Vector3(0, ballY_, 0) + direction * ballRadius_, point(0, pointY_, 0);
    const Vector3 line = point - onBall;
    const float lean = Dot(direction, line), limit = kLean * std::fabs(ballY_ - pointY_);
    face.count = 0;
    face.hasAhead = false;
    // If the ball is tiny, the core is a segment like a capsule's.
    const bool wholeLine = std::fabs(lean) <= limit || ballRadius_ <= 1e-3f * convexRadius_;
    if (wholeLine || lean <= 0) face.Add(onBall, 0);
    else face.AddAhead(onBall, 0);
    if (wholeLine || lean > 0) face.Add(point, 1);
    else face.AddAhead(point, 1);
}

Result<std::shared_ptr<const Cylinder>> Cylinder::Create(float halfHeight, float radius, float convexRadius) {
    const DefaultFloats floats;
    if (const Status size = CheckSize("halfHeight", halfHeight); !size) return size.GetError();
    if (const Status size = CheckSize("radius", radius); !size) return size.GetError();
    return Make(halfHeight, radius, radius, convexRadius);
}

Result<std::shared_ptr<const Cylinder>> Cylinder::CreateTapered(float halfHeight, float topRadius, float bottomRadius,
                                                                float convexRadius) {
    const DefaultFloats floats;
    if (const Status size = CheckSize("halfHeight", halfHeight); !size) return size.GetError();
    if (const Status size = CheckSizeOrZero("topRadius", topRadius); !size) return size.GetError();
    if (const Status size = CheckSizeOrZero("bottomRadius", bottomRadius); !size) return size.GetError();
    if (topRadius == 0 && bottomRadius == 0)
        return Error{ErrorCode::NonPositive, "topRadius and bottomRadius are both 0 m: one must be larger"};
    return Make(halfHeight, topRadius, bottomRadius, convexRadius);
}

Result<std::shared_ptr<const Cylinder>> Cylinder::CreateCone(float halfHeight, float radius, float convexRadius) {
    const DefaultFloats floats;
    if (const Status size = CheckSize("halfHeight", halfHeight); !size) return size.GetError();
    if (const Status size = CheckSize("radius", radius); !size) return size.GetError();
    return Make(halfHeight, 0, radius, convexRadius);
}

Result<std::shared_ptr<const Cylinder>> Cylinder::Make(float halfHeight, float topRadius, float bottomRadius,
                                                       float convexRadius) {
    const double h = halfHeight, top = topRadius, bottom = bottomRadius, rounding = convexRadius;
    const double slope = (top - bottom) / (2 * h), sideLength = std::sqrt(1 + slope * slope);
    const auto radiusAt = [&](double y) { return (top + bottom) / 2 + slope * y; };
    // The largest ball inside touches the larger disc and the side, or both discs.
    const double larger = std::max(top, bottom);
    const double largest = std::min(h, larger / (sideLength + std::fabs(slope)));
    if (const Status status =
            CheckConvexRadius(convexRadius, static_cast<float>(largest), "the radius of the largest ball inside");
        !status)
        return status.GetError();
    const RevolutionPiece piece = Frustum(-h, h, bottom, top);
    const SolidMass solid = RevolutionMass({&piece, 1});
    const Result<MassProperties> mass = ToMassProperties(solid);
    if (!mass) return mass.GetError();

    const std::shared_ptr<Cylinder> cylinder(new Cylinder);
    const double center = solid.center.y();
    cylinder->mass_ = mass.Value();
    cylinder->convexRadius_ = convexRadius;
    cylinder->halfHeight_ = halfHeight;
    cylinder->topRadius_ = topRadius;
    cylinder->bottomRadius_ = bottomRadius;
    cylinder->sideOut_ = static_cast<float>(1 / sideLength);
    cylinder->sideUp_ = static_cast<float>(-slope / sideLength);
    // All planes moved inwards by the rounding. Where the side's lines meet before the disc, the core ends in a tip
    // there.
    double coreTop = h - rounding, coreBottom = -h + rounding;
    const auto coreRadiusAt = [&](double y) { return radiusAt(y) - rounding * sideLength; };
    if (coreRadiusAt(coreTop) < 0) coreTop = std::max(coreBottom, (rounding * sideLength - (top + bottom) / 2) / slope);
    if (coreRadiusAt(coreBottom) < 0)
        coreBottom = std::min(coreTop, (rounding * sideLength - (top + bottom) / 2) / slope);
    cylinder->coreTopY_ = static_cast<float>(coreTop - center);
    cylinder->coreBottomY_ = static_cast<float>(coreBottom - center);
    cylinder->coreTopRadius_ = static_cast<float>(std::max(0.0, coreRadiusAt(coreTop)));
    cylinder->coreBottomRadius_ = static_cast<float>(std::max(0.0, coreRadiusAt(coreBottom)));
    const float widest = std::max(cylinder->coreTopRadius_, cylinder->coreBottomRadius_) + convexRadius;
    cylinder->bounds_ = BoundsAboutY(widest, static_cast<float>(coreBottom - rounding - center),
                                     static_cast<float>(coreTop + rounding - center));
    cylinder->innerRadius_ = static_cast<float>(std::min({h - center, h + center, radiusAt(center) / sideLength}));
    const auto rim = [](float y, float radius) { return std::sqrt(y * y + radius * radius); };
    cylinder->outerRadius_ = std::max(rim(cylinder->coreTopY_, cylinder->coreTopRadius_),
                                      rim(cylinder->coreBottomY_, cylinder->coreBottomRadius_)) +
                             convexRadius;
    cylinder->innerRadius_ =
        std::min(cylinder->innerRadius_, std::min(cylinder->bounds_.upper.y(), -cylinder->bounds_.lower.y()));
    return std::shared_ptr<const Cylinder>(cylinder);
}

Vector3 Cylinder::SupportCore(const Vector3& direction) const {
    const Azimuth azimuth(direction);
    const float y = direction.y();
    const bool top =
        y * coreTopY_ + azimuth.across * coreTopRadius_ >= y * coreBottomY_ + azimuth.across * coreBottomRadius_;
    // Straight up or down any point of the disc will do; its center depends on no rounding.
    const float radius = azimuth.across > 0 ? (top ? coreTopRadius_ : coreBottomRadius_) : 0.0f;
    return Vector3(azimuth.x * radius, top ? coreTopY_ : coreBottomY_, azimuth.z * radius);
}

void Cylinder::AddDisc(const Vector3& direction, SupportingFace& face) const {
    // Cosines of the multiples of 30 degrees.
    static constexpr float kCosines[12] = {1,  0.866025404f,  0.5f,  0, -0.5f, -0.866025404f,
                                           -1, -0.866025404f, -0.5f, 0, 0.5f,  0.866025404f};
    constexpr float kLeaning = 3e-4f;  // rad: less is noise of a standing cylinder
    const bool top = direction.y() > 0;
    const float radius = top ? coreTopRadius_ : coreBottomRadius_, y = top ? coreTopY_ : coreBottomY_;
    // Counter-clockwise seen from outside: with the angle from z towards x on top.
    const auto corner = [&](int i) {
        const int turn = top ? i : (12 - i) % 12;
        return Vector3(radius * kCosines[(turn + 9) % 12], y, radius * kCosines[turn]);
    };
    face.normal = Vector3(0, top ? 1.0f : -1.0f, 0);
    const Azimuth azimuth(direction);
    if (azimuth.across < kLeaning) {
        for (int i = 0; i < 12; ++i) face.Add(corner(i), (top ? i : (12 - i) % 12) + 1);
        return;
    }
    // The rim's farthest point first, in front of the next corner.
    const Vector3 farthest(azimuth.x * radius, y, azimuth.z * radius);
    int next = 0;
    for (int i = 0; i < 12; ++i) {
        const Vector3 from = corner(i), to = corner((i + 1) % 12);
        const float pastFrom = (from.z() * farthest.x() - from.x() * farthest.z()) * face.normal.y();
        const float beforeTo = (farthest.z() * to.x() - farthest.x() * to.z()) * face.normal.y();
        if (pastFrom >= 0 && beforeTo > 0) next = i + 1;
    }
    face.Add(farthest, 0);
    for (int i = 0; i < 12; ++i) {
        const int k = (next + i) % 12;
        face.Add(corner(k), (top ? k : (12 - k) % 12) + 1);
    }
}

void Cylinder::FindSupportingFace(const Vector3& direction, SupportingFace& face) const {
    const Azimuth azimuth(direction);
    face.count = 0;
    const bool up = direction.y() > 0;
    const float discRadius = up ? coreTopRadius_ : coreBottomRadius_;
    const float alongSide = azimuth.across * sideOut_ + direction.y() * sideUp_;
    if (discRadius > 0 && std::fabs(direction.y()) > alongSide) return AddDisc(direction, face);
    const Vector3 top(azimuth.x * coreTopRadius_, coreTopY_, azimuth.z * coreTopRadius_);
    const Vector3 bottom(azimuth.x * coreBottomRadius_, coreBottomY_, azimuth.z * coreBottomRadius_);
    if (azimuth.across > 0) {
        face.Add(bottom, 16);
        face.Add(top, 17);
    } else {
        face.Add(up ? top : bottom, up ? 17 : 16);
    }
}

}  // namespace fulcrum
