// Whether a pair touches is decided by the notes of its contacts from Solve; for a pair with a surface, by all
// manifolds together. A pair keeps its reported state while it sleeps. Events are listed by any worker and then sorted;
// except for hits, each pair of colliders has at most one.
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/FatBounds.h>

#include <algorithm>
#include <tuple>

namespace fulcrum {

namespace {

using EventKind = ContactEvent::Kind;

// Hysteresis: a contact ends when it is farther apart than this fraction of the speculative distance, so that jitter
// does not end it in every other step.
constexpr float kEndFraction = 0.25f;

// Inputs of contact events.
struct ContactSources {
    const SystemSettings& settings;
    const BodyStore& bodies;
    const ColliderStore& colliders;
    const PairStore& pairs;
    std::span<const ContactNote> notes;
};

// m: points without impulse touch within this separation. before: the pair touched in the last step.
float TouchDistance(const ContactSources& from, uint32_t first, bool before) {
    return before ? kEndFraction * SpeculativeDistance(from.settings, ShapesOf(from.colliders, from.pairs.pairs[first]))
                  : 0.0f;
}

ContactView ViewOf(const ContactSources& from, uint32_t index, ContactView::Point (&room)[ContactRecord::kMaxPoints]) {
    return ViewSolvedContact(from.bodies, from.colliders, from.pairs, index, room);
}

// Whether a contact had an impulse. When it separates, only friction may be left.
bool HasImpulse(const ContactNote& note) {
    const auto isAny = [](std::span<const float> impulses) {
        return std::ranges::any_of(impulses, [](float impulse) { return impulse != 0; });
    };
    return isAny(note.impulse) || isAny(note.frictionImpulse) || note.twistImpulse != 0;
}

// Whether a manifold had an impulse, or has points with a separation of at most `most`, m.
bool Touches(const ContactSources& from, uint32_t index, float most) {
    const Pair& pair = from.pairs.pairs[index];
    if (pair.onSeam || pair.pointCount == 0) return false;
    if (!pair.touching && !from.pairs.RecordOf(pair).Has(ContactRecord::kSensed)) return false;
    if (pair.touching && HasImpulse(from.notes[pair.contact])) return true;
    ContactView::Point room[ContactRecord::kMaxPoints];
    return std::ranges::any_of(ViewOf(from, index, room).points,
                               [&](const ContactView::Point& point) { return point.separation <= most; });
}

// Calls visit(manifold) for the manifolds of a pair that touch.
template <class Visit>
void VisitTouching(const ContactSources& from, uint32_t first, float most, Visit&& visit) {
    for (uint32_t i = first; i != PairStore::kNone; i = from.pairs.MoreOf(i))
        if (Touches(from, i, most)) visit(i);
}

// Whether an event has the second body as its A.
bool IsSwapped(const BodyStore& bodies, uint32_t first, uint32_t second) {
    const auto isDynamic = [&](uint32_t body) { return bodies.dynamics[body].motion == MotionType::Dynamic; };
    return isDynamic(first) && isDynamic(second) ? second < first : !isDynamic(first);
}

// Sets the ids of an event, or of its stored state.
template <class Event>
void SetSides(const ContactSources& from, uint32_t colliderA, uint32_t colliderB, Event& event) {
    const auto bodyOf = [&](uint32_t collider) { return from.colliders.colliders[collider].body; };
    if (IsSwapped(from.bodies, bodyOf(colliderA), bodyOf(colliderB))) std::swap(colliderA, colliderB);
    event.bodyA = from.bodies.IdOf(bodyOf(colliderA));
    event.bodyB = from.bodies.IdOf(bodyOf(colliderB));
    event.childA = ChildOf(from.bodies, from.colliders, colliderA);
    event.childB = ChildOf(from.bodies, from.colliders, colliderB);
}

ListedContact ListedOf(const ReportedContact& reported, EventKind kind, uint32_t pair) {
    const uint32_t manifolds = kind == EventKind::End ? 0 : reported.manifoldCount;
    return {reported.bodyA, reported.bodyB, reported.childA, reported.childB, kind, 1, pair, 0, manifolds};
}

// Decides whether an active pair touches, and records its event, if any; returns whether there is one.
bool LookAtPair(const ContactSources& from, uint32_t index, ReportedContact& reported) {
    const Pair& pair = from.pairs.pairs[index];
    if (pair.isMore) return false;
    const bool before = reported.isOn;
    uint32_t manifolds = 0;
    if (AreReported(from.bodies.reportsContacts, pair.bodyA, pair.bodyB))
        VisitTouching(from, index, TouchDistance(from, index, before), [&](uint32_t) { ++manifolds; });
    const bool touches = manifolds > 0;
    if (!touches && !before) return false;
    reported.isOn = touches;
    reported.manifoldCount = manifolds;
    reported.kind = !touches ? EventKind::End : before ? EventKind::Stay : EventKind::Begin;
    if (reported.kind == EventKind::Begin) SetSides(from, pair.colliderA, pair.colliderB, reported);
    return reported.kind != EventKind::Stay || from.settings.events.stays;
}

void ListActive(const ContactSources& from, std::span<ReportedContact> reported, Array<ListedContact>& listed,
                const StepWorkers& workers) {
    const IndexSet& active = from.pairs.active;
    for (WorkerFindings& findings : workers.findings) findings.eventPairs.reserve(active.Size());
    workers.jobs.ParallelFor(active.WordCount(), 1, [&](JobRange range) {
        Array<uint32_t>& found = workers.findings[range.worker].eventPairs;
        for (uint32_t word = range.begin; word < range.end; ++word)
            active.VisitWord(word, [&](uint32_t index) {
                if (LookAtPair(from, index, reported[index])) found.push_back(index);
            });
    });
    for (WorkerFindings& findings : workers.findings) {
        for (const uint32_t pair : findings.eventPairs)
            listed.push_back(ListedOf(reported[pair], reported[pair].kind, pair));
        findings.eventPairs.clear();
    }
}

// Pairs of bodies that were separated while both slept do not become active again, so their end is detected here.
void ListApart(const ContactSources& from, std::span<ReportedContact> reported, Array<ListedContact>& listed) {
    const auto areNear = [&](const Pair& pair) {
        const Array<Collider>& all = from.colliders.colliders;
        return all[pair.colliderA].fat.Overlaps(all[pair.colliderB].fat);
    };
    for (const uint32_t body : from.bodies.sleepChanges) {
        if (!from.bodies.dynamics[body].awake) continue;
        VisitColliders(from.bodies, from.colliders, body, [&](uint32_t collider) {
            from.pairs.VisitOf(collider, [&](uint32_t pair) {
                if (!reported[pair].isOn || from.pairs.active.Contains(pair) || areNear(from.pairs.pairs[pair])) return;
                reported[pair].isOn = false;
                listed.push_back(ListedOf(reported[pair], EventKind::End, pair));
            });
        });
    }
}

void ListHits(const ContactSources& from, std::span<const ReportedHit> hits, Array<ListedContact>& listed) {
    for (uint32_t i = 0; i < hits.size(); ++i) {
        const ReportedHit& hit = hits[i];
        if (!AreReported(from.bodies.reportsContacts, hit.body, hit.other)) continue;
        ListedContact event;
        event.kind = EventKind::Hit;
        event.time = hit.time;
        event.source = i;
        event.manifoldCount = 1;
        SetSides(from, hit.collider, hit.otherCollider, event);
        listed.push_back(event);
    }
}

// Sorts events: by the indices of bodies, then by the full key.
void Sort(std::span<const ListedContact> listed, Array<ContactOrder>& order) {
    order.clear();
    for (uint32_t i = 0; i < listed.size(); ++i)
        order.push_back({uint64_t{listed[i].bodyA.index} << 32 | listed[i].bodyB.index, i});
    const auto keyOf = [&](const ContactOrder& of) {
        const ListedContact& e = listed[of.listed];
        return std::tie(e.bodyA, e.bodyB, e.childA, e.childB, e.kind, e.time, e.source);
    };
    std::sort(order.begin(), order.end(), [&](const ContactOrder& x, const ContactOrder& y) {
        return x.bodies != y.bodies ? x.bodies < y.bodies : keyOf(x) < keyOf(y);
    });
}

// Assigns the manifolds' ranges to events; returns the number of manifolds. If a contact ended and began in the same
// step, because its pair was recreated, it persists: one of the two events is dropped.
uint32_t Place(bool keepsStays, std::span<ListedContact> listed, Array<ContactOrder>& order) {
    const auto areSame = [](const ListedContact& a, const ListedContact& b) {
        return std::tie(a.bodyA, a.bodyB, a.childA, a.childB) == std::tie(b.bodyA, b.bodyB, b.childA, b.childB);
    };
    size_t count = 0;
    uint32_t manifolds = 0;
    for (size_t i = 0; i < order.size(); ++i) {
        const ContactOrder place = order[i];
        ListedContact& event = listed[place.listed];
        if (event.kind == EventKind::Begin && i + 1 < order.size()) {
            const ListedContact& next = listed[order[i + 1].listed];
            if (next.kind == EventKind::End && areSame(event, next)) {
                event.kind = EventKind::Stay;
                ++i;
                if (!keepsStays) continue;
            }
        }
        event.firstManifold = manifolds;
        manifolds += event.manifoldCount;
        order[count++] = place;
    }
    order.resize(count);
    return manifolds;
}

// Swaps A and B.
void Swap(ContactEvent::Manifold& manifold) {
    manifold.normal = -manifold.normal;
    manifold.frictionImpulse = -manifold.frictionImpulse;
}

// The event manifold of a touching contact: points at the end of the step, normal as solved; raises the speed to the
// largest approach speed of its points.
ContactEvent::Manifold ManifoldOf(const ContactSources& from, uint32_t index, float most, float& approachSpeed) {
    const Pair& pair = from.pairs.pairs[index];
    static constexpr ContactNote kNone{};  // of contacts that are not solved
    const ContactNote& note = pair.touching ? from.notes[pair.contact] : kNone;
    ContactView::Point room[ContactRecord::kMaxPoints];
    const ContactView view = ViewOf(from, index, room);
    const Position normal = view.normal.cast<double>();
    ContactEvent::Manifold manifold{
        .normal = pair.touching ? Vector3(note.normal[0], note.normal[1], note.normal[2]) : view.normal,
        .frictionImpulse = Vector3(note.frictionImpulse[0], note.frictionImpulse[1], note.frictionImpulse[2]),
        .twistImpulse = note.twistImpulse,
        .triangle = from.pairs.contacts[pair.contact].triangle,
        .material = pair.material};
    const auto addWithin = [&](float distance) {
        for (size_t i = 0; i < view.points.size(); ++i) {
            const ContactView::Point& point = view.points[i];
            if (!(note.impulse[i] > 0 || point.separation <= distance)) continue;
            manifold.points[manifold.pointCount++] = {point.position + normal * (0.5 * double{point.separation}),
                                                      point.separation, note.impulse[i]};
            approachSpeed = std::max(approachSpeed, note.approachSpeed[i]);
        }
    };
    addWithin(most);
    // Only friction was left.
    if (manifold.pointCount == 0)
        addWithin(std::ranges::min(view.points, {}, &ContactView::Point::separation).separation);
    return manifold;
}

// Writes an event and its manifolds to their ranges.
void Fill(const ContactSources& from, std::span<const ReportedHit> hits, const ListedContact& listed,
          std::span<ContactEvent::Manifold> manifolds, ContactEvent& event) {
    event = {.bodyA = listed.bodyA,
             .bodyB = listed.bodyB,
             .childA = listed.childA,
             .childB = listed.childB,
             .kind = listed.kind,
             .time = listed.time,
             .approachSpeed = 0,
             .manifolds = manifolds};
    if (listed.kind == EventKind::End) return;
    bool isSwapped = false;
    if (listed.kind == EventKind::Hit) {
        const ReportedHit& hit = hits[listed.source];
        isSwapped = hit.body != listed.bodyA.index;
        manifolds[0] = hit.manifold;
        event.approachSpeed = hit.approachSpeed;
    } else {
        isSwapped = from.pairs.pairs[listed.source].bodyA != listed.bodyA.index;
        const bool before = from.pairs.reported[listed.source].kind != EventKind::Begin;
        const float most = TouchDistance(from, listed.source, before);
        size_t count = 0;
        VisitTouching(from, listed.source, most,
                      [&](uint32_t index) { manifolds[count++] = ManifoldOf(from, index, most, event.approachSpeed); });
    }
    if (isSwapped)
        for (ContactEvent::Manifold& manifold : manifolds) Swap(manifold);
}

}  // namespace

void ListContactEvents(const StepContext& step, const BodyStore& bodies, const ColliderStore& colliders,
                       const SolverLayout& solver, const SweepStore& sweeps, PairStore& pairs, EventBuffers& buffers,
                       const StepWorkers& workers) {
    if (!step.settings.events.contacts) return;
    const ContactSources from{step.settings, bodies, colliders, pairs, solver.notes};
    Array<ListedContact>& listed = buffers.listed;
    listed.clear();
    ListActive(from, pairs.reported, listed, workers);
    ListApart(from, pairs.reported, listed);
    for (const ReportedContact& ended : pairs.ended) listed.push_back(ListedOf(ended, EventKind::End, 0));
    pairs.ended.clear();
    ListHits(from, sweeps.reported, listed);
    Sort(listed, buffers.order);
    buffers.manifolds.resize(Place(step.settings.events.stays, listed, buffers.order));
    buffers.contacts.resize(buffers.order.size());
    workers.jobs.ParallelFor(static_cast<uint32_t>(buffers.order.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            const ListedContact& event = listed[buffers.order[i].listed];
            Fill(from, sweeps.reported, event,
                 std::span(buffers.manifolds).subspan(event.firstManifold, event.manifoldCount), buffers.contacts[i]);
        }
    });
    buffers.events.contacts = buffers.contacts;
}

}  // namespace fulcrum
