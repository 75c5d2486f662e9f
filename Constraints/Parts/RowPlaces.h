// Structs that lanes gather as rows of eight floats (GatherRows). Each names the places of its members in their rows in
// an enumeration beside them, and FULCRUM_CHECK_PLACE below the struct holds the two together.
#pragma once

#include <Fulcrum/Math/Matrix.h>

#include <cstddef>

namespace fulcrum {

inline constexpr size_t kRowFloats = 8;

// A member begins at this place of this row of its struct.
#define FULCRUM_CHECK_PLACE(type, member, row, place)                                                   \
    static_assert(offsetof(type, member) == sizeof(float) * (kRowFloats * size_t(row) + size_t(place)), \
                  #member " lies at another place of its row")

// Members of more than one float, from their place on.
template <class Real>
FULCRUM_FORCE_INLINE Vec3<Real> VectorAt(const Real (&row)[kRowFloats], int place) {
    return Vec3<Real>(row[place], row[place + 1], row[place + 2]);
}
template <class Real>
FULCRUM_FORCE_INLINE Quat<Real> QuaternionAt(const Real (&row)[kRowFloats], int place) {
    return {row[place], row[place + 1], row[place + 2], row[place + 3]};
}
template <class Real>
FULCRUM_FORCE_INLINE void SetVectorAt(Real (&row)[kRowFloats], int place, const Vec3<Real>& v) {
    for (int k = 0; k < 3; ++k) row[place + k] = v[k];
}

}  // namespace fulcrum
