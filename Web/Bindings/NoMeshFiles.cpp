// In place of Assets/Meshes, which needs assimp and files: shapes of kind HullFile and MeshFile give this error.
#include <Fulcrum/Assets/Meshes/MeshImport.h>

namespace fulcrum {

namespace {

const Error kNoFiles = {ErrorCode::Unsupported, "files of meshes are not read here; pass a ConvexHull or TriangleMesh"};

}  // namespace

Result<ImportedShape> ImportShape(const std::filesystem::path&, double) { return kNoFiles; }
Result<ImportedMesh> ImportMesh(const std::filesystem::path&, const MeshImportSettings&) { return kNoFiles; }

}  // namespace fulcrum
