// The pair function of polyhedra: box-hull, hull-hull, and spheres and capsules against both. The features that touched
// in the last step are tested first; if they are proven to be still the closest, they are used. Otherwise GJK finds the
// closest points of separated cores, EPA the axis of least penetration of overlapping ones, or, if EPA fails, the full
// separating axis test.
#include <Fulcrum/Collision/NarrowPhase/AxisContact.h>
#include <Fulcrum/Collision/NarrowPhase/AxisSearch.h>
#include <Fulcrum/Collision/NarrowPhase/Epa.h>
#include <Fulcrum/Collision/NarrowPhase/Gjk.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>
#include <Fulcrum/Math/Assert.h>

namespace fulcrum {

namespace {

// The result of testing the features of the last step.
struct WarmStart {
    bool done = false;  // the manifold is written
    Vector3 axis;       // the best guess otherwise, unit
};

WarmStart TryCache(const PolyhedronPair& pair, const ContactTolerances& tolerances, PairCache& cache,
                   Manifold& manifold) {
    WarmStart warm;
    switch (cache.kind) {
        case PairCache::Kind::FaceOfA:
        case PairCache::Kind::FaceOfB: {
            const bool ofA = cache.kind == PairCache::Kind::FaceOfA;
            const int index = ofA ? cache.indexA : cache.indexB;
            FULCRUM_ASSERT(index < (ofA ? pair.a.faceCount : pair.b.faceCount));
            const ReferenceFace face = MeasureFace(pair, ofA, index);
            warm.axis =
                ofA ? pair.a.faces[face.index].normal : Vector3(-(pair.rotation * pair.b.faces[face.index].normal));
            if (face.separation > tolerances.reach) {
                manifold.normal = warm.axis;
                manifold.pointCount = 0;
                warm.done = true;
            } else {
                warm.done = BuildFaceContact(pair, face, tolerances, manifold).proven && manifold.pointCount > 0;
            }
            return warm;
        }
        case PairCache::Kind::EdgePair: {
            const EdgeContact contact = TryCachedEdges(pair, tolerances, cache, manifold);
            warm.done = contact.proven || contact.beyondReach;
            break;
        }
        case PairCache::Kind::Axis: {
            const Vector3 axis = cache.Axis();
            warm.done = pair.SeparationAlong(axis) > tolerances.reach;
            manifold.normal = axis;
            manifold.pointCount = 0;
            break;
        }
        case PairCache::Kind::None: break;
    }
    warm.axis = cache.Axis();
    if (cache.kind == PairCache::Kind::None) warm.axis = Normalized(pair.position);
    return warm;
}

// The axis of the closest points, or of the least depth, and the separation along it, m.
struct CoreDistance {
    Vector3 axis;
    float separation;
    bool beyondReach, converged;
};

// GJK and EPA over `view`, the pair in float or double.
template <class View>
CoreDistance Measure(const View& view, const PolyhedronPair& pair, const Vector3& start, float reach) {
    const auto gjk = Gjk(view, start, reach);
    if (gjk.status != GjkStatus::Overlapping)
        return {gjk.axis, gjk.separation, gjk.status == GjkStatus::BeyondReach, gjk.converged};
    const EpaResult epa = Epa(view, gjk.simplex);
    const FoundAxis found =
        epa.status == EpaResult::Status::Found ? FoundAxis{epa.axis, epa.separation} : SearchAllAxes(pair);
    return {found.axis, found.separation, false, true};
}

}  // namespace

void CollidePolyhedra(const PairQuery& query, Manifold& manifold) {
    PolyhedronStorage storageA, storageB;
    const PolyhedronPair pair(CoreOf(query.a, storageA), CoreOf(query.b, storageB), query.bInA);
    const ContactTolerances tolerances = pair.Tolerances(query.settings);
    const WarmStart warm = TryCache(pair, tolerances, query.cache, manifold);
    if (warm.done) return;

    CoreDistance distance = Measure(pair, pair, warm.axis, tolerances.reach);
    if (!distance.converged) distance = Measure(PrecisePolyhedronPair{pair}, pair, warm.axis, tolerances.reach);
    if (distance.beyondReach) {
        manifold.normal = distance.axis;
        manifold.pointCount = 0;
        query.cache.RememberAxis(PairCache::Kind::Axis, distance.axis);
        return;
    }
    BuildContactFromAxis(pair, {distance.axis, distance.separation, tolerances.feature}, tolerances, query.cache,
                         manifold);
}

}  // namespace fulcrum
