#include <Fulcrum/Collision/NarrowPhase/Libccd.h>

#include <Fulcrum/Collision/NarrowPhase/AxisContact.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>
#include <Fulcrum/Collision/NarrowPhase/PlaneContact.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>

#include <ccd/ccd.h>
#include <ccd/quat.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

// A shape for libccd's callbacks: in A's frame, in double.
struct Body {
    const ConvexShape* shape;
    Mat3<double> rotation;
    Position position;
    double rounding;  // m
    Position start;   // first direction of GJK
    bool isMpr;
    mutable int supports = 0;                       // number of support calls so far
    mutable Position lastAsked = Position::Zero();  // unit

    // libccd's loops are unbounded. EPA does not terminate if a ball's center lies on a corner of the other shape: the
    // whole surface of the ball is equally near. MPR refines its portal forever if rounding of coordinates exceeds the
    // shapes' thickness.
    static constexpr int kMostSupports = 400;
    // Beyond that, supports are inside the polytope, which ends EPA, or NaN, which MPR treats as separated shapes.
    Position Last() const {
        return isMpr ? Position(Position::Constant(std::numeric_limits<double>::quiet_NaN())) : position;
    }
};

Mat3<double> DoubleRotation(const Quaternion& q) { return ToMatrix(Quat<double>{q.x, q.y, q.z, q.w}); }

void Support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* result) {
    const Body& body = *static_cast<const Body*>(object);
    if (++body.supports > Body::kMostSupports) {
        const Position last = body.Last();
        ccdVec3Set(result, last.x(), last.y(), last.z());
        return;
    }
    const Position d(direction->v[0], direction->v[1], direction->v[2]);
    const double length = std::sqrt(Dot<double>(d, d));
    const Position unit = length > 0 ? Position(d * (1 / length)) : Position(0, 1, 0);
    const Vector3 local = body.rotation.TransposeMultiply(unit).cast<float>();
    const Position core = body.shape->SupportCore(local).cast<double>();
    const Position point = body.rotation * core + body.position + unit * body.rounding;
    body.lastAsked = unit;
    ccdVec3Set(result, point.x(), point.y(), point.z());
}

void Center(const void* object, ccd_vec3_t* result) {
    const Body& body = *static_cast<const Body*>(object);
    ccdVec3Set(result, body.position.x(), body.position.y(), body.position.z());
}

void FirstDirection(const void* object, const void*, ccd_vec3_t* result) {
    const Position& start = static_cast<const Body*>(object)->start;
    ccdVec3Set(result, start.x(), start.y(), start.z());
}

// Triangles of a surface have no precomputed radii.
double OuterRadiusOf(const ConvexShape& shape) {
    if (shape.Type() != ShapeType::Triangle) return shape.OuterRadius();
    float square = 0;
    for (int i = 0; i < 3; ++i) square = std::max(square, LengthSquared(static_cast<const Triangle&>(shape).Corner(i)));
    return double{std::sqrt(square)} + shape.ConvexRadius();
}

// Lower bound of the thickness of the Minkowski difference. Flat shapes have no interior: tolerances must not be 0, or
// EPA does not terminate.
double Thickness(const ConvexShape& a, const ConvexShape& b) {
    return std::max(static_cast<double>(a.InnerRadius()) + b.InnerRadius(),
                    0.02 * (OuterRadiusOf(a) + OuterRadiusOf(b)));
}

enum class Algorithm : uint8_t { Gjk, Epa, Mpr };  // Gjk: only whether they overlap

struct Answer {
    LibccdResult::Status status;
    Position axis;      // unit, from A towards B. If apart: GJK's separating axis; MPR has none
    double depth;       // m
    Position position;  // m
};

// The arguments of a libccd call.
struct Question {
    const ConvexShape& a;
    const ConvexShape& b;
    const RelativePose& bInA;
    double roundingA, roundingB;  // m, of the cores
    double epaTolerance;          // m2: libccd compares it with squared lengths
    Position start = Position(1, 0, 0);

    Answer Ask(Algorithm algorithm) const;
};

Answer Question::Ask(Algorithm algorithm) const {
    const bool isMpr = algorithm == Algorithm::Mpr;
    const Body bodyA{
        &a, {Position(1, 0, 0), Position(0, 1, 0), Position(0, 0, 1)}, Position::Zero(), roundingA, start, isMpr};
    const Body bodyB{&b, DoubleRotation(bInA.rotation), bInA.position.cast<double>(), roundingB, start, isMpr};
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.first_dir = FirstDirection;
    ccd.support1 = ccd.support2 = Support;
    ccd.center1 = ccd.center2 = Center;
    ccd.max_iterations = 200;
    ccd.epa_tolerance = epaTolerance;
    ccd.mpr_tolerance = 1e-5 * Thickness(a, b);

    using Status = LibccdResult::Status;
    double depth = 0;
    ccd_vec3_t direction = {{0, 0, 0}}, position = {{0, 0, 0}};
    if (algorithm == Algorithm::Gjk) {
        const bool overlap = ccdGJKIntersect(&bodyA, &bodyB, &ccd) != 0;
        return {overlap ? Status::Found : Status::Apart, bodyA.lastAsked, 0, Position::Zero()};
    }
    const int status = isMpr ? ccdMPRPenetration(&bodyA, &bodyB, &ccd, &depth, &direction, &position)
                             : ccdGJKPenetration(&bodyA, &bodyB, &ccd, &depth, &direction, &position);
    if (status == -1) return {Status::Apart, bodyA.lastAsked, 0, Position::Zero()};
    // -2: out of memory. Touching shapes come back as "overlapping" with a direction of zero.
    const Position d(direction.v[0], direction.v[1], direction.v[2]);
    const double length = std::sqrt(Dot<double>(d, d));
    if (status != 0 || !(length > 0.5) || !std::isfinite(depth))
        return {Status::Failed, Position::Zero(), 0, Position::Zero()};
    return {Status::Found, d * (1 / length), depth, Position(position.v[0], position.v[1], position.v[2])};
}

// The facets of a curved shape are never exact, and their number grows with the inverse of this.
double EpaTolerance(const ConvexShape& a, const ConvexShape& b) {
    return HasPolyhedralCore(a.Type()) && HasPolyhedralCore(b.Type()) ? 1e-9 : 1e-7;
}

}  // namespace

bool HasLibccd() { return true; }

LibccdResult LibccdPenetration(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, double margin,
                               LibccdAlgorithm algorithm) {
    LibccdResult result{LibccdResult::Status::Apart, Position::Zero(), 0, Position::Zero()};
    // Bounding spheres are tested first. libccd may not terminate for distant shapes: its tolerances are based on the
    // shapes' sizes, and rounding of large coordinates exceeds them.
    const Position between = bInA.position.cast<double>();
    const double reach = double{a.OuterRadius()} + b.OuterRadius() + margin;
    if (!(Dot<double>(between, between) <= 1.0001 * reach * reach)) return result;
    const double size = Thickness(a, b);
    const Question question{
        a, b, bInA, a.ConvexRadius() + 0.5 * margin, b.ConvexRadius() + 0.5 * margin, EpaTolerance(a, b) * size * size};
    const Answer answer = question.Ask(algorithm == LibccdAlgorithm::Mpr ? Algorithm::Mpr : Algorithm::Epa);
    result.status = answer.status;
    if (answer.status != LibccdResult::Status::Found) return result;
    result.normal = answer.axis;
    result.separation = margin - answer.depth;
    result.position = answer.position;
    return result;
}

namespace {

// Directions outside of common symmetry planes: libccd fails if the origin lies on an edge of GJK's simplex.
const Position kStarts[] = {
    {0.5345, 0.8018, 0.2673}, {-0.7428, 0.3714, 0.5571}, {0.3015, -0.6030, 0.7385}, {0.1961, 0.5883, -0.7845}};

// Finds the contact of two shapes by calling libccd until its result is consistent with the support functions.
class ContactSearch {
public:
    ContactSearch(const SupportPair& pair, const RelativePose& bInA, float reach)
        : pair_(pair),
          bInA_(bInA),
          farthest_(reach + pair.RadiusSum()),
          size_(Thickness(pair.a, pair.b)),
          best_{Normalized(pair.position), 0, Vector3::Zero()} {
        best_.separation = pair.SeparationAlong(best_.axis);
        // Points of both cores prove that these are no farther apart than this.
        const float apart = Length(pair.Support(best_.axis).w.cast<float>());
        rounding_ = std::max(std::min(double{farthest_}, 1.01 * double{apart}), 0.02 * size_);
    }

    std::optional<KnownContact> Run(CollideCounters& counters) {
        const double balls = OuterRadiusOf(pair_.a) + OuterRadiusOf(pair_.b) + farthest_;
        const Position between = pair_.position.cast<double>();
        if (!(Dot<double>(between, between) <= 1.0001 * balls * balls)) return std::nullopt;  // or not finite
        if (best_.separation > farthest_) return std::nullopt;
        // First without rounding, if the difference of the cores has any thickness: flat facets are exact.
        if (pair_.InnerRadii() > 0) {
            const Outcome outcome = TryStarts(2, 0, 0, EpaTolerance(pair_.a, pair_.b) * size_ * size_);
            if (outcome == Outcome::Agreed) return best_;
            coresApart_ = outcome == Outcome::Apart;
        } else {
            const Answer answer = Question{pair_.a, pair_.b, bInA_, 0, 0, 0, kStarts[0]}.Ask(Algorithm::Gjk);
            if (answer.status == LibccdResult::Status::Apart) Consider(answer.axis);
            coresApart_ = found_ && best_.separation > 1e-3 * size_;
        }
        const double scale = size_ + rounding_, half = 0.5 * rounding_, tolerance = 1e-7 * scale * scale;
        if (coresApart_) {
            // The axis is known by now.
            const Answer answer =
                Question{pair_.a, pair_.b, bInA_, half, half, tolerance, kStarts[0]}.Ask(Algorithm::Gjk);
            if (answer.status == LibccdResult::Status::Found || best_.separation > farthest_) return Result();
        }
        if (TryStarts(4, half, half, tolerance) != Outcome::Undecided) return Result();
        ++counters.epaFailures;
        const Answer mpr = Question{pair_.a, pair_.b, bInA_, half, half, tolerance}.Ask(Algorithm::Mpr);
        if (mpr.status == LibccdResult::Status::Found) Consider(mpr.axis);
        else ++counters.centerLineFallbacks;
        VisitPlainAxes(pair_, [&](const Vector3& axis) { Consider(axis.cast<double>()); });
        return Result();
    }

private:
    enum class Outcome { Undecided, Agreed, Apart };

    std::optional<KnownContact> Result() const {
        if (best_.separation > farthest_) return std::nullopt;
        return best_;
    }

    Outcome TryStarts(int count, double roundingA, double roundingB, double tolerance) {
        const double rounding = roundingA + roundingB;
        Question question{pair_.a, pair_.b, bInA_, roundingA, roundingB, tolerance};
        for (int i = 0; i < count; ++i) {
            question.start = kStarts[i];
            const Answer answer = question.Ask(Algorithm::Epa);
            if (answer.status == LibccdResult::Status::Failed) continue;
            Consider(answer.axis);
            if (answer.status == LibccdResult::Status::Apart) {
                if (double{best_.separation} > rounding - 1e-6 * size_) return Outcome::Apart;
                continue;
            }
            // EPA's polytope lies inside the difference: no axis separates the cores by more than this.
            const double most = rounding - answer.depth;
            const double slack = std::max(0.005 * std::abs(most), 1.5 * std::sqrt(tolerance));
            if (best_.separation >= most - slack && !IsDeeperThanNeeded(answer.axis, most + slack))
                return Outcome::Agreed;
        }
        return Outcome::Undecided;
    }

    // Whether another axis separates the cores by more than `most`. For tiny overlaps EPA may end at the opposite side.
    bool IsDeeperThanNeeded(const Position& axis, double most) const {
        double farthest = pair_.SeparationAlong(Normalized(Vector3(-axis.cast<float>())));
        VisitPlainAxes(
            pair_, [&](const Vector3& plain) { farthest = std::max(farthest, double{pair_.SeparationAlong(plain)}); });
        return farthest > most;
    }

    void Consider(const Position& axis) {
        KnownContact known{Normalized(axis.cast<float>()), 0, Vector3::Zero()};
        known.separation = pair_.SeparationAlong(known.axis);
        known.onA = pair_.a.SupportCore(known.axis);
        if (known.separation <= 0) Polish(pair_, known);
        if (known.separation > 0) {
            const ConvexGjkResult gjk = ConvexGjk(pair_, known.axis, std::numeric_limits<float>::infinity());
            if (gjk.status == GjkStatus::Apart) known = {gjk.axis, gjk.separation, gjk.onA};
        }
        if (found_ && !(known.separation > best_.separation)) return;
        found_ = true;
        best_ = known;
    }

    const SupportPair& pair_;
    const RelativePose& bInA_;
    float farthest_;  // m: cores farther apart are beyond the reach
    double size_;     // m
    KnownContact best_;
    bool found_ = false;
    bool coresApart_ = false;
    double rounding_;  // m, of both cores together
};

}  // namespace

std::optional<KnownContact> FindLibccdContact(const SupportPair& pair, const RelativePose& bInA, float reach,
                                              CollideCounters& counters) {
    return ContactSearch(pair, bInA, reach).Run(counters);
}

LibccdVerdict AskLibccd(const SupportPair& pair, const RelativePose& bInA, float margin) {
    const float rounding = pair.RadiusSum() + margin;
    const Vector3 between = Normalized(pair.position);
    if (pair.SeparationAlong(between) > rounding) return {true, between};
    const double size = Thickness(pair.a, pair.b);
    Question question{pair.a,
                      pair.b,
                      bInA,
                      pair.a.ConvexRadius() + 0.5 * margin,
                      pair.b.ConvexRadius() + 0.5 * margin,
                      1e-7 * size * size};
    for (const Position& start : kStarts) {
        question.start = start;
        const Answer answer = question.Ask(Algorithm::Gjk);
        if (answer.status == LibccdResult::Status::Found) return {false, Vector3::Zero()};
        const Vector3 axis = Normalized(answer.axis.cast<float>());
        if (pair.SeparationAlong(axis) > rounding) return {true, axis};
    }
    CollideCounters unused;
    const std::optional<KnownContact> contact =
        FindLibccdContact(pair, bInA, std::numeric_limits<float>::infinity(), unused);
    const bool apart = contact && contact->separation > rounding;
    return {apart, apart ? contact->axis : Vector3(Vector3::Zero())};
}

void CollideLibccd(const PairQuery& query, Manifold& manifold) {
    manifold.pointCount = 0;
    const SupportPair supports(query.a, query.b, query.bInA);
    const std::optional<KnownContact> known =
        FindLibccdContact(supports, query.bInA, query.settings.speculativeDistance, query.counters);
    if (!known) return;
    if (!HasPolyhedralCore(query.a.Type()) || !HasPolyhedralCore(query.b.Type())) {
        const ContactTolerances tolerances(supports.InnerRadii(), supports.RadiusSum(), query.settings);
        return BuildConvexContact(supports, *known, tolerances, query.cache, manifold);
    }
    PolyhedronStorage storageA, storageB;
    const PolyhedronPair pair(CoreOf(query.a, storageA), CoreOf(query.b, storageB), query.bInA);
    const ContactTolerances tolerances = pair.Tolerances(query.settings);
    BuildContactFromAxis(pair, {known->axis, pair.SeparationAlong(known->axis), tolerances.feature}, tolerances,
                         query.cache, manifold);
}

namespace {

// The rotation that takes +y to a unit vector.
Quaternion FromUp(const Vector3& to) {
    if (to.y() < -0.999999f) return {1, 0, 0, 0};
    return Normalized(Quaternion{to.z(), 0, -to.x(), 1 + to.y()});
}

}  // namespace

void CollideWithPlaneByLibccd(const Plane& plane, const ConvexShape& shape, const RelativePose& planeInShape,
                              const CollideSettings& settings, PairCache& cache, Manifold& manifold,
                              CollideCounters& counters) {
    manifold.pointCount = 0;
    const Vector3 up = Rotate(planeInShape.rotation, plane.Normal());
    const float height = plane.Distance(planeInShape.InverseTransform(Vector3::Zero()));
    const float size = shape.OuterRadius() + settings.speculativeDistance;
    if (height > size) return;
    // So deep that the top face is always the nearest.
    const float half = 2 * Abs(height) + 4 * size;
    const auto block = Box::Create(Vector3::Constant(half));
    if (!block) return CollideWithPlane(plane, shape, planeInShape, settings, manifold);
    const RelativePose pose{up * -(height + half), FromUp(up)};
    CollideLibccd({shape, *block.Value(), pose, settings, cache, counters}, manifold);
    if (manifold.pointCount == 0) return;
    // Rounding rotates the block's top a little.
    if (Dot(manifold.normal, up) < -0.9999f) {
        manifold.normal = -up;
    } else {
        ++counters.centerLineFallbacks;
        CollideWithPlane(plane, shape, planeInShape, settings, manifold);
    }
}

}  // namespace fulcrum
