#include <Fulcrum/Collision/Shapes/ShapeFile.h>

#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/ShapeFileParts.h>

#include <algorithm>

namespace fulcrum {
namespace {

constexpr uint32_t kMagic = 0x53434C46;  // "FLCS"
constexpr int kMostNested = 8;

struct ShapeFormat {
    uint8_t code;  // in files: given once, for ever
    ShapeType type;
    void (*write)(const Shape& shape, ByteWriter& out);
    ShapeResult (*read)(ByteReader& in, int depth);
};

template <class T>
ShapeResult AsShape(const Result<std::shared_ptr<T>>& result) {
    if (!result) return result.GetError();
    return ShapePtr(result.Value());
}

void WriteSphere(const Shape& shape, ByteWriter& out) { out.Write(static_cast<const Sphere&>(shape).Radius()); }
ShapeResult ReadSphere(ByteReader& in, int) { return AsShape(Sphere::Create(in.Get<float>())); }

void WriteBox(const Shape& shape, ByteWriter& out) {
    const auto& box = static_cast<const Box&>(shape);
    out.Write(box.HalfExtents());
    out.Write(box.ConvexRadius());
}
ShapeResult ReadBox(ByteReader& in, int) {
    Vector3 halfExtents = Vector3::Zero();
    in.Read(halfExtents);
    return AsShape(Box::Create(halfExtents, in.Get<float>()));
}

void WriteCapsule(const Shape& shape, ByteWriter& out) {
    const auto& capsule = static_cast<const Capsule&>(shape);
    out.Write(capsule.HalfHeight());
    out.Write(capsule.Radius());
}
ShapeResult ReadCapsule(ByteReader& in, int) {
    const float halfHeight = in.Get<float>(), radius = in.Get<float>();
    return AsShape(Capsule::Create(halfHeight, radius));
}

void WritePlane(const Shape& shape, ByteWriter& out) {
    const auto& plane = static_cast<const Plane&>(shape);
    out.Write(plane.Normal());
    out.Write(plane.Offset());
}
ShapeResult ReadPlane(ByteReader& in, int) {
    Vector3 normal = Vector3::Zero();
    in.Read(normal);
    return AsShape(Plane::Create(normal, in.Get<float>()));
}

void WriteTaperedCapsule(const Shape& shape, ByteWriter& out) {
    const auto& capsule = static_cast<const TaperedCapsule&>(shape);
    out.Write(capsule.HalfHeight());
    out.Write(capsule.TopRadius());
    out.Write(capsule.BottomRadius());
}
ShapeResult ReadTaperedCapsule(ByteReader& in, int) {
    const float halfHeight = in.Get<float>(), top = in.Get<float>(), bottom = in.Get<float>();
    return AsShape(TaperedCapsule::Create(halfHeight, top, bottom));
}

void WriteCylinder(const Shape& shape, ByteWriter& out) {
    const auto& cylinder = static_cast<const Cylinder&>(shape);
    out.Write(cylinder.HalfHeight());
    out.Write(cylinder.TopRadius());
    out.Write(cylinder.BottomRadius());
    out.Write(cylinder.ConvexRadius());
}
ShapeResult ReadCylinder(ByteReader& in, int) {
    const float halfHeight = in.Get<float>(), top = in.Get<float>(), bottom = in.Get<float>(), radius = in.Get<float>();
    return AsShape(Cylinder::CreateTapered(halfHeight, top, bottom, radius));
}

void WriteEmpty(const Shape&, ByteWriter&) {}
ShapeResult ReadEmpty(ByteReader&, int) { return ShapePtr(EmptyShape::Create()); }

void WriteMesh(const Shape& shape, ByteWriter& out) {
    ShapeFileAccess::WriteMesh(static_cast<const TriangleMesh&>(shape), out);
}
ShapeResult ReadMesh(ByteReader& in, int) { return ShapeFileAccess::ReadMesh(in); }

void WriteField(const Shape& shape, ByteWriter& out) {
    ShapeFileAccess::WriteField(static_cast<const HeightField&>(shape), out);
}
ShapeResult ReadField(ByteReader& in, int) { return ShapeFileAccess::ReadField(in); }

// A shape that files can hold is a line here.
constexpr ShapeFormat kFormats[] = {
    {1, ShapeType::Sphere, WriteSphere, ReadSphere},
    {2, ShapeType::Box, WriteBox, ReadBox},
    {3, ShapeType::Capsule, WriteCapsule, ReadCapsule},
    {4, ShapeType::ConvexHull, WriteHull, ReadHull},
    {5, ShapeType::Compound, WriteCompound, ReadCompound},
    {6, ShapeType::TriangleMesh, WriteMesh, ReadMesh},
    {7, ShapeType::HeightField, WriteField, ReadField},
    {8, ShapeType::Plane, WritePlane, ReadPlane},
    {9, ShapeType::TaperedCapsule, WriteTaperedCapsule, ReadTaperedCapsule},
    {10, ShapeType::Cylinder, WriteCylinder, ReadCylinder},
    {11, ShapeType::Empty, WriteEmpty, ReadEmpty},
};

const ShapeFormat* FormatOf(ShapeType type) {
    const auto found = std::ranges::find(kFormats, type, &ShapeFormat::type);
    return found == std::end(kFormats) ? nullptr : found;
}

// The first shape within this one, itself included, that has no line.
const Shape* Unsupported(const Shape& shape) {
    if (!FormatOf(shape.Type())) return &shape;
    if (shape.Type() != ShapeType::Compound) return nullptr;
    for (const Compound::Child& child : static_cast<const Compound&>(shape).Children())
        if (const Shape* inside = Unsupported(*child.shape)) return inside;
    return nullptr;
}

// FNV-1a, 64 bits. Source: Fowler, Noll, Vo, draft-eastlake-fnv.
uint64_t Checksum(std::span<const uint8_t> bytes) {
    uint64_t hash = 0xCBF29CE484222325u;
    for (const uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001B3u;
    return hash;
}

}  // namespace

void WriteShape(const Shape& shape, ByteWriter& out) {
    const ShapeFormat& format = *FormatOf(shape.Type());
    out.Write(format.code);
    out.WriteWithLength([&] { format.write(shape, out); });
}

ShapeResult ReadShape(ByteReader& in, int depth) {
    if (depth > kMostNested) return Damaged("shapes are nested too deep");
    const uint8_t code = in.Get<uint8_t>();
    ByteReader part = in.ReadPart();
    if (part.HasFailed()) return Damaged("it breaks off");
    const auto format = std::ranges::find(kFormats, code, &ShapeFormat::code);
    if (format == std::end(kFormats)) return Error{ErrorCode::Unsupported, Message("shape code %d is unknown", int{code})};
    ShapeResult shape = format->read(part, depth);
    if (part.HasFailed()) return Damaged("a shape breaks off");
    if (shape && !part.IsAtEnd()) return Damaged("a shape is followed by more");
    return shape;
}

Result<std::vector<uint8_t>> SaveShape(const Shape& shape) {
    if (const Shape* other = Unsupported(shape)) {
        return Error{ErrorCode::Unsupported, Message("a %s cannot be saved", ShapeTypeName(other->Type()))};
    }
    ByteWriter content;
    WriteShape(shape, content);
    ByteWriter file;
    file.Write(kMagic);
    file.Write(kShapeFileVersion);
    file.Write(uint64_t{content.Bytes().size()});
    file.Write(Checksum(content.Bytes()));
    file.Bytes().insert(file.Bytes().end(), content.Bytes().begin(), content.Bytes().end());
    return std::move(file.Bytes());
}

ShapeResult LoadShape(std::span<const uint8_t> bytes) {
    ByteReader in(bytes);
    if (in.Get<uint32_t>() != kMagic || in.HasFailed()) return Error{ErrorCode::Unsupported, "this is no shape file"};
    const uint32_t version = in.Get<uint32_t>();
    if (version != kShapeFileVersion) {
        return Error{ErrorCode::Unsupported, Message("shape file of version %u: this is %u", version, kShapeFileVersion)};
    }
    const uint64_t length = in.Get<uint64_t>(), checksum = in.Get<uint64_t>();
    if (in.HasFailed() || length != in.Rest().size()) return Damaged("its length is not what it says");
    if (checksum != Checksum(in.Rest())) return Damaged("its checksum is wrong");
    ShapeResult shape = ReadShape(in, 0);
    if (shape && !in.IsAtEnd()) return Damaged("the shape is followed by more");
    return shape;
}

}  // namespace fulcrum
