// Newton's law of restitution and its threshold, for contacts as they are prepared and for hits of continuous
// collision. Free functions, no state.
#pragma once

#include <Fulcrum/Math/Wide.h>

namespace fulcrum {

// The speed at which a point separates that is hit at `speed`, m/s. At the threshold and below nothing bounces, so that
// bodies come to rest.
template <class Real>
inline Real BounceSpeed(Real restitution, Real speed, Real threshold) {
    return Select(speed > threshold, restitution * speed, Real(0.0f));
}

}  // namespace fulcrum
