// Volume, center of mass and inertia of solids, in double. Called by the Create functions of the shapes; pure
// functions. Everything is for density 1 kg/m3; inertia is about the center of mass.
#pragma once

#include <Fulcrum/Collision/Shapes/Shape.h>

#include <span>

namespace fulcrum {

struct SolidMass {
    double volume = 0;                   // m3
    Position center = Position::Zero();  // m
    Sym3<double> inertia;                // kg m2
};

// A polyhedron's surface: corners of polygon i are indices[firstIndex .. firstIndex + cornerCount), counter-clockwise
// seen from outside. Polygons are taken as fans of triangles about their first corner.
struct PolygonRange {
    int firstIndex;
    int cornerCount;
};

// Integral of x x^T over a solid, and the inertia tensor that it makes: trace(C) 1 - C.
using Covariance = Sym3<double>;
void AddOuterProduct(Covariance& c, const Position& v, double weight);
Sym3<double> InertiaOf(const Covariance& c);

// Exact integrals over a closed polyhedron by signed tetrahedra from the mean of its vertices, which keeps the sums
// well conditioned far from the origin. Source: Blow and Binstock, "How to find the inertia tensor (or other mass
// properties) of a 3D solid body represented by a triangle mesh", 2004.
SolidMass PolyhedronMass(std::span<const Position> vertices, std::span<const PolygonRange> polygons,
                         std::span<const int> indices);

// Sum of solids, solid i weighted by densities[i] > 0: `volume` is the sum of the volumes, `inertia` is scaled so that
// the whole has density 1 on average. Overlaps count twice. Parallel axes: I += m (|d|^2 1 - d d^T).
SolidMass CombinedMass(std::span<const SolidMass> solids, std::span<const double> densities);

// The solid after a rotation (unit) about the origin and a translation.
SolidMass Transformed(const SolidMass& solid, const Quaternion& rotation, const Position& translation);

// The solid that MassProperties describes, in the shape's user frame.
SolidMass ToSolidMass(const MassProperties& mass);

// Principal values and axes of a symmetric tensor by cyclic Jacobi rotations; a tensor whose off-diagonal elements are
// below 1e-6 of its largest diagonal element keeps the identity, so that boxes stay aligned with their axes.
struct PrincipalAxes {
    Position values;
    Quaternion rotation;  // from the principal frame to the tensor's
};
PrincipalAxes Diagonalized(const Sym3<double>& tensor);

// Principal form in float. Error: OutOfRange if the volume or a moment of inertia is not a positive normal float, which
// happens at sizes of about 1e-7 m and 1e7 m.
Result<MassProperties> ToMassProperties(const SolidMass& solid);

}  // namespace fulcrum
