#include <Fulcrum/Physics/Stages/SweepCast.h>

#include <Fulcrum/Collision/BroadPhase/BoundsTreeCasts.h>
#include <Fulcrum/Collision/Queries/Pieces.h>
#include <Fulcrum/Collision/Queries/ShapeCast.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/Stages/PlacedConvex.h>
#include <Fulcrum/Physics/World/Filters.h>
#include <Fulcrum/Physics/World/Materials.h>

#include <algorithm>

namespace fulcrum {

namespace {

// A body may move by half its thickness before it is cast, and a hit counts if the overlap would reach a quarter of the
// thickness. If the approach in a step exceeds that, a fifth of it is enough: the solver should recover overlaps, not
// stop such fast bodies.
constexpr float kFreeFraction = 0.5f, kDepthFraction = 0.25f, kFastDepthFraction = 0.2f;
// Limit of triangles tested by a cast of a shape as large as the surface: beyond it the cast is left to the contacts,
// since its time would grow with the square of the surface's size.
constexpr size_t kMostTriangles = 20000;
// rad: a shape that turns further in a step, four times around, is cast without its rotation. Its points pass every
// place within its reach several times, and each advance of such a cast is a tiny part of the step: it would take all
// its iterations at every triangle near by and then stop the body where it began.
constexpr float kMostTurn = 25;
// Minimum thickness, as a fraction of the size.
constexpr float kLeastThickness = 0.01f;

float Thickness(float innerRadius, float outerRadius) { return std::max(innerRadius, kLeastThickness * outerRadius); }
// Thickness of the thinner of two shapes.
float Thickness(const Shape& a, const Shape& b) {
    return Thickness(std::min(a.InnerRadius(), b.InnerRadius()), std::min(a.OuterRadius(), b.OuterRadius()));
}

// Whether two spheres with center offset `apart` and relative displacement `motion` come within `reach` of each other.
bool BallsMeet(const Vector3& apart, const Vector3& motion, float reach) {
    const float along = -Dot<float>(apart, motion), square = LengthSquared(motion);
    const float part = square > 0 ? std::clamp(along / square, 0.0f, 1.0f) : 0.0f;
    return LengthSquared(Vector3(apart + motion * part)) <= reach * reach;
}

// The rotation vector of q nearest to a guess; q may include several revolutions.
Vector3 TurnNear(const Quaternion& q, const Vector3& guess) {
    constexpr float kTwoPi = 6.28318530717958647692f;
    const Vector3 shortest = RotationVectorOf(q);
    const float angle = Length(guess);
    if (angle < 0.25f * kTwoPi) return shortest;
    const Vector3 axis = Normalized(Length(shortest) > 1e-3f ? shortest : guess);
    const float turns = std::floor((Dot<float>(axis, guess) - Dot<float>(axis, shortest)) / kTwoPi + 0.5f);
    return shortest + axis * (turns * kTwoPi);
}

// A sweep whose rotation, half of its cost, is computed when first needed.
struct LazySweep {
    Sweep sweep;
    bool hasTurn = true;
};

LazySweep LazySweepOf(const StepContext& step, const BodyStore& bodies, const SweepStore& sweeps, uint32_t body) {
    if (body < sweeps.places.size() && sweeps.places[body] != SweepStore::kNone)
        return {sweeps.swept[sweeps.places[body]]};
    LazySweep lazy;
    Sweep& sweep = lazy.sweep;
    sweep.body = body;
    sweep.start = bodies.CenterPoseOf(body);
    if (body >= sweeps.starts.size() || sweeps.starts[body].step != step.number) return lazy;
    const Position end = sweep.start.position;
    sweep.start = sweeps.starts[body].pose;
    sweep.displacement = Between(sweep.start.position, end);
    lazy.hasTurn = false;
    return lazy;
}

void FindTurn(const BodyStore& bodies, const SweepStore& sweeps, LazySweep& lazy) {
    if (lazy.hasTurn) return;
    const uint32_t body = lazy.sweep.body;
    const Quaternion end = bodies.RotationOf(body);
    lazy.sweep.turn =
        TurnNear(end * lazy.sweep.start.rotation.Conjugate(), Vector3(bodies.AngularVelocityOf(body) * sweeps.dt));
    lazy.hasTurn = true;
}

class SweepCaster {
public:
    SweepCaster(const CollisionView& view, const SweepStore& sweeps, const LazySweep& own, WorkerFindings& findings,
                SweepHit& best)
        : view_(view),
          sweeps_(sweeps),
          own_(own),
          findings_(findings),
          best_(best),
          isCast_(view.bodies.dynamics[own.sweep.body].continuous) {}

    bool RunAgainst(uint32_t collider, uint32_t other) {
        piece_ = &view_.colliders.shapes[collider];
        local_ = LocalOf(view_.bodies, view_.colliders, collider);
        shape_ = cast_ = static_cast<const ConvexShape*>(piece_->shape);
        motion_ = {sweep_.start, sweep_.displacement};
        CastAnew(other, ShapeCaster(*shape_, motion_, view_.step.settings.narrowPhase));
        return found_;
    }

    bool Run() {
        VisitColliders(view_.bodies, view_.colliders, sweep_.body, [&](uint32_t i) { CastPiece(i); });
        return found_;
    }

private:
    void CastPiece(uint32_t collider) {
        piece_ = &view_.colliders.shapes[collider];
        local_ = LocalOf(view_.bodies, view_.colliders, collider);
        shape_ = static_cast<const ConvexShape*>(piece_->shape);
        motion_ = {sweep_.start, sweep_.displacement};
        const PlacedConvex placed(*shape_, local_);
        cast_ = piece_->offset ? &placed : shape_;
        const ShapeCaster straight(*cast_, motion_, view_.step.settings.narrowPhase);
        if (!straight.IsValid()) return;
        const Bounds about = IsBall(*piece_) || sweep_.turn.isZero(0)
                                 ? straight.BoundsAboutCenter()
                                 : Inflated({Vector3::Zero(), Vector3::Zero()}, cast_->OuterRadius() * 1.000001f);
        const TreeRay ray(motion_.pose.position - view_.colliders.boundsOrigin + about.Center().cast<double>(),
                          motion_.displacement, about.HalfExtents());
        const auto visit = [&](uint32_t other) { CastAnew(other, straight); };
        const uint32_t layers = view_.step.settings.layerCollides[view_.bodies.dynamics[sweep_.body].layer];
        // Dispersing bodies do not collide with dynamic ones; visiting all overlaps would cost n^2.
        if ((layers & view_.colliders.movingLayers) && !view_.bodies.dynamics[sweep_.body].dispersing) {
            sweeps_.enlargedTree.CastRay(ray, limit_, visit);
            view_.colliders.movingTree.CastRay(ray, limit_, [&](uint32_t other) {
                if (!sweeps_.enlargedTree.Contains(other)) visit(other);
            });
        }
        if (layers & view_.colliders.staticLayers) view_.colliders.staticTree.CastRay(ray, limit_, visit);
    }

    static bool IsBall(const ColliderShape& piece) { return piece.shape->Type() == ShapeType::Sphere && !piece.offset; }

    // Whether the cast of a shape with the given radius about its body's center includes rotation: if points move by it
    // by a fraction of the depth that counts, or always.
    static bool TurnMatters(const ColliderShape& piece, const Sweep& sweep, float radius, float depth, float start) {
        constexpr float kTurnFraction = 0.25f;
        if (IsBall(piece) || sweep.turn.isZero(0) || !(Length(sweep.turn) <= kMostTurn)) return false;
        return sweep.turns || Length(sweep.TurnRate()) * (1 - start) * radius > kTurnFraction * depth;
    }

    // Restarts are counted per candidate: the order in which the trees find candidates must not matter. Only the limit
    // of triangles is that of the whole cast, which bounds its time.
    void CastAnew(uint32_t other, const ShapeCaster& straight) {
        restarts_ = 0;
        CastAgainst(other, straight);
    }

    // `straight`: caster of the whole motion, without rotation.
    void CastAgainst(uint32_t other, const ShapeCaster& straight, float from = 0) {
        const uint32_t body = view_.colliders.colliders[other].body;
        if (!MayCollide(view_, sweep_.body, body) || !ListenerAllows(view_, sweep_.body, body)) return;
        LazySweep theirs = LazySweepOf(view_.step, view_.bodies, sweeps_, body);
        const Sweep& theirSweep = theirs.sweep;
        const ColliderShape& piece = view_.colliders.shapes[other];
        const RelativePose theirLocal = LocalOf(view_.bodies, view_.colliders, other);
        const float theirRadius = piece.shape->OuterRadius() + (piece.offset ? Length(theirLocal.position) : 0.0f);
        const float start = std::max({sweep_.from, theirSweep.from, from});
        // Relative to the other.
        Pose at = start > theirSweep.from ? theirSweep.PoseAt(start) : theirSweep.start;
        Vector3 others = theirSweep.DisplacementRate() * (1 - start);
        ShapeMotion relative = motion_;
        const float rest = sweep_.from < 1 ? (1 - start) / (1 - sweep_.from) : 0.0f;
        relative.pose.position += (motion_.displacement * (1 - rest)).cast<double>();
        relative.displacement = motion_.displacement * rest - others;
        if (piece.shape->IsConvex() && !BallsMeet(Between(at.position, relative.pose.position), relative.displacement,
                                                  cast_->OuterRadius() + theirRadius))
            return;
        FindTurn(view_.bodies, sweeps_, own_);
        FindTurn(view_.bodies, sweeps_, theirs);
        const float depth = DepthThatCounts(*piece.shape);
        isTurning_ = TurnMatters(*piece_, sweep_, cast_->OuterRadius(), depth, start);
        const bool othersTurn = TurnMatters(piece, theirSweep, theirRadius, depth, start);
        if (start > theirSweep.from) at.rotation = theirSweep.RotationAt(start);
        if (isTurning_) {
            if (start > sweep_.from) relative.pose.rotation = sweep_.RotationAt(start);
            relative.turn = sweep_.turn * rest;
        }
        const Pieces pieces{other, theirs, start, isTurning_ || othersTurn};
        if (othersTurn && piece.shape->IsConvex()) {
            relative.turnOfOther = theirSweep.TurnRate() * (1 - start);
            const PlacedConvex placed(static_cast<const ConvexShape&>(*piece.shape), theirLocal);
            const ConvexShape& turning = piece.offset ? placed : static_cast<const ConvexShape&>(*piece.shape);
            const ShapeCaster caster(*cast_, relative, view_.step.settings.narrowPhase);
            if (caster.IsValid()) CastThrough(caster, relative, turning, at, pieces, straight);
            return;
        }
        if (piece.offset) {
            at = at * theirLocal;
            // Along the chord of its arc.
            const Vector3 chord = Between(at.position, (theirSweep.PoseAt(1) * theirLocal).position);
            relative.displacement = motion_.displacement * rest - chord;
        }
        if (!isTurning_ && theirSweep.displacement.isZero(0) && theirSweep.turn.isZero(0) && start == sweep_.from) {
            if (straight.IsValid()) CastThrough(straight, motion_, *piece.shape, at, pieces, straight);
            return;
        }
        const ShapeCaster caster(*cast_, relative, view_.step.settings.narrowPhase);
        if (caster.IsValid()) CastThrough(caster, relative, *piece.shape, at, pieces, straight);
    }

    // The target of a cast, its start time, and whether the rotation of one of the two must be included.
    struct Pieces {
        uint32_t other;
        const LazySweep& theirs;
        float start;
        bool turn;
    };

    // Casts from the time `start` to the end. `shape`, `at`: of the other.
    void CastThrough(const ShapeCaster& caster, const ShapeMotion& motion, const Shape& shape, const Pose& at,
                     const Pieces& pieces, const ShapeCaster& straight) {
        const Sweep& theirSweep = pieces.theirs.sweep;
        const float start = pieces.start, length = 1 - start;
        ShapeCastSettings settings;
        // Less than half of the depth that counts for fast approaches: hits are found this much too early.
        settings.tolerance = 0.08f * DepthThatCounts(*view_.colliders.shapes[pieces.other].shape);
        settings.measureDepth = false;
        const auto limit = [&] { return length > 0 ? std::max(0.0f, (best_.time - start) / length) : 0.0f; };
        if (length > 0) settings.maxFraction = std::min(1.0f, limit());
        float touchTime = 1;  // first touch that does not count as a hit
        caster.Visit(shape, at, settings, [&](const ShapeHit& found) {
            if (triangles_ > kMostTriangles) return 0.0f;
            SweepHit hit = HitOf(pieces, theirSweep);
            hit.time = start + found.fraction * length;
            if (ComesBefore(hit)) {
                if (Counts(motion, found, theirSweep, length, hit) && Behaves(hit)) Take(hit);
                else touchTime = std::min(touchTime, hit.time);
            }
            return limit();
        });
        // Without rotation a touch that does not count now never will.
        if (pieces.turn && touchTime < best_.time) Follow(motion, pieces, touchTime, straight);
    }

    SweepHit HitOf(const Pieces& pieces, const Sweep& theirSweep) const {
        SweepHit hit;
        hit.body = sweep_.body;
        hit.other = theirSweep.body;
        hit.collider = static_cast<uint32_t>(piece_ - view_.colliders.shapes.data());
        hit.otherCollider = pieces.other;
        hit.isBlocked = !isCast_ && !view_.bodies.dynamics[theirSweep.body].continuous;
        return hit;
    }

    // Follows a rotating shape that touches, in steps too small for tunneling, until it counts as a hit or separates.
    void Follow(const ShapeMotion& motion, const Pieces& pieces, float time, const ShapeCaster& straight) {
        constexpr int kMostSteps = 64, kMostRestarts = 8;
        const Sweep& theirSweep = pieces.theirs.sweep;
        const Shape& shape = *view_.colliders.shapes[pieces.other].shape;
        const float length = 1 - pieces.start;
        const Vector3 linear = motion.displacement * (1 / length);
        const float depth = DepthThatCounts(shape);
        const float speed = Length(linear) + Length(sweep_.TurnRate()) * cast_->OuterRadius() +
                            Length(theirSweep.TurnRate()) * shape.OuterRadius();
        SweepHit hit = HitOf(pieces, theirSweep);
        for (int i = 0; i < kMostSteps; ++i) {
            if (triangles_ > kMostTriangles) return;
            time += depth / speed;
            hit.time = time;
            if (!(time < 1 && ComesBefore(hit))) return;
            const Push push = FindPoints(motion, linear, theirSweep, time, depth, hit);
            if (hit.pointCount == 0 && restarts_++ < kMostRestarts) return CastAgainst(pieces.other, straight, time);
            if (!(push.speed > 0 && push.depth > (push.speed > depth ? kFastDepthFraction * depth : depth))) continue;
            if (Behaves(hit)) Take(hit);
            return;
        }
        hit.pointCount = 0;  // undecided
        Take(hit);
    }

    // Sets the properties of the contact after calling the listener; returns false if the contact is ignored.
    bool Behaves(SweepHit& hit) const {
        const PairMaterial material = MaterialOfPair(view_.bodies, hit.body, hit.other,
                                                     *view_.colliders.shapes[hit.otherCollider].shape, hit.material);
        hit.friction = material.friction;
        hit.restitution = material.restitution;
        if (!view_.step.listener || hit.pointCount == 0) return true;
        // A is dynamic: the other if the body itself is kinematic.
        const bool swapped = view_.bodies.dynamics[hit.body].motion != MotionType::Dynamic;
        ContactView::Point points[SweepHit::kMaxPoints];
        for (int i = 0; i < hit.pointCount; ++i) points[i] = {hit.center + hit.arms[i].cast<double>(), 0, 0};
        ContactView view{view_.bodies.IdOf(hit.body),
                         view_.bodies.IdOf(hit.other),
                         hit.normal,
                         std::span<const ContactView::Point>(points, static_cast<size_t>(hit.pointCount)),
                         ChildOf(view_.bodies, view_.colliders, hit.collider),
                         ChildOf(view_.bodies, view_.colliders, hit.otherCollider)};
        if (swapped) {
            std::swap(view.bodyA, view.bodyB);
            std::swap(view.childA, view.childB);
            view.normal = -view.normal;
        }
        const ContactChange change = AskAbout(*view_.step.listener, view, hit.friction, hit.restitution);
        hit.friction = change.friction;
        hit.restitution = change.restitution;
        hit.surfaceVelocity = swapped ? Vector3(-change.surfaceVelocity) : change.surfaceVelocity;
        hit.massOverride = swapped ? change.massOverride.Swapped() : change.massOverride;
        return !change.ignore && !change.isSensor;
    }

    // Bodies that are cast only because they were hit leave light touches to the solver.
    float DepthThatCounts(const Shape& other) const {
        const float depth = kDepthFraction * Thickness(*shape_, other.IsConvex() ? other : *shape_);
        return isCast_ ? depth : std::min(depth, 0.5f * view_.step.settings.speculativeDistance);
    }

    bool ComesBefore(const SweepHit& hit) const {
        return !found_ || hit.time < best_.time || (hit.time == best_.time && hit.otherCollider < best_.otherCollider);
    }

    void Take(const SweepHit& hit) {
        best_ = hit;
        found_ = true;
        limit_ = sweep_.from < 1 ? std::clamp((hit.time - sweep_.from) / (1 - sweep_.from), 0.0f, 1.0f) : 0.0f;
    }

    // Displacement per step of the body's point relative to the other's at an instant.
    Vector3 VelocityAt(const Position& point, const Position& own, const Vector3& linear, const Sweep& theirSweep,
                       const Position& others) const {
        Vector3 v = linear - Cross<float>(theirSweep.TurnRate(), Between(others, point));
        if (isTurning_) v += Cross<float>(sweep_.TurnRate(), Between(own, point));
        return v;
    }

    // Extrapolates to where the two would overlap by the depth that counts: the manifold there has the contact normal,
    // while the cast only knows what touches first. Sides of flush neighbors and internal edges of a surface have
    // normals that do not oppose the motion.
    bool Counts(const ShapeMotion& motion, const ShapeHit& found, const Sweep& theirSweep, float length,
                SweepHit& hit) {
        if (found.isEarly) return found.fraction > 0;
        const Shape& shape = *view_.colliders.shapes[hit.otherCollider].shape;
        float depth = DepthThatCounts(shape);
        const float left = 1 - hit.time;
        const Vector3 linear = length > 0 ? Vector3(motion.displacement * (1 / length)) : Vector3(Vector3::Zero());
        float approach;
        if (found.normal.isZero(0)) {
            approach = FindPoints(motion, linear, theirSweep, hit.time, depth, hit).speed;
        } else {
            const Position own = sweep_.PositionAt(hit.time), others = theirSweep.PositionAt(hit.time);
            approach = -Dot<float>(found.normal, VelocityAt(found.position, own, linear, theirSweep, others));
        }
        if (approach > depth) depth *= kFastDepthFraction;
        if (!(approach * left > depth)) return false;
        return FindPoints(motion, linear, theirSweep, std::min(1.0f, hit.time + depth / approach), depth, hit).speed *
                   left >
               depth;
    }

    struct Push {
        float speed = 0;  // of approach, per step
        float depth = 0;  // m
    };

    // Arguments and result of FindPoints.
    struct FoundPoints {
        const ColliderShape* piece = nullptr;
        uint32_t otherCollider = 0;
        bool isTurning = false;
        float time = 0, depth = 0;
        Quaternion rotation;
        Vector3 linear = Vector3::Zero();
        Push push;
        SweepHit hit;

        bool IsFor(const FoundPoints& asked) const {
            return piece == asked.piece && otherCollider == asked.otherCollider && isTurning == asked.isTurning &&
                   time == asked.time && depth == asked.depth && linear == asked.linear &&
                   rotation.x == asked.rotation.x && rotation.y == asked.rotation.y && rotation.z == asked.rotation.z &&
                   rotation.w == asked.rotation.w;
        }
    };

    // Writes the points of the manifold with the fastest approach at an instant to the hit; none if they do not touch.
    // A shape that overlaps many triangles of a surface at the start of the cast hits all of them at the same time and
    // needs the same points repeatedly: the last two results are cached.
    Push FindPoints(const ShapeMotion& motion, const Vector3& linear, const Sweep& theirSweep, float time, float depth,
                    SweepHit& hit) {
        FoundPoints asked{piece_, hit.otherCollider, isTurning_, time, depth, motion.pose.rotation, linear, {}, {}};
        for (const FoundPoints& known : foundPoints_)
            if (known.IsFor(asked)) {
                CopyPoints(known.hit, hit);
                return known.push;
            }
        asked.push = ComputePoints(motion, linear, theirSweep, time, depth, hit);
        CopyPoints(hit, asked.hit);
        nextFoundPoints_ ^= 1;
        foundPoints_[nextFoundPoints_] = asked;
        return asked.push;
    }

    // Copies what FindPoints writes.
    static void CopyPoints(const SweepHit& from, SweepHit& to) {
        to.pointCount = from.pointCount;
        to.normal = from.normal;
        to.triangle = from.triangle;
        to.material = from.material;
        to.center = from.center;
        std::copy_n(from.arms, from.pointCount, to.arms);
        std::copy_n(from.otherArms, from.pointCount, to.otherArms);
    }

    Push ComputePoints(const ShapeMotion& motion, const Vector3& linear, const Sweep& theirSweep, float time,
                       float depth, SweepHit& hit) {
        const Pose own{sweep_.PositionAt(time), isTurning_ ? sweep_.RotationAt(time) : motion.pose.rotation},
            others = theirSweep.PoseAt(time);
        const ColliderShape& piece = view_.colliders.shapes[hit.otherCollider];
        const Pose a = own * local_;
        Push most;
        hit.pointCount = 0;
        const auto consider = [&](const Manifold& manifold, uint8_t material, uint32_t triangle) {
            const Vector3 normal = Rotate(a.rotation, manifold.normal);
            Push push;
            for (int i = 0; i < manifold.pointCount; ++i) {
                const Vector3 v = VelocityAt(a.Transform(manifold.points[i].positionOnA), own.position, linear,
                                             theirSweep, others.position);
                push.speed = std::max(push.speed, Dot<float>(normal, v));
                push.depth = std::max(push.depth, -manifold.points[i].separation);
            }
            if (hit.pointCount > 0 && !(push.speed > most.speed)) return;
            most = push;
            hit.normal = normal;
            hit.material = material;
            hit.triangle = triangle;
            hit.pointCount = manifold.pointCount;
            hit.center = own.position;
            for (int i = 0; i < manifold.pointCount; ++i) {
                const Position point = a.Transform(manifold.points[i].positionOnA);
                hit.arms[i] = Between(own.position, point);
                hit.otherArms[i] = Between(others.position, point);
            }
        };
        FindManifolds(*piece.shape, Relative(a, others * LocalOf(view_.bodies, view_.colliders, hit.otherCollider)),
                      0.25f * depth, consider);
        return most;
    }

    template <class Consider>
    void FindManifolds(const Shape& shape, const RelativePose& bInA, float margin, const Consider& consider) {
        CollideSettings settings;
        settings.speculativeDistance = margin;
        settings.method = view_.step.settings.narrowPhase;
        if (shape.IsSurface()) {
            CollideSurface(*shape_, static_cast<const SurfaceShape&>(shape), bInA, settings, {}, findings_.surface);
            triangles_ += findings_.surface.TriangleCount();
            findings_.libccd += findings_.surface.Counters();
            for (const SurfaceManifold& m : findings_.surface.Manifolds()) consider(m.manifold, m.material, m.triangle);
            return;
        }
        Manifold manifold;
        PairCache cache;
        if (shape.Type() == ShapeType::Plane) {
            Collide(*shape_, static_cast<const Plane&>(shape), bInA, settings, cache, manifold, findings_.libccd);
        } else {
            Collide(*shape_, static_cast<const ConvexShape&>(shape), bInA, settings, cache, manifold, findings_.libccd);
        }
        consider(manifold, uint8_t{0}, 0u);
    }

    const CollisionView& view_;
    const SweepStore& sweeps_;
    LazySweep own_;
    const Sweep& sweep_ = own_.sweep;
    WorkerFindings& findings_;
    SweepHit& best_;
    bool isTurning_ = false;  // whether the current cast includes the body's rotation
    const bool isCast_;       // else cast only because it was hit in this step
    bool found_ = false;
    FoundPoints foundPoints_[2];
    int nextFoundPoints_ = 0;
    int restarts_ = 0;
    size_t triangles_ = 0;  // tested triangles
    float limit_ = 1;       // fraction of the sweep up to which hits are wanted
    const ColliderShape* piece_ = nullptr;
    RelativePose local_;                  // of the piece in its body
    const ConvexShape* shape_ = nullptr;  // of the piece
    const ConvexShape* cast_ = nullptr;   // shape_, or shape_ with its offset from the body's center
    ShapeMotion motion_;
};

}  // namespace

float FreeMotion(float innerRadius, float outerRadius) { return kFreeFraction * Thickness(innerRadius, outerRadius); }

bool IsCastTurning(const BodyStore& bodies, uint32_t body) {
    const BodyCold& cold = bodies.cold[body];
    return cold.continuous == ContinuousCollision::LinearAndAngular || !cold.shape->IsConvex();
}

Sweep SweepOf(const StepContext& step, const BodyStore& bodies, const SweepStore& sweeps, uint32_t body) {
    LazySweep lazy = LazySweepOf(step, bodies, sweeps, body);
    FindTurn(bodies, sweeps, lazy);
    return lazy.sweep;
}

bool CastSweep(const CollisionView& view, const SweepStore& sweeps, const Sweep& sweep, WorkerFindings& findings,
               SweepHit& hit) {
    hit.time = 1;
    return SweepCaster(view, sweeps, {sweep}, findings, hit).Run();
}

bool CastPair(const CollisionView& view, const SweepStore& sweeps, uint32_t collider, uint32_t other,
              WorkerFindings& findings, SweepHit& hit) {
    const ColliderShape& piece = view.colliders.shapes[other];
    const uint32_t body = view.colliders.colliders[collider].body, otherBody = view.colliders.colliders[other].body;
    if (!piece.offset && sweeps.starts[otherBody].step == view.step.number) {
        const Position &from = sweeps.starts[body].pose.position, &otherFrom = sweeps.starts[otherBody].pose.position;
        const Vector3 motion =
            Between(from, view.bodies.CenterOf(body)) - Between(otherFrom, view.bodies.CenterOf(otherBody));
        const float reach = view.colliders.shapes[collider].shape->OuterRadius() + piece.shape->OuterRadius();
        if (!BallsMeet(Between(otherFrom, from), motion, reach)) return false;
    }
    hit.time = 1;
    return SweepCaster(view, sweeps, LazySweepOf(view.step, view.bodies, sweeps, body), findings, hit)
        .RunAgainst(collider, other);
}

}  // namespace fulcrum
