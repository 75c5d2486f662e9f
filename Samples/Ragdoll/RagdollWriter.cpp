// Writing of RagdollJson.h.
#include <Fulcrum/Samples/Ragdoll/RagdollJson.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Samples/Ragdoll/RagdollFields.h>

#include <nlohmann/json.hpp>

#include <charconv>
#include <cmath>
#include <fstream>
#include <type_traits>

namespace fulcrum {

namespace {

using Json = nlohmann::ordered_json;

// The double whose shortest text is also that of the float: 0.1, not 0.10000000149.
double AsShort(float x) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, x).ptr;
    double result = x;
    std::from_chars(text, end, result);
    return static_cast<float>(result) == x ? result : x;
}

template <class T>
Json Written(const T& value);

// Writes all the fields of one object.
class Writer {
public:
    template <class T>
    void Field(const char* name, const T& value) {
        node[name] = Written(value);
    }
    template <class E, class Names>
    void Choice(const char* name, const E& value, const Names& names) {
        node[name] = names[static_cast<size_t>(value)];
    }
    Json node = Json::object();
};

Json ShapeWritten(const Shape& shape) {
    Writer fields;
    if (shape.Type() == ShapeType::Sphere) {
        fields.Field("kind", std::string("Sphere"));
        fields.Field("radius", static_cast<const Sphere&>(shape).Radius());
    } else if (shape.Type() == ShapeType::Box) {
        fields.Field("kind", std::string("Box"));
        fields.Field("halfExtents", static_cast<const Box&>(shape).HalfExtents());
        if (const float radius = static_cast<const Box&>(shape).ConvexRadius(); radius > 0)
            fields.Field("convexRadius", radius);
    } else if (shape.Type() == ShapeType::Capsule) {
        fields.Field("kind", std::string("Capsule"));
        fields.Field("halfHeight", static_cast<const Capsule&>(shape).HalfHeight());
        fields.Field("radius", static_cast<const Capsule&>(shape).Radius());
    } else {
        fields.Field("kind", std::string("ConvexHull"));
        fields.node["points"] = Json::array();
        for (const Vector3& vertex : static_cast<const ConvexHull&>(shape).Vertices())
            fields.node["points"].push_back(Written(Vector3(vertex + shape.Mass().centerOfMass)));
    }
    return fields.node;
}

// The shape's kind must be one that can be written.
bool CanBeWritten(const Shape& shape) {
    switch (shape.Type()) {
        case ShapeType::Sphere:
        case ShapeType::Box:
        case ShapeType::Capsule: return true;
        case ShapeType::ConvexHull: return static_cast<const ConvexHull&>(shape).ConvexRadius() == 0.0f;
        default: return false;
    }
}

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

template <class T>
Json Written(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
        if (std::isinf(value)) return value > 0 ? "infinity" : "-infinity";
        if constexpr (std::is_same_v<T, float>) return AsShort(value);
        else return value;
    } else if constexpr (std::is_same_v<T, Vector3> || std::is_same_v<T, Position>) {
        return Json::array({Written(value.x()), Written(value.y()), Written(value.z())});
    } else if constexpr (std::is_same_v<T, Quaternion>) {
        return Json::array({Written(value.x), Written(value.y), Written(value.z), Written(value.w)});
    } else if constexpr (std::is_same_v<T, LockedAxes>) {
        return static_cast<uint8_t>(value);
    } else if constexpr (IsOptional<T>::value) {
        return value ? Written(*value) : Json();
    } else if constexpr (std::is_same_v<T, ShapePtr>) {
        return value ? ShapeWritten(*value) : Json();
    } else if constexpr (std::is_integral_v<T> || std::is_same_v<T, std::string>) {
        return value;
    } else {
        Writer fields;
        Describe(fields, const_cast<T&>(value));  // writing changes nothing
        return fields.node;
    }
}

// Removes fields that equal those in `usual`, and empty ones.
void Shorten(Json& node, const Json& usual) {
    for (auto field = node.begin(); field != node.end();) {
        const auto other = usual.find(field.key());
        if (field->is_null() || (other != usual.end() && *field == *other)) {
            field = node.erase(field);
            continue;
        }
        if (field->is_object()) Shorten(*field, other != usual.end() && other->is_object() ? *other : Json::object());
        ++field;
    }
}

template <class T>
Json ShortlyWritten(const T& value) {
    Json node = Written(value);
    Shorten(node, Written(T{}));
    return node;
}

}  // namespace

Result<Json> RagdollToJson(const RagdollSettings& settings) {
    if (MaybeError e = Check(settings)) return *e;
    Json parts = Json::array();
    for (size_t i = 0; i < settings.parts.size(); ++i) {
        const RagdollPart& part = settings.parts[i];
        const std::string path = "parts[" + std::to_string(i) + "].";
        if (!CanBeWritten(*part.body.shape))
            return WrongAt(path + "body.shape", std::string("a ") + ShapeTypeName(part.body.shape->Type()) +
                                                    (part.body.shape->IsConvex() ? " with a convex radius" : "") +
                                                    " cannot be written");
        Json node = {{"name", part.name}};
        if (i > 0) node["parent"] = settings.parts[static_cast<size_t>(part.parent)].name;
        node["body"] = ShortlyWritten(part.body);
        if (i > 0) {
            Json joint = {{"kind", kJointKindNames[part.joint.index()]}};
            joint.update(std::visit([](const auto& ofKind) { return ShortlyWritten(ofKind); }, part.joint));
            node["joint"] = std::move(joint);
        }
        parts.push_back(std::move(node));
    }
    return Json{{"parts", std::move(parts)}};
}

Status WriteRagdoll(const std::string& file, const RagdollSettings& settings) {
    const Result<Json> document = RagdollToJson(settings);
    if (!document) return document.GetError();
    std::ofstream stream(file);
    // One part per line.
    const char* before = "{\"parts\": [\n  ";
    for (const Json& part : document.Value()["parts"]) {
        stream << before << part.dump();
        before = ",\n  ";
    }
    stream << "\n]}\n";
    stream.close();
    if (!stream) return WrongAt(file, "it cannot be written");
    return Done{};
}

}  // namespace fulcrum
