// Reads the meshes of a file, by way of assimp. Called by MeshImport; thread-safe. The only file that knows assimp is
// MeshFile.cpp. It reads in a process of its own: assimp's readers crash, hang or allocate without end for some broken
// files.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Math/Vector.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace fulcrum {

// A mesh, placed by one node of the file, in the file's unit.
struct MeshPart {
    std::string name;
    std::vector<Position> points;  // some may not be finite
    std::vector<std::array<uint32_t, 3>>
        triangles;          // counter-clockwise seen from the front; valid indices into `points`
    size_t otherFaces = 0;  // points and lines of the file, and faces that name no point
};

// One for each node of the file that has a mesh; polygons are triangulated, and mirrored meshes keep their fronts.
// Errors: UnknownId (there is no such file), Unsupported (assimp cannot read it), Degenerate (no mesh in it),
// OutOfRange (it takes more than 4 GiB of memory; more than 2 s, and one more for each million bytes; or makes more
// than 2 GiB of parts).
Result<std::vector<MeshPart>> ReadMeshParts(const std::filesystem::path& path);

// The box around all points that are finite; empty where there are none.
struct MeshBox {
    Position lowest, highest;
    MeshBox();
    void Include(const Position& point) {
        lowest = lowest.cwiseMin(point);
        highest = highest.cwiseMax(point);
    }
    double LargestExtent() const { return (highest - lowest).maxCoeff(); }
    Position Center() const { return 0.5 * (lowest + highest); }
};
MeshBox BoundsOf(const std::vector<MeshPart>& parts);

}  // namespace fulcrum
