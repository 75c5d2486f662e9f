#include <Fulcrum/Collision/NarrowPhase/Libccd.h>

#include <Fulcrum/Collision/NarrowPhase/AxisContact.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>

#include <ccd/ccd.h>
#include <ccd/quat.h>

namespace fulcrum {

namespace {

// A shape as libccd sees it: in A's frame, in double.
struct Body {
    const ConvexShape* shape;
    Mat3<double> rotation;
    Position position;
    double rounding;  // m
};

Mat3<double> DoubleRotation(const Quaternion& q) {
    return ToMatrix(Quat<double>{q.x, q.y, q.z, q.w});
}

void Support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* result) {
    const Body& body = *static_cast<const Body*>(object);
    const Position d(direction->v[0], direction->v[1], direction->v[2]);
    const double length = std::sqrt(Dot<double>(d, d));
    const Position unit = length > 0 ? Position(d * (1 / length)) : Position(0, 1, 0);
    const Vector3 local = body.rotation.TransposeMultiply(unit).cast<float>();
    const Position core = body.shape->SupportCore(local).cast<double>();
    const Position point = body.rotation * core + body.position + unit * body.rounding;
    ccdVec3Set(result, point.x(), point.y(), point.z());
}

void Centre(const void* object, ccd_vec3_t* result) {
    const Body& body = *static_cast<const Body*>(object);
    ccdVec3Set(result, body.position.x(), body.position.y(), body.position.z());
}

Vector3 CentreLine(const RelativePose& bInA) { return Normalized(bInA.position); }

}  // namespace

LibccdResult LibccdPenetration(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, double margin,
                               LibccdAlgorithm algorithm) {
    const Body bodyA{&a, {Position(1, 0, 0), Position(0, 1, 0), Position(0, 0, 1)}, Position::Zero(),
                     a.ConvexRadius() + 0.5 * margin};
    const Body bodyB{&b, DoubleRotation(bInA.rotation), bInA.position.cast<double>(), b.ConvexRadius() + 0.5 * margin};
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = Support;
    ccd.center1 = ccd.center2 = Centre;
    ccd.max_iterations = 200;
    const double size = static_cast<double>(a.InnerRadius()) + b.InnerRadius();
    // libccd holds this against squares of lengths.
    ccd.epa_tolerance = 1e-9 * size * size;
    ccd.mpr_tolerance = 1e-5 * size;

    double depth = 0;
    ccd_vec3_t direction = {{0, 0, 0}}, position = {{0, 0, 0}};
    const int status = algorithm == LibccdAlgorithm::Epa
                           ? ccdGJKPenetration(&bodyA, &bodyB, &ccd, &depth, &direction, &position)
                           : ccdMPRPenetration(&bodyA, &bodyB, &ccd, &depth, &direction, &position);
    LibccdResult result{LibccdResult::Status::Apart, Position::Zero(), 0};
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
    return result;
}

void CollideLibccd(const PairQuery& query, Manifold& manifold) {
    PolyhedronStorage storageA, storageB;
    const PolyhedronPair pair(CoreOf(query.a, storageA), CoreOf(query.b, storageB), query.bInA);
    const ContactTolerances tolerances = pair.Tolerances(query.settings);
    const double margin = query.settings.speculativeDistance;
    LibccdResult result = LibccdPenetration(query.a, query.b, query.bInA, margin, LibccdAlgorithm::Epa);
    manifold.pointCount = 0;
    if (result.status == LibccdResult::Status::Apart) return;
    Vector3 axis = Normalized(result.normal.cast<float>());
    float separation = pair.SeparationAlong(axis);
    // libccd takes some deep overlaps for touching ones: then its depth is not that of its own direction.
    const double size = static_cast<double>(query.a.InnerRadius()) + query.b.InnerRadius();
    const bool contradicts = separation - pair.RadiusSum() < result.separation - 0.01 * size;
    if (result.status == LibccdResult::Status::Failed || contradicts) {
        ++query.counters.epaFailures;
        const LibccdResult mpr = LibccdPenetration(query.a, query.b, query.bInA, margin, LibccdAlgorithm::Mpr);
        const bool mprFound = mpr.status == LibccdResult::Status::Found;
        if (!mprFound) ++query.counters.centreLineFallbacks;
        const Vector3 other = mprFound ? Vector3(mpr.normal.cast<float>()) : CentreLine(query.bInA);
        const float otherSeparation = pair.SeparationAlong(other);
        if (result.status == LibccdResult::Status::Failed || otherSeparation > separation) {
            axis = other;
            separation = otherSeparation;
        }
    }
    // The axis is as exact as libccd's tolerance; the separation along it is measured on the cores themselves. The polytope of
    // rounded shapes has flat facets: its normals are off by about the root of the relative tolerance.
    BuildContactFromAxis(pair, {axis, separation, 100 * tolerances.feature}, tolerances, query.cache, manifold);
}

}  // namespace fulcrum
