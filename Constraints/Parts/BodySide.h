// Shared by all constraint parts: how a body moves, if known at compile time, and masked updates of lanes. Used by the
// parts and the code that sets them up. No state.
#pragma once

#include <Fulcrum/Constraints/Parts/BodyState.h>

#include <cstdint>

namespace fulcrum {

// Template parameter of rows and of the rotation-Euler part; the other blocks treat every body as Dynamic, with zero
// inverse mass if it cannot move. Static: zero velocity, infinite mass; not accessed. Kinematic: its velocity is read,
// infinite mass; not written.
enum class BodySide : uint8_t { Static, Kinematic, Dynamic };

constexpr bool HasVelocity(BodySide side) { return side != BodySide::Static; }
constexpr bool HasMass(BodySide side) { return side == BodySide::Dynamic; }

// bool for float, a mask of lanes for Wide.
template <class Real>
using MaskOf = decltype(Real(0.0f) < Real(0.0f));

// mask ? a : +0. Subtracting it keeps lanes with a false mask bit-identical, -0 and NaN included; a product with zero
// would not.
inline float ZeroUnless(bool mask, float a) { return mask ? a : 0.0f; }
template <int N>
inline Wide<N> ZeroUnless(WideMask<N> mask, Wide<N> a) {
    return Wide<N>::Of(mask.bits ? a.v : typename Wide<N>::Float{});
}
template <class Real>
inline Vec3<Real> ZeroUnless(MaskOf<Real> mask, const Vec3<Real>& a) {
    return Vec3<Real>(ZeroUnless(mask, a.x()), ZeroUnless(mask, a.y()), ZeroUnless(mask, a.z()));
}

}  // namespace fulcrum
