// Whether a pair touches is decided by what Solve noted of its contacts; of a pair with a surface, by all manifolds
// together. What was said of a pair last stays with it while it sleeps, and ends with it. Events are listed by any
// worker and sorted: each pair of pieces has one at most, but for hits.
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/World/FatBounds.h>

#include <algorithm>
#include <tuple>

namespace fulcrum {

namespace {

using EventKind = ContactEvent::Kind;

// What touched goes on until it is this part of the speculative distance apart: what jitters does not end in every
// other step.
constexpr float kEndPart = 0.25f;

// What contact events are made from.
struct ContactSources {
    const SystemSettings& settings;
    const BodyStore& bodies;
    const ColliderStore& colliders;
    const PairStore& pairs;
    std::span<const ContactNote> notes;
};

// Points of a manifold that press, or are no farther apart than `most`.
struct TouchingPoints {
    const Pair& pair;
    const ContactNote& note;
    float most;  // m

    bool Has(int i) const { return note.impulse[i] > 0 || note.separation[i] <= most; }
    template <class Visit>
    void Each(Visit&& visit) const {
        for (int i = 0; i < pair.pointCount; ++i)
            if (Has(i)) visit(static_cast<size_t>(i));
    }
};

// Calls visit(manifold, points) for the manifolds of a pair that have points which touch. before: it did in the last
// step.
template <class Visit>
void VisitTouching(const ContactSources& from, uint32_t first, bool before, Visit&& visit) {
    const PairStore& pairs = from.pairs;
    const float most = before ? kEndPart * SpeculativeDistance(from.settings, pairs.pairs[first]) : 0.0f;
    for (uint32_t i = first; i != PairStore::kNone; i = pairs.pairs[i].more) {
        const Pair& pair = pairs.pairs[i];
        if (!pair.touching || pair.onSeam) continue;
        const TouchingPoints points{pair, from.notes[i], most};
        bool touches = false;
        points.Each([&](size_t) { touches = true; });
        if (touches) visit(i, points);
    }
}

bool Touches(const ContactSources& from, uint32_t first, bool before) {
    bool touches = false;
    VisitTouching(from, first, before, [&](uint32_t, const TouchingPoints&) { touches = true; });
    return touches;
}

bool AreReported(const BodyStore& bodies, uint32_t bodyA, uint32_t bodyB) {
    return bodies.cold[bodyA].reportsContacts || bodies.cold[bodyB].reportsContacts;
}

// Whether an event has the second body as its A.
bool IsSwapped(const BodyStore& bodies, uint32_t first, uint32_t second) {
    const auto isDynamic = [&](uint32_t body) { return bodies.dynamics[body].motion == MotionType::Dynamic; };
    return isDynamic(first) && isDynamic(second) ? second < first : !isDynamic(first);
}

// The ids of an event, or of what is kept of it.
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
    return {reported.bodyA, reported.bodyB, reported.childA, reported.childB, kind, 1, pair, 0, 0};
}

// Decides whether an active pair touches, and notes its event, if it has one; returns whether it has.
bool LookAtPair(const ContactSources& from, uint32_t index, ReportedContact& reported) {
    const Pair& pair = from.pairs.pairs[index];
    if (pair.isMore) return false;
    const bool before = reported.isOn;
    const bool touches = Touches(from, index, before) && AreReported(from.bodies, pair.bodyA, pair.bodyB);
    if (!touches && !before) return false;
    reported.isOn = touches;
    reported.kind = !touches ? EventKind::End : before ? EventKind::Stay : EventKind::Begin;
    if (reported.kind == EventKind::Begin) SetSides(from, pair.colliderA, pair.colliderB, reported);
    return reported.kind != EventKind::Stay || from.settings.events.stays;
}

void ListActive(const ContactSources& from, std::span<ReportedContact> reported, std::vector<ListedContact>& listed,
                const StepWorkers& workers) {
    const IndexSet& active = from.pairs.active;
    for (WorkerFindings& findings : workers.findings) findings.eventPairs.reserve(active.Size());
    workers.jobs.ParallelFor(active.WordCount(), 1, [&](JobRange range) {
        std::vector<uint32_t>& found = workers.findings[range.worker].eventPairs;
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

// Pairs of bodies that were taken apart while both slept are not active again: nothing else tells that they ended.
void ListApart(const ContactSources& from, std::span<ReportedContact> reported, std::vector<ListedContact>& listed) {
    const auto areNear = [&](const Pair& pair) {
        const std::vector<Collider>& all = from.colliders.colliders;
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

void ListHits(const ContactSources& from, std::span<const ReportedHit> hits, std::vector<ListedContact>& listed) {
    for (uint32_t i = 0; i < hits.size(); ++i) {
        const ReportedHit& hit = hits[i];
        if (!AreReported(from.bodies, hit.body, hit.other)) continue;
        ListedContact event;
        event.kind = EventKind::Hit;
        event.time = hit.time;
        event.source = i;
        event.manifoldCount = 1;
        SetSides(from, hit.collider, hit.otherCollider, event);
        listed.push_back(event);
    }
}

// Sorted; what ended and began again in the same step, as its pair was made anew, stayed.
void Order(bool keepsStays, std::vector<ListedContact>& listed) {
    const auto sidesOf = [](const ListedContact& e) { return std::tie(e.bodyA, e.bodyB, e.childA, e.childB); };
    std::sort(listed.begin(), listed.end(), [&](const ListedContact& x, const ListedContact& y) {
        return std::tie(x.bodyA, x.bodyB, x.childA, x.childB, x.kind, x.time, x.source) <
               std::tie(y.bodyA, y.bodyB, y.childA, y.childB, y.kind, y.time, y.source);
    });
    size_t count = 0;
    for (size_t i = 0; i < listed.size(); ++i) {
        ListedContact event = listed[i];
        const bool stays = event.kind == EventKind::Begin && i + 1 < listed.size() &&
                           listed[i + 1].kind == EventKind::End && sidesOf(event) == sidesOf(listed[i + 1]);
        if (stays) {
            event.kind = EventKind::Stay;
            ++i;
            if (!keepsStays) continue;
        }
        listed[count++] = event;
    }
    listed.resize(count);
}

// Turns it to the other side.
void Swap(ContactEvent::Manifold& manifold) {
    manifold.normal = -manifold.normal;
    manifold.frictionImpulse = -manifold.frictionImpulse;
}

// Of one that touches: its points as the step ended, its normal as it was solved; raises the speed to the fastest
// approach of its points.
ContactEvent::Manifold ManifoldOf(const ContactSources& from, uint32_t index, const TouchingPoints& points,
                                  float& approachSpeed) {
    ContactView::Point room[ContactRecord::kMaxPoints];
    const ContactView view = ViewSolvedContact(from.bodies, from.colliders, from.pairs, index, room);
    const ContactNote& note = points.note;
    ContactEvent::Manifold manifold{
        .normal = Vector3(note.normal[0], note.normal[1], note.normal[2]),
        .frictionImpulse = Vector3(note.frictionImpulse[0], note.frictionImpulse[1], note.frictionImpulse[2]),
        .twistImpulse = note.twistImpulse,
        .triangle = points.pair.triangle,
        .material = points.pair.material};
    const Position normal = view.normal.cast<double>();
    points.Each([&](size_t i) {
        const double half = 0.5 * double{room[i].separation};
        manifold.points[manifold.pointCount++] = {room[i].position + normal * half, room[i].separation,
                                                  note.impulse[i]};
        approachSpeed = std::max(approachSpeed, note.approachSpeed[i]);
    });
    return manifold;
}

// Writes an event and its manifolds, for which there is room.
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
        size_t count = 0;
        VisitTouching(from, listed.source, from.pairs.reported[listed.source].kind != EventKind::Begin,
                      [&](uint32_t index, const TouchingPoints& points) {
                          manifolds[count++] = ManifoldOf(from, index, points, event.approachSpeed);
                      });
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
    std::vector<ListedContact>& listed = buffers.listed;
    listed.clear();
    ListActive(from, pairs.reported, listed, workers);
    ListApart(from, pairs.reported, listed);
    for (const ReportedContact& ended : pairs.ended) listed.push_back(ListedOf(ended, EventKind::End, 0));
    pairs.ended.clear();
    ListHits(from, sweeps.reported, listed);
    Order(step.settings.events.stays, listed);

    const uint32_t count = static_cast<uint32_t>(listed.size());
    workers.jobs.ParallelFor(count, 64, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            ListedContact& event = listed[i];
            if (event.kind == EventKind::Begin || event.kind == EventKind::Stay)
                VisitTouching(from, event.source, pairs.reported[event.source].kind != EventKind::Begin,
                              [&](uint32_t, const TouchingPoints&) { ++event.manifoldCount; });
        }
    });
    uint32_t manifolds = 0;
    for (ListedContact& event : listed) {
        event.firstManifold = manifolds;
        manifolds += event.manifoldCount;
    }
    buffers.contacts.resize(count);
    buffers.manifolds.resize(manifolds);
    workers.jobs.ParallelFor(count, 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            Fill(from, sweeps.reported, listed[i],
                 std::span(buffers.manifolds).subspan(listed[i].firstManifold, listed[i].manifoldCount),
                 buffers.contacts[i]);
    });
    buffers.events.contacts = buffers.contacts;
}

}  // namespace fulcrum
