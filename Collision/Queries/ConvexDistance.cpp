#include <Fulcrum/Collision/Queries/ConvexDistance.h>

#include <Fulcrum/Collision/NarrowPhase/AxisSearch.h>
#include <Fulcrum/Collision/NarrowPhase/Epa.h>
#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/Collision/Queries/CoreShapes.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace fulcrum {

namespace {

std::optional<Polyhedron> PolyhedralCoreOf(const ConvexShape& shape, PolyhedronStorage& storage) {
    if (HasPolyhedralCore(shape.Type())) return CoreOf(shape, storage);
    if (const auto* triangle = dynamic_cast<const TriangleCore*>(&shape))
        return CoreOf(triangle->Corners(), triangle->Normal(), 0, storage);
    return std::nullopt;
}

// Of two polyhedra, one of them with faces, the axis of least depth by the separating axis test.
std::optional<Vector3> PolyhedralAxis(const SupportPair& pair, const RelativePose& bInA) {
    PolyhedronStorage storageA, storageB;
    const std::optional<Polyhedron> a = PolyhedralCoreOf(pair.a, storageA);
    if (!a) return std::nullopt;
    const std::optional<Polyhedron> b = PolyhedralCoreOf(pair.b, storageB);
    if (!b || a->faceCount + b->faceCount == 0) return std::nullopt;
    return SearchAllAxes(PolyhedronPair(*a, *b, bInA)).axis;
}

// The axis of least depth of overlapping cores. For a flat or pointed core, such as a triangle or a segment, EPA may
// fail. Then polyhedra are tested along all their axes: of two triangles libccd's EPA takes milliseconds, and there may
// be thousands of pairs. For others libccd's axis or the center line is used, whichever has less depth; without libccd
// if the depth is known to be less than `enough`, m.
Vector3 AxisOfLeastDepth(const SupportPair& pair, const RelativePose& bInA, const ConvexGjkResult& gjk, float enough) {
    Vector3 axis = gjk.axis;
    float depth = -pair.SeparationAlong(axis);
    // If the cores are far apart, GJK's simplex may contain the origin due to rounding. A separating plane proves that
    // they are apart; their separation along its normal is the best result that floats allow.
    if (depth < 0) return axis;
    const Vector3 centerLine = Normalized(pair.position);
    if (pair.SeparationAlong(centerLine) > 0) return centerLine;
    const EpaResult epa = Epa(pair, gjk.simplex);
    const auto consider = [&](const Vector3& other) {
        const float otherDepth = -pair.SeparationAlong(other);
        if (!(otherDepth < depth)) return;
        axis = other;
        depth = otherDepth;
    };
    if (epa.status != EpaResult::Status::Failed) consider(epa.axis);
    if (epa.status == EpaResult::Status::Found) return axis;
    consider(centerLine);
    consider(-centerLine);
    // If one shape is so much larger that the overlap is below its rounding, only GJK's simplex gives the closest
    // feature.
    using Real = SupportVertex::Real;
    const auto& simplex = gjk.simplex;
    const int faces = simplex.count == 4 ? 4 : simplex.count == 3 ? 1 : 0;
    for (int i = 0; i < faces; ++i) {
        const Vec3<Real> first = simplex.vertices[i].w, second = simplex.vertices[(i + 1) % simplex.count].w,
                         third = simplex.vertices[(i + 2) % simplex.count].w;
        const Vec3<Real> normal = Cross<Real>(Vec3<Real>(second - first), Vec3<Real>(third - first));
        const Real length = std::sqrt(Dot<Real>(normal, normal));
        if (!(length > 0)) continue;
        const Vector3 face = Vec3<Real>(normal * (1 / length)).template cast<float>();
        consider(face);
        consider(-face);
    }
    if (const std::optional<Vector3> found = PolyhedralAxis(pair, bInA)) {
        consider(*found);
        return axis;
    }
    if (depth < enough) return axis;
    for (const LibccdAlgorithm algorithm : {LibccdAlgorithm::Epa, LibccdAlgorithm::Mpr}) {
        const LibccdResult found = LibccdPenetration(pair.a, pair.b, bInA, 0, algorithm);
        if (found.status == LibccdResult::Status::Found) consider(Normalized(found.normal.cast<float>()));
    }
    return axis;
}

// B's deepest point, and the point of A through which B would leave.
void FindDeepestPoints(const SupportPair& pair, ConvexSeparation& result) {
    const Vector3 deepest = pair.PointOfB(pair.b.SupportCore(-pair.DirectionInB(result.normal)));
    result.onB = deepest - result.normal * pair.b.ConvexRadius();
    result.onA = result.onB - result.normal * result.separation;
    result.isBeyond = !IsFinite(result.normal) || !IsFinite(result.onA);  // overflow
}

// libccd is asked with rounded shapes, and the rounding would depend on the reach: it always is that of an infinite
// one, so that what is measured does not depend on the reach. Pairs that the center line proves to be beyond it are not
// measured.
ConvexSeparation MeasureByLibccd(const SupportPair& pair, const RelativePose& bInA, float reach) {
    constexpr float kAnyReach = std::numeric_limits<float>::infinity();
    CollideCounters unused;
    std::optional<KnownContact> known;
    if (!(pair.SeparationAlong(Normalized(pair.position)) > reach + pair.RadiusSum()))
        known = FindLibccdContact(pair, bInA, kAnyReach, unused);
    ConvexSeparation result;
    if (!known) {
        result.isBeyond = true;
        return result;
    }
    result.normal = known->axis;
    result.separation = known->separation - pair.RadiusSum();
    if (known->separation <= 0) {
        FindDeepestPoints(pair, result);
        return result;
    }
    result.onA = known->onA + known->axis * pair.a.ConvexRadius();
    result.onB = result.onA + known->axis * result.separation;
    result.isBeyond = !(result.separation <= reach) || !IsFinite(result.onA) || !IsFinite(result.onB);
    return result;
}

// Of a shape more than ten thousand times as large as the other one GJK's simplex may come near the origin by rounding,
// after the search has passed a plane that separates the two. A search with a shorter reach ends at that plane: here
// all searches do, so that what is found does not depend on the reach. `gjk`: not beyond reach.
void PreferSeparatingPlanes(const SupportPair& pair, ConvexGjkResult& gjk) {
    constexpr float kFarLarger = 1e4f, kRounding = 1e-4f;
    const float small = std::min(pair.a.OuterRadius(), pair.b.OuterRadius());
    if (!(std::max(pair.a.OuterRadius(), pair.b.OuterRadius()) > kFarLarger * small)) return;
    for (int i = 0; i < 8; ++i) {
        const float known = gjk.status == GjkStatus::Apart ? gjk.separation : 0.0f;
        const ConvexGjkResult farther = ConvexGjk(pair, Normalized(pair.position), known + kRounding * small);
        if (farther.status != GjkStatus::BeyondReach) return;
        gjk.status = GjkStatus::Apart;
        gjk.axis = farther.axis;
        gjk.separation = farther.separation;
        const Vector3 deepest = pair.PointOfB(pair.b.SupportCore(-pair.DirectionInB(gjk.axis)));
        gjk.onB = deepest;
        gjk.onA = deepest - gjk.axis * gjk.separation;
    }
}

}  // namespace

ConvexSeparation MeasureConvex(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, float reach,
                               NarrowPhaseMethod method) {
    const SupportPair pair(a, b, bInA);
    if (method == NarrowPhaseMethod::Libccd) return MeasureByLibccd(pair, bInA, reach);
    const float reachOfCores = reach + pair.RadiusSum();
    ConvexGjkResult gjk = ConvexGjk(pair, Normalized(pair.position), std::max(reachOfCores, 0.0f));
    ConvexSeparation result;
    if (gjk.status == GjkStatus::BeyondReach) {
        result.isBeyond = true;
        return result;
    }
    PreferSeparatingPlanes(pair, gjk);
    if (gjk.status == GjkStatus::Apart) {
        result.separation = gjk.separation - pair.RadiusSum();
        result.normal = gjk.axis;
        result.onA = gjk.onA + gjk.axis * a.ConvexRadius();
        result.onB = gjk.onB - gjk.axis * b.ConvexRadius();
        result.isBeyond = !(result.separation <= reach) || !IsFinite(result.onA) || !IsFinite(result.onB);
        return result;
    }
    result.normal = AxisOfLeastDepth(pair, bInA, gjk, -reachOfCores);
    result.separation = pair.SeparationAlong(result.normal) - pair.RadiusSum();
    FindDeepestPoints(pair, result);
    return result;
}

bool OverlapConvex(const ConvexShape& a, const ConvexShape& b, const RelativePose& bInA, NarrowPhaseMethod method) {
    const SupportPair pair(a, b, bInA);
    if (method == NarrowPhaseMethod::Libccd) return !AskLibccd(pair, bInA, 0).apart;
    const float radii = pair.RadiusSum();
    const ConvexGjkResult gjk = ConvexGjk(pair, Normalized(pair.position), radii);
    return gjk.status == GjkStatus::Overlapping || (gjk.status == GjkStatus::Apart && gjk.separation <= radii);
}

}  // namespace fulcrum
