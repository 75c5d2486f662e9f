// Reading of RagdollJson.h.
#include <Fulcrum/Assets/RagdollJson.h>

#include <Fulcrum/Assets/Json/RagdollParts.h>
#include <Fulcrum/Assets/Json/ShapeJson.h>
#include <Fulcrum/Assets/TextFloats.h>
#include <Fulcrum/Physics/Files/ErrorBoundary.h>
#include <Fulcrum/Physics/Files/WholeFile.h>

#include <algorithm>

namespace fulcrum {

namespace {

Result<RagdollSettings> ReadParts(const Json& document, JsonDocument& shared) {
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
        TakeChildren(part.body.shape.get(), fields.PathOf("body.shape"), shared);
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

}  // namespace

Result<RagdollSettings> ReadRagdollParts(const Json& node, const std::filesystem::path& folder, JsonBudget& budget) {
    JsonDocument document;
    document.folder = folder;
    document.budget = budget;
    Result<RagdollSettings> settings = WithErrors("", [&] { return ReadParts(node, document); });
    budget = document.budget;
    return settings;
}

Result<RagdollSettings> ReadRagdollFile(const std::filesystem::path& file, JsonBudget& budget) {
    return WithErrors(file.string(), [&]() -> Result<RagdollSettings> {
        const Result<std::string> text = ReadWholeFile(file, std::min(kMostDocumentBytes, budget.namedBytes));
        if (!text) return text.GetError();
        budget.namedBytes -= text.Value().size();
        if (const MaybeError error = CheckLimitsOfJson(text.Value()))
            return Error{error->code, file.string() + ": " + error->message};
        const Result<RagdollSettings> settings =
            ReadRagdollParts(Json::parse(text.Value()), file.parent_path(), budget);
        if (!settings) return Error{settings.GetError().code, file.string() + ": " + settings.GetError().message};
        return settings;
    });
}

Result<RagdollSettings> RagdollFromJson(const Json& document) {
    const TextFloats floats;
    JsonBudget budget;
    return ReadRagdollParts(document, {}, budget);
}

Result<RagdollSettings> ReadRagdoll(const std::string& file) {
    const TextFloats floats;
    JsonBudget budget;
    return ReadRagdollFile(file, budget);
}

}  // namespace fulcrum
