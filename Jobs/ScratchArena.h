// Arena (bump) allocator for one step: freed all at once. Each worker of each PhysicsSystem has one. Not thread-safe.
#pragma once

#include <Fulcrum/Math/Memory.h>

#include <cstddef>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

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

    class Block {
    public:
        explicit Block(size_t bytes)
            : memory_(tCurrentMemory), bytes_(bytes), begin_(AllocateFrom(memory_, bytes, kAlignment)) {}
        Block(Block&& other) noexcept
            : memory_(other.memory_), bytes_(other.bytes_), begin_(std::exchange(other.begin_, nullptr)) {}
        ~Block() {
            if (begin_) DeallocateTo(memory_, begin_, bytes_, kAlignment);
        }
        Block& operator=(Block&&) = delete;
        std::byte* Begin() const { return static_cast<std::byte*>(begin_); }

    private:
        MemoryResource* memory_;
        size_t bytes_;
        void* begin_;
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

    Array<Block> blocks_;  // the last one is in use
    std::byte* next_ = nullptr;
    size_t left_ = 0;      // bytes from next_ to the end of the last block
    size_t capacity_ = 0;  // bytes of all blocks
};

}  // namespace fulcrum
