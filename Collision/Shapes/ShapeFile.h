// Serialization of shapes, to bake shapes that are slow to create. Pure functions, thread-safe.
//
// Little-endian. A header: "FLCS", version (4 bytes), length of the rest in bytes (8), its checksum (8: FNV-1a, 64
// bits). Then the shape: its code in the table of ShapeFile.cpp (1), the length of its data (8), its data; those of a
// compound contain its children in the same form. A custom shape is the name of its format and that format's own bytes.
#pragma once

#include <Fulcrum/Collision/Shapes/CustomConvex.h>

#include <span>
#include <string>
#include <vector>

namespace fulcrum {

inline constexpr uint32_t kShapeFileVersion = 1;

// Serialization of a class that a user derived from CustomConvex.
struct CustomShapeFormat {
    std::string name;  // 1 to 255 bytes; must never change, since files contain it
    // Writes the data for `read`; returns false if the shape is of another class.
    bool (*write)(const CustomConvex& shape, std::vector<uint8_t>& bytes);
    // Creates the shape from the data of `write`. The data may be invalid, since files may be damaged.
    Result<ShapePtr> (*read)(std::span<const uint8_t> bytes);
};

// All shapes; custom ones if one of the formats writes them. Errors: Unsupported, OutOfRange (a format's name).
Result<std::vector<uint8_t>> SaveShape(const Shape& shape, std::span<const CustomShapeFormat> custom = {});

// Reads a shape; all numbers are bit-identical to those saved. Safe for damaged or malicious data: they give an error
// or a valid shape, and memory use is proportional to the size of the data. Errors: Unsupported (no shape file, another
// version, an unknown type, no format of a custom shape's name), Degenerate (damaged: the message says where), and
// those of the shape's own Create.
Result<ShapePtr> LoadShape(std::span<const uint8_t> bytes, std::span<const CustomShapeFormat> custom = {});

}  // namespace fulcrum
