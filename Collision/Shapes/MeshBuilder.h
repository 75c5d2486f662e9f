// Builds the tree of a triangle mesh. Called by TriangleMesh::Create; the result is bit-identical for any ParallelLoop.
#pragma once

#include <Fulcrum/Collision/Shapes/MeshRepair.h>
#include <Fulcrum/Collision/Shapes/MeshTree.h>
#include <Fulcrum/Collision/Shapes/ParallelLoop.h>

#include <span>

namespace fulcrum {

// Top down by the surface area heuristic in bins. Source: Wald, "On fast Construction of SAH-based Bounding Volume
// Hierarchies", 2007. `mesh` has at least one triangle; `materials` has one per triangle of the repaired mesh, or is
// empty.
MeshTree BuildMeshTree(const RepairedMesh& mesh, std::span<const uint8_t> materials, bool keepSources,
                       const ParallelLoop& parallel);

}  // namespace fulcrum
