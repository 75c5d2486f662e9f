#include <Fulcrum/Collision/NarrowPhase/Libccd.h>

#include <Fulcrum/Collision/NarrowPhase/AxisContact.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexContact.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>

#include <ccd/ccd.h>
#include <ccd/quat.h>

#include <algorithm>
#include <limits>

namespace fulcrum {

namespace {

// A shape as libccd sees it: in A's frame, in double.
struct Body {
    const ConvexShape* shape;
    Mat3<double> rotation;
    Position position;
    double rounding;  // m
    LibccdAlgorithm algorithm;
    mutable int supports = 0;  // asked for so far

    // Nothing limits libccd's loops. EPA expands what is nearest until nothing is: where a ball's center lies on a
    // corner of the other shape, all of the ball's surface is equally near, and its facets are without number. MPR
    // refines its portal for ever where coordinates round by more than the shapes are thick.
    static constexpr int kMostSupports = 400;
    // From there on supports lie inside, which ends EPA, or are no numbers, which MPR takes for shapes that are apart.
    Position Last() const {
        return algorithm == LibccdAlgorithm::Epa
                   ? position
                   : Position(Position::Constant(std::numeric_limits<double>::quiet_NaN()));
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
    ccdVec3Set(result, point.x(), point.y(), point.z());
}

void Center(const void* object, ccd_vec3_t* result) {
    const Body& body = *static_cast<const Body*>(object);
    ccdVec3Set(result, body.position.x(), body.position.y(), body.position.z());
}

Vector3 CenterLine(const RelativePose& bInA) { return Normalized(bInA.position); }

}  // namespace

LibccdResult LibccdPenetration(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, double margin,
                               LibccdAlgorithm algorithm) {
    // Where the balls around the shapes do not meet, the shapes do not. libccd would not find it out: its tolerances
    // follow from the shapes' sizes, and far apart coordinates are rounded by more than that, so that its EPA never
    // ends.
    const Position between = bInA.position.cast<double>();
    const double reach = double{a.OuterRadius()} + b.OuterRadius() + margin;
    if (!(Dot<double>(between, between) <= 1.0001 * reach * reach))
        return {LibccdResult::Status::Apart, Position::Zero(), 0, Position::Zero()};
    const Body bodyA{&a,
                     {Position(1, 0, 0), Position(0, 1, 0), Position(0, 0, 1)},
                     Position::Zero(),
                     a.ConvexRadius() + 0.5 * margin,
                     algorithm};
    const Body bodyB{&b, DoubleRotation(bInA.rotation), bInA.position.cast<double>(), b.ConvexRadius() + 0.5 * margin,
                     algorithm};
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = Support;
    ccd.center1 = ccd.center2 = Center;
    ccd.max_iterations = 200;
    // Flat shapes have no inside: their tolerance must not be 0, or EPA never ends.
    const double size = std::max(static_cast<double>(a.InnerRadius()) + b.InnerRadius(),
                                 0.02 * (static_cast<double>(a.OuterRadius()) + b.OuterRadius()));
    // libccd holds this against squares of lengths. The facets of a curved core are never exact, and their number grows
    // with the inverse of this.
    const bool curved = !HasPolyhedralCore(a.Type()) || !HasPolyhedralCore(b.Type());
    ccd.epa_tolerance = (curved ? 1e-7 : 1e-9) * size * size;
    ccd.mpr_tolerance = 1e-5 * size;

    double depth = 0;
    ccd_vec3_t direction = {{0, 0, 0}}, position = {{0, 0, 0}};
    const int status = algorithm == LibccdAlgorithm::Epa
                           ? ccdGJKPenetration(&bodyA, &bodyB, &ccd, &depth, &direction, &position)
                           : ccdMPRPenetration(&bodyA, &bodyB, &ccd, &depth, &direction, &position);
    LibccdResult result{LibccdResult::Status::Apart, Position::Zero(), 0, Position::Zero()};
    if (status == -1) return result;
    // -2: out of memory. Touching shapes come back as "overlapping" with a direction of zero.
    const Position d(direction.v[0], direction.v[1], direction.v[2]);
    const double length = std::sqrt(Dot<double>(d, d));
    if (status != 0 || !(length > 0.5) || !std::isfinite(depth)) {
        result.status = LibccdResult::Status::Failed;
        return result;
    }
    result.status = LibccdResult::Status::Found;
    result.normal = d * (1 / length);
    result.separation = margin - depth;
    result.position = Position(position.v[0], position.v[1], position.v[2]);
    return result;
}

namespace {

// The axis that libccd finds, and MPR's or the center line where it contradicts itself. Pair: any that can measure
// itself.
struct LibccdAxis {
    bool apart;
    Vector3 axis;
    float separation;  // m, of the cores along it
    Vector3 position;  // m, somewhere where they touch
};

template <class Pair>
LibccdAxis FindAxis(const PairQuery& query, const Pair& pair) {
    const double margin = query.settings.speculativeDistance;
    const LibccdResult result = LibccdPenetration(query.a, query.b, query.bInA, margin, LibccdAlgorithm::Epa);
    if (result.status == LibccdResult::Status::Apart) return {true, Vector3::Zero(), 0, Vector3::Zero()};
    LibccdAxis found{false, Normalized(result.normal.cast<float>()), 0, result.position.cast<float>()};
    found.separation = pair.SeparationAlong(found.axis);
    // libccd takes some deep overlaps for touching ones: then its depth is not that of its own direction.
    const double size = static_cast<double>(query.a.InnerRadius()) + query.b.InnerRadius();
    const bool contradicts = found.separation - pair.RadiusSum() < result.separation - 0.01 * size;
    if (result.status == LibccdResult::Status::Failed || contradicts) {
        ++query.counters.epaFailures;
        const LibccdResult mpr = LibccdPenetration(query.a, query.b, query.bInA, margin, LibccdAlgorithm::Mpr);
        const bool mprFound = mpr.status == LibccdResult::Status::Found;
        if (!mprFound) ++query.counters.centerLineFallbacks;
        const Vector3 other = mprFound ? Vector3(mpr.normal.cast<float>()) : CenterLine(query.bInA);
        const float otherSeparation = pair.SeparationAlong(other);
        if (result.status == LibccdResult::Status::Failed || otherSeparation > found.separation) {
            found.axis = other;
            found.separation = otherSeparation;
            found.position = mprFound ? Vector3(mpr.position.cast<float>()) : query.a.SupportCore(other);
        }
    }
    return found;
}

// Contact points from the shapes' supporting faces: at least one of the cores is curved.
void CollideCurved(const PairQuery& query, Manifold& manifold) {
    const SupportPair pair(query.a, query.b, query.bInA);
    const LibccdAxis found = FindAxis(query, pair);
    if (found.apart) return;
    // libccd's point lies between the surfaces: on the core along the axis.
    const float off = Dot(found.axis, Vector3(query.a.SupportCore(found.axis) - found.position));
    const KnownContact known{found.axis, found.separation, found.position + found.axis * off};
    const ContactTolerances tolerances(pair.InnerRadii(), pair.RadiusSum(), query.settings);
    BuildConvexContact(pair, known, tolerances, query.cache, manifold);
}

}  // namespace

void CollideLibccd(const PairQuery& query, Manifold& manifold) {
    manifold.pointCount = 0;
    if (!HasPolyhedralCore(query.a.Type()) || !HasPolyhedralCore(query.b.Type())) return CollideCurved(query, manifold);
    PolyhedronStorage storageA, storageB;
    const PolyhedronPair pair(CoreOf(query.a, storageA), CoreOf(query.b, storageB), query.bInA);
    const LibccdAxis found = FindAxis(query, pair);
    if (found.apart) return;
    const ContactTolerances tolerances = pair.Tolerances(query.settings);
    // The axis is as exact as libccd's tolerance; the separation along it is measured on the cores themselves. The
    // polytope of rounded shapes has flat facets: its normals are off by about the root of the relative tolerance.
    BuildContactFromAxis(pair, {found.axis, found.separation, 100 * tolerances.feature}, tolerances, query.cache,
                         manifold);
}

}  // namespace fulcrum
