// What every constraint part shares about its two bodies: how a side moves (known at compile time), masked updates
// of lanes. Called by the parts and by whoever sets them up. No state.
#pragma once

#include <Fulcrum/Constraints/Parts/BodyState.h>

#include <cstdint>

namespace fulcrum {

// Of rows and of the rotation-Euler part; the other blocks treat every body as Dynamic, and immovable ones by zeros.
// A side that is not Dynamic is neither read nor written where that changes nothing: Static has no velocity and no
// mass, Kinematic has a velocity, which the row sees, and no mass.
enum class BodySide : uint8_t { Static, Kinematic, Dynamic };

constexpr bool HasVelocity(BodySide side) { return side != BodySide::Static; }
constexpr bool HasMass(BodySide side) { return side == BodySide::Dynamic; }

// bool for float, one truth value a lane for lanes.
template <class Real>
using MaskOf = decltype(Real(0.0f) < Real(0.0f));

// mask ? a : +0. Subtracting it leaves every bit of a lane where the mask is false, -0 and NaN included; a product with
// zero would not.
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
