// Triangle meshes of recorded shapes, with normals for flat and smooth shading. Called by GlbWriter. Free functions
// without state: any thread.
#pragma once

#include <Fulcrum/Samples/Viewer/Recording.h>

namespace fulcrum {

struct ShapeMesh {
    std::vector<Vector3> positions;  // m, in the shape's frame
    std::vector<Vector3> normals;    // unit, one a position
    std::vector<uint32_t> indices;   // three a triangle, counter-clockwise seen from outside
};

// Of the shape `index`; a compound's has all of its children. The recording's indices must be valid.
ShapeMesh MeshOfShape(const Recording& recording, size_t index);

// Whether it has no triangles, as a hull without faces or a compound without children.
bool IsEmptyShape(const Recording& recording, size_t index);

}  // namespace fulcrum
