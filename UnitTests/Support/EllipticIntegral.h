// The period of a pendulum of any amplitude, for its tests and the accuracy lab. Header only; pure.
#pragma once

#include <cmath>

namespace fulcrum::testing {

// Complete elliptic integral of the first kind: K(k) = pi / (2 agm(1, sqrt(1 - k^2))), 0 <= k < 1.
inline double EllipticK(double k) {
    double a = 1, b = std::sqrt(1 - k * k);
    for (int i = 0; i < 8; ++i) {
        const double mean = 0.5 * (a + b);
        b = std::sqrt(a * b);
        a = mean;
    }
    return 3.14159265358979323846 / (2 * a);
}

}  // namespace fulcrum::testing
