// Newton's law of restitution and its threshold, for contacts as they are prepared and for hits of continuous
// collision. Free functions, no state.
#pragma once

#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

// Separation speed after an impact at `speed`, m/s. Zero at the threshold and below, so that bodies come to rest.
template <class Real>
inline Real BounceSpeed(Real restitution, Real speed, Real threshold) {
    return Select(speed > threshold, restitution * speed, Real(0.0f));
}

}  // namespace fulcrum
