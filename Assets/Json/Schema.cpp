#include <Fulcrum/Assets/Json/Schema.h>

#include <Fulcrum/Assets/Json/JsonWriter.h>
#include <Fulcrum/Assets/Json/ShapeJson.h>

namespace fulcrum {

namespace {

Json Numbers(int count) {
    return {{"type", "array"}, {"items", {{"$ref", "#/$defs/number"}}}, {"minItems", count}, {"maxItems", count}};
}
Json Ref(const std::string& name) { return {{"$ref", "#/$defs/" + name}}; }
Json Names(const auto& names) {
    Json list = Json::array();
    for (const auto& name : names) list.push_back(name);
    return {{"enum", std::move(list)}};
}

template <class T>
Json SchemaOf();

// Collects the fields of one structure, with their defaults.
class SchemaWriter {
public:
    template <class T>
    void Field(const char* name, const T& value) {
        Json schema = SchemaOf<T>();
        if constexpr (std::is_arithmetic_v<T>) schema["default"] = Written(value);
        properties[name] = std::move(schema);
    }
    template <class E, class List>
    void Choice(const char* name, const E& value, const List& names) {
        Json schema = Names(names);
        schema["default"] = names[static_cast<size_t>(value)];
        properties[name] = std::move(schema);
    }
    Json Object() const { return {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}}; }
    Json properties = Json::object();
};

template <class T>
Json SchemaOf() {
    if constexpr (std::is_same_v<T, bool>) {
        return {{"type", "boolean"}};
    } else if constexpr (std::is_floating_point_v<T>) {
        return Ref("number");
    } else if constexpr (std::is_same_v<T, LockedAxes> || std::is_same_v<T, SensorSees>) {
        return {{"type", "integer"}, {"minimum", 0}, {"maximum", 255}};
    } else if constexpr (std::is_integral_v<T>) {
        return {{"type", "integer"},
                {"minimum", std::numeric_limits<T>::min()},
                {"maximum", std::numeric_limits<T>::max()}};
    } else if constexpr (std::is_same_v<T, std::string>) {
        return {{"type", "string"}};
    } else if constexpr (std::is_same_v<T, Vector3> || std::is_same_v<T, Position>) {
        return Ref("vector");
    } else if constexpr (std::is_same_v<T, Quaternion>) {
        return Ref("rotation");
    } else if constexpr (std::is_same_v<T, ShapePtr>) {
        return Ref("shape");
    } else if constexpr (std::is_same_v<T, std::shared_ptr<const Path>>) {
        SchemaWriter point;
        PathPoint usual{};
        Describe(point, usual);
        return {{"type", "object"},
                {"properties",
                 {{"isClosed", SchemaOf<bool>()}, {"points", {{"type", "array"}, {"items", point.Object()}}}}},
                {"additionalProperties", false}};
    } else if constexpr (IsOptional<T>::value) {
        return {{"anyOf", {SchemaOf<typename T::value_type>(), {{"type", "null"}}}}};
    } else if constexpr (IsList<T>::value) {
        Json list = {{"type", "array"}, {"items", SchemaOf<typename T::value_type>()}};
        return list;
    } else {
        SchemaWriter fields;
        T usual{};
        Describe(fields, usual);
        return fields.Object();
    }
}

// One object for each kind, told apart by the field of that name.
template <class Joint>
Json JointsOf(const Json& more) {
    Json kinds = Json::array();
    [&]<size_t... index>(std::index_sequence<index...>) {
        (
            [&] {
                Json one = SchemaOf<std::variant_alternative_t<index, Joint>>();
                Json properties = {{"kind", {{"const", kJointKindNames<Joint>[index]}}}};
                properties.update(more);
                properties.update(one["properties"]);
                one["properties"] = std::move(properties);
                one["required"] = {"kind"};
                kinds.push_back(std::move(one));
            }(),
            ...);
    }
    (std::make_index_sequence<std::variant_size_v<Joint>>());
    return {{"oneOf", std::move(kinds)}};
}

}  // namespace

std::string SceneSchema() {
    const Json name = {{"type", "string"}};
    const Json bodyRef = {{"description", "the name of a body, its number in `bodies`, or \"world\""},
                          {"anyOf", {{{"type", "string"}}, {{"type", "integer"}, {"minimum", 0}}}}};
    Json body = SchemaOf<BodySettings>();
    body["properties"]["name"] = name;
    body["required"] = {"shape"};
    const Json pose = {{"type", "object"},
                       {"properties", {{"position", Ref("vector")}, {"rotation", Ref("rotation")}}},
                       {"additionalProperties", false}};
    Json part = {{"type", "object"},
                 {"properties", {{"name", name}, {"parent", name}, {"body", Ref("body")}, {"joint", Ref("partJoint")}}},
                 {"required", {"name", "body"}},
                 {"additionalProperties", false}};
    const Json ragdoll = {{"type", "object"},
                          {"properties",
                           {{"name", name},
                            {"file", name},
                            {"parts", {{"type", "array"}, {"items", Ref("part")}}},
                            {"origin", pose},
                            {"motion", Names(kMotionNames)}}},
                          {"additionalProperties", false}};
    const auto list = [](const char* of) { return Json{{"type", "array"}, {"items", Ref(of)}}; };
    const Json schema = {
        {"$schema", "https://json-schema.org/draft/2020-12/schema"},
        {"title", "Scene of Fulcrum"},
        {"description", "SI units and radians; rotations are unit quaternions x, y, z, w. Docs/SceneFiles.md"},
        {"type", "object"},
        {"properties",
         {{"fulcrumScene", {{"const", 1}}},
          {"description", name},
          {"steps", {{"type", "integer"}, {"minimum", 1}, {"default", 300}}},
          {"dt", {{"type", "number"}, {"exclusiveMinimum", 0}, {"description", "s"}}},
          {"settings", SchemaOf<SystemSettings>()},
          {"shapes", {{"type", "object"}, {"additionalProperties", Ref("shape")}}},
          {"bodies", list("body")},
          {"joints", list("joint")},
          {"ragdolls", list("ragdoll")}}},
        {"required", {"fulcrumScene"}},
        {"additionalProperties", false},
        {"$defs",
         {{"number", {{"anyOf", {{{"type", "number"}}, Names(std::array{"infinity", "-infinity"})}}}},
          {"vector", Numbers(3)},
          {"rotation", Numbers(4)},
          {"shape",
           {{"description", "a shape, or the name of one in `shapes`"},
            {"anyOf",
             {{{"type", "string"}},
              {{"type", "object"}, {"properties", {{"kind", Names(ShapeKindNames())}}}, {"required", {"kind"}}}}}}},
          {"body", std::move(body)},
          {"joint", JointsOf<AnyJointSettings>({{"name", name}, {"bodyA", bodyRef}, {"bodyB", bodyRef}})},
          {"partJoint", JointsOf<RagdollJoint>(Json::object())},
          {"part", std::move(part)},
          {"ragdoll", ragdoll}}}};
    return schema.dump(1) + "\n";
}

}  // namespace fulcrum
