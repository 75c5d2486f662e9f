// Manifolds of all active pairs. A pair whose bodies hardly moved relative to each other keeps its manifold, and
// Prepare updates its separations. The speculative distance covers the motion of the bodies within the step, so that no
// body penetrates another before a contact exists. It covers all directions, since bodies that are hit are deflected
// and rotated.
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Physics/Stages/CrowdContacts.h>
#include <Fulcrum/Physics/Stages/PairView.h>
#include <Fulcrum/Physics/Stages/PrefetchLines.h>
#include <Fulcrum/Physics/Stages/Stages.h>
#include <Fulcrum/Physics/Stages/SweepCast.h>
#include <Fulcrum/Physics/World/FatBounds.h>
#include <Fulcrum/Physics/World/Materials.h>
#include <Fulcrum/Physics/World/Waking.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace fulcrum {

namespace {

// Whether fat bounds still overlap; tested only if they changed.
bool Overlap(const ColliderStore& colliders, const Pair& pair) {
    return colliders.colliders[pair.colliderA].fat.Overlaps(colliders.colliders[pair.colliderB].fat);
}

// Records the contact of a pair that has none, if it has points: it gets its place after the loop.
void MakeContact(const CollideStores& stores, const PairView& view, uint32_t index, const Manifold& manifold,
                 WorkerFindings& findings) {
    NewContact made;
    WriteManifold(stores, view, manifold, made.contact, made.record, findings);
    if (view.pair.pointCount == 0) return;
    made.contact.reference = view.bInA;
    made.contact.pair = index;
    findings.newContacts.push_back(made);
}

// What follows from the contact of a pair with a convex shape or a plane.
PairChange LookAtContact(const CollideStores& stores, uint32_t index, PairShapes shapes, const RelativePose& bInA,
                         WorkerFindings& findings) {
    const Pair& pair = stores.pairs.pairs[index];
    if (IsFoundAgain(stores, pair, findings)) return PairChange::None;
    if (pair.pointCount > 0) NoteOverlap(stores, index, shapes, bInA, findings);
    const PairChange change = NoteTouching(stores, index, findings);
    if (pair.pointCount == 0) return PairChange::Ended;  // also if the listener had ignored it
    return TouchesSleepingBody(stores.bodies, pair) ? PairChange::WakesOther : change;
}

// Unit, world axes, from A to B.
Vector3 NormalOf(const CollideStores& stores, const Pair& pair) {
    const float* n = stores.pairs.RecordOf(pair).normal;
    return Rotate(stores.bodies.RotationOf(pair.bodyA), Vector3(n[0], n[1], n[2]));
}

// Of a pair with a contact, of convex shapes or with a plane.
PairChange UpdateContact(const CollideStores& stores, uint32_t index, PairShapes shapes, WorkerFindings& findings) {
    Pair& pair = stores.pairs.pairs[index];
    PairContact& contact = stores.pairs.contacts[pair.contact];
    const PairView view = ViewPair(stores, index);
    if (!stores.IsSecondPass() && pair.pointCount > 0 && HardlyMoved(view, contact)) {
        pair.kept = true;
        ++findings.kept;
        return LookAtContact(stores, index, shapes, view.bInA, findings);
    }
    findings.kept -= pair.kept;  // counted by an earlier pass
    pair.kept = false;
    Manifold manifold;
    FindManifold(stores, view, PairReach(stores, pair, shapes).WithRotation(stores, pair, shapes), manifold, findings);
    if (TurnsFromOthers(stores, view, manifold))
        findings.turnedNormals.push_back({pair.bodyA, pair.bodyB, NormalOf(stores, pair)});
    WriteManifold(stores, view, manifold, contact, stores.pairs.RecordOf(pair), findings);
    contact.reference = view.bInA;
    return LookAtContact(stores, index, shapes, view.bInA, findings);
}

PairChange CollidePair(const CollideStores& stores, std::span<PairChange> changes, uint32_t index,
                       WorkerFindings& findings) {
    Pair& pair = stores.pairs.pairs[index];
    const BodyPose& poseA = stores.bodies.poses[pair.bodyA];
    const BodyPose& poseB = stores.bodies.poses[pair.bodyB];
    const uint32_t now = static_cast<uint32_t>(stores.step.number);
    if (!stores.IsSecondPass()) pair.kept = false;
    if (!stores.IsSecondPass() && (poseA.boundsChangedIn == now || poseB.boundsChangedIn == now) &&
        !Overlap(stores.colliders, pair))
        return PairChange::Dead;

    const PairShapes shapes = ShapesOf(stores.colliders, pair);
    const bool hasContact = pair.contact != PairStore::kNone;
    if (hasContact && !pair.surface) return UpdateContact(stores, index, shapes, findings);
    const PairReach reach(stores, pair, shapes);
    if (!hasContact && !pair.offset && reach.AreFarApart(stores, pair, shapes)) return PairChange::None;
    if (pair.surface) return CollideWithSurface(stores, changes, index, reach, findings);
    const PairView view = ViewPair(stores, index);
    Manifold manifold;
    FindManifold(stores, view, reach.WithRotation(stores, pair, shapes), manifold, findings);
    if (manifold.pointCount > 0) MakeContact(stores, view, index, manifold, findings);
    return PairChange::None;
}

// Prefetches data of the next pairs while this one is collided.
FULCRUM_FORCE_INLINE void PrefetchAhead(const CollideStores& stores, uint32_t index) {
    constexpr uint32_t kAhead = 6;
    if (index + kAhead >= stores.pairs.pairs.size()) return;
    const Pair& pair = stores.pairs.pairs[index + kAhead];
    for (uint32_t body : {pair.bodyA, pair.bodyB}) {
        __builtin_prefetch(&stores.bodies.poses[body]);
        __builtin_prefetch(&stores.bodies.states[body]);
    }
    if (pair.contact == PairStore::kNone) return;
    __builtin_prefetch(&stores.pairs.contacts[pair.contact]);
    PrefetchLines(&stores.pairs.records[pair.contact], sizeof(ContactRecord));
}

void CollideAllActive(const CollideStores& stores, Array<PairChange>& changes, const StepWorkers& workers) {
    const IndexSet& active = stores.pairs.active;
    changes.resize(stores.pairs.pairs.size(), PairChange::None);
    workers.jobs.ParallelFor(active.WordCount(), 1, [&](JobRange range) {
        for (uint32_t word = range.begin; word < range.end; ++word)
            active.VisitWord(word, [&](uint32_t index) {
                PrefetchAhead(stores, index);
                if (stores.pairs.pairs[index].isMore) return;  // handled with its pair
                changes[index] = CollidePair(stores, changes, index, workers.findings[range.worker]);
            });
    });
}

void CollideListed(const CollideStores& stores, std::span<const uint32_t> list, Array<PairChange>& changes,
                   const StepWorkers& workers) {
    changes.resize(stores.pairs.pairs.size(), PairChange::None);
    workers.jobs.ParallelFor(static_cast<uint32_t>(list.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i)
            changes[list[i]] = CollidePair(stores, changes, list[i], workers.findings[range.worker]);
    });
}

// Lists of so many new contacts are always kept: 64 KB.
constexpr size_t kFewContacts = 256;

// Copies new contacts to their places.
void AddNewContacts(const CollideStores& stores, PairUpdates& updates, const StepWorkers& workers) {
    size_t count = 0;
    for (const WorkerFindings& findings : workers.findings) count += findings.newContacts.size();
    if (count == 0) return;
    PairStore& pairs = stores.pairs;
    pairs.ReserveContacts(count);
    const std::span<const NewContact*> all = workers.scratch.Allocate<const NewContact*>(count);
    count = 0;
    for (const WorkerFindings& findings : workers.findings)
        for (const NewContact& made : findings.newContacts) {
            pairs.AddContact(made.contact.pair);
            all[count++] = &made;
        }
    workers.jobs.ParallelFor(static_cast<uint32_t>(count), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            const uint32_t index = all[i]->contact.pair, contact = pairs.pairs[index].contact;
            pairs.contacts[contact] = all[i]->contact;
            pairs.records[contact] = all[i]->record;
            CombineMaterials(stores.bodies, stores.colliders, pairs, index);
            updates.changes[index] = LookAtContact(stores, index, ShapesOf(stores.colliders, pairs.pairs[index]),
                                                   pairs.contacts[contact].reference, workers.findings[range.worker]);
        }
    });
    // Any worker may find all of as many in a later step. The lists of the first step with very many, in which most
    // contacts of a world begin, are not kept: they are as large as the contacts.
    const bool areMany = count > std::max(kFewContacts, pairs.contacts.size() / 8);
    const bool isStart = areMany && !updates.hadManyNewContacts;
    updates.hadManyNewContacts |= areMany;
    for (WorkerFindings& findings : workers.findings) {
        findings.newContacts.clear();
        if (isStart) findings.newContacts.shrink_to_fit();
        else findings.newContacts.reserve(count);
    }
}

// An order that does not depend on the threads.
bool IsLarger(const Deflection& a, const Deflection& b) {
    const auto key = [](const Deflection& d) {
        return std::tuple(d.size, d.otherBody, d.linear.x(), d.linear.y(), d.linear.z(), d.angular.x(), d.angular.y(),
                          d.angular.z());
    };
    return key(a) > key(b);
}

// Where a normal turned, the contacts of the same two bodies that pressed the opposite way are not warm started either:
// nothing balances them now. A child of a compound that a thin floor pushes out on both sides may turn to the other
// side.
void ForgetOpposed(const CollideStores& stores, std::span<WorkerFindings> workers) {
    constexpr float kOpposite = -0.5f;
    PairStore& pairs = stores.pairs;
    for (WorkerFindings& findings : workers) {
        for (const TurnedNormal& turned : findings.turnedNormals) {
            const auto look = [&](uint32_t index) {
                const Pair& pair = pairs.pairs[index];
                const bool isSame = pair.bodyA == turned.bodyA && pair.bodyB == turned.bodyB,
                           isSwapped = pair.bodyA == turned.bodyB && pair.bodyB == turned.bodyA;
                if (!(isSame || isSwapped) || pair.pointCount == 0 || pair.surface) return;
                const float cosine = Dot(NormalOf(stores, pair), turned.before);
                if ((isSame ? cosine : -cosine) < kOpposite) pairs.RecordOf(pair).ForgetImpulses();
            };
            VisitColliders(stores.bodies, stores.colliders, turned.bodyA,
                           [&](uint32_t collider) { pairs.VisitOf(collider, look); });
        }
        findings.turnedNormals.clear();
    }
}

// Lists of so many deflections, and of so many pairs of deflected bodies, are kept once there is one.
constexpr size_t kFewDeflections = 32, kFewDeflectedPairs = 256;

// The largest deflection of each body, to updates.deflections. Returns their indices by body.
std::span<const uint32_t> MergeDeflections(const CollideStores& stores, PairUpdates& updates,
                                           const StepWorkers& workers) {
    updates.deflections.clear();
    std::span<uint32_t> deflectionOf;
    size_t count = 0;
    for (const WorkerFindings& findings : workers.findings) count += findings.deflections.size();
    if (count == 0) return deflectionOf;
    // Any worker may find all of as many in a later step.
    updates.deflections.reserve(std::max(count, kFewDeflections));
    for (WorkerFindings& findings : workers.findings) findings.deflections.reserve(std::max(count, kFewDeflections));
    for (WorkerFindings& findings : workers.findings) {
        for (const Deflection& found : findings.deflections) {
            if (deflectionOf.empty()) {
                deflectionOf = workers.scratch.Allocate<uint32_t>(stores.bodies.Size());
                std::ranges::fill(deflectionOf, PairStore::kNone);
            }
            uint32_t& index = deflectionOf[found.body];
            if (index == PairStore::kNone) {
                index = static_cast<uint32_t>(updates.deflections.size());
                updates.deflections.push_back(found);
            } else if (IsLarger(found, updates.deflections[index])) {
                updates.deflections[index] = found;
            }
        }
        findings.deflections.clear();
    }
    return deflectionOf;
}

// Whether the contacts of a pair are to be found again: not where the listener ignores them, nor of the one that
// deflects its bodies. A pair may have ended because bounds extend along the velocity of the start of the step.
bool MayCollideAgain(const CollideStores& stores, std::span<const PairChange> changes, uint32_t index) {
    const PairStore& pairs = stores.pairs;
    const auto isByOther = [&](uint32_t body, uint32_t otherBody) {
        const Deflection* deflection = stores.DeflectionOf(body);
        return deflection && deflection->otherBody != otherBody;
    };
    const Pair& pair = pairs.pairs[index];
    if (!isByOther(pair.bodyA, pair.bodyB) && !isByOther(pair.bodyB, pair.bodyA)) return false;
    if (!pairs.active.Contains(index) || pairs.pairs[index].isMore) return false;
    if (changes[index] == PairChange::WakesOther) return false;
    if (changes[index] == PairChange::Dead && pair.surface) return false;
    for (; index != PairStore::kNone; index = pairs.MoreOf(index))
        if (pairs.pairs[index].pointCount > 0 && !pairs.pairs[index].touching) return false;
    return true;
}

// The change in this step of a pair that was collided twice.
PairChange Combine(PairChange first, PairChange second, Pair& pair) {
    if (first == PairChange::Dead) {
        if (pair.pointCount > 0) return second;
        pair.touching |= second == PairChange::Ended;  // it is removed as it was
        return PairChange::Dead;
    }
    const bool isBackAsBefore = (first == PairChange::Ended && second == PairChange::Began) ||
                                (first == PairChange::Began && second == PairChange::Ended);
    if (isBackAsBefore) return PairChange::None;
    return second == PairChange::None ? first : second;
}

// Collides the pairs of deflected bodies again, for the motion that they will have.
void CollideDeflected(CollideStores stores, PairUpdates& updates, const StepWorkers& workers) {
    stores.deflectionOf = MergeDeflections(stores, updates, workers);
    stores.deflections = updates.deflections;
    if (!stores.IsSecondPass()) return;
    PairStore& pairs = stores.pairs;
    Array<uint32_t>& list = updates.deflectedPairs;
    list.clear();
    list.reserve(kFewDeflectedPairs);
    for (const Deflection& deflection : updates.deflections)
        VisitColliders(stores.bodies, stores.colliders, deflection.body, [&](uint32_t collider) {
            pairs.VisitOf(collider, [&](uint32_t index) {
                if (MayCollideAgain(stores, updates.changes, index)) list.push_back(index);
            });
        });
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    Array<PairChange>& before = updates.changesBefore;
    before.clear();
    before.reserve(kFewDeflectedPairs);
    const auto visitManifolds = [&](auto&& visit) {
        for (const uint32_t first : list)
            for (uint32_t index = first; index != PairStore::kNone; index = pairs.MoreOf(index)) visit(index);
    };
    WorkerFindings& counts = workers.findings.front();
    visitManifolds([&](uint32_t index) {
        const Pair& pair = pairs.pairs[index];
        before.push_back(updates.changes[index]);
        if (updates.changes[index] == PairChange::Dead) return;
        updates.changes[index] = PairChange::None;
        counts.contacts -= pair.touching;  // counted again
        counts.points -= pair.touching ? pair.pointCount : 0;
    });
    CollideListed(stores, list, updates.changes, workers);
    AddNewContacts(stores, updates, workers);
    size_t next = 0;
    visitManifolds([&](uint32_t index) {
        updates.changes[index] = Combine(before[next++], updates.changes[index], pairs.pairs[index]);
    });
    AddMoreManifolds(stores, updates, workers.findings);
}

void CountContacts(std::span<WorkerFindings> workers, StepReport& report) {
    for (WorkerFindings& f : workers) {
        report.contacts += std::exchange(f.contacts, 0);
        report.contactPoints += std::exchange(f.points, 0);
        report.keptManifolds += std::exchange(f.kept, 0);
    }
}

}  // namespace

void Collide(const StepContext& step, const BodyStore& bodies, const ColliderStore& colliders, const JointStore& joints,
             const ConstraintColoring& coloring, PairStore& pairs, PairUpdates& updates, const StepWorkers& workers,
             StepReport& report) {
    const CollideStores stores{step, bodies, colliders, joints, coloring, pairs};
    CollideAllActive(stores, updates.changes, workers);
    AddNewContacts(stores, updates, workers);
    AddMoreManifolds(stores, updates, workers.findings);
    CollideDeflected(stores, updates, workers);
    ForgetOpposed(stores, workers.findings);
    CountContacts(workers.findings, report);
}

void CollideActivated(const StepContext& step, const BodyStore& bodies, const ColliderStore& colliders,
                      const JointStore& joints, const ConstraintColoring& coloring, PairStore& pairs,
                      PairUpdates& updates, const StepWorkers& workers, StepReport& report) {
    const CollideStores stores{step, bodies, colliders, joints, coloring, pairs};
    CollideListed(stores, updates.activated, updates.changes, workers);
    AddNewContacts(stores, updates, workers);
    AddMoreManifolds(stores, updates, workers.findings);
    CollideDeflected(stores, updates, workers);
    ForgetOpposed(stores, workers.findings);
    CountContacts(workers.findings, report);
}

bool WakeHit(const PairStore& pairs, std::span<PairChange> changes, const SleepStores& stores) {
    bool woke = false;
    VisitChanges(changes, [&](uint32_t index) {
        if (changes[index] != PairChange::WakesOther) return;
        const Pair& pair = pairs.pairs[index];
        WakeBody(stores, pair.bodyA);
        if (!pair.fixedB) WakeBody(stores, pair.bodyB);
        // Of several manifolds of a surface, it is another one that touches the sleeping body.
        changes[index] = pair.touching ? PairChange::Began : PairChange::Ended;
        woke = true;
    });
    return woke;
}

}  // namespace fulcrum
