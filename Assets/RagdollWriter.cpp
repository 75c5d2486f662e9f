// Writing of RagdollJson.h.
#include <Fulcrum/Assets/RagdollJson.h>

#include <Fulcrum/Assets/Json/JsonWriter.h>
#include <Fulcrum/Assets/Json/ShapeJson.h>
#include <Fulcrum/Assets/TextFloats.h>
#include <Fulcrum/Physics/Files/ErrorBoundary.h>
#include <Fulcrum/Physics/Files/WholeFile.h>

namespace fulcrum {

namespace {

Result<Json> WrittenParts(const RagdollSettings& settings) {
    if (MaybeError e = Check(settings)) return *e;
    Json parts = Json::array();
    for (size_t i = 0; i < settings.parts.size(); ++i) {
        const RagdollPart& part = settings.parts[i];
        const std::string path = "parts[" + std::to_string(i) + "].";
        if (!CanBeWrittenByKind(*part.body.shape))
            return WrongAt(path + "body.shape", std::string("a ") + ShapeTypeName(part.body.shape->Type()) +
                                                    (part.body.shape->IsConvex() ? " with a convex radius" : "") +
                                                    " cannot be written");
        Json node = {{"name", part.name}};
        if (i > 0) node["parent"] = settings.parts[static_cast<size_t>(part.parent)].name;
        node["body"] = ShortlyWritten(part.body);
        if (i > 0) node["joint"] = JointWritten(part.joint);
        parts.push_back(std::move(node));
    }
    return Json{{"parts", std::move(parts)}};
}

}  // namespace

Result<Json> RagdollToJson(const RagdollSettings& settings) {
    const TextFloats floats;
    return WithErrors("", [&] { return WrittenParts(settings); });
}

Status WriteRagdoll(const std::string& file, const RagdollSettings& settings) {
    const TextFloats floats;
    return WithErrors("cannot write " + file, [&]() -> Status {
        const Result<Json> document = RagdollToJson(settings);
        if (!document) return document.GetError();
        // One part per line.
        std::string text = "{\"parts\": [";
        const char* before = "\n  ";
        for (const Json& part : document.Value()["parts"]) {
            text += before + part.dump(-1, ' ', false, Json::error_handler_t::replace);
            before = ",\n  ";
        }
        return WriteWholeFile(file, {text, "\n]}\n"});
    });
}

}  // namespace fulcrum
