// Prefetches of data that the next iterations of a loop read. Functions that do nothing but prefetch must be inlined by
// force, as this one: GCC regards calls of them as without effect and drops them.
#pragma once

#include <Fulcrum/Math/ForceInline.h>

#include <cstddef>

namespace fulcrum {

// The cache lines of `size` bytes.
FULCRUM_FORCE_INLINE void PrefetchLines(const void* data, size_t size) {
    for (size_t line = 0; line < size; line += 64) __builtin_prefetch(static_cast<const char*>(data) + line);
}

}  // namespace fulcrum
