// How deep documents may be nested: their readers call themselves for each level. Pure functions.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <string_view>

namespace fulcrum {

// An error if a document is nested deeper than it can be read. Whether it is valid is checked by who reads it.
MaybeError CheckDepthOfJson(std::string_view text);
// For CBOR also if it has tags or strings of unknown length, which scenes have not: strings within strings are levels,
// too.
MaybeError CheckDepthOfCbor(std::string_view bytes);

}  // namespace fulcrum
