// Triangle meshes and height fields in shape files.
#include <Fulcrum/Collision/Shapes/MeshTree.h>
#include <Fulcrum/Collision/Shapes/ShapeFileParts.h>
#include <Fulcrum/Collision/Shapes/SurfaceLimits.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

void WriteNode(const MeshNode& node, ByteWriter& out) {
    out.WriteAll(std::span<const float>(node.origin));
    out.WriteAll(std::span<const uint8_t>(node.exponent));
    out.Write(node.counts);
    for (int axis = 0; axis < 3; ++axis) {
        out.WriteAll(std::span<const uint8_t>(node.lower[axis]));
        out.WriteAll(std::span<const uint8_t>(node.upper[axis]));
    }
    out.WriteAll(std::span<const uint8_t>(node.leafEnd));
    out.Write(node.firstChild);
    out.Write(node.firstTriangle);
}
constexpr size_t kNodeBytes = 80;

MeshNode ReadNode(ByteReader& in) {
    MeshNode node;
    for (float& x : node.origin) in.Read(x);
    for (uint8_t& x : node.exponent) in.Read(x);
    in.Read(node.counts);
    for (int axis = 0; axis < 3; ++axis) {
        for (uint8_t& x : node.lower[axis]) in.Read(x);
        for (uint8_t& x : node.upper[axis]) in.Read(x);
    }
    for (uint8_t& x : node.leafEnd) in.Read(x);
    in.Read(node.firstChild);
    in.Read(node.firstTriangle);
    return node;
}

// Validates a tree: every node and triangle is reached once and in order, and every box contains its triangles. Then no
// search can leave the arrays or miss a triangle.
class TreeCheck {
public:
    explicit TreeCheck(const MeshTree& tree) : tree_(tree) {}
    bool IsValid() {
        Bounds all;
        return Check(0, 0, all) && nextNode_ == tree_.nodes.size() && nextTriangle_ == tree_.triangleCount;
    }

private:
    bool Check(uint32_t index, int depth, Bounds& total) {
        const MeshNode& node = tree_.nodes[index];
        const int nodes = node.NodeCount(), children = node.ChildCount();
        if (depth >= MeshTree::kMaxDepth || children < 1 || children > MeshNode::kWidth || nodes > children)
            return false;
        if (node.firstChild != nextNode_ || node.firstTriangle != nextTriangle_ || !IsGrid(node)) return false;
        if (static_cast<uint32_t>(nodes) > tree_.nodes.size() - nextNode_) return false;
        nextNode_ += static_cast<uint32_t>(nodes);
        for (int i = nodes; i < children; ++i) {
            const uint32_t from = i == nodes ? 0u : node.leafEnd[i - 1], to = node.leafEnd[i];
            if (to <= from || to - from > MeshNode::kMaxLeaf || to - from > tree_.triangleCount - nextTriangle_)
                return false;
            nextTriangle_ += to - from;
            Bounds box;
            for (uint32_t t = node.LeafBegin(i); t < node.LeafEnd(i); ++t) {
                uint32_t corners[3];
                tree_.CornersOf(t, corners);
                for (const uint32_t corner : corners) box.Include(tree_.vertices[corner]);
            }
            if (!IsInside(box, node, i)) return false;
            total.Include(box);
        }
        for (int i = 0; i < nodes; ++i) {
            Bounds box;
            if (!Check(node.firstChild + static_cast<uint32_t>(i), depth + 1, box) || !IsInside(box, node, i))
                return false;
            total.Include(box);
        }
        return true;
    }

    static bool IsGrid(const MeshNode& node) {
        for (int axis = 0; axis < 3; ++axis) {
            if (!(std::fabs(node.origin[axis]) <= kLargestCoordinate)) return false;
            if (node.exponent[axis] < 127 - 40 || node.exponent[axis] > 127 + 50) return false;
        }
        return true;
    }
    static bool IsInside(const Bounds& box, const MeshNode& node, int child) {
        for (int axis = 0; axis < 3; ++axis) {
            const double origin = node.origin[axis], step = node.Step(axis);
            if (!(origin + node.lower[axis][child] * step <= double{box.lower[axis]})) return false;
            if (!(origin + node.upper[axis][child] * step >= double{box.upper[axis]})) return false;
        }
        return true;
    }

    const MeshTree& tree_;
    uint32_t nextNode_ = 1, nextTriangle_ = 0;
};

bool AreVerticesInRange(const MeshTree& tree) {
    return std::ranges::all_of(
        tree.vertices, [](const Vector3& v) { return IsFinite(v) && v.cwiseAbs().maxCoeff() <= kLargestCoordinate; });
}

}  // namespace

void WriteMaterials(std::span<const SurfaceMaterial> materials, ByteWriter& out) {
    out.Write(static_cast<uint8_t>(materials.size()));
    for (const SurfaceMaterial& material : materials) {
        out.Write(material.friction);
        out.Write(material.restitution);
    }
}

std::vector<SurfaceMaterial> ReadMaterials(ByteReader& in) {
    std::vector<SurfaceMaterial> materials(in.Get<uint8_t>());
    for (SurfaceMaterial& material : materials) {
        in.Read(material.friction);
        in.Read(material.restitution);
    }
    return materials;
}

void ShapeFileAccess::WriteMesh(const TriangleMesh& mesh, ByteWriter& out) {
    const MeshTree& tree = *mesh.tree_;
    out.Write(static_cast<uint8_t>(mesh.isTwoSided_));
    out.Write(mesh.activeEdgeCosine_);
    out.Write(mesh.scale_);
    WriteMaterials(mesh.materials_, out);
    out.Write(tree.VertexCount());
    out.Write(tree.triangleCount);
    out.Write(static_cast<uint32_t>(tree.nodes.size()));
    out.Write(static_cast<uint8_t>((tree.materials.empty() ? 0 : 1) | (tree.sources.empty() ? 0 : 2)));
    out.WriteAll(std::span<const Vector3>(tree.vertices).first(tree.VertexCount()));
    for (uint32_t i = 0; i < tree.triangleCount; ++i) {
        uint32_t corners[3];
        tree.CornersOf(i, corners);
        out.WriteAll(std::span<const uint32_t>(corners));
    }
    for (const MeshNode& node : tree.nodes) WriteNode(node, out);
    out.WriteAll(std::span<const uint8_t>(tree.materials));
    out.WriteAll(std::span<const uint32_t>(tree.sources));
}

ShapeResult ShapeFileAccess::ReadMesh(ByteReader& in) {
    const std::shared_ptr<TriangleMesh> mesh(new TriangleMesh);
    const uint8_t isTwoSided = in.Get<uint8_t>();
    mesh->isTwoSided_ = isTwoSided != 0;
    in.Read(mesh->activeEdgeCosine_);
    Vector3 scale = Vector3::Zero();
    in.Read(scale);
    mesh->materials_ = ReadMaterials(in);
    const uint32_t vertexCount = in.Get<uint32_t>(), triangleCount = in.Get<uint32_t>(), nodeCount = in.Get<uint32_t>();
    const uint8_t has = in.Get<uint8_t>();
    const bool isCosine = std::fabs(mesh->activeEdgeCosine_) <= 1;
    if (in.HasFailed() || isTwoSided > 1 || has > 3 || !isCosine || triangleCount == 0 || nodeCount == 0 ||
        vertexCount < 3 || triangleCount > kMostTriangles || nodeCount > triangleCount)
        return Damaged("the counts or settings of a mesh");
    if (const Status status = TriangleMesh::CheckMaterials(mesh->materials_); !status) return status.GetError();

    const auto tree = std::make_shared<MeshTree>();
    std::vector<uint32_t> corners;
    in.ReadAll(tree->vertices, vertexCount, 12);
    in.ReadAll(corners, 3 * uint64_t{triangleCount});
    if (in.HasFailed() || nodeCount > in.Rest().size() / kNodeBytes) return Damaged("a mesh breaks off");
    tree->nodes.reserve(nodeCount);
    for (uint32_t i = 0; i < nodeCount; ++i) tree->nodes.push_back(ReadNode(in));
    in.ReadAll(tree->materials, (has & 1) != 0 ? triangleCount : 0);
    in.ReadAll(tree->sources, (has & 2) != 0 ? triangleCount : 0);
    if (in.HasFailed()) return Damaged("a mesh breaks off");

    if (!AreVerticesInRange(*tree)) return Damaged("a vertex of a mesh");
    if (std::ranges::any_of(corners, [&](uint32_t corner) { return corner >= vertexCount; })) {
        return Damaged("a triangle names a vertex that is not there");
    }
    for (size_t i = 0; i < corners.size(); i += 3) {
        if (!HasArea(tree->vertices[corners[i]], tree->vertices[corners[i + 1]], tree->vertices[corners[i + 2]], 0))
            return Damaged("a triangle has no area");
    }
    for (const uint8_t material : tree->materials) {
        if (!mesh->materials_.empty() && material >= mesh->materials_.size()) return Damaged("a material of a mesh");
    }
    tree->vertices.push_back(Vector3::Zero());
    PackIndices(*tree, corners);
    if (!TreeCheck(*tree).IsValid()) return Damaged("the tree of a mesh");
    mesh->tree_ = tree;
    if (scale == Vector3(Vector3::Ones())) {
        mesh->Finish(nullptr);
        return ShapePtr(mesh);
    }
    const auto scaled = TriangleMesh::Scaled(*mesh, scale);
    if (!scaled) return scaled.GetError();
    return ShapePtr(scaled.Value());
}

void ShapeFileAccess::WriteField(const HeightField& field, ByteWriter& out) {
    out.Write(field.sampleCountX_);
    out.Write(field.sampleCountZ_);
    out.Write(field.cellSizeX_);
    out.Write(field.cellSizeZ_);
    out.Write(field.origin_);
    out.Write(static_cast<uint8_t>(field.precision_));
    out.Write(field.lowestHeight_);
    out.Write(field.highestHeight_);
    out.Write(static_cast<uint8_t>(field.isTwoSided_));
    out.Write(field.activeEdgeCosine_);
    WriteMaterials(field.materials_, out);
    // None if all are 0, however they came to be so: equal contents have equal bytes.
    const bool hasCells = std::ranges::any_of(field.cells_, [](uint8_t cell) { return cell != 0; });
    out.Write(static_cast<uint8_t>(hasCells));
    out.WriteAll(std::span<const float>(field.heights_));
    out.WriteAll(std::span<const uint16_t>(field.steps_));
    if (hasCells) out.WriteAll(std::span<const uint8_t>(field.cells_));
}

ShapeResult ShapeFileAccess::ReadField(ByteReader& in) {
    HeightFieldSettings settings;
    in.Read(settings.sampleCountX);
    in.Read(settings.sampleCountZ);
    in.Read(settings.cellSizeX);
    in.Read(settings.cellSizeZ);
    in.Read(settings.origin);
    const uint8_t precision = in.Get<uint8_t>();
    settings.precision = static_cast<HeightPrecision>(precision);
    in.Read(settings.lowestHeight);
    in.Read(settings.highestHeight);
    const uint8_t isTwoSided = in.Get<uint8_t>();
    settings.isTwoSided = isTwoSided != 0;
    in.Read(settings.activeEdgeCosine);
    const std::vector<SurfaceMaterial> materials = ReadMaterials(in);
    settings.materials = materials;
    const uint8_t hasCells = in.Get<uint8_t>();
    if (in.HasFailed() || precision > 1 || isTwoSided > 1 || hasCells > 1)
        return Damaged("the settings of a height field");
    if (const Status status = HeightField::CheckGrid(settings); !status) return status.GetError();

    const uint64_t samples = uint64_t{settings.sampleCountX} * settings.sampleCountZ;
    const uint64_t cellCount = uint64_t{settings.sampleCountX - 1} * (settings.sampleCountZ - 1);
    const bool isFloat = settings.precision == HeightPrecision::Float;
    std::vector<float> heights;
    std::vector<uint16_t> steps;
    std::vector<uint8_t> cells;
    in.ReadAll(heights, isFloat ? samples : 0);
    in.ReadAll(steps, isFloat ? 0 : samples);
    in.ReadAll(cells, hasCells != 0 ? cellCount : 0);
    if (in.HasFailed()) return Damaged("a height field breaks off");
    settings.cells = cells;
    const Result<std::shared_ptr<HeightField>> field = HeightField::Prepare(settings);
    if (!field) return field.GetError();
    if (const Status status = field.Value()->CheckHeights(heights); !status) return status.GetError();
    field.Value()->heights_ = std::move(heights);
    field.Value()->steps_ = std::move(steps);
    field.Value()->Finish();
    return ShapePtr(field.Value());
}

}  // namespace fulcrum
