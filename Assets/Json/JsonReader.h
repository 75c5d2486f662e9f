// Reads settings from JSON: an archive for SettingsFields.h. One thread.
#pragma once

#include <Fulcrum/Assets/Json/JsonLimits.h>
#include <Fulcrum/Assets/Json/JsonNames.h>
#include <Fulcrum/Physics/SettingsFields.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>

namespace fulcrum {

using Json = nlohmann::ordered_json;

template <class Names>
std::string ListOf(const Names& names) {
    std::string list;
    for (const auto& name : names) list += (list.empty() ? "" : ", ") + std::string(name);
    return list;
}

// What a document may still ask for, with all that it names (JsonLimits.h).
struct JsonBudget {
    uint64_t children = kMostChildren;
    uint64_t namedBytes = kMostNamedBytes;
};

// What is the same for a whole document.
struct JsonDocument {
    MaybeError error;                        // the first
    std::map<std::string, ShapePtr> shapes;  // that bodies may name
    std::filesystem::path folder;            // to which names of other files are relative
    std::vector<std::string> notes;          // on names that earlier versions had
    JsonBudget budget;
    int levels = 0;  // of shapes within shapes
};

// Reads the fields of one object. Errors name the path in the document.
class JsonReader {
public:
    JsonReader(const Json& node, std::string path, JsonDocument& document)
        : node_(node), path_(std::move(path)), document_(document), error_(document.error) {
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
    const std::string& Where() const { return path_; }
    JsonDocument& Document() { return document_; }

    // After all fields: remaining names are unknown.
    void Finish() {
        if (error_) return;
        for (const auto& [name, value] : node_.items()) {
            if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
            if (const char* why = FormerName(PathOf(name))) {
                document_.notes.push_back(PathOf(name) + " has no effect: " + why);
                continue;
            }
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
            if (node.is_number()) ReadReal(node.get<double>(), path, value);
            else if (node == "infinity") value = std::numeric_limits<T>::infinity();
            else if (node == "-infinity") value = -std::numeric_limits<T>::infinity();
            else Fail(path, "a number, or infinity in quotes", &node);
        } else if constexpr (std::is_same_v<T, LockedAxes> || std::is_same_v<T, SensorSees>) {
            uint8_t bits = static_cast<uint8_t>(value);
            Read(node, path, bits);
            value = static_cast<T>(bits);
        } else if constexpr (std::is_integral_v<T>) {
            ReadInteger(node, path, value);
        } else {
            ReadMore(node, path, value);
        }
    }

    // A variant of joint settings, whose object has been opened: its kind and fields.
    template <class Joint>
    void ReadJoint(Joint& value) {
        size_t kind = 0;
        constexpr const auto& kNames = kJointKindNames<Joint>;
        if (!error_ && !node_.contains("kind"))
            error_ = WrongAt(path_, "kind is missing; it must be one of " + ListOf(kNames));
        Choice("kind", kind, kNames);
        if (error_) return;
        [&]<size_t... kinds>(std::index_sequence<kinds...>) {
            ((kind == kinds ? void(value.template emplace<kinds>()) : void()), ...);
        }
        (std::make_index_sequence<std::variant_size_v<Joint>>());
        std::visit([&](auto& joint) { Describe(*this, joint); }, value);
    }

private:
    void Fail(const std::string& path, const char* expected, const Json* node = nullptr) {
        if (error_) return;
        error_ = WrongAt(path, (node ? std::string("of type ") + node->type_name() + "; it" : std::string("it")) +
                                   " must be " + expected);
    }

    // A finite number must not become an infinite one.
    template <class T>
    void ReadReal(double number, const std::string& path, T& value) {
        if (std::fabs(number) <= double{std::numeric_limits<T>::max()}) value = static_cast<T>(number);
        else Fail(path, sizeof(T) == 4 ? "a number within 3.4e38, or infinity in quotes" : "a number that is finite");
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
    template <class T, size_t kSize>
    void ReadMore(const Json& node, const std::string& path, std::array<T, kSize>& values) {
        if (!IsArray(node, path, kSize)) return;
        for (size_t k = 0; k < kSize; ++k) Read(node[k], path + "[" + std::to_string(k) + "]", values[k]);
    }
    template <class T>
    void ReadMore(const Json& node, const std::string& path, std::optional<T>& value) {
        value.reset();
        if (node.is_null()) return;
        value.emplace();
        if constexpr (std::is_same_v<T, Vector3>) value->setZero();
        Read(node, path, *value);
    }
    template <class T>
    void ReadMore(const Json& node, const std::string& path, std::vector<T>& values) {
        if (!node.is_array()) return Fail(path, "an array", &node);
        for (size_t i = 0; i < node.size(); ++i) {
            T value{};
            Read(node[i], path + "[" + std::to_string(i) + "]", value);
            if (error_) return;
            values.push_back(std::move(value));
        }
    }
    // Settings of any other kind.
    template <class T>
    void ReadMore(const Json& node, const std::string& path, T& value) {
        JsonReader fields(node, path, document_);
        Describe(fields, value);
        fields.Finish();
    }
    void ReadMore(const Json& node, const std::string& path, RagdollJoint& value) {
        JsonReader fields(node, path, document_);
        fields.ReadJoint(value);
        fields.Finish();
    }
    void ReadMore(const Json& node, const std::string& path, ShapePtr& value);                     // ShapeJson.cpp
    void ReadMore(const Json& node, const std::string& path, std::shared_ptr<const Path>& value);  // likewise

    const Json& node_;
    std::string path_;
    JsonDocument& document_;
    MaybeError& error_;
    std::vector<std::string> known_;
};

}  // namespace fulcrum
