// How much of a test is run: the number of its random cases, and which of its settings. Always the first ones, so that
// a build runs the same today and tomorrow.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <initializer_list>
#include <vector>

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

// All in a normal build, a tenth under the sanitizers, which are twenty times slower.
constexpr int Cases(int normally) { return kIsSanitized ? std::max(normally / 10, 1) : normally; }

// Set by ./fulcrum test --all.
inline bool IsAllWanted() {
    static const bool isWanted = std::getenv("FULCRUM_ALL_TESTS") != nullptr;
    return isWanted;
}

// Of long statistics: as many as a change must hold every day, and all that there are on demand.
inline int Cases(int daily, int all) { return Cases(IsAllWanted() ? all : daily); }

// Of settings, or of kinds, that run the same code: all in a normal build, the first under the sanitizers.
template <class T>
std::vector<T> SomeOf(std::initializer_list<T> normally) {
    return std::vector<T>(normally.begin(), kIsSanitized && !IsAllWanted() ? normally.begin() + 1 : normally.end());
}

}  // namespace fulcrum::testing
