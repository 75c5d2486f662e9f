// Heap memory of buffers. A store lists all its members in a structured binding: a new member does not compile until it
// is counted.
#pragma once

#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Math/Memory.h>

#include <cstddef>
#include <type_traits>

namespace fulcrum {

// Types that own no memory.
template <class T>
requires std::is_trivially_copyable_v<T> size_t HeapBytes(const T&) { return 0; }

// Types with a HeapBytes function of their own.
template <class T>
requires requires(const T& t) { t.MemoryUsed(); }
size_t HeapBytes(const T& counted) { return counted.MemoryUsed(); }

inline size_t HeapBytes(const ScratchArena& arena) { return arena.CapacityInBytes(); }

template <class T>
size_t HeapBytes(const Array<T>& elements) {
    size_t bytes = elements.capacity() * sizeof(T);
    if constexpr (!std::is_trivially_copyable_v<T>)
        for (const T& element : elements) bytes += HeapBytes(element);
    return bytes;
}

template <class First, class Second, class... More>
size_t HeapBytes(const First& first, const Second& second, const More&... more) {
    return HeapBytes(first) + HeapBytes(second) + (size_t{0} + ... + HeapBytes(more));
}

}  // namespace fulcrum
