// Reading of RagdollJson.h.
#include <Fulcrum/Assets/RagdollJson.h>

#include <Fulcrum/Assets/Json/JsonDepth.h>
#include <Fulcrum/Assets/Json/JsonReader.h>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace fulcrum {

Result<RagdollSettings> RagdollFromJson(const Json& document) {
    JsonDocument shared;
    MaybeError& error = shared.error;
    RagdollSettings settings;
    JsonReader root(document, "", shared);
    const Json* parts = root.Find("parts");
    root.Finish();
    if (error) return *error;
    if (!parts || !parts->is_array()) return WrongAt("parts", "it must be an array");
    for (size_t i = 0; i < parts->size(); ++i) {
        RagdollPart part;
        JsonReader fields((*parts)[i], "parts[" + std::to_string(i) + "]", shared);
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
    const std::string text((std::istreambuf_iterator<char>(stream)), {});
    if (const MaybeError error = CheckDepthOfJson(text)) return WrongAt(file, error->message);
    Result<RagdollSettings> settings = Error{ErrorCode::Unsupported, ""};
    try {
        settings = RagdollFromJson(Json::parse(text));
    } catch (const Json::exception& error) {
        return WrongAt(file, error.what());
    }
    if (!settings) return Error{settings.GetError().code, file + ": " + settings.GetError().message};
    return settings;
}

}  // namespace fulcrum
