// Mass properties of solids of revolution, exact. Called by the Create functions of the round shapes; pure functions.
#pragma once

#include <Fulcrum/Collision/Shapes/MassProperties.h>

namespace fulcrum {

// The part of a solid of revolution about y between two heights, its squared radius a polynomial of t = y - from, m2.
struct RevolutionPiece {
    double from, to;
    double c0, c1, c2;  // squared radius = c0 + c1 t + c2 t^2
};

// The slice of a ball of `radius` about the height `center`.
RevolutionPiece BallSlice(double from, double to, double center, double radius);
// A cone's frustum, of radius `lower` at `from` and `upper` at `to`.
RevolutionPiece Frustum(double from, double to, double lower, double upper);

// Sum of the pieces. Discs of radius r: dV = pi r^2 dy, dI_yy = pi r^4 / 2 dy, dI_xx = pi (r^4 / 4 + r^2 y^2) dy, all
// polynomials, integrated term by term; then parallel axes.
SolidMass RevolutionMass(std::span<const RevolutionPiece> pieces);

}  // namespace fulcrum
