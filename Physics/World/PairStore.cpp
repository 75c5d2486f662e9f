#include <Fulcrum/Physics/World/PairStore.h>

#include <Fulcrum/Math/Assert.h>
#include <Fulcrum/Physics/World/HeapBytes.h>

#include <algorithm>
#include <utility>

namespace fulcrum {

namespace {

// Grows by an eighth: doubling the largest arrays of a world would leave up to half unused.
template <class T>
void ReserveAtLeast(Array<T>& elements, size_t count) {
    const size_t size = elements.size();
    if (count > elements.capacity()) elements.reserve(std::max(count, size + size / 8 + 64));
}

}  // namespace

uint32_t PairStore::HashOf(uint64_t key) {
    key ^= key >> 32;
    key *= 0x9E3779B97F4A7C15ull;  // Fibonacci hashing
    return static_cast<uint32_t>(key >> 32);
}

uint32_t PairStore::Find(uint32_t colliderA, uint32_t colliderB) const {
    if (table_.empty()) return kNone;
    const uint64_t key = Key(colliderA, colliderB);
    const uint32_t hash = HashOf(key), mask = static_cast<uint32_t>(table_.size() - 1);
    for (uint32_t i = hash & mask;; i = (i + 1) & mask) {
        const Entry& entry = table_[i];
        if (entry.index == kNone) return kNone;
        if (entry.hash == hash && Key(pairs[entry.index].colliderA, pairs[entry.index].colliderB) == key)
            return entry.index;
    }
}

void PairStore::Grow() {
    Array<Entry> old(table_.empty() ? 1024 : 2 * table_.size());
    old.swap(table_);
    const uint32_t mask = static_cast<uint32_t>(table_.size() - 1);
    for (const Entry& entry : old) {
        if (entry.index == kNone) continue;
        uint32_t i = entry.hash & mask;
        while (table_[i].index != kNone) i = (i + 1) & mask;
        table_[i] = entry;
    }
}

void PairStore::Reserve(size_t more) {
    const size_t count = pairs.size() + more - std::min(more, free_.size());
    ReserveAtLeast(pairs, count);
    ReserveAtLeast(links_, count);
    ReserveAtLeast(loads, count);
}

uint32_t PairStore::Allocate() {
    uint32_t index;
    if (!free_.empty()) {
        index = free_.back();
        free_.pop_back();
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
        free_.reserve(pairs.capacity());  // so that Remove never allocates
    }
    pairs[index] = {};
    loads[index] = {};
    if (keepsReported_) reported[index] = {};
    pairs[index].exists = true;
    return index;
}

void PairStore::ReserveContacts(size_t more) {
    const size_t count = contacts.size() + more - std::min(more, freeContacts_.size());
    ReserveAtLeast(contacts, count);
    ReserveAtLeast(records, count);
    freeContacts_.reserve(contacts.capacity());  // so that RemoveContact never allocates
}

uint32_t PairStore::AddContact(uint32_t pair) {
    uint32_t index;
    if (!freeContacts_.empty()) {
        index = freeContacts_.back();
        freeContacts_.pop_back();
        contacts[index] = {};
        records[index] = {};
    } else {
        index = static_cast<uint32_t>(contacts.size());
        if (index == std::min(contacts.capacity(), records.capacity())) ReserveContacts(1);
        contacts.emplace_back();
        records.emplace_back();
        if (keepsMassOverrides_) massOverrides.emplace_back();
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
    freeContacts_.push_back(index);
}

void PairStore::KeepMassOverrides(bool keep) {
    keepsMassOverrides_ = keep;
    massOverrides.resize(keep ? contacts.size() : 0);
}

void PairStore::KeepReported(bool keep) {
    if (keep == keepsReported_) return;
    keepsReported_ = keep;
    reported = Array<ReportedContact>(keep ? pairs.size() : 0);
    ended = {};
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
    pair.shapeA = first.shapeA;
    pair.shapeB = first.shapeB;
    pair.fixedB = first.fixedB;
    pair.offset = first.offset;
    pair.surface = first.surface;
    contacts[pair.contact].reference = contacts[first.contact].reference;
    pair.isMore = true;
    pair.more = first.more;
    pairs[of].more = index;
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
    const uint32_t hash = HashOf(key);
    uint32_t i = hash & mask;
    while (table_[i].index != kNone) i = (i + 1) & mask;
    table_[i] = {hash, index};
}

void PairStore::RemoveKey(uint64_t key, uint32_t index) {
    const uint32_t mask = static_cast<uint32_t>(table_.size() - 1);
    uint32_t hole = HashOf(key) & mask;
    while (table_[hole].index != index) hole = (hole + 1) & mask;
    // Backward-shift deletion: entries after the hole move up unless that would put them before their home slot.
    for (uint32_t i = (hole + 1) & mask; table_[i].index != kNone; i = (i + 1) & mask) {
        if (((i - table_[i].hash) & mask) >= ((i - hole) & mask)) {
            table_[hole] = table_[i];
            hole = i;
        }
    }
    table_[hole].index = kNone;
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
    if (pairs[index].isMore) {
        pairs[index].exists = false;
        free_.push_back(index);
        return;
    }
    Unlink(index);
    RemoveKey(Key(pairs[index].colliderA, pairs[index].colliderB), index);
    pairs[index].exists = false;
    free_.push_back(index);
    --size_;
}

size_t HeapBytes(const PairStore& store) {
    const auto& [pairs, contacts, records, massOverrides, reported, ended, loads, loadVersion, active, table, free,
                 freeContacts, links, heads, size, keepsMassOverrides, keepsReported] = store;
    return HeapBytes(pairs, contacts, records, massOverrides, reported, ended, loads, loadVersion, active, table, free,
                     freeContacts, links, heads, size, keepsMassOverrides, keepsReported);
}

}  // namespace fulcrum
