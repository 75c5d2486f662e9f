// Suggestions for misspelled names. Called by the command line parser; pure functions.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace fulcrum {

// The fewest single characters to add, remove, replace or swap with their neighbor that turn `a` into `b`.
// Source: Damerau, "A technique for computer detection and correction of spelling errors", 1964 (optimal alignment).
int EditDistance(std::string_view a, std::string_view b);

// The name with the smallest distance, the first of several; empty where there are no names. Case and the two ways to
// join words, - and _, count as equal.
std::string NearestName(std::string_view name, std::span<const std::string> names);

}  // namespace fulcrum
