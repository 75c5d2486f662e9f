// Counts calls of the global operator new, all threads and all forms of it, while the test program runs, and the bytes
// that it gave. A test reads them before and after what must not allocate, or whose memory it knows.
#pragma once

#include <cstdint>

namespace fulcrum::testing {

// Calls since the program started. Any thread.
uint64_t AllocationCount();
// What is allocated now, with what the allocator rounds up; 0 where it does not say. Any thread.
uint64_t AllocatedBytes();

}  // namespace fulcrum::testing
