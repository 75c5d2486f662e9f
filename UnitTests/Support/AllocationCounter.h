// Counts calls of the global operator new, all threads and all forms of it, while the test program runs. A test reads
// it before and after code that must not allocate.
#pragma once

#include <cstdint>

namespace fulcrum::testing {

// Calls since the program started. Any thread.
uint64_t AllocationCount();

}  // namespace fulcrum::testing
