#include <Fulcrum/Physics/World/PairStore.h>

#include <Fulcrum/Math/Assert.h>
#include <Fulcrum/Physics/World/HeapBytes.h>
#include <Fulcrum/Physics/World/ReserveMore.h>

#include <algorithm>
#include <utility>

namespace fulcrum {

uint32_t PairStore::HashOf(uint64_t key) {
    key ^= key >> 32;
    key *= 0x9E3779B97F4A7C15ull;  // Fibonacci hashing
    return static_cast<uint32_t>(key >> 32);
}

uint32_t PairStore::Find(uint32_t colliderA, uint32_t colliderB) const {
    if (!HasAny(colliderA) || !HasAny(colliderB)) return kNone;
    const uint64_t key = Key(colliderA, colliderB);
    const uint32_t mask = static_cast<uint32_t>(table_.size() - 1);
    for (uint32_t i = HashOf(key) & mask;; i = (i + 1) & mask)
        if (table_[i] == kNone || KeyOf(table_[i]) == key) return table_[i];
}

void PairStore::Grow() {
    Array<uint32_t> old(table_.empty() ? 1024 : 2 * table_.size(), kNone);
    old.swap(table_);
    for (const uint32_t index : old)
        if (index != kNone) AddKey(KeyOf(index), index);
}

void PairStore::Reserve(size_t more) {
    const size_t count = pairs.size() + more - std::min(more, size_t{freeCount_});
    ReserveAtLeast(pairs, count);
    ReserveAtLeast(links_, count);
    ReserveAtLeast(loads, count);
}

uint32_t PairStore::Allocate() {
    uint32_t index;
    if (lastFree_ != kNone) {
        index = std::exchange(lastFree_, pairs[lastFree_].colliderA);
        (lastFree_ == kNone ? firstFree_ : pairs[lastFree_].colliderB) = kNone;
        --freeCount_;
    } else {
        index = static_cast<uint32_t>(pairs.size());
        ReserveAtLeast(pairs, pairs.size() + 1);
        ReserveAtLeast(links_, links_.size() + 1);
        ReserveAtLeast(loads, loads.size() + 1);
        pairs.emplace_back();
        links_.emplace_back();
        loads.emplace_back();
        if (keepsReported_) reported.emplace_back();
        active.Reserve(index + 1);
    }
    pairs[index] = {};
    loads[index] = {};
    if (keepsReported_) reported[index] = {};
    pairs[index].exists = true;
    return index;
}

void PairStore::Free(uint32_t index) {
    pairs[index].exists = false;
    pairs[index].colliderA = lastFree_;
    pairs[index].colliderB = kNone;
    (lastFree_ == kNone ? firstFree_ : pairs[lastFree_].colliderB) = index;
    lastFree_ = index;
    ++freeCount_;
}

void PairStore::ReserveContacts(size_t more) {
    const size_t count = contacts.size() + more - std::min(more, size_t{freeContacts_});
    ReserveAtLeast(contacts, count);
    ReserveAtLeast(records, count);
}

uint32_t PairStore::AddContact(uint32_t pair) {
    uint32_t index;
    if (freeContact_ != kNone) {
        index = std::exchange(freeContact_, contacts[freeContact_].triangle);
        --freeContacts_;
        contacts[index] = {};
        records[index] = {};
        if (keepsListenersData_) surfaceVelocities[index] = {};
    } else {
        index = static_cast<uint32_t>(contacts.size());
        if (index == std::min(contacts.capacity(), records.capacity())) ReserveContacts(1);
        contacts.emplace_back();
        records.emplace_back();
        if (keepsListenersData_) {
            massOverrides.emplace_back();
            surfaceVelocities.emplace_back();
        }
    }
    contacts[index].pair = pair;
    pairs[pair].contact = index;
    return index;
}

void PairStore::RemoveContact(uint32_t pair) {
    const uint32_t index = std::exchange(pairs[pair].contact, kNone);
    if (index == kNone) return;
    FULCRUM_ASSERT(contacts[index].color.color == ColorSlot{}.color);
    contacts[index].pair = kNone;
    contacts[index].triangle = std::exchange(freeContact_, index);
    ++freeContacts_;
}

void PairStore::KeepListenersData(bool keep) {
    keepsListenersData_ = keep;
    massOverrides.resize(keep ? contacts.size() : 0);
    surfaceVelocities.assign(keep ? contacts.size() : 0, {});
}

void PairStore::KeepReported(bool keep) {
    if (keep == keepsReported_) return;
    keepsReported_ = keep;
    if (keep) reported.assign(pairs.size(), {});
    else reported = {};
    ended = {};
}

void PairStore::ReserveListenersData() {
    ReserveRoom(massOverrides, contacts.size());
    ReserveRoom(surfaceVelocities, contacts.size());
}

void PairStore::ReserveReported() { ReserveRoom(reported, pairs.size()); }

void PairStore::ReserveRemovals(size_t count) {
    if (keepsReported_) ReserveMore(ended, count);
}

size_t PairStore::CountOf(uint32_t collider) const {
    size_t count = 0;
    VisitOf(collider, [&](uint32_t index) {
        for (; index != kNone; index = MoreOf(index)) ++count;
    });
    return count;
}

uint32_t PairStore::AddMore(uint32_t of) {
    const uint32_t index = Allocate();
    AddContact(index);
    Pair& pair = pairs[index];
    const Pair& first = pairs[of];
    pair.bodyA = first.bodyA;
    pair.bodyB = first.bodyB;
    pair.colliderA = first.colliderA;
    pair.colliderB = first.colliderB;
    pair.fixedB = first.fixedB;
    pair.offset = first.offset;
    pair.surface = first.surface;
    contacts[pair.contact].reference = contacts[first.contact].reference;
    pair.isMore = true;
    contacts[pair.contact].more = contacts[first.contact].more;
    contacts[first.contact].more = index;
    return index;
}

uint32_t PairStore::Add(uint32_t colliderA, uint32_t colliderB) {
    if (2 * (size_ + 1) > table_.size()) Grow();
    const uint32_t index = Allocate();
    pairs[index].colliderA = colliderA;
    pairs[index].colliderB = colliderB;

    AddKey(Key(colliderA, colliderB), index);
    ++size_;
    Link(index);
    return index;
}

void PairStore::AddKey(uint64_t key, uint32_t index) {
    const uint32_t mask = static_cast<uint32_t>(table_.size() - 1);
    uint32_t i = HashOf(key) & mask;
    while (table_[i] != kNone) i = (i + 1) & mask;
    table_[i] = index;
}

void PairStore::RemoveKey(uint64_t key, uint32_t index) {
    const uint32_t mask = static_cast<uint32_t>(table_.size() - 1);
    uint32_t hole = HashOf(key) & mask;
    while (table_[hole] != index) hole = (hole + 1) & mask;
    // Backward-shift deletion: entries after the hole move up unless that would put them before their home slot.
    for (uint32_t i = (hole + 1) & mask; table_[i] != kNone; i = (i + 1) & mask) {
        if (((i - HashOf(KeyOf(table_[i]))) & mask) >= ((i - hole) & mask)) {
            table_[hole] = table_[i];
            hole = i;
        }
    }
    table_[hole] = kNone;
}

void PairStore::Link(uint32_t index) {
    for (int side = 0; side < 2; ++side) {
        const uint32_t collider = ColliderOf(index, side);
        if (collider >= heads_.size()) heads_.resize(collider + 1, kNone);
        const uint32_t head = heads_[collider];
        links_[index].next[side] = head;
        links_[index].previous[side] = kNone;
        if (head != kNone) links_[head].previous[SideOf(head, collider)] = index;
        heads_[collider] = index;
    }
}

void PairStore::Unlink(uint32_t index) {
    for (int side = 0; side < 2; ++side) {
        const uint32_t collider = ColliderOf(index, side);
        const uint32_t next = links_[index].next[side], previous = links_[index].previous[side];
        if (next != kNone) links_[next].previous[SideOf(next, collider)] = previous;
        if (previous != kNone) links_[previous].next[SideOf(previous, collider)] = next;
        else heads_[collider] = next;
    }
}

void PairStore::Remove(uint32_t index) {
    active.Erase(index);
    RemoveContact(index);
    if (keepsReported_ && reported[index].isOn) ended.push_back(reported[index]);
    if (pairs[index].isMore) return Free(index);
    Unlink(index);
    RemoveKey(KeyOf(index), index);
    Free(index);
    --size_;
}

size_t HeapBytes(const PairStore& store) {
    const auto& [pairs, contacts, records, massOverrides, surfaceVelocities, reported, ended, loads, loadVersion,
                 active, table, firstFree, lastFree, freeCount, freeContact, freeContacts, links, heads, size,
                 keepsListenersData, keepsReported] = store;
    return HeapBytes(pairs, contacts, records, massOverrides, surfaceVelocities, reported, ended, loads, loadVersion,
                     active, table, firstFree, lastFree, freeCount, freeContact, freeContacts, links, heads, size,
                     keepsListenersData, keepsReported);
}

}  // namespace fulcrum
