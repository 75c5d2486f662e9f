// Counts calls of the global operator new, all threads and all forms of it, while the test program runs, and the bytes
// that it gave. A test reads them before and after what must not allocate, or whose memory it knows.
#pragma once

#include <cstdint>
#include <cstdlib>

namespace fulcrum::testing {

// Calls since the program started. Any thread.
uint64_t AllocationCount();
// What is allocated now, with what the allocator rounds up; 0 where it does not say. Any thread.
uint64_t AllocatedBytes();

// Calls of malloc, as C libraries make them; operator new is not among them. Always 0 where kCountsMalloc is false.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
inline constexpr bool kCountsMalloc = true;
#else
inline constexpr bool kCountsMalloc = false;
#endif
uint64_t MallocCount();

}  // namespace fulcrum::testing
