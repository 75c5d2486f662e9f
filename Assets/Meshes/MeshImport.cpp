#include <Fulcrum/Assets/Meshes/MeshImport.h>

#include <Fulcrum/Assets/TextFloats.h>
#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Assets/Meshes/MeshFile.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fulcrum {
namespace {

constexpr size_t kMostHulls = 128;

Result<std::shared_ptr<const ConvexHull>> HullOf(const MeshPart& part, const MeshBox& box, double size) {
    const double scale = size / box.LargestExtent();
    const Position center = box.Center();
    std::vector<Vector3> points;
    points.reserve(part.points.size());
    for (const Position& point : part.points) points.push_back(((point - center) * scale).cast<float>());
    return ConvexHull::Create(points);
}

std::string Label(const MeshPart& part) {
    return "mesh '" + part.name + "' (" + std::to_string(part.points.size()) + " points)";
}

// Leaves out what has no volume at this scale, then the smallest of too many. The rest may be of another size than the
// whole was, so the caller measures again.
void KeepSolids(std::vector<MeshPart>& parts, double size, std::vector<std::string>& warnings) {
    const MeshBox box = BoundsOf(parts);
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
    std::vector<MeshPart> solids;
    for (size_t index : kept) solids.push_back(std::move(parts[index]));
    parts.swap(solids);
}

// The vertices and triangles of all parts, those without a finite place left out.
struct Triangles {
    std::vector<Position> points;
    std::vector<uint32_t> indices;
    size_t otherFaces = 0, nonFinite = 0;  // left out
};

Triangles Joined(const std::vector<MeshPart>& parts) {
    Triangles all;
    for (const MeshPart& part : parts) {
        const size_t first = all.points.size();
        for (const Position& point : part.points) all.points.push_back(IsFinite(point) ? point : Position::Zero());
        for (const auto& triangle : part.triangles) {
            const bool isFinite =
                std::all_of(triangle.begin(), triangle.end(), [&](uint32_t i) { return IsFinite(part.points[i]); });
            all.nonFinite += isFinite ? 0 : 1;
            for (uint32_t corner : triangle)
                if (isFinite) all.indices.push_back(static_cast<uint32_t>(first + corner));
        }
        all.otherFaces += part.otherFaces;
    }
    return all;
}

// The cyclic rotation of the axes that makes `up` y, and half a turn about z if it points down.
void LayUpAlongY(UpAxis up, std::vector<Position>& points) {
    const int axis = static_cast<int>(up) % 3;
    const double sign = static_cast<int>(up) < 3 ? 1 : -1;
    for (Position& p : points) p = Position(sign * p[(axis + 2) % 3], sign * p[axis], p[(axis + 1) % 3]);
}

double VolumeOf(const std::vector<Vector3>& vertices, const std::vector<uint32_t>& indices) {
    double six = 0;
    for (size_t i = 0; i < indices.size(); i += 3) {
        const Position a = vertices[indices[i]].cast<double>(), b = vertices[indices[i + 1]].cast<double>();
        six += a.dot(b.cross(Position(vertices[indices[i + 2]].cast<double>())));
    }
    return six / 6;
}

// Descriptions of repairs; empty if there were none.
std::vector<std::string> Repairs(const MeshReport& report) {
    std::vector<std::string> lines;
    const auto add = [&](const MeshFinding& finding, const char* what, const char* which) {
        if (finding.count > 0)
            lines.push_back(std::to_string(finding.count) + " " + what + " (the first is " + which + " " +
                            std::to_string(finding.first) + ")");
    };
    add(report.weldedVertices, "vertices welded to an earlier one at the same place", "vertex");
    add(report.unusedVertices, "vertices left out that no triangle uses", "vertex");
    add(report.degenerateTriangles, "triangles without area left out", "triangle");
    add(report.duplicateTriangles, "duplicate triangles left out", "triangle");
    return lines;
}

}  // namespace

Result<ImportedMesh> ImportMesh(const std::filesystem::path& path, const MeshImportSettings& settings) {
    const TextFloats floats;
    if (settings.scale && !(*settings.scale > 0 && std::isfinite(*settings.scale)))
        return Error{ErrorCode::NonPositive,
                     "scale must be finite and above 0, not " + std::to_string(*settings.scale)};
    const Result<std::vector<MeshPart>> parts = ReadMeshParts(path);
    if (!parts) return parts.GetError();
    Triangles all = Joined(parts.Value());
    ImportedMesh imported;
    if (all.otherFaces > 0) imported.repairs.push_back(std::to_string(all.otherFaces) + " points and lines left out");
    if (all.nonFinite > 0)
        imported.repairs.push_back(std::to_string(all.nonFinite) +
                                   " triangles with a corner that is not finite left out");
    if (all.indices.empty())
        return Error{ErrorCode::Degenerate, path.string() + " has no triangles" +
                                                (imported.repairs.empty() ? "" : ": " + imported.repairs.front())};
    LayUpAlongY(settings.up, all.points);
    MeshBox box;
    for (uint32_t corner : all.indices) box.Include(all.points[corner]);
    imported.fileSize = box.LargestExtent();
    imported.scale = settings.scale ? *settings.scale : settings.size / imported.fileSize;
    if (!(imported.fileSize > 0 && std::isfinite(imported.scale)))
        return Error{ErrorCode::Degenerate, path.string() + " has no extent: all its triangles lie in one point"};

    // On y = 0, above the origin.
    const Position middle(box.Center().x(), box.lowest.y(), box.Center().z());
    std::vector<Vector3> vertices;
    vertices.reserve(all.points.size());
    for (const Position& point : all.points) vertices.push_back(((point - middle) * imported.scale).cast<float>());
    // The rounding of the largest coordinate is 6e-8 of it: closer points were one vertex.
    TriangleMeshSettings mesh{.vertices = vertices, .indices = all.indices};
    mesh.weldDistance = static_cast<float>(1e-6 * imported.scale * imported.fileSize);
    auto created = TriangleMesh::Create(mesh, &imported.report);
    // The orientation is used if it is consistent and encloses a volume; otherwise the mesh is two-sided.
    const bool isClosed = imported.report.boundaryEdges == 0 && imported.report.irregularEdges == 0;
    imported.isTwoSided = mesh.isTwoSided = created && !(isClosed && VolumeOf(vertices, all.indices) > 0);
    if (mesh.isTwoSided) {
        imported.report = {};
        created = TriangleMesh::Create(mesh, &imported.report);
    }
    if (!created) return Error{created.GetError().code, path.string() + ": " + created.GetError().message};
    imported.mesh = created.Value();
    for (std::string& line : Repairs(imported.report)) imported.repairs.push_back(std::move(line));
    return imported;
}

Result<ImportedShape> ImportShape(const std::filesystem::path& path, double size) {
    const TextFloats floats;
    Result<std::vector<MeshPart>> read = ReadMeshParts(path);
    if (!read) return read.GetError();
    std::vector<MeshPart> parts = std::move(read.Value());

    ImportedShape imported;
    const double whole = BoundsOf(parts).LargestExtent();
    if (!(whole > 0 && std::isfinite(whole)))
        return Error{ErrorCode::Degenerate,
                     path.string() + " has no extent: all its points coincide, or none is finite"};
    KeepSolids(parts, size, imported.warnings);
    if (parts.empty())
        return Error{ErrorCode::Degenerate, path.string() + " has no part with a volume: " + imported.warnings.front()};

    const MeshBox box = BoundsOf(parts);
    imported.fileSize = box.LargestExtent();
    std::vector<Compound::ChildSettings> children;
    for (const MeshPart& part : parts) {
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
