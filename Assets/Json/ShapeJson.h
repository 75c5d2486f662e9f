// Shapes as JSON objects with a `kind`. Any thread.
//   Sphere          radius
//   Box             halfExtents, convexRadius
//   Capsule         halfHeight, radius
//   TaperedCapsule  halfHeight, topRadius, bottomRadius
//   Cylinder        halfHeight, radius, convexRadius; or topRadius and bottomRadius in place of radius
//   ConvexHull      points, maxVertices, convexRadius
//   Plane           normal, offset
//   TriangleMesh    vertices, indices (three a triangle), isTwoSided, activeEdgeCosine
//   HeightField     sampleCountX, sampleCountZ, heights, cellSizeX, cellSizeZ, origin, isTwoSided
//   Compound, MutableCompound   children: shape, position, rotation, density
//   Empty
//   HullFile        file, size: the convex hulls of a mesh file (MeshImport.h)
//   MeshFile        file, size or scale: its triangles
//   Baked           base64: the bytes of SaveShape (ShapeFile.h), of any shape
// Lengths in meters. All shapes but custom ones can be written: in a form that can be read where this gives the same
// shape bit by bit, else baked.
#pragma once

#include <Fulcrum/Assets/Json/JsonReader.h>

namespace fulcrum {

// The names of the kinds.
std::span<const char* const> ShapeKindNames();

// Error Unsupported: a custom shape.
Result<Json> ShapeToJson(const ShapePtr& shape);

// Counts the children of a compound that a body has, if it is one: a small document may have many bodies of a large
// one.
void TakeChildren(const Shape* shape, const std::string& path, JsonDocument& document);

// Kinds that ragdolls may have written: a ball, a box, a capsule, a sharp hull.
bool CanBeWrittenByKind(const Shape& shape);

}  // namespace fulcrum
