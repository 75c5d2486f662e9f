// Reading of RagdollJson.h.
#include <Fulcrum/Samples/Ragdoll/RagdollJson.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Samples/Ragdoll/RagdollFields.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <type_traits>
#include <utility>

namespace fulcrum {

namespace {

using Json = nlohmann::ordered_json;

template <class Names>
std::string ListOf(const Names& names) {
    std::string list;
    for (const auto& name : names) list += (list.empty() ? "" : ", ") + std::string(name);
    return list;
}

// Reads the fields of one object; keeps the first error of the whole document.
class Reader {
public:
    Reader(const Json& node, std::string path, MaybeError& error) : node_(node), path_(std::move(path)), error_(error) {
        if (!node_.is_object()) Fail(path_, "an object");
    }

    template <class T>
    void Field(const char* name, T& value) {
        if (const Json* field = Find(name)) Read(*field, PathOf(name), value);
    }

    template <class E, class Names>
    void Choice(const char* name, E& value, const Names& names) {
        const Json* field = Find(name);
        if (!field) return;
        std::string text;
        Read(*field, PathOf(name), text);
        if (error_) return;
        const auto found = std::find(names.begin(), names.end(), text);
        if (found != names.end()) value = static_cast<E>(found - names.begin());
        else error_ = WrongAt(PathOf(name), "\"" + text + "\"; it must be one of " + ListOf(names));
    }

    // Null where it is left out, or after an error.
    const Json* Find(const char* name) {
        known_.emplace_back(name);
        if (error_) return nullptr;
        const auto found = node_.find(name);
        return found == node_.end() ? nullptr : &*found;
    }
    std::string PathOf(const std::string& name) const { return path_.empty() ? name : path_ + "." + name; }

    // After all fields: remaining names are unknown.
    void Finish() {
        if (error_) return;
        for (const auto& [name, value] : node_.items()) {
            if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
            error_ = WrongAt(PathOf(name), "an unknown name; known are " + ListOf(known_));
            return;
        }
    }

    template <class T>
    void Read(const Json& node, const std::string& path, T& value) {
        if (error_) return;
        if constexpr (std::is_same_v<T, bool>) {
            if (node.is_boolean()) value = node.get<bool>();
            else Fail(path, "true or false");
        } else if constexpr (std::is_same_v<T, std::string>) {
            if (node.is_string()) value = node.get<std::string>();
            else Fail(path, "a string", &node);
        } else if constexpr (std::is_floating_point_v<T>) {
            if (node.is_number()) value = static_cast<T>(node.get<double>());
            else if (node == "infinity") value = std::numeric_limits<T>::infinity();
            else if (node == "-infinity") value = -std::numeric_limits<T>::infinity();
            else Fail(path, "a number", &node);
        } else if constexpr (std::is_same_v<T, LockedAxes>) {
            uint8_t bits = static_cast<uint8_t>(value);
            Read(node, path, bits);
            value = static_cast<LockedAxes>(bits);
        } else if constexpr (std::is_integral_v<T>) {
            ReadInteger(node, path, value);
        } else {
            ReadMore(node, path, value);
        }
    }

private:
    void Fail(const std::string& path, const char* expected, const Json* node = nullptr) {
        error_ = WrongAt(path, (node ? std::string("of type ") + node->type_name() + "; it" : std::string("it")) +
                                   " must be " + expected);
    }

    template <class T>
    void ReadInteger(const Json& node, const std::string& path, T& value) {
        constexpr T kLow = std::numeric_limits<T>::min(), kHigh = std::numeric_limits<T>::max();
        if (node.is_number_unsigned() && std::in_range<T>(node.get<uint64_t>())) {
            value = static_cast<T>(node.get<uint64_t>());
        } else if (node.is_number_integer() && !node.is_number_unsigned() && std::in_range<T>(node.get<int64_t>())) {
            value = static_cast<T>(node.get<int64_t>());
        } else {
            const std::string range = "a whole number from " + std::to_string(kLow) + " to " + std::to_string(kHigh);
            Fail(path, range.c_str(), &node);
        }
    }

    bool IsArray(const Json& node, const std::string& path, size_t size) {
        if (node.is_array() && node.size() == size) return true;
        const std::string expected = "an array of " + std::to_string(size) + " numbers";
        Fail(path, expected.c_str());
        return false;
    }
    template <class Real>
    void ReadMore(const Json& node, const std::string& path, Vec3<Real>& value) {
        if (!IsArray(node, path, 3)) return;
        for (int k = 0; k < 3; ++k) Read(node[static_cast<size_t>(k)], path + "[" + std::to_string(k) + "]", value[k]);
    }
    void ReadMore(const Json& node, const std::string& path, Quaternion& value) {
        if (!IsArray(node, path, 4)) return;
        float* const numbers[] = {&value.x, &value.y, &value.z, &value.w};
        for (size_t k = 0; k < 4; ++k) Read(node[k], path + "[" + std::to_string(k) + "]", *numbers[k]);
    }
    template <class T>
    void ReadMore(const Json& node, const std::string& path, std::optional<T>& value) {
        value.reset();
        if (node.is_null()) return;
        value.emplace();
        if constexpr (std::is_same_v<T, Vector3>) value->setZero();
        Read(node, path, *value);
    }
    void ReadMore(const Json& node, const std::string& path, ShapePtr& value);
    void ReadMore(const Json& node, const std::string& path, RagdollJoint& value) {
        Reader fields(node, path, error_);
        size_t kind = 0;
        if (!error_ && !node.contains("kind"))
            error_ = WrongAt(path, "kind is missing; it must be one of " + ListOf(kJointKindNames));
        fields.Choice("kind", kind, kJointKindNames);
        if (error_) return;
        [&]<size_t... kinds>(std::index_sequence<kinds...>) {
            ((kind == kinds ? void(value.emplace<kinds>()) : void()), ...);
        }
        (std::make_index_sequence<std::variant_size_v<RagdollJoint>>());
        std::visit([&](auto& joint) { Describe(fields, joint); }, value);
        fields.Finish();
    }
    template <class T>
    void ReadMore(const Json& node, const std::string& path, std::vector<T>& values) {
        if (!node.is_array()) return Fail(path, "an array", &node);
        for (size_t i = 0; i < node.size(); ++i) {
            T value;
            Read(node[i], path + "[" + std::to_string(i) + "]", value);
            values.push_back(std::move(value));
        }
    }
    template <class T>
    requires requires(Reader& archive, T& value) { Describe(archive, value); }
    void ReadMore(const Json& node, const std::string& path, T& value) {
        Reader fields(node, path, error_);
        Describe(fields, value);
        fields.Finish();
    }

    const Json& node_;
    std::string path_;
    MaybeError& error_;
    std::vector<std::string> known_;
};

constexpr std::array kShapeKindNames = {"Sphere", "Box", "Capsule", "ConvexHull"};

void Reader::ReadMore(const Json& node, const std::string& path, ShapePtr& value) {
    Reader fields(node, path, error_);
    if (!error_ && !node.contains("kind"))
        error_ = WrongAt(path, "kind is missing; it must be one of " + ListOf(kShapeKindNames));
    size_t kind = 0;
    fields.Choice("kind", kind, kShapeKindNames);
    float radius = 0, halfHeight = 0, convexRadius = 0;
    Vector3 halfExtents = Vector3::Zero();
    std::vector<Vector3> points;
    if (kind == 0 || kind == 2) fields.Field("radius", radius);
    if (kind == 1) fields.Field("halfExtents", halfExtents);
    if (kind == 1) fields.Field("convexRadius", convexRadius);
    if (kind == 2) fields.Field("halfHeight", halfHeight);
    if (kind == 3) fields.Field("points", points);
    fields.Finish();
    if (error_) return;
    const auto keep = [&](const auto& shape) {
        if (shape) value = shape.Value();
        else error_ = Error{shape.GetError().code, path + ": " + shape.GetError().message};
    };
    if (kind == 0) keep(Sphere::Create(radius));
    if (kind == 1) keep(Box::Create(halfExtents, convexRadius));
    if (kind == 2) keep(Capsule::Create(halfHeight, radius));
    if (kind == 3) keep(ConvexHull::Create(points));
}

}  // namespace

Result<RagdollSettings> RagdollFromJson(const Json& document) {
    MaybeError error;
    RagdollSettings settings;
    Reader root(document, "", error);
    const Json* parts = root.Find("parts");
    root.Finish();
    if (error) return *error;
    if (!parts || !parts->is_array()) return WrongAt("parts", "it must be an array");
    for (size_t i = 0; i < parts->size(); ++i) {
        RagdollPart part;
        Reader fields((*parts)[i], "parts[" + std::to_string(i) + "]", error);
        fields.Field("name", part.name);
        fields.Field("body", part.body);
        if (const Json* parent = fields.Find("parent")) {
            std::string name;
            fields.Read(*parent, fields.PathOf("parent"), name);
            const auto found = std::find_if(settings.parts.begin(), settings.parts.end(),
                                            [&](const RagdollPart& p) { return p.name == name; });
            part.parent = static_cast<int>(found - settings.parts.begin());
            if (found == settings.parts.end() && !error)
                error = WrongAt(fields.PathOf("parent"), "no part before has the name \"" + name + "\"");
        }
        if (const Json* joint = fields.Find("joint")) fields.Read(*joint, fields.PathOf("joint"), part.joint);
        else if (i > 0 && !error) error = WrongAt(fields.PathOf("joint"), "missing; only the first part has none");
        fields.Finish();
        if (error) return *error;
        settings.parts.push_back(std::move(part));
    }
    if (MaybeError e = Check(settings)) return *e;
    return settings;
}

Result<RagdollSettings> ReadRagdoll(const std::string& file) {
    std::ifstream stream(file);
    if (!stream) return WrongAt(file, "it cannot be opened");
    Result<RagdollSettings> settings = Error{ErrorCode::Unsupported, ""};
    try {
        settings = RagdollFromJson(Json::parse(stream));
    } catch (const Json::parse_error& error) {
        return WrongAt(file, error.what());
    }
    if (!settings) return Error{settings.GetError().code, file + ": " + settings.GetError().message};
    return settings;
}

}  // namespace fulcrum
