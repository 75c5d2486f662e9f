#include <Fulcrum/Constraints/Joints/JointAngles.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

void TurnCount::Start(double wrapped, const AxisControl& control) {
    numbers = {wrapped};
    if (!control.limited) return;
    const double min = control.limits.min, max = control.limits.max;
    const auto outside = [&](double x) { return std::max(min - x, x - max); };
    if (outside(wrapped) <= 0.0) return;
    for (const double end : {min, max}) {
        if (!std::isfinite(end)) continue;
        for (const double near : {end, end - kFullTurn, end + kFullTurn}) {
            const double candidate = NearestTurn(wrapped, near);
            if (outside(candidate) < outside(numbers[0])) numbers[0] = candidate;
        }
    }
}

}  // namespace fulcrum
