// Shapes as bytes and back: to bake at build time what is slow to make at run time. Pure functions, thread-safe.
//
// Little-endian. A header: "FLCS", version (4 bytes), length of the rest in bytes (8), its checksum (8: FNV-1a, 64
// bits). Then the shape: its code in the table of ShapeFile.cpp (1), the length of its part (8), its numbers; children
// of a compound are parts of it in the same form. A custom shape is the name of its format and that format's own bytes.
#pragma once

#include <Fulcrum/Collision/Shapes/CustomConvex.h>

#include <span>
#include <string_view>
#include <vector>

namespace fulcrum {

inline constexpr uint32_t kShapeFileVersion = 1;

// How files hold the shapes of a class that a user derived from CustomConvex.
struct CustomShapeFormat {
    std::string_view name;  // in files, 1 to 255 bytes: given once, for ever
    // What `read` needs; false: the shape is of another class.
    bool (*write)(const CustomConvex& shape, std::vector<uint8_t>& bytes);
    // A custom shape made of what `write` wrote, or of anything else: files may be damaged.
    Result<ShapePtr> (*read)(std::span<const uint8_t> bytes);
};

// Any shape that has a line in the table of ShapeFile.cpp: all, custom ones where one of the formats writes them.
// Errors: Unsupported, OutOfRange (a format's name).
Result<std::vector<uint8_t>> SaveShape(const Shape& shape, std::span<const CustomShapeFormat> custom = {});

// The shape that was saved, with the same bits in all its numbers, however it was made. Trusts nothing: what is
// damaged, cut short or made up is refused or gives a shape that is as valid as one that Create made. Needs memory in
// proportion to the bytes given. Errors: Unsupported (no shape file, another version, an unknown type, no format of a
// custom shape's name), Degenerate (damaged: the message says where), and those of the shape's own Create.
Result<ShapePtr> LoadShape(std::span<const uint8_t> bytes, std::span<const CustomShapeFormat> custom = {});

}  // namespace fulcrum
