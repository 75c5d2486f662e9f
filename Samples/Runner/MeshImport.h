// Makes a shape of a mesh file, by way of assimp. Called by the runner's drop command; thread-safe. The only file that knows
// assimp is MeshImport.cpp.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

#include <filesystem>
#include <string>
#include <vector>

namespace fulcrum {

struct ImportedShape {
    ShapePtr shape;                     // a convex hull, or a compound of several
    size_t points = 0;                  // of the file's meshes that became hulls
    size_t hulls = 0;
    size_t hullVertices = 0;
    double fileSize = 0;                // largest extent in the file's own unit
    std::vector<std::string> warnings;  // meshes that were left out, and why
};

// The convex hull (at most 64 vertices) of each mesh of the file, placed by the file's nodes, as one shape whose largest
// extent is `size` metres, > 0, and whose bounds are centred on its origin. Meshes without a volume are left out with a
// warning, and so are the smallest of more than 128. Errors: UnknownId (there is no such file), Unsupported (assimp cannot
// read it), Degenerate (no mesh in it, or none that has a volume).
Result<ImportedShape> ImportShape(const std::filesystem::path& path, double size);

}  // namespace fulcrum
