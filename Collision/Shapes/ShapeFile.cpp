#include <Fulcrum/Collision/Shapes/ShapeFile.h>

#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/ShapeFileParts.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>

namespace fulcrum {
namespace {

constexpr uint32_t kMagic = 0x53434C46;  // "FLCS"
constexpr int kMostNested = 8;

struct ShapeFormat {
    uint8_t code;  // must never change, since files contain it
    ShapeType type;
    void (*write)(const Shape& shape, ByteWriter& out, const ShapeFileScope& scope);
    ShapeResult (*read)(ByteReader& in, const ShapeFileScope& scope);
};

template <class T>
ShapeResult AsShape(const Result<std::shared_ptr<T>>& result) {
    if (!result) return result.GetError();
    return ShapePtr(result.Value());
}

void WriteSphere(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    out.Write(static_cast<const Sphere&>(shape).Radius());
}
ShapeResult ReadSphere(ByteReader& in, const ShapeFileScope&) { return AsShape(Sphere::Create(in.Get<float>())); }

void WriteBox(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    const auto& box = static_cast<const Box&>(shape);
    out.Write(box.HalfExtents());
    out.Write(box.ConvexRadius());
}
ShapeResult ReadBox(ByteReader& in, const ShapeFileScope&) {
    Vector3 halfExtents = Vector3::Zero();
    in.Read(halfExtents);
    return AsShape(Box::Create(halfExtents, in.Get<float>()));
}

void WriteCapsule(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    const auto& capsule = static_cast<const Capsule&>(shape);
    out.Write(capsule.HalfHeight());
    out.Write(capsule.Radius());
}
ShapeResult ReadCapsule(ByteReader& in, const ShapeFileScope&) {
    const float halfHeight = in.Get<float>(), radius = in.Get<float>();
    return AsShape(Capsule::Create(halfHeight, radius));
}

void WritePlane(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    const auto& plane = static_cast<const Plane&>(shape);
    out.Write(plane.Normal());
    out.Write(plane.Offset());
}
ShapeResult ReadPlane(ByteReader& in, const ShapeFileScope&) {
    Vector3 normal = Vector3::Zero();
    in.Read(normal);
    return AsShape(Plane::Create(normal, in.Get<float>()));
}

void WriteTaperedCapsule(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    const auto& capsule = static_cast<const TaperedCapsule&>(shape);
    out.Write(capsule.HalfHeight());
    out.Write(capsule.TopRadius());
    out.Write(capsule.BottomRadius());
}
ShapeResult ReadTaperedCapsule(ByteReader& in, const ShapeFileScope&) {
    const float halfHeight = in.Get<float>(), top = in.Get<float>(), bottom = in.Get<float>();
    return AsShape(TaperedCapsule::Create(halfHeight, top, bottom));
}

void WriteCylinder(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    const auto& cylinder = static_cast<const Cylinder&>(shape);
    out.Write(cylinder.HalfHeight());
    out.Write(cylinder.TopRadius());
    out.Write(cylinder.BottomRadius());
    out.Write(cylinder.ConvexRadius());
}
ShapeResult ReadCylinder(ByteReader& in, const ShapeFileScope&) {
    const float halfHeight = in.Get<float>(), top = in.Get<float>(), bottom = in.Get<float>(), radius = in.Get<float>();
    return AsShape(Cylinder::CreateTapered(halfHeight, top, bottom, radius));
}

void WriteEmpty(const Shape&, ByteWriter&, const ShapeFileScope&) {}
ShapeResult ReadEmpty(ByteReader&, const ShapeFileScope&) { return ShapePtr(EmptyShape::Create()); }

void WriteMesh(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    ShapeFileAccess::WriteMesh(static_cast<const TriangleMesh&>(shape), out);
}
ShapeResult ReadMesh(ByteReader& in, const ShapeFileScope&) { return ShapeFileAccess::ReadMesh(in); }

void WriteField(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    ShapeFileAccess::WriteField(static_cast<const HeightField&>(shape), out);
}
ShapeResult ReadField(ByteReader& in, const ShapeFileScope&) { return ShapeFileAccess::ReadField(in); }

void WriteTriangle(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    ShapeFileAccess::WriteTriangle(static_cast<const Triangle&>(shape), out);
}
ShapeResult ReadTriangle(ByteReader& in, const ShapeFileScope&) { return ShapeFileAccess::ReadTriangle(in); }

void WriteMutableCompound(const Shape& shape, ByteWriter& out, const ShapeFileScope& scope) {
    ShapeFileAccess::WriteMutableCompound(static_cast<const MutableCompound&>(shape), out, scope);
}
ShapeResult ReadMutableCompound(ByteReader& in, const ShapeFileScope& scope) {
    return ShapeFileAccess::ReadMutableCompound(in, scope);
}

// The format that knows the shape's class, and what it writes.
const CustomShapeFormat* FormatOf(const CustomConvex& shape, std::span<const CustomShapeFormat> formats,
                                  std::vector<uint8_t>& bytes) {
    for (const CustomShapeFormat& format : formats) {
        bytes.clear();
        if (format.write(shape, bytes)) return &format;
    }
    return nullptr;
}

void WriteCustom(const Shape& shape, ByteWriter& out, const ShapeFileScope& scope) {
    std::vector<uint8_t> bytes;
    const CustomShapeFormat& format = *FormatOf(static_cast<const CustomConvex&>(shape), scope.custom, bytes);
    out.Write(static_cast<uint8_t>(format.name.size()));
    for (const char c : format.name) out.Write(static_cast<uint8_t>(c));
    out.WriteWithLength([&] { out.WriteAll(std::span<const uint8_t>(bytes)); });
}

ShapeResult ReadCustom(ByteReader& in, const ShapeFileScope& scope) {
    std::vector<uint8_t> letters;
    in.ReadAll(letters, in.Get<uint8_t>());
    const std::string name(letters.begin(), letters.end());
    ByteReader block = in.ReadBlock();
    if (in.HasFailed()) return Damaged("a custom shape breaks off");
    const auto format = std::ranges::find(scope.custom, std::string_view(name), &CustomShapeFormat::name);
    if (format == scope.custom.end()) {
        return Error{ErrorCode::Unsupported,
                     Message("no format of the name \"%.100s\" is given, which a custom shape needs", name.c_str())};
    }
    ShapeResult shape = format->read(block.Rest());
    if (shape && !(shape.Value() && shape.Value()->Type() == ShapeType::Custom))
        return Error{ErrorCode::Unsupported, Message("the format \"%.100s\" reads no custom shape", name.c_str())};
    return shape;
}

// A new shape needs a line here.
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
    {12, ShapeType::Triangle, WriteTriangle, ReadTriangle},
    {13, ShapeType::MutableCompound, WriteMutableCompound, ReadMutableCompound},
    {14, ShapeType::Custom, WriteCustom, ReadCustom},
};

const ShapeFormat* FormatOf(ShapeType type) {
    const auto found = std::ranges::find(kFormats, type, &ShapeFormat::type);
    return found == std::end(kFormats) ? nullptr : found;
}

// The first shape within this one, itself included, that cannot be written.
const Shape* Unsupported(const Shape& shape, std::span<const CustomShapeFormat> custom) {
    if (!FormatOf(shape.Type())) return &shape;
    std::vector<uint8_t> bytes;
    if (shape.Type() == ShapeType::Custom && !FormatOf(static_cast<const CustomConvex&>(shape), custom, bytes))
        return &shape;
    if (!shape.IsCompound()) return nullptr;
    for (const CompoundShape::Child& child : static_cast<const CompoundShape&>(shape).Children()) {
        if (!child.shape) continue;
        if (const Shape* inside = Unsupported(*child.shape, custom)) return inside;
    }
    return nullptr;
}

Status CheckFormats(std::span<const CustomShapeFormat> custom) {
    for (const CustomShapeFormat& format : custom) {
        if (format.name.empty() || format.name.size() > 255 || !format.write || !format.read)
            return Error{ErrorCode::OutOfRange,
                         "a custom format needs a name of 1 to 255 bytes, a writer and a reader"};
    }
    return Done{};
}

// FNV-1a, 64 bits. Source: Fowler, Noll, Vo, draft-eastlake-fnv.
uint64_t Checksum(std::span<const uint8_t> bytes) {
    uint64_t hash = 0xCBF29CE484222325u;
    for (const uint8_t byte : bytes) hash = (hash ^ byte) * 0x100000001B3u;
    return hash;
}

}  // namespace

void WriteShape(const Shape& shape, ByteWriter& out, const ShapeFileScope& scope) {
    const ShapeFormat& format = *FormatOf(shape.Type());
    out.Write(format.code);
    out.WriteWithLength([&] { format.write(shape, out, scope); });
}

ShapeResult ReadShape(ByteReader& in, const ShapeFileScope& scope) {
    if (scope.depth > kMostNested) return Damaged("shapes are nested too deep");
    const uint8_t code = in.Get<uint8_t>();
    ByteReader block = in.ReadBlock();
    if (block.HasFailed()) return Damaged("it breaks off");
    const auto format = std::ranges::find(kFormats, code, &ShapeFormat::code);
    if (format == std::end(kFormats))
        return Error{ErrorCode::Unsupported, Message("shape code %d is unknown", int{code})};
    ShapeResult shape = format->read(block, scope);
    if (block.HasFailed()) return Damaged("a shape breaks off");
    if (shape && !block.IsAtEnd()) return Damaged("a shape is followed by more");
    return shape;
}

Result<std::vector<uint8_t>> SaveShape(const Shape& shape, std::span<const CustomShapeFormat> custom) {
    const DefaultFloats floats;
    if (const Status status = CheckFormats(custom); !status) return status.GetError();
    if (const Shape* other = Unsupported(shape, custom)) {
        const char* why = other->Type() == ShapeType::Custom ? ": none of the formats given knows its class" : "";
        return Error{ErrorCode::Unsupported, Message("a %s cannot be saved%s", ShapeTypeName(other->Type()), why)};
    }
    ByteWriter content;
    WriteShape(shape, content, {custom});
    ByteWriter file;
    file.Write(kMagic);
    file.Write(kShapeFileVersion);
    file.Write(uint64_t{content.Bytes().size()});
    file.Write(Checksum(content.Bytes()));
    file.Bytes().insert(file.Bytes().end(), content.Bytes().begin(), content.Bytes().end());
    return std::move(file.Bytes());
}

ShapeResult LoadShape(std::span<const uint8_t> bytes, std::span<const CustomShapeFormat> custom) {
    const DefaultFloats floats;
    if (const Status status = CheckFormats(custom); !status) return status.GetError();
    ByteReader in(bytes);
    if (in.Get<uint32_t>() != kMagic || in.HasFailed()) return Error{ErrorCode::Unsupported, "this is no shape file"};
    const uint32_t version = in.Get<uint32_t>();
    if (version != kShapeFileVersion) {
        return Error{ErrorCode::Unsupported,
                     Message("shape file of version %u: this is %u", version, kShapeFileVersion)};
    }
    const uint64_t length = in.Get<uint64_t>(), checksum = in.Get<uint64_t>();
    if (in.HasFailed() || length != in.Rest().size()) return Damaged("its length is not what it says");
    if (checksum != Checksum(in.Rest())) return Damaged("its checksum is wrong");
    ShapeResult shape = ReadShape(in, {custom});
    if (shape && !in.IsAtEnd()) return Damaged("the shape is followed by more");
    return shape;
}

}  // namespace fulcrum
