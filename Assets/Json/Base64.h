// Bytes as text (RFC 4648). Pure functions.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fulcrum {

std::string ToBase64(std::string_view bytes);
// Null: it is no Base64, or its padding is missing.
std::optional<std::vector<uint8_t>> FromBase64(std::string_view text);

}  // namespace fulcrum
