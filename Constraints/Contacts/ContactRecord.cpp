#include <Fulcrum/Constraints/Contacts/ContactRecord.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

namespace {

// Pseudo-angle: increases monotonically with the angle of (x, y) about the origin, 0..4; no trigonometry.
float PseudoAngle(float x, float y) {
    const float sum = std::fabs(x) + std::fabs(y);
    const float t = sum > 0 ? y / sum : 0.0f;
    return x < 0 ? 2.0f - t : (y < 0 ? 4.0f + t : t);
}

}  // namespace

float MeanDistance(const float* x, const float* y, int count) {
    if (count < 2) return 0;
    if (count == 2) {
        const float dx = x[1] - x[0], dy = y[1] - y[0];
        return 0.25f * std::sqrt(dx * dx + dy * dy);
    }
    int order[4] = {0, 1, 2, 3};
    float angle[4];
    for (int i = 0; i < count; ++i) angle[i] = PseudoAngle(x[i], y[i]);
    for (int i = 1; i < count; ++i)
        for (int j = i; j > 0 && angle[order[j]] < angle[order[j - 1]]; --j) std::swap(order[j], order[j - 1]);

    static constexpr float kSimpson[5] = {1.0f / 12, 4.0f / 12, 2.0f / 12, 4.0f / 12, 1.0f / 12};
    float area = 0, moment = 0;
    for (int i = 0; i < count; ++i) {
        const int p = order[i], q = order[(i + 1) % count];
        const float triangle = 0.5f * std::fabs(x[p] * y[q] - y[p] * x[q]);
        float mean = 0;
        for (int k = 0; k < 5; ++k) {
            const float s = 0.25f * static_cast<float>(k);
            const float px = x[p] + (x[q] - x[p]) * s, py = y[p] + (y[q] - y[p]) * s;
            mean += kSimpson[k] * std::sqrt(px * px + py * py);
        }
        area += triangle;
        moment += triangle * mean;
    }
    return area > 0 ? (2.0f / 3.0f) * moment / area : 0.0f;
}

}  // namespace fulcrum
