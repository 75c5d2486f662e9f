// The pair function of shapes with curved cores: tapered capsules, cylinders and custom shapes, among themselves and
// against all others. The face that touched in the last step is tested first. Otherwise GJK finds the closest points of
// separated cores, EPA the axis of least depth of overlapping cores.
#include <Fulcrum/Collision/NarrowPhase/ConvexContact.h>
#include <Fulcrum/Collision/NarrowPhase/ConvexGjk.h>
#include <Fulcrum/Collision/NarrowPhase/Epa.h>
#include <Fulcrum/Collision/NarrowPhase/PairFunctions.h>

namespace fulcrum {

namespace {

// Takes the axis if it separates the cores farther than the known one.
void TryAxis(const SupportPair& pair, const Vector3& axis, KnownContact& known) {
    const float separation = pair.SeparationAlong(axis);
    if (separation <= known.separation) return;
    known.axis = axis;
    known.separation = separation;
}

// Both shapes' axes and the line between their centers: starting points for Polish if EPA fails.
void TryPlainAxes(const SupportPair& pair, KnownContact& known) {
    VisitPlainAxes(pair, [&](const Vector3& axis) { TryAxis(pair, axis, known); });
}

Vector3 StartAxis(const PairCache& cache, const RelativePose& bInA) {
    if (cache.kind == PairCache::Kind::Axis) return cache.Axis();
    return Normalized(bInA.position);
}

}  // namespace

// Moves B out along the axis until the cores are a little apart: the direction between the closest points is then an
// axis that separates them at least as far. For n' the new axis, n the old, d the depth along n and m what is left
// between: separation(n') >= m - n.n' (d + m) >= -d. Converges to the axis of least depth near the start in a few
// rounds.
void Polish(const SupportPair& pair, KnownContact& known) {
    constexpr int kRounds = 6;
    const float left = 0.02f * (pair.InnerRadii() + pair.RadiusSum()) + 1e-3f * pair.Size();
    const float enough = 1e-6f * pair.Size() + 1e-12f;
    SupportPair moved = pair;
    for (int i = 0; i < kRounds; ++i) {
        moved.position = pair.position + known.axis * (left - known.separation);
        const ConvexGjkResult gjk = ConvexGjk(moved, known.axis, std::numeric_limits<float>::infinity());
        if (gjk.status != GjkStatus::Apart) return;
        const float separation = pair.SeparationAlong(gjk.axis), gained = separation - known.separation;
        known.onA = gjk.onA;
        if (!(gained > 0)) return;
        known.axis = gjk.axis;
        known.separation = separation;
        if (gained <= enough) return;
    }
}

KnownContact FindDepth(const SupportPair& pair, const Simplex<SupportVertex>& simplex, const Vector3& guess) {
    KnownContact known{guess, pair.SeparationAlong(guess), Vector3::Zero()};
    const EpaResult epa = Epa(pair, simplex);
    if (epa.status == EpaResult::Status::Failed) TryPlainAxes(pair, known);
    else TryAxis(pair, epa.axis, known);
    known.onA = pair.a.SupportCore(known.axis);
    Polish(pair, known);
    return known;
}

void CollideConvex(const PairQuery& query, Manifold& manifold) {
    const SupportPair pair(query.a, query.b, query.bInA);
    const ContactTolerances tolerances(pair.InnerRadii(), pair.RadiusSum(), query.settings);
    PairCache& cache = query.cache;
    Vector3 start = StartAxis(cache, query.bInA);
    if (cache.kind == PairCache::Kind::FaceOfA || cache.kind == PairCache::Kind::FaceOfB) {
        const CachedFace cached = TryCachedFace(pair, tolerances, cache, manifold);
        if (cached.done) return;
        start = cached.axis;
    }
    const ConvexGjkResult gjk = ConvexGjk(pair, start, tolerances.reach);
    if (gjk.status == GjkStatus::BeyondReach) {
        manifold.normal = gjk.axis;
        manifold.pointCount = 0;
        cache.RememberAxis(PairCache::Kind::Axis, gjk.axis);
        return;
    }
    const KnownContact known = gjk.status == GjkStatus::Apart ? KnownContact{gjk.axis, gjk.separation, gjk.onA}
                                                              : FindDepth(pair, gjk.simplex, start);
    BuildConvexContact(pair, known, tolerances, cache, manifold);
}

}  // namespace fulcrum
