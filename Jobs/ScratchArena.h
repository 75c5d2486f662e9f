// Arena (bump) allocator for one step: freed all at once. Each worker of each PhysicsSystem has one. Not thread-safe.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

namespace fulcrum {

class ScratchArena {
public:
    static constexpr size_t kAlignment = 64;  // bytes: a cache line, and the widest register

    // Reserves nothing before the first Allocate.
    ScratchArena() = default;

    // Uninitialized memory for `count` objects, aligned to kAlignment, valid until Reset. Empty for a count of 0.
    // Pieces of different calls share no cache line. Throws std::bad_alloc if out of memory.
    template <class T>
    requires(std::is_trivially_destructible_v<T> && alignof(T) <= kAlignment) std::span<T> Allocate(size_t count) {
        if (count > kMaximumBytes / sizeof(T)) throw std::bad_array_new_length();
        return {static_cast<T*>(AllocateBytes(count * sizeof(T))), count};
    }

    // Frees everything and keeps the memory. If several blocks were needed since the last Reset they are merged into
    // one, so steps of similar size soon allocate nothing.
    void Reset();

    size_t CapacityInBytes() const { return capacity_; }
    size_t BlockCount() const { return blocks_.size(); }

private:
    static constexpr size_t kMaximumBytes = size_t{1} << (8 * sizeof(size_t) - 2);

    struct Release {
        void operator()(std::byte* block) const { ::operator delete (block, std::align_val_t{kAlignment}); }
    };

    void* AllocateBytes(size_t bytes) {
        const size_t rounded = (bytes + kAlignment - 1) & ~(kAlignment - 1);
        if (rounded > left_) AddBlock(rounded);
        void* piece = next_;
        next_ += rounded;
        left_ -= rounded;
        return piece;
    }
    void AddBlock(size_t minimumBytes);

    std::vector<std::unique_ptr<std::byte, Release>> blocks_;  // the last one is in use
    std::byte* next_ = nullptr;
    size_t left_ = 0;      // bytes from next_ to the end of the last block
    size_t capacity_ = 0;  // bytes of all blocks
};

}  // namespace fulcrum
