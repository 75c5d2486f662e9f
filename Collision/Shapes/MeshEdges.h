// Finds which edges of a mesh are active (SurfaceShape.h). Called by TriangleMesh, once a mesh or scaled instance.
// Pure.
#pragma once

#include <Fulcrum/Collision/Shapes/MeshTree.h>

namespace fulcrum {

struct MeshEdges {
    std::vector<uint8_t> active;  // one byte per triangle, bit i: its edge from corner i to i + 1
    uint32_t boundaryEdges = 0, irregularEdges = 0;
};

// For the vertices times `scale`, keeping front sides (a mirroring scale swaps corners 1 and 2, and the edges with
// them).
MeshEdges FindActiveEdges(const MeshTree& tree, const Vector3& scale, float cosine, bool isTwoSided);

}  // namespace fulcrum
