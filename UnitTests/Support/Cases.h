// The number of random cases of a test: all in a normal build, a tenth under the sanitizers, which are twenty times
// slower.
#pragma once

#include <algorithm>

namespace fulcrum::testing {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kIsSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif
#else
inline constexpr bool kIsSanitized = false;
#endif

constexpr int Cases(int normally) { return kIsSanitized ? std::max(normally / 10, 1) : normally; }

}  // namespace fulcrum::testing
