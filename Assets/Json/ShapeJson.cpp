#include <Fulcrum/Assets/Json/ShapeJson.h>

#include <Fulcrum/Assets/Json/Base64.h>
#include <Fulcrum/Assets/Json/JsonWriter.h>
#include <Fulcrum/Assets/Meshes/MeshImport.h>
#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/EmptyShape.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

namespace fulcrum {

// ---- Reading

template <class Archive>
void Describe(Archive& archive, CompoundShape::ChildSettings& s) {
    archive.Field("shape", s.shape);
    archive.Field("position", s.position);
    archive.Field("rotation", s.rotation);
    archive.Field("density", s.density);
}

namespace {

template <class T>
T Read(JsonReader& fields, const char* name, T usual = {}) {
    fields.Field(name, usual);
    return usual;
}
Vector3 ReadVector(JsonReader& fields, const char* name, const Vector3& usual = Vector3::Zero()) {
    return Read(fields, name, Vector3(usual));
}

void TakeChildren(uint64_t count, const std::string& path, JsonDocument& document) {
    if (document.error) return;
    if (const MaybeError e = TakeFrom(document.budget.children, count, kMostChildren, "children of compounds"))
        document.error = Error{e->code, path + ": " + e->message};
}

// Counts the bytes of a file that the document names.
std::filesystem::path NamedFile(JsonReader& fields) {
    const std::filesystem::path file = fields.Document().folder / Read<std::string>(fields, "file");
    std::error_code ignored;
    const uint64_t size =
        std::filesystem::is_regular_file(file, ignored) ? std::filesystem::file_size(file, ignored) : 0;
    if (fields.Document().error) return file;
    const MaybeError e = TakeFrom(fields.Document().budget.namedBytes, size, kMostNamedBytes, "bytes of files");
    if (e) fields.Document().error = Error{e->code, fields.Where() + ": " + e->message};
    return file;
}

ShapePtr Kept(JsonReader& fields, auto&& created) {
    if (fields.Document().error) return nullptr;
    if (created) return created.Value();
    fields.Document().error = Error{created.GetError().code, fields.Where() + ": " + created.GetError().message};
    return nullptr;
}

ShapePtr ReadSphere(JsonReader& fields) { return Kept(fields, Sphere::Create(Read<float>(fields, "radius"))); }

ShapePtr ReadBox(JsonReader& fields) {
    const Vector3 half = ReadVector(fields, "halfExtents");
    return Kept(fields, Box::Create(half, Read<float>(fields, "convexRadius")));
}

ShapePtr ReadCapsule(JsonReader& fields) {
    const float half = Read<float>(fields, "halfHeight");
    return Kept(fields, Capsule::Create(half, Read<float>(fields, "radius")));
}

ShapePtr ReadTaperedCapsule(JsonReader& fields) {
    const float half = Read<float>(fields, "halfHeight"), top = Read<float>(fields, "topRadius"),
                bottom = Read<float>(fields, "bottomRadius");
    return Kept(fields, TaperedCapsule::Create(half, top, bottom));
}

ShapePtr ReadCylinder(JsonReader& fields) {
    const float half = Read<float>(fields, "halfHeight"), radius = Read<float>(fields, "radius"),
                top = Read<float>(fields, "topRadius", radius), bottom = Read<float>(fields, "bottomRadius", radius),
                convexRadius = Read<float>(fields, "convexRadius");
    if (top == 0 && bottom > 0) return Kept(fields, Cylinder::CreateCone(half, bottom, convexRadius));
    if (top == bottom) return Kept(fields, Cylinder::Create(half, top, convexRadius));
    return Kept(fields, Cylinder::CreateTapered(half, top, bottom, convexRadius));
}

ShapePtr ReadConvexHull(JsonReader& fields) {
    const auto points = Read<std::vector<Vector3>>(fields, "points");
    ConvexHullSettings settings;
    settings.maxVertices = Read(fields, "maxVertices", settings.maxVertices);
    settings.convexRadius = Read(fields, "convexRadius", settings.convexRadius);
    return Kept(fields, ConvexHull::Create(points, settings));
}

ShapePtr ReadPlane(JsonReader& fields) {
    const Vector3 normal = ReadVector(fields, "normal", Vector3(0, 1, 0));
    return Kept(fields, Plane::Create(normal, Read<float>(fields, "offset")));
}

ShapePtr ReadTriangleMesh(JsonReader& fields) {
    const auto vertices = Read<std::vector<Vector3>>(fields, "vertices");
    const auto indices = Read<std::vector<uint32_t>>(fields, "indices");
    TriangleMeshSettings settings{.vertices = vertices, .indices = indices};
    settings.isTwoSided = Read(fields, "isTwoSided", settings.isTwoSided);
    settings.activeEdgeCosine = Read(fields, "activeEdgeCosine", settings.activeEdgeCosine);
    return Kept(fields, TriangleMesh::Create(settings));
}

ShapePtr ReadHeightField(JsonReader& fields) {
    const auto heights = Read<std::vector<float>>(fields, "heights");
    HeightFieldSettings settings{.heights = heights};
    settings.sampleCountX = Read(fields, "sampleCountX", settings.sampleCountX);
    settings.sampleCountZ = Read(fields, "sampleCountZ", settings.sampleCountZ);
    settings.cellSizeX = Read(fields, "cellSizeX", settings.cellSizeX);
    settings.cellSizeZ = Read(fields, "cellSizeZ", settings.cellSizeZ);
    settings.origin = ReadVector(fields, "origin", settings.origin);
    settings.isTwoSided = Read(fields, "isTwoSided", settings.isTwoSided);
    return Kept(fields, HeightField::Create(settings));
}

// Children that are compounds count as theirs.
size_t ChildrenOf(const Shape* shape) {
    return shape && shape->IsCompound() ? static_cast<const CompoundShape*>(shape)->Children().size() : 0;
}

template <class AnyCompound>
ShapePtr ReadAnyCompound(JsonReader& fields) {
    const auto children = Read<std::vector<CompoundShape::ChildSettings>>(fields, "children");
    uint64_t count = 0;
    for (const CompoundShape::ChildSettings& child : children)
        count += std::max<size_t>(ChildrenOf(child.shape.get()), 1);
    TakeChildren(count, fields.Where(), fields.Document());
    if (fields.Document().error) return nullptr;
    return Kept(fields, AnyCompound::Create(children));
}

ShapePtr ReadEmpty(JsonReader&) { return EmptyShape::Create(); }

ShapePtr ReadHullFile(JsonReader& fields) {
    const std::filesystem::path file = NamedFile(fields);
    const double size = Read<double>(fields, "size", 1);
    if (fields.Document().error) return nullptr;
    const Result<ImportedShape> imported = ImportShape(file, size);
    return Kept(fields, imported ? Result<ShapePtr>(imported.Value().shape) : Result<ShapePtr>(imported.GetError()));
}

ShapePtr ReadMeshFile(JsonReader& fields) {
    const std::filesystem::path file = NamedFile(fields);
    MeshImportSettings settings;
    settings.size = Read(fields, "size", settings.size);
    settings.scale = Read(fields, "scale", settings.scale);
    if (fields.Document().error) return nullptr;
    const Result<ImportedMesh> imported = ImportMesh(file, settings);
    return Kept(fields, imported ? Result<ShapePtr>(imported.Value().mesh) : Result<ShapePtr>(imported.GetError()));
}

ShapePtr ReadBaked(JsonReader& fields) {
    const std::optional<std::vector<uint8_t>> bytes = FromBase64(Read<std::string>(fields, "base64"));
    if (!bytes) return Kept(fields, Result<ShapePtr>(Error{ErrorCode::Unsupported, "base64 is none"}));
    return Kept(fields, LoadShape(*bytes));
}

struct ShapeKind {
    const char* name;
    ShapePtr (*read)(JsonReader& fields);
};
constexpr ShapeKind kShapeKinds[] = {{"Sphere", ReadSphere},
                                     {"Box", ReadBox},
                                     {"Capsule", ReadCapsule},
                                     {"TaperedCapsule", ReadTaperedCapsule},
                                     {"Cylinder", ReadCylinder},
                                     {"ConvexHull", ReadConvexHull},
                                     {"Plane", ReadPlane},
                                     {"TriangleMesh", ReadTriangleMesh},
                                     {"HeightField", ReadHeightField},
                                     {"Compound", ReadAnyCompound<Compound>},
                                     {"MutableCompound", ReadAnyCompound<MutableCompound>},
                                     {"Empty", ReadEmpty},
                                     {"HullFile", ReadHullFile},
                                     {"MeshFile", ReadMeshFile},
                                     {"Baked", ReadBaked}};
constexpr auto kShapeKindNames = [] {
    std::array<const char*, std::size(kShapeKinds)> names{};
    for (size_t i = 0; i < names.size(); ++i) names[i] = kShapeKinds[i].name;
    return names;
}();

}  // namespace

void TakeChildren(const Shape* shape, const std::string& path, JsonDocument& document) {
    TakeChildren(ChildrenOf(shape), path, document);
}

std::span<const char* const> ShapeKindNames() { return kShapeKindNames; }

void JsonReader::ReadMore(const Json& node, const std::string& path, ShapePtr& value) {
    if (node.is_null()) return value.reset();
    if (node.is_string()) {
        const auto found = document_.shapes.find(node.get<std::string>());
        if (found != document_.shapes.end()) value = found->second;
        else error_ = WrongAt(path, "no shape has the name \"" + node.get<std::string>() + "\"");
        return;
    }
    // Documents that a program made have not been counted.
    if (document_.levels >= DocumentLimits().levels) error_ = WrongAt(path, "shapes are nested too deep");
    if (error_) return;
    JsonReader fields(node, path, document_);
    if (!error_ && !node.contains("kind"))
        error_ = WrongAt(path, "kind is missing; it must be one of " + ListOf(kShapeKindNames));
    size_t kind = 0;
    fields.Choice("kind", kind, kShapeKindNames);
    if (error_) return;
    ++document_.levels;
    ShapePtr shape = kShapeKinds[kind].read(fields);
    --document_.levels;
    fields.Finish();
    if (!error_) value = std::move(shape);
}

void JsonReader::ReadMore(const Json& node, const std::string& path, std::shared_ptr<const Path>& value) {
    JsonReader fields(node, path, document_);
    bool isClosed = value->IsClosed();
    std::vector<PathPoint> points;
    fields.Field("isClosed", isClosed);
    fields.Field("points", points);
    fields.Finish();
    if (error_) return;
    if (!node.contains("points")) points.assign(value->Points().begin(), value->Points().end());
    const auto created = Path::Hermite(points, isClosed);
    if (created) value = created.Value();
    else error_ = Error{created.GetError().code, path + ": " + created.GetError().message};
}

// ---- Writing

bool CanBeWrittenByKind(const Shape& shape) {
    switch (shape.Type()) {
        case ShapeType::Sphere:
        case ShapeType::Box:
        case ShapeType::Capsule: return true;
        case ShapeType::ConvexHull: return static_cast<const ConvexHull&>(shape).ConvexRadius() == 0.0f;
        default: return false;
    }
}

namespace {

// By its kind; null where it has no such form.
Json WrittenByKind(const Shape& shape) {
    JsonWriter fields;
    const auto kind = [&](const char* name) { fields.Field("kind", std::string(name)); };
    const auto convexRadius = [&](float radius) {
        if (radius > 0) fields.Field("convexRadius", radius);
    };
    const auto children = [&](const CompoundShape& compound) {
        fields.node["children"] = Json::array();
        for (const CompoundShape::ChildSettings& child : compound.Settings())
            fields.node["children"].push_back(ShortlyWritten(child));
    };
    switch (shape.Type()) {
        case ShapeType::Sphere:
            kind("Sphere");
            fields.Field("radius", static_cast<const Sphere&>(shape).Radius());
            break;
        case ShapeType::Box:
            kind("Box");
            fields.Field("halfExtents", static_cast<const Box&>(shape).HalfExtents());
            convexRadius(static_cast<const Box&>(shape).ConvexRadius());
            break;
        case ShapeType::Capsule:
            kind("Capsule");
            fields.Field("halfHeight", static_cast<const Capsule&>(shape).HalfHeight());
            fields.Field("radius", static_cast<const Capsule&>(shape).Radius());
            break;
        case ShapeType::TaperedCapsule:
            kind("TaperedCapsule");
            fields.Field("halfHeight", static_cast<const TaperedCapsule&>(shape).HalfHeight());
            fields.Field("topRadius", static_cast<const TaperedCapsule&>(shape).TopRadius());
            fields.Field("bottomRadius", static_cast<const TaperedCapsule&>(shape).BottomRadius());
            break;
        case ShapeType::Cylinder: {
            const auto& cylinder = static_cast<const Cylinder&>(shape);
            kind("Cylinder");
            fields.Field("halfHeight", cylinder.HalfHeight());
            if (cylinder.TopRadius() == cylinder.BottomRadius()) {
                fields.Field("radius", cylinder.TopRadius());
            } else {
                fields.Field("topRadius", cylinder.TopRadius());
                fields.Field("bottomRadius", cylinder.BottomRadius());
            }
            convexRadius(cylinder.ConvexRadius());
            break;
        }
        case ShapeType::ConvexHull:
            if (!CanBeWrittenByKind(shape)) return {};
            kind("ConvexHull");
            fields.node["points"] = Json::array();
            for (const Vector3& vertex : static_cast<const ConvexHull&>(shape).Vertices())
                fields.node["points"].push_back(Written(Vector3(vertex + shape.Mass().centerOfMass)));
            break;
        case ShapeType::Plane:
            kind("Plane");
            fields.Field("normal", static_cast<const Plane&>(shape).Normal());
            fields.Field("offset", static_cast<const Plane&>(shape).Offset());
            break;
        case ShapeType::Compound:
            kind("Compound");
            children(static_cast<const CompoundShape&>(shape));
            break;
        case ShapeType::MutableCompound:
            kind("MutableCompound");
            children(static_cast<const CompoundShape&>(shape));
            break;
        case ShapeType::Empty: kind("Empty"); break;
        case ShapeType::Triangle:
        case ShapeType::Custom:
        case ShapeType::TriangleMesh:
        case ShapeType::HeightField: return {};
    }
    return fields.node;
}

}  // namespace

Json ShapeWritten(const Shape& shape) { return WrittenByKind(shape); }

Result<Json> ShapeToJson(const ShapePtr& shape) {
    const Result<std::vector<uint8_t>> bytes = SaveShape(*shape);
    if (!bytes) return bytes.GetError();
    // Children that have no form of their own make the whole compound baked.
    if (Json node = WrittenByKind(*shape); !node.is_null()) {
        JsonDocument document;
        ShapePtr again;
        const Json none = Json::object();
        JsonReader root(none, "", document);
        root.Read(node, "", again);
        if (!document.error && again) {
            const Result<std::vector<uint8_t>> same = SaveShape(*again);
            if (same && same.Value() == bytes.Value()) return node;
        }
    }
    return Json{{"kind", "Baked"},
                {"base64", ToBase64({reinterpret_cast<const char*>(bytes.Value().data()), bytes.Value().size()})}};
}

}  // namespace fulcrum
