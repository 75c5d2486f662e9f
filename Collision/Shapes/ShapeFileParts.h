// What the table of ShapeFile.cpp names: how each shape is written and read. Used by the shape files alone. A reader
// checks all that it reads, because it may be anything.
#pragma once

#include <Fulcrum/Collision/Shapes/ByteStream.h>
#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/HullBuilder.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

namespace fulcrum {

using ShapeResult = Result<ShapePtr>;

// Reaches into the shapes whose parts the file holds as they are, so that they come back with the same bits.
struct ShapeFileAccess {
    // The hull of these faces, or an error where they are no closed convex polyhedron around the origin.
    static ShapeResult MakeHull(const HullMesh& mesh, const MassProperties& mass, float convexRadius);
    static ShapeResult MakeCompound(std::vector<Compound::Child> children, const MassProperties& mass);
    static void WriteMesh(const TriangleMesh& mesh, ByteWriter& out);
    static ShapeResult ReadMesh(ByteReader& in);
    static void WriteField(const HeightField& field, ByteWriter& out);
    static ShapeResult ReadField(ByteReader& in);
};

// A shape within another, with its code and length; the depth of nesting is limited.
void WriteShape(const Shape& shape, ByteWriter& out);
ShapeResult ReadShape(ByteReader& in, int depth);

void WriteHull(const Shape& shape, ByteWriter& out);
ShapeResult ReadHull(ByteReader& in, int depth);
void WriteCompound(const Shape& shape, ByteWriter& out);
ShapeResult ReadCompound(ByteReader& in, int depth);

void WriteMaterials(std::span<const SurfaceMaterial> materials, ByteWriter& out);
std::vector<SurfaceMaterial> ReadMaterials(ByteReader& in);

// The error of a file that breaks off or says what cannot be.
inline Error Damaged(const char* what) { return {ErrorCode::Degenerate, std::string("damaged shape file: ") + what}; }

}  // namespace fulcrum
