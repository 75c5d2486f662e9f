#include <Fulcrum/Collision/Shapes/Submersion.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/Revolution.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fulcrum {

namespace {

constexpr double kPiHere = 3.14159265358979323846;

// The half space up . x <= level.
struct Half {
    Position up;
    double level;
    double HeightOf(const Position& x) const { return Dot<double>(up, x) - level; }
};

// Of a ball about the origin: the cap of height h has the volume pi h^2 (3 r - h) / 3, and its middle is
// 3 (2 r - h)^2 / (4 (3 r - h)) from the center.
SubmergedPart OfBall(double r, const Half& half) {
    const double h = std::clamp(half.level + r, 0.0, 2 * r);
    if (!(h > 0)) return {};
    const double below = 3 * (2 * r - h) * (2 * r - h) / (4 * (3 * r - h));
    return {kPiHere * h * h * (3 * r - h) / 3, half.up * -below};
}

// Signed tetrahedra between a point of the plane and the faces, clipped at the plane; the cut face contributes none.
class ClippedVolume {
public:
    explicit ClippedVolume(const Half& half) : half_(half), apex_(half.up * half.level) {}

    // A convex polygon, counter-clockwise seen from outside.
    template <class CornerOf>
    void Add(int count, const CornerOf& cornerOf) {
        Position first, last;
        int corners = 0;
        const auto emit = [&](const Position& p) {
            if (corners == 0) first = p;
            else if (corners > 1) AddTetrahedron(first, last, p);
            last = p;
            ++corners;
        };
        Position from = cornerOf(count - 1);
        double heightFrom = half_.HeightOf(from);
        for (int i = 0; i < count; ++i) {
            const Position to = cornerOf(i);
            const double heightTo = half_.HeightOf(to);
            if ((heightFrom > 0) != (heightTo > 0)) emit(from + (to - from) * (heightFrom / (heightFrom - heightTo)));
            if (!(heightTo > 0)) emit(to);
            from = to;
            heightFrom = heightTo;
        }
    }
    SubmergedPart Part() const {
        if (!(volume_ > 0)) return {};
        return {volume_, apex_ + moment_ * (1 / volume_)};
    }

private:
    void AddTetrahedron(const Position& a, const Position& b, const Position& c) {
        const Position pa = a - apex_, pb = b - apex_, pc = c - apex_;
        const double volume = Dot<double>(pa, Cross<double>(pb, pc)) / 6;
        volume_ += volume;
        moment_ += (pa + pb + pc) * (volume / 4);
    }

    const Half& half_;
    Position apex_, moment_ = Position::Zero();  // about the apex
    double volume_ = 0;
};

// Calls visit(count, cornerOf, normal) for the faces; cornerOf(i) is a Position.
template <class Visit>
void VisitFaces(const Box& box, Visit&& visit) {
    const Position half = box.HalfExtents().cast<double>();
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const auto cornerOf = [&](int i) {
                constexpr double kU[4] = {-1, 1, 1, -1}, kV[4] = {-1, -1, 1, 1};
                const int at = side > 0 ? i : 3 - i;
                Position p;
                p[axis] = side * half[axis];
                p[u] = kU[at] * half[u];
                p[v] = kV[at] * half[v];
                return p;
            };
            Position normal = Position::Zero();
            normal[axis] = side;
            visit(4, cornerOf, normal);
        }
}
template <class Visit>
void VisitFaces(const ConvexHull& hull, Visit&& visit) {
    for (const ConvexHull::Face& face : hull.Faces())
        visit(
            face.cornerCount,
            [&](int i) {
                const size_t index = face.firstIndex + static_cast<size_t>(i);
                return Position(hull.Vertices()[hull.Indices()[index]].cast<double>());
            },
            Position(face.normal.cast<double>()));
}

template <class Solid>
SubmergedPart ByClipping(const Solid& solid, const Half& half) {
    ClippedVolume clipped(half);
    VisitFaces(solid, [&](int count, const auto& cornerOf, const Position&) { clipped.Add(count, cornerOf); });
    return clipped.Part();
}

SubmergedPart OfHull(const ConvexHull& hull, const Half& half) {
    if (hull.ConvexRadius() == 0) return ByClipping(hull, half);
    const SubmergedPart core = ByClipping(hull, {half.up, std::numeric_limits<float>::max()});
    const double scale = std::cbrt(double{hull.Mass().volume} / core.volume);
    SubmergedPart part = ByClipping(hull, {half.up, half.level / scale});
    part.volume *= scale * scale * scale;
    part.center *= scale;
    return part;
}

// ---- Solids of revolution about y

// The part of a disc of radius r where t <= d: its area and first moment along t.
struct DiscPart {
    double area, moment;
};
DiscPart PartOfDisc(double r, double d) {
    if (d >= r) return {kPiHere * r * r, 0};
    if (d <= -r) return {0, 0};
    const double root = std::sqrt((r - d) * (r + d));
    return {r * r * Acos(-d / r) + d * root, -2.0 / 3.0 * root * root * root};
}

// Roots of a t^2 + b t + c in ascending order; returns how many.
int Roots(double a, double b, double c, double (&roots)[2]) {
    if (std::fabs(a) < 1e-12 * (std::fabs(b) + std::fabs(c))) {
        if (b == 0) return 0;
        roots[0] = -c / b;
        return 1;
    }
    const double discriminant = b * b - 4 * a * c;
    if (discriminant < 0) return 0;
    const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
    roots[0] = q / a;
    roots[1] = q != 0 ? c / q : 0;
    if (roots[0] > roots[1]) std::swap(roots[0], roots[1]);
    return 2;
}

// Below a plane s t + up.y y = level, where t is along the plane's horizontal direction.
class Slices {
public:
    explicit Slices(const Half& half) : half_(half) {
        const double across = std::sqrt(half.up.x() * half.up.x() + half.up.z() * half.up.z());
        slope_ = std::max(across, 1e-9);
        if (across > 0) direction_ = Position(half.up.x() / across, 0, half.up.z() / across);
    }

    void Add(const RevolutionPiece& piece) {
        // Discs are cut where the plane meets the surface: (level - up.y y)^2 = s^2 r^2.
        const double u = half_.up.y(), a = half_.level - u * piece.from, square = slope_ * slope_;
        double cuts[4] = {piece.from, piece.from, piece.to, piece.to}, roots[2];
        const int count =
            Roots(u * u - square * piece.c2, -2 * a * u - square * piece.c1, a * a - square * piece.c0, roots);
        for (int i = 0; i < count; ++i) cuts[1 + i] = std::clamp(piece.from + roots[i], piece.from, piece.to);
        if (count == 1) cuts[2] = piece.to;
        for (int i = 0; i < 3; ++i)
            if (cuts[i + 1] > cuts[i]) AddSmooth(piece, cuts[i], cuts[i + 1]);
    }
    // centerY: of the center frame, where y is that of the pieces.
    SubmergedPart Part(double centerY) const {
        if (!(volume_ > 0)) return {};
        return {volume_, direction_ * (across_ / volume_) + Position(0, along_ / volume_ - centerY, 0)};
    }

private:
    // Gauss and Legendre's rule of eight points, twice.
    void AddSmooth(const RevolutionPiece& piece, double from, double to) {
        const double middle = (from + to) / 2;
        AddHalf(piece, from, middle);
        AddHalf(piece, middle, to);
    }
    void AddHalf(const RevolutionPiece& piece, double from, double to) {
        constexpr double kPlaces[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
        constexpr double kWeights[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
        const double middle = (from + to) / 2, half = (to - from) / 2;
        for (int i = 0; i < 4; ++i)
            for (const double side : {-1.0, 1.0})
                AddSlice(piece, middle + side * half * kPlaces[i], half * kWeights[i]);
    }
    void AddSlice(const RevolutionPiece& piece, double y, double thickness) {
        const double t = y - piece.from, r = std::sqrt(std::max(piece.c0 + t * (piece.c1 + t * piece.c2), 0.0));
        const DiscPart disc = PartOfDisc(r, (half_.level - half_.up.y() * y) / slope_);
        volume_ += disc.area * thickness;
        along_ += disc.area * thickness * y;
        across_ += disc.moment * thickness;
    }

    const Half& half_;
    double slope_;
    Position direction_ = Position(1, 0, 0);
    double volume_ = 0, along_ = 0, across_ = 0;
};

// `half` is seen from the center frame, pieces from the user's.
template <size_t N>
SubmergedPart BySlices(const RevolutionPiece (&pieces)[N], double centerY, const Half& half) {
    const Half seen{half.up, half.level + half.up.y() * centerY};
    Slices slices(seen);
    for (const RevolutionPiece& piece : pieces) slices.Add(piece);
    return slices.Part(centerY);
}

SubmergedPart OfTaperedCapsule(double h, double top, double bottom, double centerY, const Half& half) {
    const double sine = (bottom - top) / (2 * h), cosine = std::sqrt(1 - sine * sine);
    const double low = -h + bottom * sine, high = h + top * sine;
    const RevolutionPiece pieces[3] = {BallSlice(-h - bottom, low, -h, bottom),
                                       Frustum(low, high, bottom * cosine, top * cosine),
                                       BallSlice(high, h + top, h, top)};
    return BySlices(pieces, centerY, half);
}

// An affine image of a ball: a plane at a given fraction of its height cuts off the same fraction of its volume as of a
// ball's, with the center at the same fraction of the line from the middle to the lowest point.
SubmergedPart AsEllipsoid(const ConvexShape& shape, const Half& half) {
    const Vector3 up = half.up.cast<float>();
    const Position top = shape.Support(up).cast<double>(), bottom = shape.Support(Vector3(-up)).cast<double>();
    const double high = Dot<double>(half.up, top), low = Dot<double>(half.up, bottom), radius = (high - low) / 2;
    if (!(radius > 0)) return {};
    const SubmergedPart ball = OfBall(1, {half.up, (half.level - (high + low) / 2) / radius});
    const Position middle = (top + bottom) * 0.5;
    return {ball.volume * double{shape.Mass().volume} * 3 / (4 * kPiHere),
            middle + (bottom - middle) * -Dot<double>(half.up, ball.center)};
}

}  // namespace

SubmergedPart Submerged(const ConvexShape& shape, const Vector3& up, double level) {
    const DefaultFloats floats;
    const Half half{up.cast<double>(), level};
    const double centerY = double{shape.Mass().centerOfMass.y()};
    switch (shape.Type()) {
        case ShapeType::Sphere: return OfBall(double{static_cast<const Sphere&>(shape).Radius()}, half);
        case ShapeType::Box: return ByClipping(static_cast<const Box&>(shape), half);
        case ShapeType::ConvexHull: return OfHull(static_cast<const ConvexHull&>(shape), half);
        case ShapeType::Capsule: {
            const auto& capsule = static_cast<const Capsule&>(shape);
            const double r = capsule.Radius();
            return OfTaperedCapsule(double{capsule.HalfHeight()}, r, r, centerY, half);
        }
        case ShapeType::TaperedCapsule: {
            const auto& capsule = static_cast<const TaperedCapsule&>(shape);
            return OfTaperedCapsule(double{capsule.HalfHeight()}, double{capsule.TopRadius()},
                                    double{capsule.BottomRadius()}, centerY, half);
        }
        case ShapeType::Cylinder: {
            const auto& cylinder = static_cast<const Cylinder&>(shape);
            const double h = cylinder.HalfHeight();
            const RevolutionPiece piece[1] = {
                Frustum(-h, h, double{cylinder.BottomRadius()}, double{cylinder.TopRadius()})};
            return BySlices(piece, centerY, half);
        }
        default: break;
    }
    if (shape.Mass().volume > 0 && shape.Type() != ShapeType::Triangle) return AsEllipsoid(shape, half);
    return {};
}

namespace {

template <class Solid>
float ShadowOfFaces(const Solid& solid, const Position& direction) {
    double area = 0;
    VisitFaces(solid, [&](int count, const auto& cornerOf, const Position& normal) {
        const double cosine = Dot<double>(normal, direction);
        if (!(cosine > 0)) return;
        const Position origin = cornerOf(0);
        Position twice = Position::Zero();
        for (int i = 2; i < count; ++i)
            twice += Cross<double>(Position(cornerOf(i - 1) - origin), Position(cornerOf(i) - origin));
        area += 0.5 * std::sqrt(Dot<double>(twice, twice)) * cosine;
    });
    return static_cast<float>(area);
}

}  // namespace

float ShadowArea(const ConvexShape& shape, const Vector3& direction) {
    const DefaultFloats floats;
    const float pi = static_cast<float>(kPiHere), along = std::fabs(direction.y());
    const float across = std::sqrt(std::max(1 - along * along, 0.0f));
    switch (shape.Type()) {
        case ShapeType::Sphere: return pi * shape.ConvexRadius() * shape.ConvexRadius();
        case ShapeType::Box: return ShadowOfFaces(static_cast<const Box&>(shape), direction.cast<double>());
        case ShapeType::ConvexHull:
            if (shape.ConvexRadius() > 0) break;
            return ShadowOfFaces(static_cast<const ConvexHull&>(shape), direction.cast<double>());
        case ShapeType::Capsule: {
            const auto& capsule = static_cast<const Capsule&>(shape);
            return capsule.Radius() * (pi * capsule.Radius() + 4 * capsule.HalfHeight() * across);
        }
        case ShapeType::Cylinder: {
            const auto& cylinder = static_cast<const Cylinder&>(shape);
            const float r = cylinder.TopRadius();
            if (r != cylinder.BottomRadius()) break;
            return r * (pi * r * along + 4 * cylinder.HalfHeight() * across);
        }
        default: break;
    }
    const Vector3 size = shape.LocalBounds().HalfExtents() * 2.0f, d = direction.cwiseAbs();
    return d.x() * size.y() * size.z() + d.y() * size.z() * size.x() + d.z() * size.x() * size.y();
}

}  // namespace fulcrum
