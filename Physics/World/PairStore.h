// Pairs of colliders with overlapping fat bounds, and their contacts. A pair exists as long as the bounds overlap, its
// contact as long as its shapes are so near that it has points: most pairs of a scene in motion have none. Both have
// stable indices; records and colors refer to contacts. The index of a contact depends on the threads, so no result may
// depend on it. A pair is active while one of its bodies is awake.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/Manifold.h>
#include <Fulcrum/Constraints/Coloring.h>
#include <Fulcrum/Constraints/Contacts/ContactRecord.h>
#include <Fulcrum/Constraints/MassOverride.h>
#include <Fulcrum/Math/Memory.h>

#include <Fulcrum/Physics/StepEvents.h>
#include <Fulcrum/Physics/World/IndexSet.h>
#include <Fulcrum/Physics/World/LoadLevel.h>

namespace fulcrum {

struct Pair {
    uint32_t bodyA = 0, bodyB = 0;          // A is dynamic, B any
    uint32_t colliderA = 0, colliderB = 0;  // their shapes: see PairShapes.h
    PairCache cache;
    uint32_t contact = ~0u;  // index of its contact; kNone if it has none: no points, and B is no surface
    uint8_t pointCount = 0;  // of the manifold; also of the record, unless onSeam
    bool exists : 1 = false;
    bool fixedB : 1 = false;    // B's body is immovable: static or kinematic
    bool offset : 1 = false;    // a shape is not at its body's center frame (child of a compound)
    bool surface : 1 = false;   // B is a surface
    bool touching : 1 = false;  // was active and had points in the last step
    bool onSeam : 1 = false;    // its record has no points, since the contact is a ghost collision at a seam
    bool kept : 1 = false;      // within a step: its manifold is that of the last one, and was counted as such
    bool isMore = false;        // for surfaces: an additional manifold of another pair
    uint8_t material = 0;       // for surfaces: index into the palette
};
static_assert(sizeof(Pair) == 44);

// What a pair has besides its record while it has points; always if B is a surface.
struct alignas(64) PairContact {
    RelativePose reference;  // pose of shape B in shape A when the manifold was found
    uint32_t features[Manifold::kMaxPoints] = {0, 0, 0, 0};
    ColorSlot color;
    uint32_t triangle = 0;  // for surfaces: the triangle of the deepest point; if unused, the next unused contact
    uint32_t pair = ~0u;    // its index; kNone if unused
    uint32_t more = ~0u;    // for surfaces: index of the next manifold of these two colliders, a pair
};
static_assert(sizeof(PairContact) == 64);

// The reported state of a pair for contact events.
struct ReportedContact {
    BodyId bodyA, bodyB;
    uint32_t childA = 0, childB = 0;
    bool isOn = false;  // it began, and has not ended
    // Kind of its event in this step, if any.
    ContactEvent::Kind kind = ContactEvent::Kind::Stay;
    uint32_t manifoldCount = 0;
};

class PairStore {
public:
    Array<Pair> pairs;
    Array<PairContact> contacts;
    Array<ContactRecord> records;  // by contact
    // By contact: mass overrides of records with kMassOverride, and surface velocities. Empty without a contact
    // listener, which sets them.
    Array<MassOverride> massOverrides;
    Array<SurfaceVelocity> surfaceVelocities;
    void KeepListenersData(bool keep);
    // By pair, for its first manifold; empty without contact events. Kept while bodies sleep.
    Array<ReportedContact> reported;
    Array<ReportedContact> ended;  // for pairs removed since the last events
    void KeepReported(bool keep);
    // So that the next of these ask for no memory: KeepListenersData(true), KeepReported(true), Remove of `count`
    // pairs.
    void ReserveListenersData();
    void ReserveReported();
    void ReserveRemovals(size_t count);
    size_t CountOf(uint32_t collider) const;  // pairs, with all their manifolds
    Array<LoadLevel> loads;                   // by pair: kept while it has no contact
    uint64_t loadVersion = 1;                 // incremented when a load level changes, also of joints
    IndexSet active;

    // Index of the pair of two colliders, or kNone.
    static constexpr uint32_t kNone = ~0u;
    uint32_t Find(uint32_t colliderA, uint32_t colliderB) const;
    bool HasAny(uint32_t collider) const { return collider < heads_.size() && heads_[collider] != kNone; }
    uint32_t Add(uint32_t colliderA, uint32_t colliderB);  // must not exist yet
    // So many pairs can be added without moving the others.
    bool HasRoomFor(size_t more) const { return more <= freeCount_ + (pairs.capacity() - pairs.size()); }
    void Reserve(size_t more);
    // Adds a manifold to the pair `of`, between the same shapes and bodies, with a contact. Not found by Find, and not
    // active.
    uint32_t AddMore(uint32_t of);
    // For surfaces: the next manifold of the same two colliders, or kNone.
    uint32_t MoreOf(uint32_t pair) const {
        const Pair& p = pairs[pair];
        return p.surface && p.contact != kNone ? contacts[p.contact].more : kNone;
    }
    // Gives a pair without a contact one, and a record, without material; returns its index.
    uint32_t AddContact(uint32_t pair);
    // So many can be added without moving the others.
    void ReserveContacts(size_t more);
    void RemoveContact(uint32_t pair);  // must not be colored; nothing if it has none
    const ContactRecord& RecordOf(const Pair& pair) const { return records[pair.contact]; }
    ContactRecord& RecordOf(const Pair& pair) { return records[pair.contact]; }
    const Pair& PairOf(uint32_t contact) const { return pairs[contacts[contact].pair]; }
    // Calls visit(pair) for all pairs of a collider, active or not, except additional manifolds; the visitor may remove
    // it.
    template <class Visitor>
    void VisitOf(uint32_t collider, Visitor&& visit) const {
        if (collider >= heads_.size()) return;
        for (uint32_t index = heads_[collider]; index != kNone;) {
            const uint32_t next = links_[index].next[SideOf(index, collider)];
            visit(index);
            index = next;
        }
    }
    // With its contact. Must not be colored; its additional manifolds must be removed separately.
    void Remove(uint32_t index);
    friend size_t HeapBytes(const PairStore& store);

private:
    friend struct SnapshotAccess;
    static uint64_t Key(uint32_t a, uint32_t b) { return a < b ? (uint64_t(a) << 32 | b) : (uint64_t(b) << 32 | a); }
    uint64_t KeyOf(uint32_t index) const { return Key(pairs[index].colliderA, pairs[index].colliderB); }
    // Linked lists of the pairs of each collider, so that removing a collider need not scan all pairs.
    struct Links {
        uint32_t next[2] = {kNone, kNone}, previous[2] = {kNone, kNone};  // in the lists of colliders A and B
    };
    int SideOf(uint32_t index, uint32_t collider) const { return pairs[index].colliderB == collider; }
    uint32_t ColliderOf(uint32_t index, int side) const {
        return side ? pairs[index].colliderB : pairs[index].colliderA;
    }
    void Link(uint32_t index);
    void Unlink(uint32_t index);

    uint32_t Allocate();
    void Free(uint32_t index);
    static uint32_t HashOf(uint64_t key);
    void Grow();
    void AddKey(uint64_t key, uint32_t index);     // inserts into the table, which must have space
    void RemoveKey(uint64_t key, uint32_t index);  // removes from the table, which must contain it

    // Open addressing with linear probing, at most half full: indices of pairs, or kNone. Its order does not influence
    // results. Keys are those of the pairs.
    Array<uint32_t> table_;
    // Indices of removed pairs, of which the last is used first: colliderA of each is the one before it, colliderB the
    // one after it.
    uint32_t firstFree_ = kNone, lastFree_ = kNone, freeCount_ = 0;
    uint32_t freeContact_ = kNone, freeContacts_ = 0;  // the first unused contact, and their number
    Array<Links> links_;                               // by pair
    Array<uint32_t> heads_;                            // by collider
    uint32_t size_ = 0;
    bool keepsListenersData_ = false, keepsReported_ = false;
};

}  // namespace fulcrum
