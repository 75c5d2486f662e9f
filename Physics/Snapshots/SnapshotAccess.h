// The sections of a snapshot: the state of each store. They are written, and read into a world whose arrays already
// have their sizes. Derived state is not written: indices in lists, shapes and bodies of pairs, lists of colors, trees
// and the hash table of pairs. Called by the functions of Snapshots.h; one thread.
#pragma once

#include <Fulcrum/Math/ForceInline.h>
#include <Fulcrum/Physics/Snapshots/SnapshotElements.h>
#include <Fulcrum/Physics/Snapshots/Snapshots.h>

#include <bit>
#include <utility>

namespace fulcrum {

// Scalars and sizes of arrays.
struct SnapshotHead {
    SystemSettings settings;
    uint64_t step = 0;
    float lastSubstepDt = 0, stiffnessDt = 0;
    uint32_t bodies = 0, colliders = 0, pairs = 0, joints = 0;
    bool keepsListenersData = false;
};

// Instead of the hash of a body's shape: the body has no shape, or a mutable compound of its own.
inline constexpr uint64_t kNoShape = 0, kOwnCompound = 2;

// A class, since it is a friend of the stores.
struct SnapshotAccess {
    // Whether a pair is in the hash table, and its colliders.
    struct PairPlace {
        bool isInTable = false;
        uint32_t colliderA = 0, colliderB = 0;
        uint64_t Key() const { return PairStore::Key(colliderA, colliderB); }
        bool operator==(const PairPlace&) const = default;
    };

    static SnapshotHead HeadOf(const WorldState& world, const StepState& step);
    template <class Stream>
    static void VisitHead(Stream& s, SnapshotHead& head);

    template <class Stream, class Bodies>
    static void VisitBodies(Stream& s, Bodies& bodies);
    template <class Stream, class Colliders>
    static void VisitColliders(Stream& s, Colliders& colliders);
    // attach.OfPair(i, before) is called for each index when its pair has been visited; before: PlaceOf the previous
    // one. attach.OfContact(pair, color): then for its contact, if there is one.
    template <class Stream, class Pairs, class Attach>
    static void VisitPairs(Stream& s, Pairs& pairs, const Attach& attach);
    // Indices of removed pairs.
    template <class Stream, class Pairs>
    static void VisitFree(Stream& s, Pairs& pairs);
    template <class Stream, class Joints>
    static bool VisitJoints(Stream& s, Joints& joints);
    template <class Stream, class Sleeping>
    static void VisitSleeping(Stream& s, Sleeping& sleeping);
    // changed: SensorStore::changed, or a copy without repetitions.
    template <class Stream, class Sensors, class Changed>
    static void VisitSensors(Stream& s, Sensors& sensors, Changed& changed);
    template <class Stream, class World, class Step>
    static void VisitStep(Stream& s, World& world, Step& step, SavedEfforts& efforts);
    template <class Stream, class World>
    static void VisitUserData(Stream& s, World& world);

    // Used by the reader.
    static void Resize(BodyStore& bodies, uint32_t count);
    static void Resize(ColliderStore& colliders, uint32_t count);
    static void Resize(PairStore& pairs, uint32_t count);  // the arrays; also reserves the table of pairs
    static void Resize(JointStore& joints, uint32_t count);
    // Derived state. Indices of bodies in the list of awake ones;
    static void FindAwakePlaces(BodyStore& bodies);
    // which of them were pushed, are to stop, have a shape that may be edited in place, or stand for the world;
    static void ListSpecial(BodyStore& bodies);
    // the body and the piece of each collider; returns whether all bodies are those that they were; which of them
    // moved; the trees;
    static bool AttachPieces(const BodyStore& bodies, ColliderStore& colliders);
    static void ListMoved(ColliderStore& colliders);
    static void UpdateTrees(const BodyStore& bodies, ColliderStore& colliders);
    // a pair's bodies and shapes, its entry in the hash table; entries in the lists of colors.
    static void ClearColors(uint32_t bodies, ConstraintColoring& coloring);
    // areBodiesSame: result of AttachPieces; before: the previous PlaceOf the pair at this index.
    static void AttachPair(const ColliderStore& colliders, bool areBodiesSame, PairStore& pairs, uint32_t index,
                           const PairPlace& before);
    static void ListColor(ConstraintColoring& coloring, ConstraintColoring::Kind kind,
                          const ConstraintColoring::Entry& entry, const ColorSlot& place);

private:
    static PairPlace PlaceOf(const Pair& pair) {
        if (!pair.exists || pair.isMore) return {};
        return {true, pair.colliderA, pair.colliderB};
    }
    static void SetWord(IndexSet& set, uint32_t word, uint64_t bits) {
        set.size_ += static_cast<uint32_t>(std::popcount(bits) - std::popcount(set.words_[word]));
        set.words_[word] = bits;
    }
};

template <class Stream>
void SnapshotAccess::VisitHead(Stream& s, SnapshotHead& head) {
    auto& [settings, step, lastSubstepDt, stiffnessDt, bodies, colliders, pairs, joints, keepsListenersData] = head;
    s.Begin(SnapshotSection::Head);
    s.Reserve(2048);
    VisitSystemSettings(s, settings);
    s(step, lastSubstepDt, stiffnessDt, bodies, colliders, pairs, joints, keepsListenersData);
    s.EndBlock();
}

template <class Stream, class Bodies>
void SnapshotAccess::VisitBodies(Stream& s, Bodies& bodies) {
    auto& [states, masses, poses, unconstrained, dynamics, cold, remainders, slowMotions, placed, awake, worldBody,
           continuousCount, targetCount, reportsContacts, pushed, singleMoves, editable, sleepChanges,
           notesSleepChanges, free, count, placedAsleep] = bodies;
    s.Begin(SnapshotSection::Bodies);
    VisitElements(s, bodies.Size(), kMostOfBody,
                  [&](auto& stream, uint32_t i) FULCRUM_FORCE_INLINE_LAMBDA { VisitBody(stream, bodies, i); });
    s.Begin(SnapshotSection::BodyLists);
    s.Reserve(64);
    s(continuousCount, targetCount, count, reportsContacts.size_);
    s.List(placed);
    s.List(awake);
    s.List(free);
    s.List(reportsContacts.words_);
    s.List(sleepChanges);
    s.EndBlock();
}

template <class Stream, class Colliders>
void SnapshotAccess::VisitColliders(Stream& s, Colliders& store) {
    auto& [colliders, shapes, boundsOrigin, staticTree, movingTree, sensorTree, movingLayers, staticLayers, moved,
           movedHasEmpty, runs, free, freeRuns] = store;
    s.Begin(SnapshotSection::Colliders);
    VisitElements(s, static_cast<uint32_t>(colliders.size()), kMostOfCollider,
                  [&](auto& stream, uint32_t i) FULCRUM_FORCE_INLINE_LAMBDA {
                      VisitCollider(stream, store.colliders[i], !store.shapes[i].shape);
                  });
    s.Begin(SnapshotSection::ColliderLists);
    s.Reserve(64);
    s(boundsOrigin, movingLayers, staticLayers, movedHasEmpty);
    s.List(runs);
    VisitList(s, free, 0, [&](auto& firsts) { s.List(firsts); });
    s.List(freeRuns);
    s.EndBlock();
}

template <class Stream, class Pairs, class Attach>
void SnapshotAccess::VisitPairs(Stream& s, Pairs& store, const Attach& attach) {
    auto& [pairs, contacts, records, massOverrides, surfaceVelocities, reported, ended, loads, loadVersion, active,
           table, firstFree, lastFree, freeCount, freeContact, freeContacts, links, heads, size, keepsListenersData,
           keepsReported] = store;
    s.Begin(SnapshotSection::Pairs);
    const auto count = static_cast<uint32_t>(pairs.size());
    uint64_t activeOfWord = 0;
    VisitElements(s, count, kMostOfPair, [&](auto& stream, uint32_t i) FULCRUM_FORCE_INLINE_LAMBDA {
        // References once: bytes that are read may alias the arrays' own members.
        auto& pair = store.pairs[i];
        auto& link = store.links_[i];
        auto& load = store.loads[i];
        constexpr uint32_t kAhead = 12;  // prefetch distance
        if (i + kAhead < count) __builtin_prefetch(&pair + kAhead);
        const PairPlace before = Stream::kWrites ? PairPlace{} : PlaceOf(pair);
        bool isActive = Stream::kWrites && store.active.Contains(i), hasContact = pair.contact != PairStore::kNone;
        uint32_t more = Stream::kWrites ? store.MoreOf(i) : PairStore::kNone;
        if (VisitPair(stream, pair, isActive, hasContact, more)) {
            auto& [next, previous] = link;
            if (!pair.isMore) stream(next, previous);
            stream(load);
            attach.OfPair(i, before);
            if (hasContact) {
                if constexpr (!Stream::kWrites) {
                    store.AddContact(i);
                    store.contacts[pair.contact].more = more;
                }
                auto& contact = store.contacts[pair.contact];
                auto& record = store.records[pair.contact];
                __builtin_prefetch(&contact + kAhead);
                __builtin_prefetch(&record + kAhead);
                VisitContact(stream, contact, pair.pointCount);
                VisitRecord(stream, record, pair.pointCount);
                if (store.keepsListenersData_ && record.Has(ContactRecord::kSurfaceVelocity))
                    VisitSurfaceVelocity(stream, store.surfaceVelocities[pair.contact]);
                if (store.keepsListenersData_ && record.Has(ContactRecord::kMassOverride))
                    VisitMassOverride(stream, store.massOverrides[pair.contact]);
                attach.OfContact(pair, contact.color);
            }
            if (store.keepsReported_) VisitReported(stream, store.reported[i]);
            activeOfWord |= uint64_t{isActive} << i % 64;
        } else {
            attach.OfPair(i, before);
        }
        if constexpr (!Stream::kWrites) {
            if (i % 64 == 63 || i + 1 == count) SetWord(store.active, i / 64, std::exchange(activeOfWord, 0));
        }
    });
    s.Begin(SnapshotSection::PairLists);
    s.Reserve(64);
    s(size);
    VisitFree(s, store);
    s.List(heads);
    VisitList(s, ended, 32, [&](auto& contact) { VisitReported(s, contact); });
    s.EndBlock();
}

template <class Stream, class Pairs>
void SnapshotAccess::VisitFree(Stream& s, Pairs& store) {
    uint32_t count = store.freeCount_;
    s.Reserve(sizeof count * (size_t{count} + 1));
    s(count);
    if constexpr (Stream::kWrites) {
        for (uint32_t i = store.firstFree_; i != PairStore::kNone; i = store.pairs[i].colliderB) s(i);
    } else {
        store.firstFree_ = store.lastFree_ = PairStore::kNone;
        store.freeCount_ = 0;
        for (uint32_t left = count; left > 0 && !s.HasFailed(); --left) {
            const uint32_t i = s.template Get<uint32_t>();
            if (i < store.pairs.size() && !store.pairs[i].exists) store.Free(i);
        }
    }
}

template <class Stream, class Joints>
bool SnapshotAccess::VisitJoints(Stream& s, Joints& store) {
    auto& [records, types, joints, breakable, targetCount, strainVersion, moved, first, free, count] = store;
    s.Begin(SnapshotSection::Joints);
    for (uint32_t i = 0; i < joints.size(); ++i) {
        s.Reserve(kMostOfJoint);
        bool isBreakable = breakable.Contains(i);
        if (VisitJoint(s, joints[i], isBreakable)) {
            VisitJointRecord(s, records[i]);
            if (!VisitType(s, *types[i])) return false;
            if constexpr (!Stream::kWrites)
                if (isBreakable) breakable.Insert(i);
        }
        EndElement(s, i);
    }
    s.EndBlock();
    s.Begin(SnapshotSection::JointLists);
    s.Reserve(64);
    s(targetCount, count);
    VisitList(s, moved, sizeof(MovedBody), [&](auto& of) { s(of.body, of.before.position, of.before.rotation); });
    s.List(first);
    s.List(free);
    s.EndBlock();
    return true;
}

template <class Stream, class Sleeping>
void SnapshotAccess::VisitSleeping(Stream& s, Sleeping& sleeping) {
    auto& [pending, inside, islands, free] = sleeping;
    s.Begin(SnapshotSection::Sleeping);
    VisitList(s, islands, 0, [&](auto& bodies) { s.List(bodies); });
    s.List(free);
    s.EndBlock();
}

template <class Stream, class Sensors, class Changed>
void SnapshotAccess::VisitSensors(Stream& s, Sensors& store, Changed& itsChanged) {
    auto& [sensors, changed, events] = store;
    s.Begin(SnapshotSection::Sensors);
    VisitList(s, sensors, 0, [&](auto& sensor) {
        auto& [id, sees, reportsStay, removed, inside, insideNext, ownEvents] = sensor;
        s.Reserve(64);
        s(id, sees, reportsStay, removed);
        s.List(inside);
    });
    s.List(itsChanged);
    VisitList(s, events, sizeof(SensorEvent), [&](auto& event) { VisitEvent(s, event); });
    s.EndBlock();
}

// Names all members: those not used here are written elsewhere, are temporary, or are derived.
template <class Stream, class World, class Step>
void SnapshotAccess::VisitStep(Stream& s, World& world, Step& step, SavedEfforts& efforts) {
    auto& [settings, jobs, listener, observer, callObserver, bodies, colliders, itsPairs, joints, coloring, sleeping,
           sensors, removed, number, lock, outsideFatBounds, pendingTrees, seenPoses, heededShapeVersion, lifts] =
        world;
    auto& [lastSubstepDt, stiffnessDt, report, findings, scratch, ofWorkers, pairs, crowd, began, seams, solver, saved,
           sleepCandidates, sweeps, sensing, events, errors] = step;
    auto& [deepOverlaps, dispersing, crowded, settling, settled] = crowd;
    s.Begin(SnapshotSection::Step);
    s.List(removed);
    s.List(deepOverlaps);
    VisitList(s, dispersing, 128, [&](auto& body) { VisitDispersing(s, body); });
    s.List(crowded);
    VisitList(s, settling, 8, [&](auto& body) { s(body.body, body.seconds); });
    s.List(seams);
    VisitList(s, events.broken, 32, [&](auto& joint) { VisitBroken(s, joint); });
    VisitList(s, events.bodies, 64, [&](auto& body) { VisitReportedBody(s, body); });
    s.Reserve(64);
    s(efforts.areCurrent);
    VisitList(s, efforts.groups, 32, [&](auto& group) { VisitSavedEffort(s, group); });
    s.EndBlock();
}

template <class Stream, class World>
void SnapshotAccess::VisitUserData(Stream& s, World& world) {
    s.Begin(SnapshotSection::UserData);
    for (uint32_t i = 0; i < world.bodies.cold.size(); ++i) {
        s.Reserve(sizeof(uint64_t));
        if (world.bodies.cold[i].exists) s(world.bodies.cold[i].userData);
        EndElement(s, i);
    }
    for (uint32_t i = 0; i < world.joints.joints.size(); ++i) {
        s.Reserve(sizeof(uint64_t));
        if (world.joints.joints[i].exists) s(world.joints.joints[i].userData);
        EndElement(s, i);
    }
    s.EndBlock();
}

}  // namespace fulcrum
