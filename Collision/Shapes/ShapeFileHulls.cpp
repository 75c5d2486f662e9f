// Hulls and mass properties in shape files.
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/ShapeFileParts.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

// Whether corners lie in their face's plane and no vertex outside it, to within rounding.
bool IsConvexPolyhedron(const HullMesh& mesh) {
    double size = 0;
    for (const Position& v : mesh.vertices) size = std::max(size, std::sqrt(Dot(v, v)));
    for (const HullMesh::Face& face : mesh.faces) {
        if (!IsUnit(Dot(face.normal, face.normal))) return false;
        double outermost = -INFINITY, lowestCorner = INFINITY;
        for (const Position& v : mesh.vertices) outermost = std::max(outermost, Dot(face.normal, v));
        for (int i = 0; i < face.corners.cornerCount; ++i) {
            const Position& corner = mesh.vertices[mesh.indices[face.corners.firstIndex + i]];
            lowestCorner = std::min(lowestCorner, Dot(face.normal, corner));
        }
        if (!(outermost - lowestCorner <= 0.01 * size) || !(outermost > 0)) return false;
    }
    return IsClosedPolyhedron(mesh);
}

}  // namespace

void WriteMass(const MassProperties& mass, ByteWriter& out) {
    out.Write(mass.volume);
    out.Write(mass.centerOfMass);
    out.Write(mass.principalInertia);
    out.Write(mass.principalAxes);
}

MassProperties ReadMass(ByteReader& in) {
    MassProperties mass;
    in.Read(mass.volume);
    in.Read(mass.centerOfMass);
    in.Read(mass.principalInertia);
    in.Read(mass.principalAxes);
    return mass;
}

bool IsPlausible(const MassProperties& mass) {
    if (!std::isfinite(mass.volume) || !(mass.volume > 0) || !IsFinite(mass.centerOfMass)) return false;
    const Vector3& inertia = mass.principalInertia;
    if (!IsFinite(inertia) || !(inertia.minCoeff() > 0) || !IsFinite(mass.principalAxes)) return false;
    const double sum = double{inertia.x()} + double{inertia.y()} + double{inertia.z()};
    return double{inertia.maxCoeff()} <= 0.501 * sum && IsUnit(double{LengthSquared(mass.principalAxes)});
}

void WriteHull(const Shape& shape, ByteWriter& out, const ShapeFileScope&) {
    const auto& hull = static_cast<const ConvexHull&>(shape);
    WriteMass(hull.Mass(), out);
    out.Write(hull.ConvexRadius());
    out.Write(static_cast<uint8_t>(hull.Vertices().size()));
    out.Write(static_cast<uint8_t>(hull.Faces().size()));
    out.WriteAll(hull.Vertices());
    for (const ConvexHull::Face& face : hull.Faces()) {
        out.Write(face.normal);
        out.Write(static_cast<uint8_t>(face.cornerCount));
        out.WriteAll(hull.Indices().subspan(face.firstIndex, face.cornerCount));
    }
}

ShapeResult ReadHull(ByteReader& in, const ShapeFileScope&) {
    const MassProperties mass = ReadMass(in);
    const float convexRadius = in.Get<float>();
    const uint8_t vertexCount = in.Get<uint8_t>(), faceCount = in.Get<uint8_t>();
    std::vector<Vector3> vertices;
    in.ReadAll(vertices, vertexCount, 12);
    HullMesh mesh;
    for (const Vector3& v : vertices) {
        if (!IsFinite(v) || !(v.cwiseAbs().maxCoeff() < 1e18f)) return Damaged("a vertex of a hull is out of range");
        mesh.vertices.push_back(v.cast<double>());
    }
    for (int i = 0; i < faceCount; ++i) {
        Vector3 normal = Vector3::Zero();
        in.Read(normal);
        std::vector<uint8_t> corners;
        in.ReadAll(corners, in.Get<uint8_t>());
        if (in.HasFailed() || !IsFinite(normal) || corners.size() < 3) return Damaged("a face of a hull");
        mesh.faces.push_back(
            {{static_cast<int>(mesh.indices.size()), static_cast<int>(corners.size())}, normal.cast<double>(), 0});
        for (const uint8_t corner : corners) {
            if (corner >= vertexCount) return Damaged("a face of a hull names a vertex that is not there");
            mesh.indices.push_back(corner);
        }
    }
    const bool isRadius = std::isfinite(convexRadius) && convexRadius >= 0;
    if (in.HasFailed() || !isRadius || !IsPlausible(mass) || vertexCount < 4 || faceCount < 4 ||
        !IsConvexPolyhedron(mesh))
        return Damaged("a hull that is no closed convex polyhedron, or its mass");
    return ShapeFileAccess::MakeHull(mesh, mass, convexRadius);
}

}  // namespace fulcrum
