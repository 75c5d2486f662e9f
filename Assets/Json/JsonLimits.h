// What a document may ask of its reader, at most. A small file can ask for very much: its reader calls itself for each
// level, keeps a tree of all values, and compares each name with all others of its object; and what the document
// describes may be used again and again. Docs/SceneFiles.md gives the reasons. Pure functions.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <cstdint>
#include <string_view>

namespace fulcrum {

struct DocumentLimits {
    int levels = 100;
    // 16 bytes each, and again half of that while a list grows: 1.6 GB.
    uint64_t values = uint64_t{1} << 26;
    // Of names within one object, each with those before it: n names take n (n - 1) / 2. Some seconds.
    uint64_t comparisons = uint64_t{1} << 30;
};
// Convex shapes in compounds, counted for each compound and for each body of one.
inline constexpr uint64_t kMostChildren = uint64_t{1} << 20;
// Bytes of the files that a document names, counted each time that they are named.
inline constexpr uint64_t kMostNamedBytes = uint64_t{1} << 30;

// An error if a document exceeds them. Whether it is valid is checked by who reads it.
MaybeError CheckLimitsOfJson(std::string_view text, const DocumentLimits& limits = {});
// For CBOR also if it has tags or strings of unknown length, which scenes have not: strings within strings are levels,
// too.
MaybeError CheckLimitsOfCbor(std::string_view bytes, const DocumentLimits& limits = {});

// Takes so many of what is left; or an error that says how many of what are allowed.
MaybeError TakeFrom(uint64_t& left, uint64_t count, uint64_t most, const char* what);

}  // namespace fulcrum
