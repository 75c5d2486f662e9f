#include <Fulcrum/Collision/Queries/ConvexRay.h>

#include <Fulcrum/Collision/Queries/CoreCast.h>
#include <Fulcrum/Collision/Queries/CoreShapes.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The interval of a line that is inside a shape.
struct Chord {
    LineHit in, out;
};

bool ChordOfBall(const Vector3& center, float radius, const LinePiece& line, Chord& chord) {
    const Vector3 from = line.point - center;
    const float along = Dot(from, line.direction);
    // The square of the distance from the center, free of cancellation.
    const Vector3 across = from - line.direction * along;
    const float square = radius * radius - LengthSquared(across);
    if (square < 0) return false;
    const float half = std::sqrt(square), scale = 1 / radius;
    chord.in = {-along - half, (across - line.direction * half) * scale};
    chord.out = {half - along, (across + line.direction * half) * scale};
    return true;
}

bool ChordOfBox(const Vector3& half, const LinePiece& line, Chord& chord) {
    chord.in.distance = -kInfinity;
    chord.out.distance = kInfinity;
    int inAxis = 0, outAxis = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float d = line.direction[axis], p = line.point[axis];
        if (Abs(d) < 1e-12f) {
            if (Abs(p) > half[axis]) return false;
            continue;
        }
        const float inverse = 1 / d, reach = std::copysign(half[axis], d);
        const float in = (-reach - p) * inverse, out = (reach - p) * inverse;
        if (in > chord.in.distance) chord.in.distance = in, inAxis = axis;
        if (out < chord.out.distance) chord.out.distance = out, outAxis = axis;
    }
    if (!(chord.in.distance <= chord.out.distance)) return false;
    chord.in.normal[inAxis] = -std::copysign(1.0f, line.direction[inAxis]);
    chord.out.normal[outAxis] = std::copysign(1.0f, line.direction[outAxis]);
    return true;
}

// The cylinder if the line crosses it between the ends, otherwise the ball at the end.
bool ChordOfCapsule(const Capsule& capsule, const LinePiece& line, Chord& chord) {
    const float h = capsule.HalfHeight(), r = capsule.Radius();
    const double dx = line.direction.x(), dz = line.direction.z(), px = line.point.x(), pz = line.point.z();
    const double a = dx * dx + dz * dz, b = dx * px + dz * pz, cross = dx * pz - dz * px;
    double in = -1e30, out = 1e30;
    if (a > 1e-12) {
        const double square = a * r * r - cross * cross;
        if (square < 0) return false;
        const double root = std::sqrt(square);
        in = (-b - root) / a;
        out = (-b + root) / a;
    } else if (px * px + pz * pz > double{r} * r) {
        return false;
    }
    const auto end = [&](double s, bool isEntry, LineHit& hit) {
        const double y = line.point.y() + line.direction.y() * s;
        if (std::fabs(y) <= h) {
            const float at = static_cast<float>(s);
            const Vector3 point = line.point + line.direction * at;
            hit = {at, Normalized(Vector3(point.x(), 0, point.z()))};
            return true;
        }
        Chord ball;
        if (!ChordOfBall(Vector3(0, y > 0 ? h : -h, 0), r, line, ball)) return false;
        hit = isEntry ? ball.in : ball.out;
        return true;
    };
    return end(in, true, chord.in) && end(out, false, chord.out);
}

struct Lane {
    float value;
    int face;
};

// The best of eight lanes; of equal ones, the lowest face.
Lane Best(const Wide<8>& values, const Wide<8>& faces, float sign) {
    Lane best{values[0], static_cast<int>(faces[0])};
    for (int i = 1; i < 8; ++i) {
        const Lane lane{values[i], static_cast<int>(faces[i])};
        const bool isBetter = sign * lane.value > sign * best.value;
        if (isBetter || (lane.value == best.value && lane.face < best.face)) best = lane;
    }
    return best;
}

// Between the last plane that the line enters and the first that it leaves; eight faces at once. `grown`: m, by which
// the faces are moved outwards.
bool ChordOfFaces(const ConvexHull& hull, float grown, const LinePiece& line, Chord& chord) {
    using Eight = Wide<8>;
    const Eight px(line.point.x()), py(line.point.y()), pz(line.point.z());
    const Eight dx(line.direction.x()), dy(line.direction.y()), dz(line.direction.z());
    const Eight zero(0.0f), infinity(kInfinity), more(grown);
    Eight in = -infinity, out = infinity, inFace = zero, outFace = zero;
    float first[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    Eight faces = Eight::Load(first);
    auto outside = zero < zero;
    for (int i = 0; i < hull.PaddedFaceCount(); i += 8) {
        const Eight nx = Eight::Load(hull.NormalLaneX() + i), ny = Eight::Load(hull.NormalLaneY() + i),
                    nz = Eight::Load(hull.NormalLaneZ() + i);
        const Eight speed = nx * dx + ny * dy + nz * dz;
        const Eight height = Eight::Load(hull.OffsetLane() + i) + more - (nx * px + ny * py + nz * pz);
        const Eight distance = height / speed;
        const auto enters = speed<zero, leaves = speed> zero;
        outside = outside | (~(enters | leaves) & (height < zero));
        const auto later = enters & (distance > in), earlier = leaves & (distance < out);
        in = Select(later, distance, in);
        inFace = Select(later, faces, inFace);
        out = Select(earlier, distance, out);
        outFace = Select(earlier, faces, outFace);
        faces += Eight(8.0f);
    }
    if (outside.Any()) return false;
    const Lane entry = Best(in, inFace, 1), exit = Best(out, outFace, -1);
    if (!(entry.value <= exit.value)) return false;
    const auto normalOf = [&](int face) {
        return Vector3(hull.NormalLaneX()[face], hull.NormalLaneY()[face], hull.NormalLaneZ()[face]);
    };
    chord.in = {entry.value, normalOf(entry.face)};
    chord.out = {exit.value, normalOf(exit.face)};
    return true;
}

enum class ChordAnswer : uint8_t { Miss, Exact, AtMost };

// The chord, or an upper bound: that of the shape enlarged with sharp edges, or of its bounding sphere.
ChordAnswer ChordOf(const ConvexShape& shape, const LinePiece& line, Chord& chord) {
    const auto answer = [](bool hit, bool isExact) {
        return !hit ? ChordAnswer::Miss : isExact ? ChordAnswer::Exact : ChordAnswer::AtMost;
    };
    const bool isSharp = shape.ConvexRadius() == 0;
    switch (shape.Type()) {
        case ShapeType::Sphere: return answer(ChordOfBall(Vector3::Zero(), shape.ConvexRadius(), line, chord), true);
        case ShapeType::Box:
            return answer(ChordOfBox(static_cast<const Box&>(shape).HalfExtents(), line, chord), isSharp);
        case ShapeType::Capsule: return answer(ChordOfCapsule(static_cast<const Capsule&>(shape), line, chord), true);
        case ShapeType::ConvexHull:
            return answer(ChordOfFaces(static_cast<const ConvexHull&>(shape), shape.ConvexRadius(), line, chord),
                          isSharp);
        default: return answer(ChordOfBall(Vector3::Zero(), shape.OuterRadius(), line, chord), false);
    }
}

// `to`: a point where the line has certainly left the shape. A shorter segment only ends the search earlier; the hit is
// bit-identical.
LineResult EnterBetween(const ConvexShape& shape, const LinePiece& line, float from, float to) {
    LineResult result;
    if (!(from <= std::min(to, line.to))) return result;
    const PointCore point;
    CoreMotion motion;
    motion.position = line.point.cast<double>() + line.direction.cast<double>() * double{from};
    motion.displacement = line.direction * (to - from);
    CoreCastLimits limits;
    if (line.to < to) limits.maxFraction = (line.to - from) / (to - from);
    const CoreCastResult cast = CastLinear(shape, point, motion, limits);
    if (!cast.IsHit()) return result;
    result.hit = true;
    result.startsInside = cast.status == CoreCastResult::Status::AtStart && from == line.from;
    result.entry.distance = from + (to - from) * static_cast<float>(cast.fraction);
    result.entry.normal = cast.coresOverlap ? Vector3(-line.direction) : cast.normal;
    return result;
}

}  // namespace

LineResult EnterBySupport(const ConvexShape& shape, const LinePiece& line) {
    Chord chord;
    if (!ChordOfBall(Vector3::Zero(), shape.OuterRadius() * 1.00001f, line, chord)) return {};
    return EnterBetween(shape, line, std::max(line.from, chord.in.distance), chord.out.distance);
}

LineResult EnterConvex(const ConvexShape& shape, const LinePiece& line) {
    Chord chord;
    const ChordAnswer answer = ChordOf(shape, line, chord);
    if (answer == ChordAnswer::Miss || chord.out.distance < line.from || chord.in.distance > line.to) return {};
    if (answer == ChordAnswer::AtMost) return EnterBySupport(shape, line);
    LineResult result;
    result.hit = true;
    result.startsInside = chord.in.distance < line.from;
    result.entry = chord.in;
    return result;
}

bool LeaveConvex(const ConvexShape& shape, const LinePiece& line, LineHit& exit) {
    Chord chord;
    const ChordAnswer answer = ChordOf(shape, line, chord);
    if (answer == ChordAnswer::Exact) {
        exit = chord.out;
        return exit.distance <= line.to;
    }
    // The exit is the entry of the reversed line, from beyond the shape.
    const float beyond = 2 * shape.OuterRadius() + Length(line.point);
    const LinePiece back{line.point, -line.direction, -beyond, -line.from};
    const LineResult entry = EnterBySupport(shape, back);
    if (!entry.hit) return false;
    exit = {-entry.entry.distance, entry.entry.normal};
    return exit.distance <= line.to;
}

}  // namespace fulcrum
