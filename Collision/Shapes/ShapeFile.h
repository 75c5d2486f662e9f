// Shapes as bytes and back: to bake at build time what is slow to make at run time. Pure functions, thread-safe.
//
// Little-endian. A header: "FLCS", version (4 bytes), length of the rest in bytes (8), its checksum (8: FNV-1a, 64 bits).
// Then the shape: its code in the table of ShapeFile.cpp (1), the length of its part (8), its numbers; children of a compound are
// parts of it in the same form.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

#include <span>
#include <vector>

namespace fulcrum {

inline constexpr uint32_t kShapeFileVersion = 1;

// Any shape that has a line in the table of ShapeFile.cpp. Error: Unsupported.
Result<std::vector<uint8_t>> SaveShape(const Shape& shape);

// The shape that was saved, with the same bits in all its numbers, however it was made. Trusts nothing: what is damaged, cut
// short or made up is refused or gives a shape that is as valid as one that Create made. Needs memory in proportion to
// the bytes given.
// Errors: Unsupported (no shape file, another version, an unknown type), Degenerate (damaged: the message says where), and
// those of the shape's own Create.
Result<ShapePtr> LoadShape(std::span<const uint8_t> bytes);

}  // namespace fulcrum
