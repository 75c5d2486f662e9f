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
// rad: float has no meaningful rotation beyond that, and none takes place.
constexpr float kFarthestTurn = 1e6f;

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

// Time for which two rotating shapes certainly stay farther apart than the target distance along an axis n, which is at
// rest or rotates by u. With r from the center c of a shape, R the radius of its core, w its turn, d the displacement,
// the position of a point along the axis is n . (c + d s + r) at the time s. Its second derivative is at most
//     |w| |w x n| R, or (|w| + |u|)^2 R if the axis rotates, or nothing if w = u, for r,
//     |u|^2 (|c| + |d| s) + 2 |u| |d| for c.
// A function whose second derivative is at most k exceeds the chord over an interval of length h by no more than
// k s (h - s) / 2. The extent of a shape is the maximum over its points, which the chord between the maxima at both
// ends bounds, too. So the shapes stay apart if they are at both ends, by enough for that in between.
//
// Along an axis at rest the far ends of a large shape that rotates soon come as far as a small one beside it, wherever
// that is. An axis that rotates with the large shape is only limited by how the small one moves relative to it.
class AxisAdvance {
public:
    // `gap`: current separation along the axis minus the target distance, > 0. `axis`, unit, and `axisTurn`, of the
    // axis: in the motion's axes.
    AxisAdvance(const ConvexShape& a, const ConvexShape& b, const CoreMotion& motion, const CorePoses& now,
                const Vector3& axis, double gap, const Vector3& axisTurn = Vector3::Zero())
        : axis_(axis, axisTurn),
          a_(a, 1, axis, motion.turnOfA, axisTurn, now.rotationOfA),
          b_(b, -1, axis, motion.turn, axisTurn, now.rotation),
          center_(motion.PositionAt(now.fraction)),
          displacement_(motion.displacement.cast<double>()),
          gap_(gap),
          start_(Along(0)),
          approach_(-Dot<double>(axis.cast<double>(), displacement_)) {
        const double turn = double{Length(axisTurn)};
        if (turn > 0) {
            const double moved = std::sqrt(Dot<double>(displacement_, displacement_)),
                         distance = std::sqrt(Dot<double>(center_, center_));
            approach_ -= Dot<double>(Cross<float>(axisTurn, axis).cast<double>(), center_);
            curvature_ = turn * (turn * (distance + moved) + 2 * moved);
        }
        acceleration_ = curvature_;
        curvature_ += a_.Curvature() + b_.Curvature();
    }

    // Proven time step, as a fraction of the motion; at most `remaining`.
    double Step(double remaining) const {
        // Most of the gap is enough, and more evaluations save hardly any GJK: it finds a better axis.
        constexpr int kEvaluations = 8;
        constexpr double kEnough = 0.05;
        const double fastest = approach_ + acceleration_ * remaining + a_.Speed() + b_.Speed();
        if (fastest * remaining <= gap_) return remaining;
        if (!(gap_ / fastest > 0)) return 0;  // overflow: the search ends early
        double from = 0, gap = gap_, to = remaining, gapAtEnd = GapAt(to);
        if (StayApart(gap, gapAtEnd, to)) return remaining;
        for (int i = 0; i < kEvaluations && gap > kEnough * gap_; ++i) {
            const double part = gapAtEnd < 0 ? gap / (gap - gapAtEnd) : 0.5;  // false position, or bisection
            const double step = std::max((to - from) * part, gap / fastest), gapThen = GapAt(from + step);
            if (StayApart(gap, gapThen, step)) {
                from += step;
                gap = gapThen;
            } else {
                to = from + step;
                gapAtEnd = gapThen;
            }
        }
        return std::min(from + gap / fastest, remaining);
    }

private:
    // A vector that rotates at a constant rate. turn: rad per motion.
    class Rotating {
    public:
        Rotating(const Vector3& v, const Vector3& turn)
            : rate_(Length(turn)),
              along_(rate_ > 0 ? Vector3(turn * (Dot<float>(turn, v) / (rate_ * rate_))) : v),
              across_(v - along_),
              around_(rate_ > 0 ? Vector3(Cross<float>(turn, v) * (1 / rate_)) : Vector3(Vector3::Zero())) {}
        bool IsTurning() const { return rate_ > 0; }
        Vector3 At(double time) const {
            const float angle = rate_ * static_cast<float>(time);
            const SineCosine<float> of = SinCos<float>(angle < kFarthestTurn ? angle : 0.0f);
            return along_ + across_ * of.cosine + around_ * of.sine;
        }

    private:
        float rate_;
        Vector3 along_, across_, around_;
    };

    // The extent of a shape rotating about its center along the axis, or against it with sign -1.
    class Extent {
    public:
        Extent(const ConvexShape& shape, float sign, const Vector3& axis, const Vector3& turn, const Vector3& axisTurn,
               const Quaternion& rotation)
            : shape_(shape),
              sign_(sign),
              turn_(turn),
              rotation_(rotation),
              axis_(InverseRotate(rotation, axis), -InverseRotate(rotation, turn)),
              isTurning_(!(turn - axisTurn).isZero(0)) {
            if (!isTurning_) return;
            const double radius = double{shape.OuterRadius() - std::min(shape.ConvexRadius(), shape.OuterRadius())},
                         rate = double{Length(turn)}, both = rate + double{Length(axisTurn)};
            const bool isAxisAtRest = axisTurn.isZero(0);
            const Vector3 relative = turn - axisTurn;
            speed_ = radius * double{Length(isAxisAtRest ? Cross<float>(axis, relative) : relative)};
            curvature_ = isAxisAtRest ? rate * speed_ : both * both * radius;
        }

        bool IsTurning() const { return isTurning_; }
        double Speed() const { return speed_; }          // upper bound; m per motion
        double Curvature() const { return curvature_; }  // likewise; m per motion squared
        // m, of the core. axis: in the motion's axes; null: at rest.
        double At(double time, const Vector3* axis) const {
            const Vector3 n = axis ? InAxesAt(time, *axis) : axis_.At(time);
            return Dot<double>(n.cast<double>(), shape_.SupportCore(n * sign_).cast<double>());
        }

    private:
        Vector3 InAxesAt(double time, const Vector3& v) const {
            return InverseRotate(TurnedBy(turn_ * static_cast<float>(time), rotation_), v);
        }

        const ConvexShape& shape_;
        float sign_;
        Vector3 turn_;
        Quaternion rotation_;  // now
        Rotating axis_;        // in the shape's axes, if it is at rest
        bool isTurning_;
        double speed_ = 0, curvature_ = 0;
    };

    // m: the extents of what turns relative to the axis, and the distance of the centers if the axis turns.
    double Along(double time) const {
        const Vector3 axis = axis_.IsTurning() ? axis_.At(time) : Vector3(Vector3::Zero());
        const Vector3* turned = axis_.IsTurning() ? &axis : nullptr;
        double sum = 0;
        if (turned) sum += Dot<double>(axis.cast<double>(), Position(center_ + displacement_ * time));
        if (b_.IsTurning()) sum += b_.At(time, turned);
        if (a_.IsTurning()) sum -= a_.At(time, turned);
        return sum;
    }
    double GapAt(double time) const { return gap_ + Along(time) - start_ - (axis_.IsTurning() ? 0 : approach_ * time); }
    // Whether the gap stays positive over an interval with these gaps at its ends.
    bool StayApart(double start, double end, double length) const {
        if (!(start > 0 && end > 0)) return false;
        const double bend = curvature_ * length * length;  // k h^2
        if (!(std::fabs(end - start) < 0.5 * bend)) return bend < std::numeric_limits<double>::infinity();
        const double at = 0.5 - (end - start) / bend;  // of the least
        return start + (end - start) * at - 0.5 * bend * at * (1 - at) > 0;
    }

    Rotating axis_;
    Extent a_, b_;
    Position center_, displacement_;  // m, of B's center relative to A's
    double gap_, start_;
    double approach_;  // m per motion, of the centers along the axis, now
    double acceleration_ = 0, curvature_ = 0;
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
