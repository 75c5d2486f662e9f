#include <Fulcrum/Assets/Meshes/MeshFile.h>

#include <Fulcrum/Assets/Meshes/ChildProcess.h>
#include <Fulcrum/Assets/TextFloats.h>
#include <Fulcrum/Physics/Files/ErrorBoundary.h>

#include <Eigen/LU>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace fulcrum {
namespace {

using Transform = Eigen::Matrix4d;

Transform ToTransform(const aiMatrix4x4& m) {
    Transform transform;
    transform << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
    return transform;
}

MeshPart Placed(const aiMesh& mesh, const aiNode& node, const Transform& transform) {
    MeshPart part;
    part.name = mesh.mName.length > 0 ? mesh.mName.C_Str() : node.mName.C_Str();
    part.points.reserve(mesh.mNumVertices);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
        const aiVector3D& point = mesh.mVertices[v];
        part.points.push_back((transform * Eigen::Vector4d(point.x, point.y, point.z, 1)).head<3>());
    }
    const bool isMirrored = transform.topLeftCorner<3, 3>().determinant() < 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
        const aiFace& face = mesh.mFaces[f];
        const bool isTriangle = face.mNumIndices == 3 && face.mIndices[0] < mesh.mNumVertices &&
                                face.mIndices[1] < mesh.mNumVertices && face.mIndices[2] < mesh.mNumVertices;
        if (!isTriangle) {
            ++part.otherFaces;
            continue;
        }
        part.triangles.push_back({face.mIndices[0], face.mIndices[1], face.mIndices[2]});
        if (isMirrored) std::swap(part.triangles.back()[1], part.triangles.back()[2]);
    }
    return part;
}

using Parts = std::vector<MeshPart>;

// The meshes of a scene where its nodes place them. The reader of RAW files leaves all but the last node of a file out:
// where a node is missing, meshes that no other one places stand where they are.
class PartCollector {
public:
    explicit PartCollector(const aiScene& scene) : scene_(scene), isPlaced_(scene.mMeshes ? scene.mNumMeshes : 0) {}

    Parts Collect() {
        const aiNode& root = *scene_.mRootNode;
        Visit(root, Transform::Identity());
        for (unsigned i = 0; lacksNodes_ && i < isPlaced_.size(); ++i)
            if (!isPlaced_[i]) Place(i, root, Transform::Identity());
        return std::move(parts_);
    }

private:
    void Visit(const aiNode& node, const Transform& parent) {
        const Transform transform = parent * ToTransform(node.mTransformation);
        for (unsigned i = 0; node.mMeshes && i < node.mNumMeshes; ++i) Place(node.mMeshes[i], node, transform);
        for (unsigned i = 0; node.mChildren && i < node.mNumChildren; ++i) {
            if (node.mChildren[i]) Visit(*node.mChildren[i], transform);
            else lacksNodes_ = true;
        }
    }
    void Place(unsigned number, const aiNode& node, const Transform& transform) {
        const aiMesh* const mesh = number < isPlaced_.size() ? scene_.mMeshes[number] : nullptr;
        if (!mesh || !mesh->mVertices || !mesh->mFaces) return;
        parts_.push_back(Placed(*mesh, node, transform));
        isPlaced_[number] = true;
    }

    const aiScene& scene_;
    std::vector<bool> isPlaced_;
    bool lacksNodes_ = false;
    Parts parts_;
};

Result<Parts> ReadByAssimp(const std::filesystem::path& path) {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate);
    if (!scene || !scene->mRootNode)
        return Error{ErrorCode::Unsupported, path.string() + " cannot be read as a mesh: " + importer.GetErrorString()};
    Parts parts = PartCollector(*scene).Collect();
    if (parts.empty()) return Error{ErrorCode::Degenerate, path.string() + " holds no mesh"};
    return parts;
}

// ---- Between the processes: numbers and arrays in sequence, and at the end the mark of a whole message.

constexpr uint64_t kEnd = 0x646E652073747261;

class PartSender {
public:
    explicit PartSender(const SendBytes& send) : send_(send) {}

    void Send(const Result<Parts>& read) {
        Value(uint8_t{static_cast<bool>(read)});
        if (!read) {
            Value(read.GetError().code);
            Array(read.GetError().message);
        } else {
            Value(uint64_t{read.Value().size()});
            for (const MeshPart& part : read.Value()) {
                Array(part.name);
                Array(part.points);
                Array(part.triangles);
                Value(uint64_t{part.otherFaces});
            }
        }
        Value(kEnd);
    }

private:
    template <class T>
    void Value(const T& value) {
        static_cast<void>(send_(std::as_bytes(std::span(&value, 1))));  // nobody reads a message that breaks off
    }
    template <class List>
    void Array(const List& list) {
        Value(uint64_t{list.size()});
        static_cast<void>(send_(std::as_bytes(std::span(list))));
    }
    const SendBytes& send_;
};

// Trusts nothing: the process that sent it may have overwritten its memory.
class PartReceiver {
public:
    explicit PartReceiver(std::span<const std::byte> bytes) : bytes_(bytes) {}

    // Nothing where it breaks off.
    std::optional<Result<Parts>> Receive() {
        std::optional<Result<Parts>> read;
        if (Value<uint8_t>() != 0) {
            Parts parts;
            for (uint64_t left = Value<uint64_t>(); left > 0 && !hasFailed_; --left) parts.push_back(Part());
            read.emplace(std::move(parts));
        } else {
            const auto code = Value<ErrorCode>();
            read.emplace(Error{code, Array<std::string>()});
        }
        if (Value<uint64_t>() != kEnd || hasFailed_) return std::nullopt;
        return read;
    }

private:
    MeshPart Part() {
        MeshPart part;
        part.name = Array<std::string>();
        part.points = Array<std::vector<Position>>();
        part.triangles = Array<decltype(part.triangles)>();
        part.otherFaces = Value<uint64_t>();
        for (const auto& triangle : part.triangles)
            for (const uint32_t corner : triangle) hasFailed_ |= corner >= part.points.size();
        return part;
    }
    template <class T>
    T Value() {
        T value{};
        Copy(&value, sizeof value);
        return value;
    }
    template <class List>
    List Array() {
        const uint64_t count = Value<uint64_t>();
        constexpr size_t kSize = sizeof(typename List::value_type);
        hasFailed_ |= count > bytes_.size() / kSize;
        List list;
        list.resize(hasFailed_ ? 0 : count);
        Copy(list.data(), list.size() * kSize);
        return list;
    }
    void Copy(void* to, size_t size) {
        hasFailed_ |= size > bytes_.size();
        if (hasFailed_ || size == 0) return;
        std::memcpy(to, bytes_.data(), size);
        bytes_ = bytes_.subspan(size);
    }

    std::span<const std::byte> bytes_;
    bool hasFailed_ = false;
};

Error FailureOf(ProcessEnd end, const std::string& path) {
    const auto of = [&](ErrorCode code, const char* what) {
        return Error{code, path + " cannot be read as a mesh: " + what};
    };
    switch (end) {
        case ProcessEnd::TookTooLong: return of(ErrorCode::OutOfRange, "it takes too long for its size");
        case ProcessEnd::SentTooMuch: return of(ErrorCode::OutOfRange, "its parts are too large");
        case ProcessEnd::NotStarted: return of(ErrorCode::OutOfRange, "no process can be started for it");
        default: return of(ErrorCode::Unsupported, "its reader crashed, so it is broken");
    }
}

}  // namespace

MeshBox::MeshBox() : lowest(Position::Constant(std::numeric_limits<double>::infinity())), highest(-lowest) {}

MeshBox BoundsOf(const std::vector<MeshPart>& parts) {
    const TextFloats floats;
    MeshBox box;
    for (const MeshPart& part : parts)
        for (const Position& point : part.points)
            if (IsFinite(point)) box.Include(point);
    return box;
}

Result<std::vector<MeshPart>> ReadMeshParts(const std::filesystem::path& path) {
    const TextFloats floats;
    constexpr uint64_t kMostMemory = uint64_t{4} << 30, kMostParts = uint64_t{2} << 30;  // bytes
    constexpr uint64_t kBytesPerSecond = 1'000'000;  // some tenths of what assimp reads of the slowest format
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        return Error{ErrorCode::UnknownId, "there is no file " + path.string()};
    if (!std::filesystem::is_regular_file(path, ignored))
        return Error{ErrorCode::UnknownId, path.string() + " is not a file"};
    return WithErrors(path.string(), [&]() -> Result<Parts> {
        const uint64_t size = std::filesystem::file_size(path);
        const auto read = [&](const SendBytes& send) {
            PartSender(send).Send(WithErrors(path.string(), [&] { return ReadByAssimp(path); }));
        };
        const ProcessRun run = RunInProcess(read, {.seconds = 2 + static_cast<unsigned>(size / kBytesPerSecond),
                                                   .bytes = kMostMemory,
                                                   .mostSent = kMostParts});
        if (run.end != ProcessEnd::Returned) return FailureOf(run.end, path.string());
        std::optional<Result<Parts>> parts = PartReceiver(run.sent).Receive();
        if (!parts) return FailureOf(ProcessEnd::Died, path.string());
        return std::move(*parts);
    });
}

}  // namespace fulcrum
