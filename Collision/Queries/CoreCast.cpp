#include <Fulcrum/Collision/Queries/CoreCast.h>

#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

constexpr int kMaxIterations = 64;
constexpr int kMaxTurningIterations = 200;

using Vec4 = std::array<double, 4>;

// The rounding of the shapes' surfaces, m: below it, touching and apart cannot be told apart.
double LeastTolerance(const ConvexShape& a, const ConvexShape& b) {
    const float small = std::min(a.OuterRadius(), b.OuterRadius()), large = std::max(a.OuterRadius(), b.OuterRadius());
    return double{1e-6f * small + 2e-7f * large + 1e-9f};
}

// The two cores with B rotated but not moved: its position is added in double, exactly.
struct TurnedPair {
    const ConvexShape& a;
    const ConvexShape& b;
    Matrix3 rotation;

    SupportVertex Support(const Position& at, const Position& axis) const {
        const Vector3 n = axis.cast<float>();
        const Vector3 onA = a.SupportCore(n), onB = rotation * b.SupportCore(-rotation.TransposeMultiply(n));
        return {at + onB.cast<double>() - onA.cast<double>(), onA, onB};
    }
};

Position StartAxis(const Position& position) {
    const double length = std::sqrt(Dot<double>(position, position));
    return length > 1e-12 ? Position(position * (1 / length)) : Position(0, 1, 0);
}

// The weights of the corners of a tetrahedron around the origin; all zero where it is flat.
Vec4 WeightsInside(const Simplex<SupportVertex>& s) {
    const auto volume = [](const Position& a, const Position& b, const Position& c) {
        return Dot<double>(a, Cross<double>(b, c));
    };
    const Position &a = s.vertices[0].w, &b = s.vertices[1].w, &c = s.vertices[2].w, &d = s.vertices[3].w;
    const Vec4 volumes{volume(b, c, d), -volume(a, c, d), volume(a, b, d), -volume(a, b, c)};
    const double sum = volumes[0] + volumes[1] + volumes[2] + volumes[3];
    if (sum == 0) return {};
    return {volumes[0] / sum, volumes[1] / sum, volumes[2] / sum, volumes[3] / sum};
}

Vector3 PointOnA(const Simplex<SupportVertex>& simplex) {
    Vec4 weights{};
    if (simplex.count == 4) {
        weights = WeightsInside(simplex);
    } else {
        const Position inPlane = ClosestWeights(simplex);
        for (int i = 0; i < 3; ++i) weights[static_cast<size_t>(i)] = inPlane[i];
    }
    Position point = Position::Zero();
    for (int i = 0; i < simplex.count; ++i)
        point += simplex.vertices[i].onA.cast<double>() * weights[static_cast<size_t>(i)];
    return point.cast<float>();
}

CoreCastResult HitAt(CoreCastResult::Status status, double fraction, const Position& normal, const Vector3& onA) {
    CoreCastResult result;
    result.status = status;
    result.fraction = fraction;
    result.normal = Normalized(normal.cast<float>());
    result.onA = onA;
    return result;
}

CoreCastResult::Status Touching(bool advanced) {
    return advanced ? CoreCastResult::Status::Hit : CoreCastResult::Status::AtStart;
}

CoreCastResult CoresOverlapAtStart() {
    CoreCastResult result;
    result.status = CoreCastResult::Status::AtStart;
    result.coresOverlap = true;
    return result;
}

}  // namespace

Quaternion CoreMotion::RotationAt(double fraction) const {
    // Beyond so many radians float gives no meaningful rotation.
    constexpr float kFarthestTurn = 1e6f;
    const Vector3 turned = turn * static_cast<float>(fraction);
    if (!(turned.cwiseAbs().maxCoeff() < kFarthestTurn)) return rotation;
    return Normalized(RotationFromVector(turned) * rotation);
}

CoreCastResult CastLinear(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                          const CoreCastLimits& limits) {
    using Outcome = CoreCastResult::Status;
    const TurnedPair pair{a, b, ToMatrix(motion.rotation)};
    const double target = double{a.ConvexRadius()} + b.ConvexRadius() + limits.separation;
    const double least = LeastTolerance(a, b), tolerance = std::max(double{limits.tolerance}, least);
    const Position displacement = motion.displacement.cast<double>();
    Position at = motion.position, axis = StartAxis(motion.position), provenAxis = axis;
    double fraction = 0;
    bool advanced = false, touches = false;
    Simplex<SupportVertex> simplex;
    for (int i = 0; i < kMaxIterations; ++i) {
        SupportVertex vertex = pair.Support(at, axis);
        const double gap = Dot<double>(axis, vertex.w) - target;
        // The closest points are near enough, and the separation along the axis agrees: the axis is the normal.
        if (touches && gap >= -2 * tolerance) return HitAt(Touching(advanced), fraction, axis, PointOnA(simplex));
        bool moved = false;
        if (gap > 0) {
            const double speed = -Dot<double>(axis, displacement);
            if (!(speed > 0) || gap > speed * (limits.maxFraction - fraction)) return {};
            const double step = gap / speed;
            const Position shift = displacement * step;
            fraction += step;
            at += shift;
            vertex.w += shift;
            for (int k = 0; k < simplex.count; ++k) simplex.vertices[k].w += shift;
            provenAxis = axis;
            moved = advanced = true;
        }
        const bool known = Contains(simplex, vertex);
        // GJK makes no more progress: the cores touch to within rounding.
        if (known && !moved) return HitAt(Touching(advanced), fraction, axis, PointOnA(simplex));
        if (!known) simplex.vertices[simplex.count++] = vertex;
        const Position closest = ClosestOn(simplex);
        const double distance = std::sqrt(Dot<double>(closest, closest));
        if (simplex.count == 4 || distance <= least) {
            if (!advanced) return CoresOverlapAtStart();
            return HitAt(Outcome::Hit, fraction, provenAxis, PointOnA(simplex));
        }
        axis = closest * (1 / distance);
        touches = distance - target <= tolerance;
        // The closest points are too near each other to give a direction: the normal of the last separating plane is
        // used.
        if (touches && advanced && distance <= 100 * least)
            return HitAt(Outcome::Hit, fraction, provenAxis, PointOnA(simplex));
    }
    if (touches) return HitAt(Touching(advanced), fraction, axis, PointOnA(simplex));
    return HitAt(advanced ? Outcome::Early : Outcome::AtStart, fraction, advanced ? provenAxis : axis,
                 PointOnA(simplex));
}

namespace {

// For how long no point of a turning shape comes nearer than the target distance along an axis. All points of B follow
//     n . x(t + s) >= n . (c + r) + s (n . d + r . (n x w)) - s^2 / 2 |w|^2 R,
// r from B's center, R the radius of its core, w the turn: the linear part is smallest for the support of B along
// n + s (n x w), and as a minimum of linear functions it is concave in s. So if the bound holds at the end of an
// interval and the shapes are apart at its beginning, it holds in between.
class AxisAdvance {
public:
    // `gap`: by which B is farther away along the axis now than the target distance, > 0.
    AxisAdvance(const ConvexShape& b, const CoreMotion& motion, const Vector3& axis, const Quaternion& rotation,
                double gap)
        : b_(b),
          axis_(axis),
          turned_(Cross<float>(axis, motion.turn)),
          rotation_(ToMatrix(rotation)),
          gap_(gap),
          approach_(-Dot<double>(axis.cast<double>(), motion.displacement.cast<double>())),
          radius_(b.OuterRadius() - std::min(b.ConvexRadius(), b.OuterRadius())),
          bending_(0.5 * double{LengthSquared(motion.turn)} * radius_),
          lowest_(LowestAlong(0)) {}

    // Proven, in fractions of the motion: `remaining` where it reaches that far.
    double Step(double remaining) const {
        const double speed = approach_ + double{Length(turned_)} * radius_;
        if (speed * remaining <= gap_) return remaining;
        const double sure = gap_ / speed;
        if (!(sure > 0)) return 0;  // overflow: the search ends early
        double low = sure, high = remaining;
        if (Margin(high) > 0) return high;
        // False position with bisection: each iteration costs a support.
        double lowMargin = Margin(low), highMargin = Margin(high);
        if (!(lowMargin > 0)) return sure;
        for (int i = 0; i < 8 && high - low > 0.02 * low; ++i) {
            const double secant = low + (high - low) * 0.95 * lowMargin / (lowMargin - highMargin);
            const bool isBetween = secant > low && secant < high;  // not where margins are not finite
            const double middle = i % 2 == 0 && isBetween ? secant : 0.5 * (low + high);
            const double margin = Margin(middle);
            (margin > 0 ? low : high) = middle;
            (margin > 0 ? lowMargin : highMargin) = margin;
        }
        return low;
    }

private:
    double LowestAlong(double step) const {
        const Vector3 n = axis_ + turned_ * static_cast<float>(step);
        const Vector3 r = rotation_ * b_.SupportCore(-rotation_.TransposeMultiply(n));
        return Dot<double>(n.cast<double>(), r.cast<double>());
    }
    double Margin(double step) const {
        return gap_ - approach_ * step + LowestAlong(step) - lowest_ - bending_ * step * step;
    }

    const ConvexShape& b_;
    Vector3 axis_, turned_;
    Matrix3 rotation_;
    double gap_, approach_, radius_, bending_, lowest_;
};

// Conservative advancement until `separate` (GJK, or a plane) finds the shapes no farther apart than the target
// distance. separate(fraction) returns {apart by more than the target along a unit axis, axis, point of A's core, cores
// overlap}.
struct Separated {
    double gap;
    Vector3 axis;
    Vector3 onA;
    bool coresOverlap;
};

template <class Separate>
CoreCastResult Advance(const ConvexShape& b, const CoreMotion& motion, const CoreCastLimits& limits, double tolerance,
                       const Separate& separate) {
    using Outcome = CoreCastResult::Status;
    double fraction = 0;
    Separated last{0, Vector3(0, 1, 0), Vector3::Zero(), true};
    for (int i = 0; i < kMaxTurningIterations; ++i) {
        const Separated now = separate(fraction, last.axis);
        if (now.coresOverlap || now.gap <= tolerance) {
            if (now.coresOverlap && i == 0) return CoresOverlapAtStart();
            const Separated& known = now.coresOverlap ? last : now;
            return HitAt(i == 0 ? Outcome::AtStart : Outcome::Hit, fraction, known.axis.template cast<double>(),
                         known.onA);
        }
        // Not shortened to maxFraction, so that the hit has the same bits for every maxFraction.
        const double remaining = 1 - fraction;
        // Advances to half the tolerance from touching, so that the search ends there.
        const AxisAdvance advance(b, motion, now.axis, motion.RotationAt(fraction), now.gap - 0.5 * tolerance);
        const double step = advance.Step(remaining);
        if (step >= remaining) return {};
        fraction += step;
        if (fraction > double{limits.maxFraction}) return {};
        last = now;
    }
    return HitAt(Outcome::Early, fraction, last.axis.cast<double>(), last.onA);
}

}  // namespace

CoreCastResult CastTurning(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                           const CoreCastLimits& limits) {
    const double target = double{a.ConvexRadius()} + b.ConvexRadius() + limits.separation;
    const double tolerance = std::max(double{limits.tolerance}, 20 * LeastTolerance(a, b));
    const auto separate = [&](double fraction, const Vector3& guess) -> Separated {
        const Position position = motion.PositionAt(fraction);
        const SupportPair pair(a, b, {position.cast<float>(), motion.RotationAt(fraction)});
        const Vector3 start = fraction == 0 ? Normalized(pair.position) : guess;
        const ConvexGjkResult found = ConvexGjk(pair, start, std::numeric_limits<float>::infinity());
        const bool overlap = found.status == GjkStatus::Overlapping;
        // The separation along the axis, which may be less than the distance of the points by rounding.
        return {double{pair.SeparationAlong(found.axis)} - target, found.axis, found.onA, overlap};
    };
    return Advance(b, motion, limits, tolerance, separate);
}

CoreCastResult CastByLibccd(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                            const CoreCastLimits& limits) {
    const double target = double{a.ConvexRadius()} + b.ConvexRadius() + limits.separation;
    const double tolerance = std::max(double{limits.tolerance}, 20 * LeastTolerance(a, b));
    const auto separate = [&](double fraction, const Vector3&) -> Separated {
        const RelativePose pose{motion.PositionAt(fraction).cast<float>(), motion.RotationAt(fraction)};
        const SupportPair pair(a, b, pose);
        const LibccdVerdict verdict = AskLibccd(pair, pose, limits.separation + static_cast<float>(tolerance));
        if (verdict.apart) {
            const double gap = double{pair.SeparationAlong(verdict.axis)} - target;
            if (gap > tolerance) return {gap, verdict.axis, a.SupportCore(verdict.axis), false};
        }
        CollideCounters unused;
        const std::optional<KnownContact> touch =
            FindLibccdContact(pair, pose, std::numeric_limits<float>::infinity(), unused);
        if (!touch) return {0, Vector3(0, 1, 0), Vector3::Zero(), true};  // not finite
        // Later it is known how deep they are by rounding, and along which axis.
        const bool coresOverlap = fraction == 0 && touch->separation <= 0;
        return {double{touch->separation} - target, touch->axis, touch->onA, coresOverlap};
    };
    // What is within the tolerance, but apart, and moves away straight does not touch, as in CastLinear.
    if (!motion.IsTurning()) {
        const Separated start = separate(0, Vector3(0, 1, 0));
        if (start.gap > 0 && Dot(start.axis, motion.displacement) >= 0) return {};
    }
    return Advance(b, motion, limits, tolerance, separate);
}

CoreCastResult CastToPlane(const Vector3& normal, double offset, const ConvexShape& b, const CoreMotion& motion,
                           const CoreCastLimits& limits) {
    using Outcome = CoreCastResult::Status;
    const Position n = normal.cast<double>();
    const double target = double{b.ConvexRadius()} + limits.separation;
    const auto separate = [&](double fraction, const Vector3&) -> Separated {
        const Matrix3 rotation = ToMatrix(motion.RotationAt(fraction));
        const Vector3 support = rotation * b.SupportCore(-rotation.TransposeMultiply(normal));
        const Position lowest = motion.PositionAt(fraction) + support.cast<double>();
        const double height = Dot<double>(n, lowest) - offset;
        return {height - target, normal, Vector3((lowest - n * height).cast<float>()), false};
    };
    const double tolerance = std::max(double{limits.tolerance}, 1e-6 * double{b.OuterRadius()} + 1e-9);
    if (motion.IsTurning()) return Advance(b, motion, limits, tolerance, separate);
    const Separated start = separate(0, normal);
    if (start.gap <= 0) return HitAt(Outcome::AtStart, 0, n, start.onA);
    const double speed = -Dot<double>(n, motion.displacement.cast<double>());
    if (!(speed > 0) || start.gap > speed * limits.maxFraction) return {};
    const double fraction = start.gap / speed;
    return HitAt(Outcome::Hit, fraction, n, separate(fraction, normal).onA);
}

}  // namespace fulcrum
