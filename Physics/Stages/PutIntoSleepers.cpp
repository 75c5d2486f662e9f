#include <Fulcrum/Physics/Stages/PutIntoSleepers.h>

#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Physics/Stages/ContactLoads.h>
#include <Fulcrum/Physics/World/FatBounds.h>

#include <algorithm>
#include <utility>

namespace fulcrum {

namespace {

// m: how deep a convex piece overlaps another piece.
float DepthOf(const CollisionView& view, uint32_t convex, uint32_t other, WorkerFindings& findings) {
    const auto& a = static_cast<const ConvexShape&>(*view.colliders.shapes[convex].shape);
    const Shape& b = *view.colliders.shapes[other].shape;
    const RelativePose bInA = Relative(ColliderPoseOf(view.bodies, view.colliders, convex),
                                       ColliderPoseOf(view.bodies, view.colliders, other));
    const CollideSettings settings{SpeculativeDistance(view.step.settings, PairShapes{a, b}),
                                   view.step.settings.narrowPhase};
    float least = 0;
    const auto take = [&](const Manifold& manifold) {
        for (int i = 0; i < manifold.pointCount; ++i) least = std::min(least, manifold.points[i].separation);
    };
    if (b.IsSurface()) {
        CollideSurface(a, static_cast<const SurfaceShape&>(b), bInA, settings, {}, findings.surface);
        findings.libccd += findings.surface.Counters();
        for (const SurfaceManifold& manifold : findings.surface.Manifolds()) take(manifold.manifold);
        return -least;
    }
    Manifold manifold;
    PairCache cache;
    if (b.Type() == ShapeType::Plane)
        Collide(a, static_cast<const Plane&>(b), bInA, settings, cache, manifold, findings.libccd);
    else Collide(a, static_cast<const ConvexShape&>(b), bInA, settings, cache, manifold, findings.libccd);
    take(manifold);
    return -least;
}

// m: bodies at rest may overlap by as much, by the usual target or that of the two.
float DepthAtRest(const CollisionView& view, uint32_t a, uint32_t b) {
    const ColliderStore& store = view.colliders;
    const float target = PenetrationTargetOf(view.bodies, store.colliders[a].body, store.colliders[b].body,
                                             view.step.settings.accuracy.penetration);
    float size = store.shapes[a].shape->InnerRadius();
    if (store.shapes[b].shape->IsConvex()) size = std::min(size, store.shapes[b].shape->InnerRadius());
    return std::min(target, AccuracyTarget().penetration) * size;
}

// Along an axis of the world two solids overlap by no more than their bounds: so most that only touch are told apart.
// What is behind a surface is as deep in it as in a solid, however thin its bounds are.
bool BoundsOverlapBy(const CollisionView& view, uint32_t a, uint32_t b, float depth) {
    const Bounds boundsA = TightBoundsOf(view.bodies, view.colliders, a),
                 boundsB = TightBoundsOf(view.bodies, view.colliders, b);
    const Vector3 overlap = boundsA.upper.cwiseMin(boundsB.upper) - boundsA.lower.cwiseMax(boundsB.lower);
    return view.colliders.shapes[b].shape->IsSurface() ? overlap.minCoeff() >= 0 : overlap.minCoeff() > depth;
}

}  // namespace

void NoteIfPutIntoSleeper(const CollisionView& view, uint32_t index, uint32_t other, WorkerFindings& findings) {
    const auto bodyOf = [&](uint32_t collider) { return view.colliders.colliders[collider].body; };
    if (view.bodies.dynamics[bodyOf(index)].motion != MotionType::Dynamic) std::swap(index, other);
    const float depthAtRest = DepthAtRest(view, index, other);
    if (!BoundsOverlapBy(view, index, other, depthAtRest)) return;
    if (!CanCollide(view, bodyOf(index), bodyOf(other)) || !ListenerAllows(view, bodyOf(index), bodyOf(other))) return;
    if (DepthOf(view, index, other, findings) > depthAtRest) findings.putInto.push_back(bodyOf(index));
}

// In the order of their indices: which worker found them must not matter.
bool WakePutInto(std::span<WorkerFindings> workers, const SleepStores& stores) {
    Array<uint32_t> bodies;
    for (WorkerFindings& findings : workers) {
        bodies.insert(bodies.end(), findings.putInto.begin(), findings.putInto.end());
        findings.putInto.clear();
    }
    std::ranges::sort(bodies);
    for (const uint32_t body : bodies) WakeBody(stores, body);
    return !bodies.empty();
}

}  // namespace fulcrum
