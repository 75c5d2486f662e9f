#include <Fulcrum/Assets/Meshes/MeshFile.h>

#include <Eigen/LU>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <limits>
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

void CollectParts(const aiScene& scene, const aiNode& node, const Transform& parent, std::vector<MeshPart>& parts) {
    const Transform transform = parent * ToTransform(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i)
        parts.push_back(Placed(*scene.mMeshes[node.mMeshes[i]], node, transform));
    for (unsigned i = 0; i < node.mNumChildren; ++i) CollectParts(scene, *node.mChildren[i], transform, parts);
}

}  // namespace

MeshBox::MeshBox() : lowest(Position::Constant(std::numeric_limits<double>::infinity())), highest(-lowest) {}

MeshBox BoundsOf(const std::vector<MeshPart>& parts) {
    MeshBox box;
    for (const MeshPart& part : parts)
        for (const Position& point : part.points)
            if (IsFinite(point)) box.Include(point);
    return box;
}

Result<std::vector<MeshPart>> ReadMeshParts(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        return Error{ErrorCode::UnknownId, "there is no file " + path.string()};
    if (!std::filesystem::is_regular_file(path, ignored))
        return Error{ErrorCode::UnknownId, path.string() + " is not a file"};
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate);
    if (!scene || !scene->mRootNode)
        return Error{ErrorCode::Unsupported, path.string() + " cannot be read as a mesh: " + importer.GetErrorString()};
    std::vector<MeshPart> parts;
    CollectParts(*scene, *scene->mRootNode, Transform::Identity(), parts);
    if (parts.empty()) return Error{ErrorCode::Degenerate, path.string() + " holds no mesh"};
    return parts;
}

}  // namespace fulcrum
