#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <Fulcrum/Collision/Shapes/MeshBuilder.h>
#include <Fulcrum/Collision/Shapes/MeshEdges.h>
#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/SurfaceLimits.h>
#include <Fulcrum/Collision/Shapes/SurfaceNormal.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

Status CheckSettings(const TriangleMeshSettings& s) {
    const size_t triangles = s.indices.size() / 3;
    if (!std::isfinite(s.activeEdgeCosine) || !std::isfinite(s.weldDistance)) {
        return Error{ErrorCode::NonFinite, Message("activeEdgeCosine %g or weldDistance %g is not finite",
                                                   double{s.activeEdgeCosine}, double{s.weldDistance})};
    }
    if (!(std::fabs(s.activeEdgeCosine) <= 1)) {
        return Error{ErrorCode::OutOfRange,
                     Message("activeEdgeCosine is %g: it must be -1 to 1", double{s.activeEdgeCosine})};
    }
    if (s.weldDistance < 0) {
        return Error{ErrorCode::OutOfRange,
                     Message("weldDistance is %g m: it must be 0 or more", double{s.weldDistance})};
    }
    if (!s.triangleMaterials.empty() && s.triangleMaterials.size() != triangles) {
        return Error{ErrorCode::OutOfRange, Message("%zu triangleMaterials for %zu triangles: one for each, or none",
                                                    s.triangleMaterials.size(), triangles)};
    }
    for (size_t i = 0; i < s.triangleMaterials.size() && !s.materials.empty(); ++i) {
        if (s.triangleMaterials[i] < s.materials.size()) continue;
        return Error{ErrorCode::OutOfRange, Message("material %d of triangle %zu: there are %zu",
                                                    int{s.triangleMaterials[i]}, i, s.materials.size())};
    }
    return Done{};
}

}  // namespace

TriangleMesh::TriangleMesh() : SurfaceShape(ShapeType::TriangleMesh) {}
TriangleMesh::~TriangleMesh() = default;

Result<std::shared_ptr<const TriangleMesh>> TriangleMesh::Create(const TriangleMeshSettings& settings,
                                                                 MeshReport* report, const ParallelLoop& parallel) {
    const DefaultFloats floats;
    if (const Status status = CheckSettings(settings); !status) return status.GetError();
    if (const Status status = CheckMaterials(settings.materials); !status) return status.GetError();
    MeshReport ownReport;
    MeshReport& found = report ? *report : ownReport;
    const Result<RepairedMesh> repaired = RepairMesh(settings.vertices, settings.indices, settings.weldDistance, found);
    if (!repaired) return repaired.GetError();

    std::vector<uint8_t> materials;
    if (!settings.triangleMaterials.empty())
        for (const uint32_t source : repaired.Value().sources) materials.push_back(settings.triangleMaterials[source]);

    const std::shared_ptr<TriangleMesh> mesh(new TriangleMesh);
    mesh->tree_ =
        std::make_shared<MeshTree>(BuildMeshTree(repaired.Value(), materials, settings.keepSourceTriangles, parallel));
    mesh->materials_.assign(settings.materials.begin(), settings.materials.end());
    mesh->isTwoSided_ = settings.isTwoSided;
    mesh->activeEdgeCosine_ = settings.activeEdgeCosine;
    mesh->Finish(&found);
    return std::shared_ptr<const TriangleMesh>(mesh);
}

Result<std::shared_ptr<const TriangleMesh>> TriangleMesh::Scaled(const TriangleMesh& mesh, const Vector3& scale) {
    const DefaultFloats floats;
    if (!IsFinite(scale)) return Error{ErrorCode::NonFinite, "the scale is not finite"};
    const Vector3 whole = mesh.scale_.cwiseProduct(scale);
    for (int axis = 0; axis < 3; ++axis) {
        const float size = std::fabs(whole[axis]);
        if (size >= kSmallestScale && size <= kLargestScale) continue;
        return Error{ErrorCode::OutOfRange,
                     Message("the scale along axis %d comes to %g: its size must be %g to %g", axis,
                             double{whole[axis]}, double{kSmallestScale}, double{kLargestScale})};
    }
    const std::shared_ptr<TriangleMesh> instance(new TriangleMesh);
    instance->tree_ = mesh.tree_;
    instance->materials_ = mesh.materials_;
    instance->isTwoSided_ = mesh.isTwoSided_;
    instance->activeEdgeCosine_ = mesh.activeEdgeCosine_;
    instance->scale_ = whole;
    instance->isScaled_ = whole != Vector3(Vector3::Ones());
    instance->isMirrored_ = (whole.x() < 0) != ((whole.y() < 0) != (whole.z() < 0));
    instance->Finish(nullptr);
    if (!(instance->outerRadius_ <= kLargestCoordinate)) {
        return Error{ErrorCode::OutOfRange, Message("the scaled mesh reaches %g m: at most %g m",
                                                    double{instance->outerRadius_}, double{kLargestCoordinate})};
    }
    return std::shared_ptr<const TriangleMesh>(instance);
}

// Computes the data derived from tree, scale and settings.
void TriangleMesh::Finish(MeshReport* report) {
    MeshEdges edges = FindActiveEdges(*tree_, scale_, activeEdgeCosine_, isTwoSided_);
    activeEdges_ = std::move(edges.active);
    if (report) {
        report->boundaryEdges = edges.boundaryEdges;
        report->irregularEdges = edges.irregularEdges;
    }
    bounds_ = {};
    double farthest = 0;
    for (uint32_t i = 0; i < VertexCount(); ++i) {
        const Vector3 vertex = Vertex(i);
        bounds_.Include(vertex);
        treeExtent_ = std::max(treeExtent_, tree_->vertices[i].cwiseAbs().maxCoeff());
        const Position exact = vertex.cast<double>();
        farthest = std::max(farthest, Dot(exact, exact));
    }
    outerRadius_ = RoundUp(std::sqrt(farthest));
}

uint32_t TriangleMesh::TriangleIdEnd() const { return tree_->triangleCount; }
uint32_t TriangleMesh::VertexCount() const { return tree_->VertexCount(); }
Vector3 TriangleMesh::Vertex(uint32_t id) const {
    const DefaultFloats floats;
    return tree_->vertices[id].cwiseProduct(scale_);
}
bool TriangleMesh::HasSourceTriangles() const { return !tree_->sources.empty(); }
uint32_t TriangleMesh::SourceTriangle(uint32_t id) const { return tree_->sources[id]; }

size_t TriangleMesh::MemoryUsed() const {
    return sizeof(TriangleMesh) + sizeof(MeshTree) + tree_->MemoryUsed() + activeEdges_.capacity() +
           materials_.capacity() * sizeof(SurfaceMaterial);
}

inline void TriangleMesh::FillView(uint32_t id, TriangleView& view) const {
    const MeshTree& tree = *tree_;
    tree.CornersOf(id, view.vertexIds);
    if (isMirrored_) std::swap(view.vertexIds[1], view.vertexIds[2]);
    for (int i = 0; i < 3; ++i) view.vertices[i] = tree.vertices[view.vertexIds[i]].cwiseProduct(scale_);
    view.normal = TriangleNormal(view.vertices[0], view.vertices[1], view.vertices[2]);
    view.id = id;
    view.activeEdges = activeEdges_[id];
    view.material = tree.materials.empty() ? uint8_t{0} : tree.materials[id];
}

TriangleView TriangleMesh::GetTriangle(uint32_t id) const {
    const DefaultFloats floats;
    TriangleView view;
    FillView(id, view);
    return view;
}

void TriangleMesh::GetTriangles(std::span<const uint32_t> ids, TriangleView* views) const {
    for (const uint32_t id : ids) FillView(id, *views++);
}

}  // namespace fulcrum
