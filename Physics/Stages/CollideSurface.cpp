// A pair of a convex shape and a surface has one manifold per direction of contact. The first is stored in the pair;
// the others are additional pairs chained to it, which later stages treat like any other pair. They persist, empty or
// not, as long as the pair does.
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/World/Materials.h>

#include <algorithm>

namespace fulcrum {

namespace {

template <class Visit>
void VisitManifolds(const PairStore& pairs, uint32_t pair, Visit&& visit) {
    for (; pair != PairStore::kNone; pair = pairs.MoreOf(pair)) visit(pair);
}

int CommonFeatures(const PairStore& pairs, uint32_t index, const Manifold& manifold) {
    const Pair& pair = pairs.pairs[index];
    const uint32_t(&features)[Manifold::kMaxPoints] = pairs.contacts[pair.contact].features;
    int count = 0;
    for (int i = 0; i < pair.pointCount; ++i)
        for (int j = 0; j < manifold.pointCount; ++j) count += features[i] == manifold.points[j].feature;
    return count;
}

void Write(const CollideStores& stores, const PairView& view, uint32_t index, const SurfaceManifold& contact,
           WorkerFindings& findings) {
    Pair& pair = stores.pairs.pairs[index];
    PairContact& place = stores.pairs.contacts[pair.contact];
    place.triangle = contact.triangle;
    if (pair.material != contact.material || pair.isMore) {
        pair.material = contact.material;
        CombineMaterials(stores.bodies, stores.colliders, stores.pairs, index);
    }
    WriteManifold(stores, {pair, view.shapes, view.bodyBInA, view.bInA}, contact.manifold, place,
                  stores.pairs.RecordOf(pair), findings);
}

// Motion of the center of the convex piece relative to the surface within the step, m, in that piece's frame.
Vector3 MotionInA(const CollideStores& stores, const PairView& view) {
    const BodyStore& bodies = stores.bodies;
    const uint32_t a = view.pair.bodyA, b = view.pair.bodyB;
    const Quaternion rotation = stores.RotationOf(a);
    Vector3 arm = Vector3::Zero();
    Quaternion toPiece{};
    if (view.pair.offset) {
        const RelativePose piece = LocalOf(stores.bodies, stores.colliders, view.pair.colliderA);
        arm = Rotate(rotation, piece.position);
        toPiece = piece.rotation.Conjugate();
    }
    const Vector3 armB = arm - Rotate(rotation, view.bodyBInA.position);
    const Vector3 velocity = bodies.LinearVelocityOf(a) + Cross<float>(bodies.AngularVelocityOf(a), arm) -
                             bodies.LinearVelocityOf(b) - Cross<float>(bodies.AngularVelocityOf(b), armB);
    return Rotate(toPiece, InverseRotate(rotation, Vector3(velocity * stores.step.dt)));
}

}  // namespace

// Assigns each manifold to the slot with matching features, then the rest to free slots.
void WriteSurfaceManifolds(const CollideStores& stores, const PairView& view, uint32_t first, bool writesEmpty,
                           WorkerFindings& findings) {
    constexpr uint32_t kTaken = ~0u;
    Array<uint32_t>& places = findings.surfacePlaces;
    places.clear();
    VisitManifolds(stores.pairs, first, [&](uint32_t index) { places.push_back(index); });
    const std::span<const SurfaceManifold> found = findings.surface.Manifolds();
    Array<uint32_t>& left = findings.surfaceLeft;
    left.clear();
    for (uint32_t m = 0; m < found.size(); ++m) {
        int most = 0;
        size_t best = places.size();
        for (size_t i = 0; i < places.size(); ++i) {
            const int common = places[i] == kTaken ? 0 : CommonFeatures(stores.pairs, places[i], found[m].manifold);
            if (common > most) {
                most = common;
                best = i;
            }
        }
        if (best == places.size()) {
            left.push_back(m);
            continue;
        }
        Write(stores, view, places[best], found[m], findings);
        places[best] = kTaken;
    }
    size_t next = 0;
    std::erase_if(left, [&](uint32_t m) {
        while (next < places.size() && places[next] == kTaken) ++next;
        if (next == places.size()) return false;
        Write(stores, view, places[next], found[m], findings);
        places[next] = kTaken;
        return true;
    });
    for (uint32_t place : places)
        if (writesEmpty && place != kTaken) stores.pairs.pairs[place].pointCount = 0;
}

void FindSurfaceManifolds(const CollideStores& stores, const PairView& view, uint32_t first, float reach,
                          WorkerFindings& findings) {
    CollideSettings settings;
    settings.speculativeDistance = reach;
    settings.method = stores.step.settings.narrowPhase;
    Array<uint32_t>& touched = findings.surfaceTouched;
    touched.clear();
    VisitManifolds(stores.pairs, first, [&](uint32_t index) {
        const Pair& pair = stores.pairs.pairs[index];
        if (pair.pointCount > 0) touched.push_back(stores.pairs.contacts[pair.contact].triangle);
    });
    CollideSurface(view.shapes.a, static_cast<const SurfaceShape&>(view.shapes.b), view.bInA, settings,
                   {MotionInA(stores, view), touched}, findings.surface);
    findings.libccd += findings.surface.Counters();
}

PairChange CollideWithSurface(const CollideStores& stores, std::span<PairChange> changes, uint32_t first,
                              const PairReach& reach, WorkerFindings& findings) {
    bool touches = false;
    VisitManifolds(stores.pairs, first, [&](uint32_t index) { touches |= stores.pairs.pairs[index].pointCount > 0; });
    const PairView view = ViewPair(stores, first);
    Array<PairContact>& contacts = stores.pairs.contacts;
    const bool hardlyMoved = touches && HardlyMoved(view, contacts[view.pair.contact]);
    if (hardlyMoved && !stores.IsSecondPass()) {
        stores.pairs.pairs[first].kept = true;
        ++findings.kept;
    } else {
        findings.kept -= stores.pairs.pairs[first].kept;  // counted by an earlier pass
        stores.pairs.pairs[first].kept = false;
        FindSurfaceManifolds(stores, view, first, reach.WithRotation(stores, view.pair, view.shapes), findings);
        WriteSurfaceManifolds(stores, view, first, true, findings);
        for (const uint32_t m : findings.surfaceLeft)
            findings.more.push_back({first, m, findings.surface.Manifolds()[m]});
        VisitManifolds(stores.pairs, first,
                       [&](uint32_t index) { contacts[stores.pairs.pairs[index].contact].reference = view.bInA; });
    }
    PairChange ofFirst = PairChange::None;
    bool wakes = false;
    VisitManifolds(stores.pairs, first, [&](uint32_t index) {
        const Pair& pair = stores.pairs.pairs[index];
        if (IsFoundAgain(stores, pair, findings)) return;
        if (pair.pointCount > 0) NoteOverlap(stores, index, view.shapes, view.bInA, findings);
        const PairChange change = NoteTouching(stores, index, findings);
        wakes |= TouchesSleepingBody(stores.bodies, pair);
        if (index == first) ofFirst = change;
        else changes[index] = change;
    });
    return wakes ? PairChange::WakesOther : ofFirst;
}

void AddMoreManifolds(const CollideStores& stores, PairUpdates& updates, std::span<WorkerFindings> workers) {
    Array<MoreManifold>& all = updates.moreManifolds;
    all.clear();
    for (WorkerFindings& findings : workers) {
        all.insert(all.end(), findings.more.begin(), findings.more.end());
        findings.more.clear();
    }
    if (all.empty()) return;
    std::sort(all.begin(), all.end(), [](const MoreManifold& a, const MoreManifold& b) {
        return a.pair < b.pair || (a.pair == b.pair && a.order < b.order);
    });
    for (const MoreManifold& more : all) {
        const uint32_t index = stores.pairs.AddMore(more.pair);
        updates.changes.resize(std::max(updates.changes.size(), stores.pairs.pairs.size()), PairChange::None);
        Write(stores, ViewPair(stores, more.pair), index, more.contact, workers.front());
        updates.changes[index] = NoteTouching(stores, index, workers.front());
        if (TouchesSleepingBody(stores.bodies, stores.pairs.pairs[index]))
            updates.changes[more.pair] = PairChange::WakesOther;
    }
}

}  // namespace fulcrum
