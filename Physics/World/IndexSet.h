// A set of small integers as bits, visited in ascending order, independent of the order of insertion.
#pragma once

#include <Fulcrum/Math/Memory.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace fulcrum {

class IndexSet {
public:
    // Reserves 0..count - 1.
    void Reserve(uint32_t count) {
        if (words_.size() * 64 < count) words_.resize((count + 63) / 64, 0);
    }
    // So that Reserve(count) asks for no memory.
    void ReserveRoom(uint32_t count) {
        const size_t words = (size_t{count} + 63) / 64, room = words_.capacity();
        if (words > room) words_.reserve(std::max(words, room + room / 8 + 2));
    }
    bool Contains(uint32_t i) const { return i / 64 < words_.size() && (words_[i / 64] >> i % 64 & 1) != 0; }
    // i must be below the reserved count. Returns whether the set changed.
    bool Insert(uint32_t i) {
        const bool is = Contains(i);
        words_[i / 64] |= uint64_t(1) << i % 64;
        size_ += !is;
        return !is;
    }
    bool Erase(uint32_t i) {
        const bool is = Contains(i);
        if (is) words_[i / 64] &= ~(uint64_t(1) << i % 64);
        size_ -= is;
        return is;
    }
    uint32_t Size() const { return size_; }
    uint32_t WordCount() const { return static_cast<uint32_t>(words_.size()); }
    uint64_t Word(uint32_t word) const { return words_[word]; }
    size_t MemoryUsed() const { return words_.capacity() * sizeof(uint64_t); }

    // Visits the members among 64 word..64 word + 63 as of the start of the call: the visitor may erase.
    template <class Visitor>
    void VisitWord(uint32_t word, Visitor&& visit) const {
        for (uint64_t bits = words_[word]; bits != 0; bits &= bits - 1)
            visit(word * 64 + static_cast<uint32_t>(std::countr_zero(bits)));
    }
    template <class Visitor>
    void Visit(Visitor&& visit) const {
        for (uint32_t word = 0; word < words_.size(); ++word) VisitWord(word, visit);
    }

private:
    friend struct SnapshotAccess;
    Array<uint64_t> words_;
    uint32_t size_ = 0;
};

}  // namespace fulcrum
