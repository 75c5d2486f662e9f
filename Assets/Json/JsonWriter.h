// Writes settings as JSON: an archive for SettingsFields.h. Pure functions.
#pragma once

#include <Fulcrum/Assets/Json/JsonNames.h>
#include <Fulcrum/Physics/SettingsFields.h>

#include <nlohmann/json.hpp>

#include <charconv>
#include <cmath>
#include <exception>
#include <string>
#include <type_traits>
#include <utility>

namespace fulcrum {

using Json = nlohmann::ordered_json;

// Only a shape that CanBeWritten (ShapeJson.h).
Json ShapeWritten(const Shape& shape);

// The double whose shortest text is also that of the float: 0.1, not 0.10000000149.
inline double AsShort(float x) {
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, x).ptr;
    double result = x;
    std::from_chars(text, end, result);
    return static_cast<float>(result) == x ? result : x;
}

// Thrown where a setting has a value that no document has: not a number, an enumerator that does not exist, nothing. It
// says which; who writes a document returns it as an Error.
class CannotBeWritten : public std::exception {
public:
    explicit CannotBeWritten(std::string text) : text_(std::move(text)) {}
    CannotBeWritten In(const std::string& field) const {
        return CannotBeWritten(field + (text_.starts_with(' ') ? "" : ".") + text_);
    }
    const char* what() const noexcept override { return text_.c_str(); }

private:
    std::string text_;
};

template <class T>
Json Written(const T& value);

// Writes all the fields of one object.
class JsonWriter {
public:
    template <class T>
    void Field(const char* name, const T& value) {
        try {
            node[name] = Written(value);
        } catch (const CannotBeWritten& inside) {
            throw inside.In(name);
        }
    }
    template <class E, class Names>
    void Choice(const char* name, const E& value, const Names& names) {
        const auto number = static_cast<size_t>(value);
        if (number >= names.size())
            throw CannotBeWritten(" is " + std::to_string(number) + ", which is none of its values").In(name);
        node[name] = names[number];
    }
    Json node = Json::object();
};

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsList : std::false_type {};
template <class T>
struct IsList<std::vector<T>> : std::true_type {};
template <class T, size_t kSize>
struct IsList<std::array<T, kSize>> : std::true_type {};

template <class T>
Json Written(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
        if (std::isnan(value)) throw CannotBeWritten(" is not a number");
        if (std::isinf(value)) return value > 0 ? "infinity" : "-infinity";
        if constexpr (std::is_same_v<T, float>) return AsShort(value);
        else return value;
    } else if constexpr (std::is_same_v<T, Vector3> || std::is_same_v<T, Position>) {
        return Json::array({Written(value.x()), Written(value.y()), Written(value.z())});
    } else if constexpr (std::is_same_v<T, Quaternion>) {
        return Json::array({Written(value.x), Written(value.y), Written(value.z), Written(value.w)});
    } else if constexpr (std::is_same_v<T, LockedAxes> || std::is_same_v<T, SensorSees>) {
        return static_cast<uint8_t>(value);
    } else if constexpr (IsOptional<T>::value) {
        return value ? Written(*value) : Json();
    } else if constexpr (IsList<T>::value) {
        Json list = Json::array();
        for (const auto& element : value) list.push_back(Written(element));
        return list;
    } else if constexpr (std::is_same_v<T, ShapePtr>) {
        return value ? ShapeWritten(*value) : Json();
    } else if constexpr (std::is_same_v<T, std::shared_ptr<const Path>>) {
        if (!value) throw CannotBeWritten(" is null");
        JsonWriter fields;
        fields.Field("isClosed", value->IsClosed());
        fields.Field("points", std::vector<PathPoint>(value->Points().begin(), value->Points().end()));
        return fields.node;
    } else if constexpr (std::is_integral_v<T> || std::is_same_v<T, std::string>) {
        return value;
    } else {
        JsonWriter fields;
        Describe(fields, const_cast<T&>(value));  // writing changes nothing
        return fields.node;
    }
}

// Removes fields that equal those in `usual`, and empty ones that it does not have.
inline void Shorten(Json& node, const Json& usual) {
    for (auto field = node.begin(); field != node.end();) {
        const auto other = usual.find(field.key());
        if (other == usual.end() ? field->is_null() : *field == *other) {
            field = node.erase(field);
            continue;
        }
        if (field->is_object()) Shorten(*field, other != usual.end() && other->is_object() ? *other : Json::object());
        ++field;
    }
}

// Without what equals the defaults.
template <class T>
Json ShortlyWritten(const T& value) {
    Json node = Written(value);
    Shorten(node, Written(T{}));
    return node;
}

// A variant of joint settings.
template <class Joint>
Json JointWritten(const Joint& joint) {
    if (joint.valueless_by_exception()) throw CannotBeWritten("settings has no kind of joint");
    Json node = {{"kind", kJointKindNames<Joint>[joint.index()]}};
    node.update(std::visit([](const auto& ofKind) { return ShortlyWritten(ofKind); }, joint));
    return node;
}

}  // namespace fulcrum
