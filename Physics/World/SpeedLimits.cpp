#include <Fulcrum/Physics/World/SpeedLimits.h>

#include <cmath>
#include <limits>

namespace fulcrum {

namespace {

// m/s, m/s2 etc.: larger changes reach the speed limit in any step anyway.
constexpr double kMostChange = 1e18;

}  // namespace

Vector3 LimitedPush(const Vector3& push, double inverse) {
    const Position exact = push.cast<double>();
    const double made = std::sqrt(Dot<double>(exact, exact)) * inverse;
    return made > kMostChange ? Vector3((exact * (kMostChange / made)).cast<float>()) : push;
}

bool LimitLength(Vector3& v, float limit) {
    const float squared = LengthSquared(v);
    if (!(squared > limit * limit)) return false;
    if (squared <= std::numeric_limits<float>::max()) {
        v *= limit / std::sqrt(squared);
    } else {
        const Position exact = v.cast<double>();
        v = (exact * (double{limit} / std::sqrt(Dot<double>(exact, exact)))).cast<float>();
    }
    return true;
}

}  // namespace fulcrum
