#include <Fulcrum/Collision/Queries/CoreCast.h>

#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/Collision/Queries/CoreShapes.h>
#include <Fulcrum/Math/Trigonometry.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

constexpr int kMaxIterations = 64;
constexpr int kMaxTurningIterations = 200;
// Axes that rotate with a shape are tried if it is larger than the other by this factor.
constexpr float kFarLarger = 50;

using Vec4 = std::array<double, 4>;

// The rounding error of the shapes' surfaces, m.
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

// The weights of the corners of a tetrahedron around the origin; all zero if it is flat.
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

Quaternion TurnedBy(const Vector3& turn, const Quaternion& rotation) {
    // rad: float has no meaningful rotation beyond that.
    constexpr float kFarthestTurn = 1e6f;
    if (!(turn.cwiseAbs().maxCoeff() < kFarthestTurn)) return rotation;
    return Normalized(RotationFromVector(turn) * rotation);
}

}  // namespace

CorePoses CoreMotion::At(double fraction) const {
    CorePoses poses{fraction, TurnedBy(turn * static_cast<float>(fraction), rotation), {}, {}};
    poses.bInA = {PositionAt(fraction).cast<float>(), poses.rotation};
    if (turnOfA.isZero(0)) return poses;
    poses.rotationOfA = TurnedBy(turnOfA * static_cast<float>(fraction), {});
    poses.bInA = Inverse({Vector3::Zero(), poses.rotationOfA}) * poses.bInA;
    return poses;
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
        // The closest points are close enough, and the separation along the axis agrees: the axis is the normal.
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
        // The closest points are too close to define a direction: the normal of the last separating plane is used.
        if (touches && advanced && distance <= 100 * least)
            return HitAt(Outcome::Hit, fraction, provenAxis, PointOnA(simplex));
    }
    if (touches) return HitAt(Touching(advanced), fraction, axis, PointOnA(simplex));
    return HitAt(advanced ? Outcome::Early : Outcome::AtStart, fraction, advanced ? provenAxis : axis,
                 PointOnA(simplex));
}

namespace {

// Lower bound of the time for which two rotating shapes stay farther apart than the target distance along an axis n,
// which is at rest or rotates by u. With r from the center c of a shape, R the radius of its core, w its turn, d the
// displacement:
//     n . x(t + s) = n . (c + r) + s (n . d + (u x n) . c + r . (n x (w - u))) + at most the bending,
// s^2 / 2 (|w| + |u|)^2 R, or nothing if w = u, for r, and s^2 (|u|^2 |c| / 2 + |u| |d|) + s^3 |u|^2 |d| / 6 for c. The
// linear part is extreme for the shape's support along n + s (n x (w - u)). The difference of B's and A's extremes is a
// minimum of linear functions, hence concave in s. So if the bound holds at the end of an interval and the shapes are
// apart at its beginning, it holds in between.
//
// Along an axis at rest the far ends of a large shape that rotates soon come as far as a small one beside it, wherever
// that is. An axis that rotates with the large shape is only limited by how the small one moves relative to it.
class AxisAdvance {
public:
    // `gap`: current separation along the axis minus the target distance, > 0. `axis`, unit, and `axisTurn`, of the
    // axis: in the motion's axes.
    AxisAdvance(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion, const CorePoses& now,
                const Vector3& axis, double gap, const Vector3& axisTurn = Vector3::Zero())
        : a_(a, 1, axis, motion.turnOfA, axisTurn, now.rotationOfA),
          b_(b, -1, axis, motion.turn, axisTurn, now.rotation),
          gap_(gap),
          approach_(-Dot<double>(axis.cast<double>(), motion.displacement.cast<double>())),
          bending_(a_.Bending() + b_.Bending()) {
        if (axisTurn.isZero(0)) return;
        const Position center = motion.PositionAt(now.fraction);
        const double turn = double{Length(axisTurn)}, moved = double{Length(motion.displacement)},
                     distance = std::sqrt(Dot<double>(center, center));
        approach_ -= Dot<double>(Cross<float>(axisTurn, axis).cast<double>(), center);
        bending_ += turn * (0.5 * turn * distance + moved);
        twist_ = turn * turn * moved / 6;
        acceleration_ = bending_ + twist_;
    }

    // Proven time step, as a fraction of the motion; at most `remaining`.
    double Step(double remaining) const {
        const double speed = approach_ + a_.Speed() + b_.Speed();
        if ((speed + acceleration_ * remaining) * remaining <= gap_) return remaining;
        const double sure = 2 * gap_ / (speed + std::sqrt(speed * speed + 4 * acceleration_ * gap_));
        if (!(sure > 0)) return 0;  // overflow: the search ends early
        double low = sure, high = remaining;
        if (Margin(high) > 0) return high;
        // False position with bisection: each iteration costs two supports.
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
    // The extent of a shape rotating about its center along the axis, or against it with sign -1.
    class Turning {
    public:
        Turning(const ConvexShape& shape, float sign, const Vector3& axis, const Vector3& turn, const Vector3& axisTurn,
                const Quaternion& rotation)
            : shape_(shape),
              sign_(sign),
              axis_(axis),
              turned_(Cross<float>(axis, Vector3(turn - axisTurn))),
              rotation_(ToMatrix(rotation)),
              radius_(shape.OuterRadius() - std::min(shape.ConvexRadius(), shape.OuterRadius())),
              isTurning_(!(turn - axisTurn).isZero(0)),
              bending_(isTurning_ ? BendingOf(turn, axisTurn) * radius_ : 0),
              start_(isTurning_ ? Extreme(0) : 0) {}

        bool IsTurning() const { return isTurning_; }
        double Speed() const { return double{Length(turned_)} * radius_; }  // upper bound; m per motion
        double Bending() const { return bending_; }
        // Along the axis, m: of the points that are extreme in the linear part of their motion.
        double Extreme(double step) const {
            const Vector3 n = axis_ + turned_ * static_cast<float>(step);
            const Vector3 r = rotation_ * shape_.SupportCore(rotation_.TransposeMultiply(n) * sign_);
            return Dot<double>(n.cast<double>(), r.cast<double>());
        }
        double Start() const { return start_; }

    private:
        static double BendingOf(const Vector3& turn, const Vector3& axisTurn) {
            if (axisTurn.isZero(0)) return 0.5 * double{LengthSquared(turn)};
            const double both = double{Length(turn)} + double{Length(axisTurn)};
            return 0.5 * both * both;
        }

        const ConvexShape& shape_;
        float sign_;
        Vector3 axis_, turned_;
        Matrix3 rotation_;
        double radius_;
        bool isTurning_;
        double bending_, start_;
    };

    double Margin(double step) const {
        double margin = gap_ - approach_ * step;
        if (b_.IsTurning()) margin += b_.Extreme(step) - b_.Start();
        if (a_.IsTurning()) margin -= a_.Extreme(step) - a_.Start();
        return margin - (bending_ + twist_ * step) * step * step;
    }

    Turning a_, b_;
    double gap_, approach_, bending_, twist_ = 0;
    // What the speed may grow by, m: none along an axis at rest, where the speeds of the shapes are those of all times.
    double acceleration_ = 0;
};

bool IsFarLarger(const ConvexShape& shape, const ConvexShape& other) {
    return shape.OuterRadius() > kFarLarger * other.OuterRadius();
}

// A proven step along an axis of the time `now`, as a fraction of the motion.
double ProvenStep(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion, const CorePoses& now,
                  const Vector3& axis, double gap, double remaining) {
    const double step = AxisAdvance(a, b, motion, now, axis, gap).Step(remaining);
    if (step >= remaining) return step;
    const auto stepAlong = [&](const Vector3& turn) {
        return turn.isZero(0) ? 0.0 : AxisAdvance(a, b, motion, now, axis, gap, turn).Step(remaining);
    };
    if (IsFarLarger(b, a)) return std::max(step, stepAlong(motion.turn));
    if (IsFarLarger(a, b)) return std::max(step, stepAlong(motion.turnOfA));
    return step;
}

// Conservative advancement until `separate` (GJK, or a plane) finds the shapes no farther apart than the target
// distance. separate(const CorePoses&, guess) returns {apart by more than the target along a unit axis, axis, point of
// A's core, cores overlap}, all in A's axes of then, as the guess is.
struct Separated {
    double gap;
    Vector3 axis;
    Vector3 onA;
    bool coresOverlap;
};

// `from`, `to`: the interval of the motion outside of which they do not touch. isHalfSpace: A is one, not a point.
template <class Separate>
CoreCastResult Advance(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                       const CoreCastLimits& limits, double tolerance, const Separate& separate, double from = 0,
                       double to = 1, bool isHalfSpace = false) {
    using Outcome = CoreCastResult::Status;
    const bool turnsA = !motion.turnOfA.isZero(0);
    double fraction = from;
    Separated last{0, Normalized(motion.PositionAt(from).cast<float>(), Vector3(0, 1, 0)), Vector3::Zero(), true};
    for (int i = 0; i < kMaxTurningIterations; ++i) {
        const CorePoses poses = motion.At(fraction);
        Separated now = separate(poses, turnsA ? InverseRotate(poses.rotationOfA, last.axis) : last.axis);
        if (turnsA) {
            now.axis = Rotate(poses.rotationOfA, now.axis);
            now.onA = Rotate(poses.rotationOfA, now.onA);
        }
        if (now.coresOverlap || now.gap <= tolerance) {
            if (now.coresOverlap && fraction == 0) return CoresOverlapAtStart();
            const Separated& known = now.coresOverlap ? last : now;
            return HitAt(fraction == 0 ? Outcome::AtStart : Outcome::Hit, fraction, known.axis.template cast<double>(),
                         known.onA);
        }
        // Not shortened to maxFraction, so that the hit is bit-identical for every maxFraction.
        const double remaining = to - fraction;
        // Advances to half the tolerance from touching, so that the search ends there.
        const double gap = now.gap - 0.5 * tolerance;
        const double step = isHalfSpace ? AxisAdvance(a, b, motion, poses, now.axis, gap).Step(remaining)
                                        : ProvenStep(a, b, motion, poses, now.axis, gap, remaining);
        if (step >= remaining) return {};
        fraction += step;
        if (fraction > limits.maxFraction) return {};
        last = now;
    }
    return HitAt(Outcome::Early, fraction, last.axis.cast<double>(), last.onA);
}

// The interval of the motion in which the centers are no farther apart than `reach`; empty: never.
struct MotionPart {
    double from = 0, to = -1;
};
MotionPart PartWithin(const CoreMotion& motion, double reach) {
    const Position d = motion.displacement.cast<double>();
    const double square = Dot<double>(d, d), along = Dot<double>(d, motion.position),
                 beyond = Dot<double>(motion.position, motion.position) - reach * reach;
    if (!(square > 0)) return beyond > 0 ? MotionPart{} : MotionPart{0, 1};
    const double root = along * along - square * beyond;
    if (root < 0) return {};
    return {std::max(0.0, (-along - std::sqrt(root)) / square), std::min(1.0, (-along + std::sqrt(root)) / square)};
}

}  // namespace

CoreCastResult CastTurning(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                           const CoreCastLimits& limits) {
    const double target = double{a.ConvexRadius()} + b.ConvexRadius() + limits.separation;
    const double tolerance = std::max(double{limits.tolerance}, 20 * LeastTolerance(a, b));
    const auto separate = [&](const CorePoses& poses, const Vector3& guess) -> Separated {
        const SupportPair pair(a, b, poses.bInA);
        const ConvexGjkResult found = ConvexGjk(pair, guess, std::numeric_limits<float>::infinity());
        const bool overlap = found.status == GjkStatus::Overlapping;
        // The separation along the axis, which may be less than the distance of the points by rounding.
        return {double{pair.SeparationAlong(found.axis)} - target, found.axis, found.onA, overlap};
    };
    const double reach = (double{a.OuterRadius()} + b.OuterRadius()) * (1 + 1e-6) + limits.separation + tolerance;
    const MotionPart part = PartWithin(motion, reach);
    if (!(part.from <= part.to) || part.from > limits.maxFraction) return {};
    return Advance(a, b, motion, limits, tolerance, separate, part.from, part.to);
}

CoreCastResult CastByLibccd(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion,
                            const CoreCastLimits& limits) {
    const double target = double{a.ConvexRadius()} + b.ConvexRadius() + limits.separation;
    const double tolerance = std::max(double{limits.tolerance}, 20 * LeastTolerance(a, b));
    const auto separate = [&](const CorePoses& poses, const Vector3&) -> Separated {
        const RelativePose& pose = poses.bInA;
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
        // At later times an overlap is only rounding error, and the axis is known.
        const bool coresOverlap = poses.fraction == 0 && touch->separation <= 0;
        return {double{touch->separation} - target, touch->axis, touch->onA, coresOverlap};
    };
    // Shapes within the tolerance that are separated and move apart without rotation do not touch, as in CastLinear.
    if (!motion.IsTurning()) {
        const Separated start = separate(motion.At(0), Vector3(0, 1, 0));
        if (start.gap > 0 && Dot(start.axis, motion.displacement) >= 0) return {};
    }
    return Advance(a, b, motion, limits, tolerance, separate);
}

CoreCastResult CastToPlane(const Vector3& normal, double offset, const ConvexShape& b, const CoreMotion& motion,
                           const CoreCastLimits& limits) {
    using Outcome = CoreCastResult::Status;
    const Position n = normal.cast<double>();
    const double target = double{b.ConvexRadius()} + limits.separation;
    const auto separate = [&](const CorePoses& poses, const Vector3&) -> Separated {
        const Matrix3 rotation = ToMatrix(poses.rotation);
        const Vector3 support = rotation * b.SupportCore(-rotation.TransposeMultiply(normal));
        const Position lowest = motion.PositionAt(poses.fraction) + support.cast<double>();
        const double height = Dot<double>(n, lowest) - offset;
        return {height - target, normal, Vector3((lowest - n * height).cast<float>()), false};
    };
    const double tolerance = std::max(double{limits.tolerance}, 1e-6 * double{b.OuterRadius()} + 1e-9);
    if (motion.IsTurning()) return Advance(PointCore{}, b, motion, limits, tolerance, separate, 0, 1, true);
    const Separated start = separate(motion.At(0), normal);
    if (start.gap <= 0) return HitAt(Outcome::AtStart, 0, n, start.onA);
    const double speed = -Dot<double>(n, motion.displacement.cast<double>());
    if (!(speed > 0) || start.gap > speed * limits.maxFraction) return {};
    const double fraction = start.gap / speed;
    return HitAt(Outcome::Hit, fraction, n, separate(motion.At(fraction), normal).onA);
}

}  // namespace fulcrum
