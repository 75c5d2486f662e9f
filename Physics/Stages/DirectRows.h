// What the rows of joints and of contacts have in common where an island is solved directly. Used by DirectIsland and
// DirectContacts.
#pragma once

#include <Fulcrum/Constraints/Direct/DirectProblem.h>
#include <Fulcrum/Math/Vector.h>

namespace fulcrum::direct {

using Vector = Vec3<double>;

// m/s2, least gravity that counts for tolerances and softness.
inline constexpr double kLeastGravity = 1;
// m or rad: corrections that rounding asks for, of floats at arms of some meters. What is redundant would take them for
// contradictions, and move far along what it hardly holds.
inline constexpr double kRounding = 1e-6;

template <class Real>
Vector InDouble(const Vec3<Real>& v, int lane) {
    return Vector(double{v.x()[lane]}, double{v.y()[lane]}, double{v.z()[lane]});
}

inline void Set(double (&j)[6], const Vector& linear, const Vector& angular) {
    for (int k = 0; k < 3; ++k) {
        j[k] = linear[k];
        j[3 + k] = angular[k];
    }
}

// J M^-1 J^T of one body.
inline double ResponseOf(const DirectBody& body, const double (&j)[6]) {
    const double* i = body.inverseInertia;
    double linear = 0;
    for (int k = 0; k < 3; ++k)
        if (!(body.lockedAxes >> k & 1u)) linear += j[k] * j[k];
    const double x = j[3], y = j[4], z = j[5];
    return body.inverseMass * linear + (i[0] * x * x + i[1] * y * y + i[2] * z * z) +
           2 * (i[3] * x * y + i[4] * x * z + i[5] * y * z);
}
inline double ResponseOf(std::span<const DirectBody> bodies, const DirectRow& row) {
    double k = 0;
    if (row.a != DirectRow::kNone) k += ResponseOf(bodies[row.a], row.ja);
    if (row.b != DirectRow::kNone) k += ResponseOf(bodies[row.b], row.jb);
    return k;
}

}  // namespace fulcrum::direct
