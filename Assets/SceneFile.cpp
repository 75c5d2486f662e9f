#include <Fulcrum/Assets/SceneFile.h>

#include <Fulcrum/Assets/Json/JsonWriter.h>
#include <Fulcrum/Assets/Json/RagdollParts.h>
#include <Fulcrum/Assets/Json/ShapeJson.h>
#include <Fulcrum/Assets/RagdollJson.h>
#include <Fulcrum/Assets/TextFloats.h>
#include <Fulcrum/Physics/Files/ErrorBoundary.h>
#include <Fulcrum/Physics/Files/WholeFile.h>

#include <cmath>
#include <set>

namespace fulcrum {

namespace {

constexpr const char* kWorldName = "world";

// ---- Reading

class SceneReader {
public:
    SceneReader(const Json& node, const std::filesystem::path& folder) : root_(node, "", document_) {
        document_.folder = folder;
    }

    Result<SceneDescription> Read() {
        int version = 0;
        root_.Field("fulcrumScene", version);
        if (!document_.error && version != kSceneFileVersion)
            document_.error = WrongAt(
                "fulcrumScene", std::to_string(version) + "; this version reads " + std::to_string(kSceneFileVersion));
        root_.Field("description", scene_.description);
        root_.Field("steps", scene_.steps);
        root_.Field("dt", scene_.dt);
        if (!document_.error && scene_.steps < 1) document_.error = WrongAt("steps", "it must be 1 or more");
        if (!document_.error && !(scene_.dt > 0 && std::isfinite(scene_.dt)))
            document_.error = WrongAt("dt", "it must be a positive time in seconds");
        root_.Field("settings", scene_.settings);
        if (const Json* shapes = root_.Find("shapes")) ReadShapes(*shapes);
        Each("bodies", [&](JsonReader& fields) { ReadBody(fields); });
        Each("joints", [&](JsonReader& fields) { ReadJoint(fields); });
        Each("ragdolls", [&](JsonReader& fields) { ReadRagdoll(fields); });
        root_.Finish();
        if (document_.error) return *document_.error;
        scene_.notes = std::move(document_.notes);
        return std::move(scene_);
    }

private:
    template <class ReadOne>
    void Each(const char* name, const ReadOne& readOne) {
        const Json* list = root_.Find(name);
        if (!list) return;
        if (!list->is_array()) {
            document_.error = WrongAt(name, "it must be an array");
            return;
        }
        for (size_t i = 0; i < list->size() && !document_.error; ++i) {
            JsonReader fields((*list)[i], std::string(name) + "[" + std::to_string(i) + "]", document_);
            if (document_.error) return;
            readOne(fields);
            fields.Finish();
        }
    }

    // In their order: a compound may name those before it.
    void ReadShapes(const Json& shapes) {
        if (!shapes.is_object()) document_.error = WrongAt("shapes", "it must be an object");
        for (const auto& [name, node] : shapes.items()) {
            if (document_.error) return;
            ShapePtr shape;
            root_.Read(node, "shapes." + name, shape);
            document_.shapes[name] = shape;
        }
    }

    // Empty where it has none.
    std::string NameOf(JsonReader& fields, std::set<std::string>& taken) {
        std::string name;
        fields.Field("name", name);
        if (document_.error || name.empty()) return name;
        if (name == kWorldName) document_.error = WrongAt(fields.PathOf("name"), "\"world\" is the world's");
        else if (!taken.insert(name).second)
            document_.error = WrongAt(fields.PathOf("name"), "\"" + name + "\" is another's already");
        return name;
    }

    void ReadBody(JsonReader& fields) {
        SceneBody body;
        body.name = NameOf(fields, bodyNames_);
        Describe(fields, body.settings);
        if (!document_.error && !body.settings.shape)
            document_.error = WrongAt(fields.PathOf("shape"), "it is missing");
        TakeChildren(body.settings.shape.get(), fields.PathOf("shape"), document_);
        if (!body.name.empty()) numbers_[body.name] = static_cast<int>(scene_.bodies.size());
        scene_.bodies.push_back(std::move(body));
    }

    // A name, or a number in `bodies`.
    int BodyOf(JsonReader& fields, const char* name) {
        const Json* node = fields.Find(name);
        if (document_.error) return SceneJoint::kWorld;
        if (!node) {
            document_.error = WrongAt(fields.PathOf(name), "it is missing: the name or number of a body, or \"world\"");
            return SceneJoint::kWorld;
        }
        if (node->is_string()) {
            const std::string text = node->get<std::string>();
            if (text == kWorldName) return SceneJoint::kWorld;
            const auto found = numbers_.find(text);
            if (found != numbers_.end()) return found->second;
            document_.error = WrongAt(fields.PathOf(name), "no body has the name \"" + text + "\"");
            return SceneJoint::kWorld;
        }
        uint32_t number = 0;
        fields.Read(*node, fields.PathOf(name), number);
        if (!document_.error && number >= scene_.bodies.size())
            document_.error = WrongAt(fields.PathOf(name),
                                      "there are " + std::to_string(scene_.bodies.size()) + " bodies, counted from 0");
        return static_cast<int>(number);
    }

    void ReadJoint(JsonReader& fields) {
        SceneJoint joint;
        joint.name = NameOf(fields, jointNames_);
        joint.bodyA = BodyOf(fields, "bodyA");
        joint.bodyB = BodyOf(fields, "bodyB");
        if (!document_.error) fields.ReadJoint(joint.settings);
        scene_.joints.push_back(std::move(joint));
    }

    void ReadRagdoll(JsonReader& fields) {
        SceneRagdoll ragdoll;
        ragdoll.name = NameOf(fields, ragdollNames_);
        if (const Json* origin = fields.Find("origin")) {
            JsonReader pose(*origin, fields.PathOf("origin"), document_);
            pose.Field("position", ragdoll.origin.position);
            pose.Field("rotation", ragdoll.origin.rotation);
            pose.Finish();
        }
        MotionType motion = MotionType::Dynamic;
        fields.Choice("motion", motion, kMotionNames);
        if (fields.Find("motion")) ragdoll.motion = motion;
        std::string file;
        fields.Field("file", file);
        const Json* parts = fields.Find("parts");
        if (document_.error) return;
        const Result<RagdollSettings> settings =
            parts ? ReadRagdollParts(Json{{"parts", *parts}}, document_.folder, document_.budget)
                  : ReadRagdollFile(document_.folder / file, document_.budget);
        if (settings) ragdoll.settings = settings.Value();
        else document_.error = Error{settings.GetError().code, fields.Where() + ": " + settings.GetError().message};
        scene_.ragdolls.push_back(std::move(ragdoll));
    }

    JsonDocument document_;
    JsonReader root_;
    SceneDescription scene_;
    std::set<std::string> bodyNames_, jointNames_, ragdollNames_;
    std::map<std::string, int> numbers_;
};

// ---- Writing

// A name that is no UTF-8, as a program or a CBOR file may have it, is written with replacement characters.
std::string Dump(const Json& node) { return node.dump(-1, ' ', false, Json::error_handler_t::replace); }

class SceneWriter {
public:
    explicit SceneWriter(const SceneDescription& scene) : scene_(scene) {}

    Result<Json> Write() {
        if (MaybeError e = CheckHead()) return *e;
        Json node = {{"fulcrumScene", kSceneFileVersion}};
        if (!scene_.description.empty()) node["description"] = scene_.description;
        node["steps"] = scene_.steps;
        if (scene_.dt != SceneDescription().dt) node["dt"] = scene_.dt;
        const Result<Json> settings = At("settings", [&] { return ShortlyWritten(scene_.settings); });
        if (!settings) return settings.GetError();
        if (!settings.Value().empty()) node["settings"] = settings.Value();
        if (MaybeError e = NameShapes()) return *e;
        if (!shapes_.empty()) node["shapes"] = shapes_;
        node["bodies"] = Json::array();
        if (MaybeError e = Each("bodies", scene_.bodies, node)) return *e;
        if (MaybeError e = Each("joints", scene_.joints, node)) return *e;
        if (MaybeError e = Each("ragdolls", scene_.ragdolls, node)) return *e;
        return node;
    }

private:
    // What stands at a place of the document; its errors begin with it.
    template <class Write>
    static Result<Json> At(const std::string& place, const Write& write) {
        Result<Json> written = WithErrors("", [&]() -> Result<Json> { return write(); });
        if (!written) return Error{written.GetError().code, place + ": " + written.GetError().message};
        return written;
    }
    template <class Element>
    MaybeError Each(const char* list, const std::vector<Element>& elements, Json& node) {
        std::set<std::string> names;
        for (size_t i = 0; i < elements.size(); ++i) {
            const std::string place = std::string(list) + "[" + std::to_string(i) + "]";
            const std::string& name = elements[i].name;
            if (!name.empty() && (name == kWorldName || !names.insert(Dump(Json(name))).second))
                return Error{ErrorCode::Unsupported,
                             place + ".name: \"" + name + "\" is another's already, as it is written"};
            Result<Json> one = At(place, [&] { return WrittenOne(elements[i]); });
            if (!one) return one.GetError();
            node[list].push_back(std::move(one.Value()));
        }
        return {};
    }
    // What reading refuses.
    MaybeError CheckHead() const {
        if (scene_.steps < 1) return Error{ErrorCode::NonPositive, "steps: it must be 1 or more"};
        if (!(scene_.dt > 0 && std::isfinite(scene_.dt)))
            return Error{ErrorCode::NonPositive, "dt: it must be a positive time in seconds"};
        return {};
    }

    Result<Json> WrittenOne(const SceneBody& body) const {
        Json one = Named(body.name);
        one["shape"] = shapeOf_.at(body.settings.shape.get());
        BodySettings rest = body.settings;
        rest.shape = nullptr;
        one.update(ShortlyWritten(rest));
        return one;
    }
    Result<Json> WrittenOne(const SceneJoint& joint) const {
        if (!IsBody(joint.bodyA) || !IsBody(joint.bodyB))
            return Error{ErrorCode::OutOfRange, "there is no body of that number"};
        Json one = Named(joint.name);
        one["bodyA"] = NameOfBody(joint.bodyA);
        one["bodyB"] = NameOfBody(joint.bodyB);
        one.update(JointWritten(joint.settings));
        return one;
    }
    static Result<Json> WrittenOne(const SceneRagdoll& ragdoll) {
        const Result<Json> parts = RagdollToJson(ragdoll.settings);
        if (!parts) return parts.GetError();
        Json one = Named(ragdoll.name);
        JsonWriter origin;
        origin.Field("position", ragdoll.origin.position);
        origin.Field("rotation", ragdoll.origin.rotation);
        one["origin"] = origin.node;
        if (ragdoll.motion) {
            JsonWriter motion;
            motion.Choice("motion", *ragdoll.motion, kMotionNames);
            one.update(motion.node);
        }
        one.update(parts.Value());
        return one;
    }
    static Json Named(const std::string& name) {
        Json node = Json::object();
        if (!name.empty()) node["name"] = name;
        return node;
    }
    bool IsBody(int number) const { return number >= SceneJoint::kWorld && number < std::ssize(scene_.bodies); }
    Json NameOfBody(int number) const {
        if (number == SceneJoint::kWorld) return kWorldName;
        const std::string& name = scene_.bodies[static_cast<size_t>(number)].name;
        return name.empty() ? Json(number) : Json(name);
    }

    // A shape of one body is written in its body, one of several in `shapes`, by a name.
    MaybeError NameShapes() {
        uint64_t comparisons = 0;  // of names, as they are read
        std::map<const Shape*, size_t> uses;
        for (const SceneBody& body : scene_.bodies) ++uses[body.settings.shape.get()];
        for (size_t i = 0; i < scene_.bodies.size(); ++i) {
            const BodySettings& body = scene_.bodies[i].settings;
            const std::string path = "bodies[" + std::to_string(i) + "]";
            if (!body.shape) return Error{ErrorCode::Unsupported, path + ": it has no shape"};
            if (body.group.filter) return Error{ErrorCode::Unsupported, path + ": a group filter cannot be written"};
            if (shapeOf_.contains(body.shape.get())) continue;
            const Result<Json> node = ShapeToJson(body.shape);
            if (!node) return Error{node.GetError().code, path + ": " + node.GetError().message};
            Json& place = shapeOf_[body.shape.get()];
            if (uses[body.shape.get()] == 1) {
                place = node.Value();
            } else {
                const std::string name = "shape" + std::to_string(shapes_.size());
                if (comparisons += shapes_.size(); comparisons > DocumentLimits().comparisons)
                    return Error{ErrorCode::OutOfRange, "more than 46341 shapes are those of several bodies"};
                shapes_[name] = node.Value();
                place = name;
            }
        }
        return {};
    }

    const SceneDescription& scene_;
    Json shapes_ = Json::object();
    std::map<const Shape*, Json> shapeOf_;  // what stands in a body's place
};

// One element of the lists a line.
std::string Text(const Json& scene) {
    std::string text = "{";
    const char* before = "\n";
    for (const auto& [name, node] : scene.items()) {
        text += before + Dump(Json(name)) + ": ";
        before = ",\n";
        const bool isList = node.is_array() || name == "shapes";
        if (!isList || node.empty()) {
            text += Dump(node);
            continue;
        }
        text += node.is_array() ? "[" : "{";
        const char* beforeOne = "\n  ";
        for (const auto& [key, element] : node.items()) {
            text += beforeOne + (node.is_array() ? "" : Dump(Json(key)) + ": ") + Dump(element);
            beforeOne = ",\n  ";
        }
        text += node.is_array() ? "\n]" : "\n}";
    }
    return text + "\n}\n";
}

}  // namespace

Result<SceneDescription> SceneFromJson(std::string_view text, const std::filesystem::path& folder) {
    const TextFloats floats;
    return WithErrors("the document", [&]() -> Result<SceneDescription> {
        if (const MaybeError e = CheckLimitsOfJson(text)) return Error{e->code, "the document: " + e->message};
        const Json node = Json::parse(text);
        return SceneReader(node, folder).Read();
    });
}

Result<SceneDescription> SceneFromCbor(std::string_view bytes, const std::filesystem::path& folder) {
    const TextFloats floats;
    return WithErrors("the document", [&]() -> Result<SceneDescription> {
        if (const MaybeError e = CheckLimitsOfCbor(bytes)) return Error{e->code, "the document: " + e->message};
        const Json node = Json::from_cbor(bytes, true, false);
        if (node.is_discarded()) return WrongAt("", "it is neither JSON nor CBOR");
        return SceneReader(node, folder).Read();
    });
}

Result<std::string> SceneToJson(const SceneDescription& scene) {
    const TextFloats floats;
    return WithErrors("", [&]() -> Result<std::string> {
        const Result<Json> node = SceneWriter(scene).Write();
        if (!node) return node.GetError();
        return Text(node.Value());
    });
}

Result<SceneDescription> ReadScene(const std::filesystem::path& file) {
    const TextFloats floats;
    return WithErrors(file.string(), [&]() -> Result<SceneDescription> {
        const Result<std::string> read = ReadWholeFile(file);
        if (!read) return read.GetError();
        const std::string& bytes = read.Value();
        const size_t first = bytes.find_first_not_of(" \t\r\n");
        const bool isText = first != std::string::npos && bytes[first] == '{';
        Result<SceneDescription> scene =
            isText ? SceneFromJson(bytes, file.parent_path()) : SceneFromCbor(bytes, file.parent_path());
        if (!scene) return Error{scene.GetError().code, file.string() + ": " + scene.GetError().message};
        return scene;
    });
}

Status WriteScene(const std::filesystem::path& file, const SceneDescription& scene) {
    const TextFloats floats;
    return WithErrors("cannot write " + file.string(), [&]() -> Status {
        const Result<Json> node = SceneWriter(scene).Write();
        if (!node) return node.GetError();
        if (file.extension() != ".cbor") return WriteWholeFile(file, {Text(node.Value())});
        const std::vector<uint8_t> bytes = Json::to_cbor(node.Value());
        return WriteWholeFile(file, {{reinterpret_cast<const char*>(bytes.data()), bytes.size()}});
    });
}

}  // namespace fulcrum
