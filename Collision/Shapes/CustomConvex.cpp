#include <Fulcrum/Collision/Shapes/CustomConvex.h>

#include <Fulcrum/Collision/Shapes/SampledSurface.h>
#include <Fulcrum/Collision/Shapes/SizeChecks.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

SolidMass MassOf(const SampledSurface& surface) {
    std::vector<Position> vertices;
    for (const Vector3& v : surface.vertices) vertices.push_back(v.cast<double>());
    std::vector<PolygonRange> triangles;
    for (int i = 0; i < static_cast<int>(surface.indices.size()); i += 3) triangles.push_back({i, 3});
    return PolyhedronMass(vertices, triangles, surface.indices);
}

// Richardson extrapolation: the error of an inscribed mesh falls with the square of its spacing, so that a third of the
// difference to a mesh of twice the spacing remains. It is 0 for polyhedra.
double Extrapolated(double fine, double coarse) { return fine + (fine - coarse) / 3; }

SolidMass Extrapolated(const SolidMass& fine, const SolidMass& coarse) {
    SolidMass solid;
    solid.volume = Extrapolated(fine.volume, coarse.volume);
    for (int i = 0; i < 3; ++i) solid.center[i] = Extrapolated(fine.center[i], coarse.center[i]);
    const Sym3<double>&f = fine.inertia, &c = coarse.inertia;
    solid.inertia = {Extrapolated(f.xx, c.xx), Extrapolated(f.yy, c.yy), Extrapolated(f.zz, c.zz),
                     Extrapolated(f.xy, c.xy), Extrapolated(f.xz, c.xz), Extrapolated(f.yz, c.yz)};
    return solid;
}

// Each point must be the farthest along its own direction.
Status CheckSupports(const ConvexShape& shape, const SampledSurface& surface) {
    float size = 0;
    for (const Vector3& v : surface.vertices) {
        if (!IsFinite(v)) return Error{ErrorCode::NonFinite, "FarthestPoint returned a point that is not finite"};
        size = std::max(size, Length(v));
    }
    for (size_t i = 0; i < 2 * surface.vertices.size(); ++i) {
        const Vector3 direction = Normalized(surface.vertices[i / 2]) * (i % 2 == 0 ? 1.0f : -1.0f);
        const float most = Dot(direction, shape.Support(direction));
        for (const Vector3& other : surface.vertices) {
            if (Dot(direction, other) <= most + 1e-4f * size) continue;
            return Error{
                ErrorCode::Degenerate,
                Message(
                    "FarthestPoint is not that of a convex shape: along (%g, %g, %g) another point lies %g m farther",
                    double{direction.x()}, double{direction.y()}, double{direction.z()},
                    double{Dot(direction, other) - most})};
        }
    }
    return Done{};
}

}  // namespace

Status CustomConvex::Complete() {
    const DefaultFloats floats;
    if (const Status size = CheckSizeOrZero("convexRadius", convexRadius_); !size) return size.GetError();
    mass_.centerOfMass = Vector3::Zero();
    if (const Status status = CheckSupports(*this, SampleSurface(*this, 6)); !status) return status.GetError();

    constexpr int kDivisions = 128;
    SampledSurface surface = SampleSurface(*this, kDivisions);
    std::optional<SolidMass> solid = KnownMass();
    if (!solid) solid = Extrapolated(MassOf(surface), MassOf(SampleSurface(*this, kDivisions / 2)));
    if (!(solid->volume > 0)) return Error{ErrorCode::Degenerate, "FarthestPoint spans no volume"};
    const Result<MassProperties> mass = ToMassProperties(*solid);
    if (!mass) return mass.GetError();
    mass_ = mass.Value();

    // Outwards by the rounding of the subtraction, a few units in the last place.
    outerRadius_ = 0;
    for (Vector3& v : surface.vertices) {
        v -= mass_.centerOfMass;
        outerRadius_ = std::max(outerRadius_, Length(v));
    }
    const float slack = 1e-6f * (outerRadius_ + Length(mass_.centerOfMass));
    bounds_ = {};
    for (int axis = 0; axis < 3; ++axis) {
        const Vector3 direction = Vector3::Unit(axis);
        bounds_.lower[axis] = Support(Vector3(-direction))[axis] - slack;
        bounds_.upper[axis] = Support(direction)[axis] + slack;
    }
    // The farthest point lies within half a diagonal of the grid's squares, 0.011 rad, of a sampled direction.
    outerRadius_ = outerRadius_ * 1.0001f + slack;
    // The mesh is inscribed: the ball inside it is inside the shape.
    innerRadius_ = outerRadius_;
    for (size_t i = 0; i < surface.indices.size(); i += 3) {
        const Position a = surface.vertices[static_cast<size_t>(surface.indices[i])].cast<double>();
        const Position b = surface.vertices[static_cast<size_t>(surface.indices[i + 1])].cast<double>();
        const Position c = surface.vertices[static_cast<size_t>(surface.indices[i + 2])].cast<double>();
        const Position normal = Cross<double>(Position(b - a), Position(c - a));
        const double length = std::sqrt(Dot<double>(normal, normal));
        // Normals of slivers are only rounding errors.
        if (length <= 1e-7 * double{outerRadius_} * double{outerRadius_}) continue;
        innerRadius_ = std::min(innerRadius_, static_cast<float>(Dot<double>(normal, a) / length));
    }
    innerRadius_ = std::max(innerRadius_, convexRadius_ > 0 ? slack : 0.0f);
    return Done{};
}

}  // namespace fulcrum
