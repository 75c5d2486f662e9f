// Helpers for structs that are gathered into lanes as rows of eight floats (GatherRows). Each struct names the indices
// of its members in their rows by an enumeration, which FULCRUM_CHECK_PLACE below the struct checks.
#pragma once

#include <Fulcrum/Math/Matrix.h>

#include <cstddef>
#include <type_traits>

namespace fulcrum {

inline constexpr size_t kRowFloats = 8;

// Asserts that a member begins at this index of this row of its struct.
#define FULCRUM_CHECK_PLACE(type, member, row, place)                                                   \
    static_assert(offsetof(type, member) == sizeof(float) * (kRowFloats * size_t(row) + size_t(place)), \
                  #member " lies at another place of its row")

// Members of several floats, from their index on.
template <int kPlace, class Real>
FULCRUM_FORCE_INLINE Vec3<Real> VectorAt(const Real (&row)[kRowFloats]) {
    return Vec3<Real>(row[kPlace], row[kPlace + 1], row[kPlace + 2]);
}
template <int kPlace, class Real>
FULCRUM_FORCE_INLINE Quat<Real> QuaternionAt(const Real (&row)[kRowFloats]) {
    return {row[kPlace], row[kPlace + 1], row[kPlace + 2], row[kPlace + 3]};
}
template <int kPlace, class Real>
FULCRUM_FORCE_INLINE void SetVectorAt(Real (&row)[kRowFloats], const std::type_identity_t<Vec3<Real>>& v) {
    for (int k = 0; k < 3; ++k) row[kPlace + k] = v[k];
}

}  // namespace fulcrum
