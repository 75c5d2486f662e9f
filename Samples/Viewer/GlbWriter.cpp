#include <Fulcrum/Samples/Viewer/GlbWriter.h>

#include <Fulcrum/Physics/Files/WholeFile.h>
#include <Fulcrum/Samples/Viewer/GlbBuffer.h>
#include <Fulcrum/Samples/Viewer/ShapeMesh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace fulcrum {
namespace {

constexpr float kPositionTolerance = 2e-4f;  // m
constexpr float kRotationTolerance = 5e-4f;  // of a part of the quaternion
constexpr uint64_t kLargestFile = std::numeric_limits<uint32_t>::max();

struct Key {
    size_t frame;
    Vector3 position;
    Quaternion rotation;  // of the sign nearest to that of the key before
};

// All states of each body; the state of a rest is repeated at its end, since glTF interpolates linearly between keys.
std::vector<std::vector<Key>> KeysOfBodies(const Recording& recording) {
    std::vector<std::vector<Key>> keys(recording.bodies.size());
    for (size_t frame = 0; frame < recording.frames.size(); ++frame) {
        for (const RecordedState& state : recording.frames[frame].states) {
            std::vector<Key>& own = keys[state.body];
            Quaternion q = Normalized(state.rotation);
            if (!own.empty()) {
                if (own.back().frame + 1 < frame) own.push_back({frame - 1, own.back().position, own.back().rotation});
                const Quaternion& last = own.back().rotation;
                if (q.x * last.x + q.y * last.y + q.z * last.z + q.w * last.w < 0) q = {-q.x, -q.y, -q.z, -q.w};
            }
            own.push_back({frame, state.position, q});
        }
    }
    return keys;
}

template <size_t N>
using Curve = std::vector<std::array<float, N>>;

// Indices of the values to keep so that linear interpolation gives all others within the tolerance. A kept value starts
// a cone of slopes, one interval per component, that contains all later values; the value before the first one outside
// is kept.
template <size_t N>
std::vector<size_t> NeededKeys(const std::vector<float>& times, const Curve<N>& values, float tolerance) {
    std::vector<size_t> needed = {0};
    std::array<float, N> lowest, highest;
    const auto open = [&] {
        lowest.fill(-std::numeric_limits<float>::infinity());
        highest.fill(std::numeric_limits<float>::infinity());
    };
    const auto isInside = [&](size_t i, size_t start) {
        const float span = times[i] - times[start];
        for (size_t k = 0; k < N; ++k) {
            const float slope = (values[i][k] - values[start][k]) / span;
            if (slope < lowest[k] || slope > highest[k]) return false;
        }
        return true;
    };
    open();
    for (size_t i = 1; i < values.size(); ++i) {
        if (!isInside(i, needed.back())) {
            needed.push_back(i - 1);
            open();
        }
        const size_t start = needed.back();
        const float span = times[i] - times[start];
        for (size_t k = 0; k < N; ++k) {
            lowest[k] = std::max(lowest[k], (values[i][k] - tolerance - values[start][k]) / span);
            highest[k] = std::min(highest[k], (values[i][k] + tolerance - values[start][k]) / span);
        }
    }
    if (values.size() > 1) needed.push_back(values.size() - 1);
    return needed;
}

template <size_t N>
bool Moves(const Curve<N>& values, float tolerance) {
    for (const auto& value : values)
        for (size_t k = 0; k < N; ++k)
            if (std::fabs(value[k] - values[0][k]) > tolerance) return true;
    return false;
}

class Document {
public:
    explicit Document(const Recording& recording)
        : recording_(recording), keys_(KeysOfBodies(recording)), presences_(PresencesOf(recording)) {
        AddMaterials();
        if (recording.frames.empty())
            for (uint32_t body = 0; body < recording.bodies.size(); ++body)
                presences_.push_back({body, recording.bodies[body].shape, 0, 0});
        for (size_t node = 0; node < presences_.size(); ++node) AddNode(node);
        for (size_t node = 0; node < presences_.size(); ++node) Animate(node);
        Finish();
    }

    const Json& Text() const { return json_; }
    const std::string& Binary() const { return buffer_.Bytes(); }

private:
    // One for static bodies, one for kinematic ones, then a few for dynamic ones, of neighboring bodies different; last
    // glass, for sensors.
    void AddMaterials() {
        static constexpr std::array<std::array<float, 3>, 7> kColors = {{{0.64f, 0.68f, 0.72f},
                                                                         {0.32f, 0.38f, 0.45f},
                                                                         {0.14f, 0.32f, 0.62f},
                                                                         {0.74f, 0.35f, 0.11f},
                                                                         {0.16f, 0.44f, 0.23f},
                                                                         {0.62f, 0.14f, 0.16f},
                                                                         {0.30f, 0.22f, 0.58f}}};
        for (const auto& color : kColors)
            json_["materials"].push_back({{"pbrMetallicRoughness",
                                           {{"baseColorFactor", {color[0], color[1], color[2], 1.0f}},
                                            {"metallicFactor", 0.0f},
                                            {"roughnessFactor", 0.65f}}}});
        dynamicMaterials_ = kColors.size() - 2;
        const bool hasSensors = std::any_of(recording_.bodies.begin(), recording_.bodies.end(),
                                            [](const RecordedBody& body) { return body.isSensor; });
        if (!hasSensors) return;
        json_["materials"].push_back({{"name", "glass"},
                                      {"alphaMode", "BLEND"},
                                      {"doubleSided", true},
                                      {"pbrMetallicRoughness",
                                       {{"baseColorFactor", {0.04f, 0.39f, 0.54f, 0.3f}},
                                        {"metallicFactor", 0.0f},
                                        {"roughnessFactor", 0.2f}}}});
    }

    size_t MaterialOf(size_t body) const {
        if (recording_.bodies[body].isSensor) return 2 + dynamicMaterials_;
        switch (recording_.bodies[body].motion) {
            case RecordedMotion::Static: return 0;
            case RecordedMotion::Kinematic: return 1;
            case RecordedMotion::Dynamic: break;
        }
        return 2 + body % dynamicMaterials_;
    }

    // Meshes that differ in their material only share their vertices.
    size_t MeshOf(size_t shape, size_t material) {
        const auto [found, isNew] = meshes_.try_emplace({shape, material}, json_["meshes"].size());
        if (!isNew) return found->second;
        if (!geometries_.contains(shape)) {
            const ShapeMesh mesh = MeshOfShape(recording_, shape);
            geometries_[shape] = {buffer_.AddVertices(mesh.positions), buffer_.AddVertices(mesh.normals),
                                  buffer_.AddIndices(mesh.indices)};
        }
        const Geometry& geometry = geometries_[shape];
        Json mesh = {{"primitives",
                      {{{"attributes", {{"POSITION", geometry.positions}, {"NORMAL", geometry.normals}}},
                        {"indices", geometry.indices},
                        {"material", material}}}}};
        if (!recording_.shapes[shape].name.empty()) mesh["name"] = recording_.shapes[shape].name;
        json_["meshes"].push_back(mesh);
        return found->second;
    }

    // A node for each shape that a body has in the recording: mostly one.
    void AddNode(size_t index) {
        const auto [body, shape, from, until] = presences_[index];
        const RecordedBody& recorded = recording_.bodies[body];
        std::string name = recorded.name.empty() ? "body " + std::to_string(body) : recorded.name;
        if (index > 0 && presences_[index - 1].body == body) name += " from frame " + std::to_string(from);
        Json node = {{"name", name}};
        if (!IsEmptyShape(recording_, shape)) node["mesh"] = MeshOf(shape, MaterialOf(body));
        if (!keys_[body].empty()) {
            const Key& first = keys_[body].front();
            node["translation"] = {first.position.x(), first.position.y(), first.position.z()};
            node["rotation"] = {first.rotation.x, first.rotation.y, first.rotation.z, first.rotation.w};
        }
        json_["nodes"].push_back(node);
    }

    float TimeOf(size_t frame) const {
        return static_cast<float>(recording_.frames[frame].time - recording_.frames[0].time);
    }

    // Absent bodies have scale 0.
    void AnimatePresence(size_t node) {
        const auto [body, shape, from, until] = presences_[node];
        if (from == 0 && until >= recording_.frames.size()) return;
        std::vector<float> times;
        Curve<3> scales;
        const auto put = [&](size_t frame, float scale) {
            times.push_back(TimeOf(frame));
            scales.push_back({scale, scale, scale});
        };
        if (from > 0) put(0, 0);
        put(from, 1);
        if (until < recording_.frames.size()) put(until, 0);
        AddSampler(node, "scale", times, scales, "STEP");
    }

    void Animate(size_t node) {
        if (recording_.frames.empty()) return;
        AnimatePresence(node);
        const size_t body = presences_[node].body;
        std::vector<float> times;
        Curve<3> positions;
        Curve<4> rotations;
        for (const Key& key : keys_[body]) {
            times.push_back(TimeOf(key.frame));
            positions.push_back({key.position.x(), key.position.y(), key.position.z()});
            rotations.push_back({key.rotation.x, key.rotation.y, key.rotation.z, key.rotation.w});
        }
        AddChannel(node, "translation", times, positions, kPositionTolerance);
        AddChannel(node, "rotation", times, rotations, kRotationTolerance);
    }

    template <size_t N>
    void AddChannel(size_t node, const char* path, const std::vector<float>& times, const Curve<N>& values,
                    float tolerance) {
        if (values.size() < 2 || !Moves(values, tolerance)) return;
        std::vector<float> keptTimes;
        Curve<N> kept;
        for (size_t i : NeededKeys(times, values, tolerance)) {
            keptTimes.push_back(times[i]);
            kept.push_back(values[i]);
        }
        AddSampler(node, path, keptTimes, kept, "LINEAR");
    }

    template <size_t N>
    void AddSampler(size_t node, const char* path, const std::vector<float>& times, const Curve<N>& values,
                    const char* interpolation) {
        const size_t sampler = samplers_.size();
        // Many bodies have the same key times, those that moved in every frame for one.
        auto [input, isNew] = inputs_.try_emplace(times, 0);
        if (isNew) input->second = buffer_.AddTimes(times);
        samplers_.push_back(
            {{"input", input->second}, {"output", buffer_.AddValues(values)}, {"interpolation", interpolation}});
        channels_.push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
    }

    void Finish() {
        json_["asset"] = {{"version", "2.0"}, {"generator", "Fulcrum"}};
        Json scene = {{"name", recording_.title}};
        for (size_t node = 0; node < presences_.size(); ++node) scene["nodes"].push_back(node);
        json_["scenes"] = {scene};
        json_["scene"] = 0;
        if (!channels_.empty())
            json_["animations"] = {{{"name", recording_.title}, {"samplers", samplers_}, {"channels", channels_}}};
        if (buffer_.Bytes().empty()) return;
        json_["accessors"] = buffer_.Accessors();
        json_["bufferViews"] = buffer_.Views();
        json_["buffers"] = {{{"byteLength", buffer_.Bytes().size()}}};
    }

    struct Geometry {
        size_t positions, normals, indices;  // accessors
    };

    const Recording& recording_;
    std::vector<std::vector<Key>> keys_;
    std::vector<RecordedPresence> presences_;  // by node
    GlbBuffer buffer_;
    Json json_, samplers_ = Json::array(), channels_ = Json::array();
    size_t dynamicMaterials_ = 0;
    std::map<std::pair<size_t, size_t>, size_t> meshes_;  // of shape and material
    std::map<size_t, Geometry> geometries_;               // of shape
    std::map<std::vector<float>, size_t> inputs_;         // accessor of key times
};

std::string LittleEndian(uint64_t value) {
    std::string bytes;
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift & 255));
    return bytes;
}

// Chunks are multiples of four bytes long; JSON is filled up with spaces, binary with zeros.
std::string Padded(std::string bytes, char filler) {
    bytes.resize((bytes.size() + 3) / 4 * 4, filler);
    return bytes;
}

}  // namespace

Status WriteGlb(const Recording& recording, const std::filesystem::path& path) {
    if (Status valid = CheckRecording(recording); !valid) return valid;
    if (recording.bodies.empty())
        return Error{ErrorCode::OutOfRange,
                     "cannot write " + path.string() + ": the recording has no bodies, and glTF no empty scenes"};
    const Document document(recording);
    const std::string text = Padded(document.Text().dump(-1, ' ', false, Json::error_handler_t::replace), ' ');
    const std::string binary = Padded(document.Binary(), '\0');
    const uint64_t length = 12 + 8 + text.size() + (binary.empty() ? 0 : 8 + binary.size());
    if (length > kLargestFile)
        return Error{ErrorCode::OutOfRange,
                     "cannot write " + path.string() + ": " + std::to_string(length) + " bytes do not fit into a .glb"};
    const std::string header = "glTF" + LittleEndian(2) + LittleEndian(length) + LittleEndian(text.size()) + "JSON";
    const std::string binaryHeader = binary.empty() ? "" : LittleEndian(binary.size()) + std::string("BIN\0", 4);
    return WriteWholeFile(path, {header, text, binaryHeader, binary}, MissingFolders::AreCreated);
}

}  // namespace fulcrum
