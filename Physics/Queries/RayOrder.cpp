#include <Fulcrum/Physics/Queries/RayOrder.h>

#include <Fulcrum/Physics/Queries/RayBounds.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace fulcrum {
namespace {

// Treats a ray as a point in six dimensions, origin and displacement, and computes its Morton code in the bounding box
// of all rays. The bits of the code are assigned to dimensions by extent, as if the box were repeatedly halved across
// its longest side. So the dimensions in which the rays differ dominate: origins of parallel rays, directions of camera
// rays.
class Places {
public:
    static constexpr int kDigitBits = 11, kBits = 2 * kDigitBits;

    Places(std::span<const Ray> rays, size_t runs)
        : bounds_(RayBounds::Of(rays.size(), [&](size_t i) -> const Ray& { return rays[i]; })) {
        double side[kSides];
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis] = bounds_.low[axis];
            low_[3 + axis] = double{bounds_.displacements.lower[axis]};
            side[axis] = bounds_.high[axis] - bounds_.low[axis];
            side[3 + axis] = double{bounds_.displacements.upper[axis]} - low_[3 + axis];
        }
        for (int k = 0; k < kSides; ++k) scale_[k] = side[k] > 0 ? kMostSteps / side[k] : 0;
        for (int& dealt : dealtTo_) {
            dealt = static_cast<int>(std::max_element(side, side + kSides) - side);
            side[dealt] *= 0.5;
            if (runs > 1 && (runs /= 2) == 1) isWorthIt_ = IsTight(side);
        }
    }

    // Whether neighbors in the order will be close together, assuming that the rays fill their box uniformly.
    bool IsWorthIt() const { return isWorthIt_; }

    // Assigns the bits to dimensions. Call before Of.
    void Deal() {
        int bitsOf[kSides] = {};
        for (int bit = 0; bit < kBits; ++bit) {
            // The first bit assigned to a dimension is its most significant one.
            const int side = dealtTo_[bit], inSide = kSideBits - 1 - bitsOf[side]++;
            for (uint32_t byte = 0; inSide >= 0 && byte < 256; ++byte)
                if (byte >> (inSide & 7) & 1) deal_[side][inSide >> 3][byte] |= 1u << (kBits - 1 - bit);
        }
        for (int k = 0; k < kSides; ++k)
            if (bitsOf[k] > 0 && scale_[k] > 0) used_[usedCount_++] = k;
    }

    uint32_t Of(const Ray& ray) const {
        uint32_t place = 0;
        for (int i = 0; i < usedCount_; ++i) {
            const int k = used_[i];
            const double at = ((k < 3 ? ray.origin[k] : double{ray.displacement[k - 3]}) - low_[k]) * scale_[k];
            const uint32_t step = at > 0 ? static_cast<uint32_t>(std::min(at, kMostSteps)) : 0u;
            place |= deal_[k][0][step & 255] | deal_[k][1][step >> 8];
        }
        return place;
    }

private:
    static constexpr int kSides = 6, kSideBits = 16;
    static constexpr double kMostSteps = 65535;
    static constexpr double kTight = 0.25;  // stricter than RayBounds, since sorting has a cost, too

    bool IsTight(const double (&side)[kSides]) const {
        double reach = 0, way = 0;
        for (int axis = 0; axis < 3; ++axis) {
            reach += 0.5 * (side[axis] + side[3 + axis]);
            // The mean length, independent of the rays' directions.
            const double low = low_[3 + axis], high = double{bounds_.displacements.upper[axis]};
            way += 0.5 * (std::max(-low, high) + std::fabs(0.5 * (low + high)));
        }
        return reach <= kTight * way;
    }

    RayBounds bounds_;
    double low_[kSides], scale_[kSides];
    int dealtTo_[kBits];  // dimension of each bit of a code, most significant first
    int used_[kSides];
    int usedCount_ = 0;
    bool isWorthIt_ = false;
    uint32_t deal_[kSides][2][256] = {};  // code bits for each byte of a dimension
};

}  // namespace

void RayOrder::Sort(std::span<const Ray> rays, uint32_t together) {
    const uint32_t count = static_cast<uint32_t>(rays.size());
    numbers_.resize(count);
    Places places(rays, count / together);
    if (!places.IsWorthIt()) {
        std::iota(numbers_.begin(), numbers_.end(), 0u);
        return;
    }
    places.Deal();
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
