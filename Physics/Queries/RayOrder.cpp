#include <Fulcrum/Physics/Queries/RayOrder.h>

#include <Fulcrum/Physics/Queries/RayBounds.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace fulcrum {
namespace {

// A ray is a point in six dimensions: its origin and its displacement. Its place is the path to it from the box around all,
// halved again and again across its longest side: a Morton code whose bits are dealt out by length. So only what the rays
// differ in counts, be it where they are, as rays from above, or where they go, as those of a camera.
class Places {
public:
    static constexpr int kDigitBits = 11, kBits = 2 * kDigitBits;

    Places(std::span<const Ray> rays, size_t packets) {
        const RayBounds bounds = RayBounds::Of(rays);
        double length[kSides];
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis] = bounds.low[axis];
            low_[3 + axis] = bounds.displacements.lower[axis];
            length[axis] = bounds.high[axis] - bounds.low[axis];
            length[3 + axis] = double{bounds.displacements.upper[axis]} - bounds.displacements.lower[axis];
        }
        int bitsOf[kSides] = {};
        double extent[kSides];
        std::copy(length, length + kSides, extent);
        for (int bit = kBits - 1; bit >= 0; --bit) {
            const int longest = static_cast<int>(std::max_element(length, length + kSides) - length);
            length[longest] *= 0.5;
            if (packets > 1) {
                packets /= 2;
                if (packets <= 1) isWorthIt_ = IsWorthIt(bounds, length);
            }
            // The first bit of a side is the highest of what it is counted in.
            const int inSide = kSideBits - 1 - bitsOf[longest]++;
            for (uint32_t byte = 0; inSide >= 0 && byte < 256; ++byte)
                if (byte >> (inSide & 7) & 1) deal_[longest][inSide >> 3][byte] |= 1u << bit;
        }
        for (int k = 0; k < kSides; ++k) {
            if (bitsOf[k] == 0 || !(extent[k] > 0)) continue;
            used_[usedCount_] = k;
            scale_[usedCount_++] = kMostSteps / extent[k];
        }
    }

    // Whether runs of neighbours will be close, if the rays fill their box evenly.
    bool IsWorthIt() const { return isWorthIt_; }

    uint32_t Of(const Ray& ray) const {
        uint32_t place = 0;
        for (int i = 0; i < usedCount_; ++i) {
            const int k = used_[i];
            const double at = ((k < 3 ? ray.origin[k] : double{ray.displacement[k - 3]}) - low_[k]) * scale_[i];
            const uint32_t step = at > 0 ? static_cast<uint32_t>(std::min(at, kMostSteps)) : 0u;
            place |= deal_[k][0][step & 255] | deal_[k][1][step >> 8];
        }
        return place;
    }

private:
    static constexpr int kSides = 6, kSideBits = 16;
    static constexpr double kMostSteps = 65535;

    static bool IsWorthIt(const RayBounds& bounds, const double (&side)[kSides]) {
        double reach = 0, way = 0;
        for (int axis = 0; axis < 3; ++axis) {
            reach += 0.5 * (side[axis] + side[3 + axis]);
            way += std::max(std::fabs(double{bounds.displacements.lower[axis]}), std::fabs(double{bounds.displacements.upper[axis]}));
        }
        return reach <= RayBounds::kTight * way;
    }

    double low_[kSides];
    double scale_[kSides];
    int used_[kSides];
    int usedCount_ = 0;
    bool isWorthIt_ = false;
    uint32_t deal_[kSides][2][256] = {};  // the bits of a place that a byte of a side gives
};

}  // namespace

void RayOrder::Sort(std::span<const Ray> rays, uint32_t together) {
    const uint32_t count = static_cast<uint32_t>(rays.size());
    numbers_.resize(count);
    const Places places(rays, count / together);
    if (!places.IsWorthIt()) {
        std::iota(numbers_.begin(), numbers_.end(), 0u);
        return;
    }
    items_.resize(count);
    sorted_.resize(count);
    constexpr uint32_t kDigits = 1u << Places::kDigitBits;
    std::array<uint32_t, kDigits> low{}, high{};
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t place = places.Of(rays[i]);
        items_[i] = {place, i};
        ++low[place & (kDigits - 1)];
        ++high[place >> Places::kDigitBits];
    }
    uint32_t lows = 0, highs = 0;
    for (uint32_t digit = 0; digit < kDigits; ++digit) {
        lows += std::exchange(low[digit], lows);
        highs += std::exchange(high[digit], highs);
    }
    for (const Item& item : items_) sorted_[low[item.place & (kDigits - 1)]++] = item;
    for (const Item& item : sorted_) numbers_[high[item.place >> Places::kDigitBits]++] = item.number;
}

}  // namespace fulcrum
