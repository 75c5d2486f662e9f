#include <Fulcrum/Physics/Stages/SensorVisits.h>

#include <Fulcrum/Collision/Queries/Distance.h>
#include <Fulcrum/Collision/Queries/Pieces.h>
#include <Fulcrum/Collision/Queries/ShapeCast.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Physics/Stages/PlacedConvex.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>

#include <algorithm>

namespace fulcrum {

namespace {

// rad: smaller rotations are ignored by casts.
constexpr float kLeastTurn = 1e-4f;
// Subdivisions per radian: within each, the one of two rotating shapes that is not cast keeps its rotation.
constexpr float kPartsPerRadian = 16, kMostParts = 32;
// Fraction of the step: visits closer than this, as of adjacent shapes, are merged.
constexpr float kSameTime = 1e-6f;

Pose PoseOf(const ColliderShape& piece, const Pose& body) { return piece.offset ? body * piece.local : body; }

// A collider of a body on a segment of its path.
struct Mover {
    const MotionPath& path;
    const MotionSegment& segment;
    const ColliderShape& piece;

    Pose BodyAt(float time) const { return path.PoseAt(segment, time); }
    Pose PieceAt(float time) const { return PoseOf(piece, BodyAt(time)); }
    bool IsStill() const { return segment.sweep.displacement.isZero(0) && segment.sweep.turn.isZero(0); }
    // rad; zero for balls, whose rotation has no effect.
    float Angle(float from, float until) const {
        const bool isRound = piece.shape->Type() == ShapeType::Sphere && !piece.offset;
        return isRound ? 0.0f : Length(segment.sweep.TurnRate()) * (until - from);
    }
    float Radius() const { return piece.shape->OuterRadius() + Length(piece.local.position); }
    bool IsConvex() const { return piece.shape->IsConvex(); }
};

struct Touch {
    bool found = false;
    bool isSure = true;  // else they are separated until that time, and close to each other
    float time = 0;
};

// Casts from `start` to `end`, which may be earlier (backwards). The other keeps the rotation of the middle of the
// interval.
Touch Cast(const Mover& caster, const Mover& other, float start, float end, NarrowPhaseMethod method) {
    const ConvexShape& shape = static_cast<const ConvexShape&>(*caster.piece.shape);
    const float from = std::min(start, end), until = std::max(start, end);
    const bool turns = caster.Angle(from, until) > kLeastTurn;
    const PlacedConvex placed(shape, caster.piece.local);
    ShapeMotion motion;
    motion.pose = turns ? caster.BodyAt(start) : caster.PieceAt(start);
    const Pose last = turns ? caster.BodyAt(end) : caster.PieceAt(end);
    Pose at = other.PieceAt(start);
    motion.displacement =
        Between(motion.pose.position, last.position) - Between(at.position, other.PieceAt(end).position);
    if (turns) motion.turn = caster.segment.sweep.TurnRate() * (end - start);
    if (other.Angle(from, until) > kLeastTurn) at.rotation = other.PieceAt(0.5f * (start + end)).rotation;
    const ConvexShape* cast = &shape;
    if (turns && caster.piece.offset) cast = &placed;
    ShapeCastSettings settings;
    settings.backFaces = true;
    settings.measureDepth = false;
    ShapeHit hit;
    if (!ShapeCaster(*cast, motion, method).CastClosest(*other.piece.shape, at, settings, hit)) return {};
    return {true, !hit.isEarly, std::clamp(start + hit.fraction * (end - start), from, until)};
}

// The first time between `start` and `end` at which the two touch.
Touch FirstTouch(const Mover& sensor, const Mover& body, float start, float end, NarrowPhaseMethod method) {
    if (!sensor.IsConvex() && !body.IsConvex()) return {};
    const float from = std::min(start, end), until = std::max(start, end);
    const float sensorAngle = sensor.Angle(from, until), bodyAngle = body.Angle(from, until);
    const bool castsBody =
        body.IsConvex() && (!sensor.IsConvex() || bodyAngle * body.Radius() >= sensorAngle * sensor.Radius());
    const Mover &caster = castsBody ? body : sensor, &other = castsBody ? sensor : body;
    const float angle = castsBody ? sensorAngle : bodyAngle;
    const int parts =
        angle > kLeastTurn ? static_cast<int>(std::clamp(std::ceil(kPartsPerRadian * angle), 1.0f, kMostParts)) : 1;
    for (int i = 0; i < parts; ++i) {
        const float a = start + (end - start) * (static_cast<float>(i) / static_cast<float>(parts));
        const float b =
            i + 1 == parts ? end : start + (end - start) * (static_cast<float>(i + 1) / static_cast<float>(parts));
        if (const Touch touch = Cast(caster, other, a, b, method); touch.found) return touch;
    }
    return {};
}

class PairSearch {
public:
    PairSearch(const CollisionView& view, uint32_t place, const MotionPath& sensorPath, const MotionPath& bodyPath,
               Array<SensorVisit>& visits)
        : view_(view),
          place_(place),
          sensorPath_(sensorPath),
          bodyPath_(bodyPath),
          visits_(visits),
          first_(visits.size()) {}

    void Run(AtStart atStart) {
        if (!IsOnePiece(view_.bodies, sensorPath_.Body()) || !IsOnePiece(view_.bodies, bodyPath_.Body()))
            atStart = AtStart::Unknown;
        VisitColliders(view_.bodies, view_.colliders, bodyPath_.Body(), [&](uint32_t j) {
            const Bounds bounds = PieceBounds(view_.bodies, view_.colliders, bodyPath_, j);
            VisitColliders(view_.bodies, view_.colliders, sensorPath_.Body(), [&](uint32_t i) {
                if (bounds.Overlaps(view_.colliders.colliders[i].fat)) RunPieces(i, j, atStart);
            });
        });
        Merge();
    }

private:
    NarrowPhaseMethod Method() const { return view_.step.settings.narrowPhase; }

    void RunPieces(uint32_t sensorCollider, uint32_t bodyCollider, AtStart atStart) {
        const ColliderShape sensorPiece = PieceOf(view_.bodies, view_.colliders, sensorCollider),
                            bodyPiece = PieceOf(view_.bodies, view_.colliders, bodyCollider);
        const MotionSegment* a = sensorPath_.Segments().data();
        const MotionSegment* b = bodyPath_.Segments().data();
        bool inside = atStart == AtStart::Inside;
        if (atStart == AtStart::Unknown)
            inside = IsOverlap({sensorPath_, *a, sensorPiece}, {bodyPath_, *b, bodyPiece}, 0);
        for (float from = 0; from < 1;) {
            const float until = std::min(a->until, b->until);
            inside = Stretch({sensorPath_, *a, sensorPiece}, {bodyPath_, *b, bodyPiece}, from, until, inside);
            if (until >= 1) return;
            if (a->until <= until) ++a;
            if (b->until <= until) ++b;
            from = until;
        }
    }

    bool IsOverlap(const Mover& sensor, const Mover& body, float time) const {
        return Overlap(*sensor.piece.shape, *body.piece.shape, Relative(sensor.PieceAt(time), body.PieceAt(time)),
                       Method());
    }

    // Returns whether they overlap at its end.
    bool Stretch(const Mover& sensor, const Mover& body, float from, float until, bool wasInside) {
        if (sensor.IsStill() && body.IsStill()) {
            if (wasInside) Add(from, until, wasInside, true);
            return wasInside;
        }
        const bool isInside = IsOverlap(sensor, body, until);
        if (wasInside && isInside) {
            Add(from, until, true, true);
        } else if (wasInside) {
            const Touch last = FirstTouch(sensor, body, until, from, Method());
            Add(from, last.found ? last.time : from, true, false);
        } else {
            const Touch first = FirstTouch(sensor, body, from, until, Method());
            if (isInside) {
                Add(first.found ? first.time : until, until, false, true);
            } else if (first.found && first.isSure) {
                const Touch last = FirstTouch(sensor, body, until, from, Method());
                Add(first.time, last.found ? std::max(first.time, last.time) : first.time, false, false);
            }
        }
        return isInside;
    }

    void Add(float from, float until, bool inFrom, bool inUntil) {
        SensorVisit visit;
        visit.sensor = place_;
        visit.body = bodyPath_.Body();
        visit.from = from;
        visit.until = until;
        visit.atStart = inFrom && from <= 0;
        visit.atEnd = inUntil && until >= 1;
        visits_.push_back(visit);
    }

    // Merges visits that several colliders or segments of the path found at the same time.
    void Merge() {
        if (visits_.size() - first_ < 2) return;
        const auto begin = visits_.begin() + static_cast<ptrdiff_t>(first_);
        std::sort(begin, visits_.end(), [](const SensorVisit& a, const SensorVisit& b) { return a.from < b.from; });
        auto last = begin;
        for (auto next = begin + 1; next != visits_.end(); ++next) {
            if (next->from > last->until + kSameTime) {
                *++last = *next;
                continue;
            }
            last->until = std::max(last->until, next->until);
            last->atStart |= next->atStart;
            last->atEnd |= next->atEnd;
        }
        visits_.erase(last + 1, visits_.end());
    }

    const CollisionView& view_;
    uint32_t place_;
    const MotionPath& sensorPath_;
    const MotionPath& bodyPath_;
    Array<SensorVisit>& visits_;
    size_t first_;
};

}  // namespace

std::span<const MotionSegment> CutSegmentsOf(std::span<const MotionSegment> cut, uint32_t body) {
    const auto first = std::lower_bound(
        cut.begin(), cut.end(), body, [](const MotionSegment& segment, uint32_t b) { return segment.sweep.body < b; });
    auto last = first;
    while (last != cut.end() && last->sweep.body == body) ++last;
    return {first, last};
}

MotionPath::MotionPath(const StepContext& step, const BodyStore& bodies, const SweepStore& sweeps,
                       std::span<const MotionSegment> cut, uint32_t body)
    : body_(body), end_(bodies.CenterPoseOf(body)), segments_(CutSegmentsOf(cut, body)) {
    if (!segments_.empty()) return;
    own_.sweep = SweepOf(step, bodies, sweeps, body);
    segments_ = {&own_, 1};
}

Pose MotionPath::PoseAt(const MotionSegment& segment, float time) const {
    if (time >= 1) return end_;
    return time <= segment.sweep.from ? segment.sweep.start : segment.sweep.PoseAt(time);
}

namespace {

// Convex shapes contain their centers of mass and the inscribed spheres about them, which decides most cases well
// inside.
bool CentersTell(const Shape& sensor, const Shape& body, const Vector3& center) {
    if (!sensor.IsConvex() || !body.IsConvex()) return false;
    const float reach = sensor.InnerRadius() + body.InnerRadius();
    if (LengthSquared(center) < reach * reach) return true;
    return sensor.Type() == ShapeType::Box && center.cwiseAbs().isBelow(static_cast<const Box&>(sensor).HalfExtents());
}

}  // namespace

bool OverlapAtEnd(const CollisionView& view, uint32_t sensor, uint32_t body) {
    const ColliderShape a = PieceOf(view.bodies, view.colliders, view.bodies.cold[sensor].firstCollider);
    const ColliderShape b = PieceOf(view.bodies, view.colliders, view.bodies.cold[body].firstCollider);
    const RelativePose relative =
        Relative(PoseOf(a, view.bodies.CenterPoseOf(sensor)), PoseOf(b, view.bodies.CenterPoseOf(body)));
    return CentersTell(*a.shape, *b.shape, relative.position) ||
           Overlap(*a.shape, *b.shape, relative, view.step.settings.narrowPhase);
}

Bounds PieceBounds(const BodyStore& bodies, const ColliderStore& colliders, const MotionPath& path, uint32_t collider) {
    Bounds bounds;
    const ColliderShape piece = PieceOf(bodies, colliders, collider);
    const Position& origin = colliders.boundsOrigin;
    for (const MotionSegment& segment : path.Segments()) {
        const Mover mover{path, segment, piece};
        Bounds ends = BoundsAbout(origin, *mover.piece.shape, mover.PieceAt(segment.sweep.from));
        const float angle = mover.Angle(segment.sweep.from, segment.until);
        if (!mover.IsStill()) ends.Include(BoundsAbout(origin, *mover.piece.shape, mover.PieceAt(segment.until)));
        // A point at distance r from the center deviates from the chord by at most r (1 - cos(angle / 2)).
        bounds.Include(Inflated(ends, std::min(0.125f * angle * angle, 2.0f) * mover.Radius()));
    }
    return bounds;
}

void FindVisits(const CollisionView& view, uint32_t sensor, const MotionPath& sensorPath, const MotionPath& bodyPath,
                AtStart atStart, Array<SensorVisit>& visits) {
    PairSearch(view, sensor, sensorPath, bodyPath, visits).Run(atStart);
}

}  // namespace fulcrum
