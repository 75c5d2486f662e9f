// The functions that the table of ShapeFile.cpp names, which write and read each type of shape. Readers validate
// everything, because files may be damaged.
#pragma once

#include <Fulcrum/Collision/Shapes/ByteStream.h>
#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/HullBuilder.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <cmath>

namespace fulcrum {

using ShapeResult = Result<ShapePtr>;

inline bool IsUnit(double lengthSquared) { return std::fabs(lengthSquared - 1) < 1e-5; }

// Context of a shape being read or written.
struct ShapeFileScope {
    std::span<const CustomShapeFormat> custom;
    int depth = 0;  // of nesting
};

// Access to private data of shapes, which are saved bit-exactly.
struct ShapeFileAccess {
    // The hull of these faces, or an error if they are not a closed convex polyhedron around the origin.
    static ShapeResult MakeHull(const HullMesh& mesh, const MassProperties& mass, float convexRadius);
    static ShapeResult MakeCompound(std::vector<Compound::Child> children, const MassProperties& mass);
    static void WriteMutableCompound(const MutableCompound& compound, ByteWriter& out, const ShapeFileScope& scope);
    static ShapeResult ReadMutableCompound(ByteReader& in, const ShapeFileScope& scope);
    static void WriteTriangle(const Triangle& triangle, ByteWriter& out);
    static ShapeResult ReadTriangle(ByteReader& in);
    static void WriteMesh(const TriangleMesh& mesh, ByteWriter& out);
    static ShapeResult ReadMesh(ByteReader& in);
    static void WriteField(const HeightField& field, ByteWriter& out);
    static ShapeResult ReadField(ByteReader& in);
};

// A shape within another, with its code and length; the depth of nesting is limited.
void WriteShape(const Shape& shape, ByteWriter& out, const ShapeFileScope& scope);
ShapeResult ReadShape(ByteReader& in, const ShapeFileScope& scope);

void WriteHull(const Shape& shape, ByteWriter& out, const ShapeFileScope& scope);
ShapeResult ReadHull(ByteReader& in, const ShapeFileScope& scope);
void WriteCompound(const Shape& shape, ByteWriter& out, const ShapeFileScope& scope);
ShapeResult ReadCompound(ByteReader& in, const ShapeFileScope& scope);

void WriteMass(const MassProperties& mass, ByteWriter& out);
MassProperties ReadMass(ByteReader& in);
// Whether these mass properties are physically possible: positive, and no moment of inertia above the sum of the
// others.
bool IsPlausible(const MassProperties& mass);

void WriteMaterials(std::span<const SurfaceMaterial> materials, ByteWriter& out);
std::vector<SurfaceMaterial> ReadMaterials(ByteReader& in);

// The error of a truncated or invalid file.
inline Error Damaged(const char* what) { return {ErrorCode::Degenerate, std::string("damaged shape file: ") + what}; }

}  // namespace fulcrum
