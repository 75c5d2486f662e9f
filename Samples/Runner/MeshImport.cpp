#include <Fulcrum/Samples/Runner/MeshImport.h>

#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>

#include <assimp/Importer.hpp>
#include <assimp/scene.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace fulcrum {
namespace {

constexpr size_t kMostHulls = 128;

// A mesh as one node of the file places it.
struct Part {
    std::string name;
    std::vector<Position> points;
};

using Transform = Eigen::Matrix4d;

Transform ToTransform(const aiMatrix4x4& m) {
    Transform transform;
    transform << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4;
    return transform;
}

void CollectParts(const aiScene& scene, const aiNode& node, const Transform& parent, std::vector<Part>& parts) {
    const Transform transform = parent * ToTransform(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) {
        const aiMesh& mesh = *scene.mMeshes[node.mMeshes[i]];
        Part part{mesh.mName.length > 0 ? mesh.mName.C_Str() : node.mName.C_Str(), {}};
        part.points.reserve(mesh.mNumVertices);
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D& point = mesh.mVertices[v];
            part.points.push_back((transform * Eigen::Vector4d(point.x, point.y, point.z, 1)).head<3>());
        }
        parts.push_back(std::move(part));
    }
    for (unsigned i = 0; i < node.mNumChildren; ++i) CollectParts(scene, *node.mChildren[i], transform, parts);
}

struct Box {
    Position lowest = Position::Constant(std::numeric_limits<double>::infinity());
    Position highest = -lowest;

    void Include(const Part& part) {
        for (const Position& point : part.points) {
            if (!IsFinite(point)) continue;
            lowest = lowest.cwiseMin(point);
            highest = highest.cwiseMax(point);
        }
    }
    double LargestExtent() const { return (highest - lowest).maxCoeff(); }
};

Box BoundsOf(const std::vector<Part>& parts) {
    Box box;
    for (const Part& part : parts) box.Include(part);
    return box;
}

Result<std::shared_ptr<const ConvexHull>> HullOf(const Part& part, const Box& box, double size) {
    const double scale = size / box.LargestExtent();
    const Position centre = 0.5 * (box.lowest + box.highest);
    std::vector<Vector3> points;
    points.reserve(part.points.size());
    for (const Position& point : part.points) points.push_back(((point - centre) * scale).cast<float>());
    return ConvexHull::Create(points);
}

std::string Label(const Part& part) {
    return "mesh '" + part.name + "' (" + std::to_string(part.points.size()) + " points)";
}

// Leaves out what has no volume at this scale, then the smallest of too many. The rest may be of another size than the
// whole was, so the caller measures again.
void KeepSolids(std::vector<Part>& parts, double size, std::vector<std::string>& warnings) {
    const Box box = BoundsOf(parts);
    std::vector<std::pair<double, size_t>> volumes;
    for (size_t i = 0; i < parts.size(); ++i) {
        const auto hull = HullOf(parts[i], box, size);
        if (hull) volumes.push_back({-static_cast<double>(hull.Value()->Mass().volume), i});
        else warnings.push_back(Label(parts[i]) + " left out: " + hull.GetError().message);
    }
    if (volumes.size() > kMostHulls) {
        std::sort(volumes.begin(), volumes.end());
        warnings.push_back("the smallest " + std::to_string(volumes.size() - kMostHulls) + " of " +
                           std::to_string(volumes.size()) + " meshes left out");
        volumes.resize(kMostHulls);
    }
    std::vector<size_t> kept;
    for (const auto& [volume, index] : volumes) kept.push_back(index);
    std::sort(kept.begin(), kept.end());
    std::vector<Part> solids;
    for (size_t index : kept) solids.push_back(std::move(parts[index]));
    parts.swap(solids);
}

Result<std::vector<Part>> ReadParts(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) return Error{ErrorCode::UnknownId, "there is no file " + path.string()};
    if (!std::filesystem::is_regular_file(path, ignored))
        return Error{ErrorCode::UnknownId, path.string() + " is not a file"};
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(path.string(), 0);
    if (!scene || !scene->mRootNode)
        return Error{ErrorCode::Unsupported, path.string() + " cannot be read as a mesh: " + importer.GetErrorString()};
    std::vector<Part> parts;
    CollectParts(*scene, *scene->mRootNode, Transform::Identity(), parts);
    if (parts.empty()) return Error{ErrorCode::Degenerate, path.string() + " holds no mesh"};
    return parts;
}

}  // namespace

Result<ImportedShape> ImportShape(const std::filesystem::path& path, double size) {
    Result<std::vector<Part>> read = ReadParts(path);
    if (!read) return read.GetError();
    std::vector<Part> parts = std::move(read.Value());

    ImportedShape imported;
    const double whole = BoundsOf(parts).LargestExtent();
    if (!(whole > 0 && std::isfinite(whole)))
        return Error{ErrorCode::Degenerate, path.string() + " has no extent: all its points coincide, or none is finite"};
    KeepSolids(parts, size, imported.warnings);
    if (parts.empty())
        return Error{ErrorCode::Degenerate, path.string() + " has no part with a volume: " + imported.warnings.front()};

    const Box box = BoundsOf(parts);
    imported.fileSize = box.LargestExtent();
    std::vector<Compound::ChildSettings> children;
    for (const Part& part : parts) {
        const auto hull = HullOf(part, box, size);
        if (!hull) return hull.GetError();
        children.push_back({.shape = hull.Value()});
        imported.points += part.points.size();
        imported.hullVertices += hull.Value()->Vertices().size();
    }
    imported.hulls = children.size();
    if (children.size() == 1) {
        imported.shape = children.front().shape;
        return imported;
    }
    const auto compound = Compound::Create(children);
    if (!compound) return compound.GetError();
    imported.shape = compound.Value();
    return imported;
}

}  // namespace fulcrum
