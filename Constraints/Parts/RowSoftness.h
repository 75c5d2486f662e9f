// How soft a row is that a solver of many small substeps sets up anew in each of them, without knowing its mass. Chosen
// by whoever sets a part up. Plain data, no threads.
//
//     delta lambda = -massScale K^-1 (J v + b) - impulseScale * total lambda
// (1, 0) is the hard row. A spring of gamma (SpringPart.h) has massScale = K / (K + gamma), impulseScale = gamma / (K +
// gamma); implicit, with w = 2 pi f, substep h and a = h w (2 zeta + h w), that is a / (1 + a) and 1 / (1 + a),
// whatever the mass, and b = C w / (2 zeta + h w).   Source: E. Catto, "Solver2D", 2024.
#pragma once

namespace fulcrum {

// Both 0..1.
template <class Real>
struct RowSoftness {
    Real massScale = Real(1.0f);
    Real impulseScale = Real(0.0f);
};

}  // namespace fulcrum
