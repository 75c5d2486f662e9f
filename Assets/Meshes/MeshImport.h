// Makes shapes of mesh files: hulls to drop, and triangle meshes to drop them onto. Called by the runner's drop
// command; thread-safe.
#pragma once

#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fulcrum {

struct ImportedShape {
    ShapePtr shape;     // a convex hull, or a compound of several
    size_t points = 0;  // of the file's meshes that became hulls
    size_t hulls = 0;
    size_t hullVertices = 0;
    double fileSize = 0;                // largest extent in the file's own unit
    std::vector<std::string> warnings;  // meshes that were left out, and why
};

// The convex hull (at most 64 vertices) of each mesh of the file, placed by the file's nodes, as one shape whose
// largest extent is `size` meters, > 0, and whose bounds are centered on its origin. Meshes without a volume are left
// out with a warning, and so are the smallest of more than 128. Errors: UnknownId (there is no such file), Unsupported
// (assimp cannot read it), Degenerate (no mesh in it, or none that has a volume).
Result<ImportedShape> ImportShape(const std::filesystem::path& path, double size);

// The up axis of the file.
enum class UpAxis : uint8_t { X, Y, Z, MinusX, MinusY, MinusZ };

struct MeshImportSettings {
    double size = 20;               // m, > 0: the largest extent, unless `scale` is given
    std::optional<double> scale{};  // m a unit of the file, > 0
    UpAxis up = UpAxis::Y;
};

struct ImportedMesh {
    std::shared_ptr<const TriangleMesh> mesh;
    bool isTwoSided = false;  // if the surface is open, or its orientation is inconsistent or inwards
    double fileSize = 0;      // largest extent in the file's own unit
    double scale = 1;         // m a unit of the file
    MeshReport report;
    std::vector<std::string> repairs;  // descriptions of what was dropped or repaired
};

// All triangles of the file, placed by its nodes and welded, as one mesh that stands on y = 0 above the origin, y up.
// Errors: as ImportShape's; NonPositive (the scale); Degenerate where there is no triangle, or none with an area.
Result<ImportedMesh> ImportMesh(const std::filesystem::path& path, const MeshImportSettings& settings = {});

}  // namespace fulcrum
