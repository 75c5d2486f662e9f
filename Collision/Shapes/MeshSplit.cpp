#include <Fulcrum/Collision/Shapes/MeshSplit.h>

#include <algorithm>
#include <vector>

namespace fulcrum {
namespace {

constexpr int kBins = 16;
constexpr uint32_t kChunk = 8192;  // boxes that one job takes

struct Bins {
    BoxUnion box[3][kBins];
    uint32_t count[3][kBins] = {};
    void Include(const Bins& other) {
        for (int axis = 0; axis < 3; ++axis) {
            for (int i = 0; i < kBins; ++i) {
                box[axis][i].Include(other.box[axis][i]);
                count[axis][i] += other.count[axis][i];
            }
        }
    }
};

// Maps centers to bins; the same expression partitions the boxes.
struct Binning {
    float from[3], scale[3];
    int BinOf(const TriangleBox& box, int axis) const {
        return std::min(kBins - 1, static_cast<int>((box.Center(axis) - from[axis]) * scale[axis]));
    }
};

// Reduces one result per chunk; sums of counts and minima are the same in any order.
template <class T, class F>
T OverChunks(std::span<const TriangleBox> boxes, const ParallelLoop& parallel, F&& add) {
    const uint32_t count = static_cast<uint32_t>(boxes.size()), chunks = (count + kChunk - 1) / kChunk;
    T total;
    if (chunks <= 1 || !parallel) {
        for (const TriangleBox& box : boxes) add(total, box);
        return total;
    }
    std::vector<T> results(chunks);
    RunLoop(parallel, chunks, [&](uint32_t i) {
        const uint32_t end = std::min(count, (i + 1) * kChunk);
        T result;
        for (uint32_t k = i * kChunk; k < end; ++k) add(result, boxes[k]);
        results[i] = result;
    });
    for (const T& result : results) total.Include(result);
    return total;
}

Binning BinningOf(std::span<const TriangleBox> boxes, const ParallelLoop& parallel) {
    const BoxUnion centers = OverChunks<BoxUnion>(boxes, parallel, [](BoxUnion& sum, const TriangleBox& box) {
        const Wide<8> lanes = Wide<8>::Load(box.lane);
        TriangleBox center;
        for (int axis = 0; axis < 3; ++axis) {
            center.lane[axis] = lanes[axis] - lanes[4 + axis];
            center.lane[4 + axis] = -center.lane[axis];
        }
        center.lane[3] = center.lane[7] = 0;
        sum.Include(center);
    });
    Binning binning;
    for (int axis = 0; axis < 3; ++axis) {
        const float extent = -centers.v[4 + axis] - centers.v[axis];
        binning.from[axis] = centers.v[axis];
        // An extent whose inverse is no float counts as 0.
        binning.scale[axis] = extent > 1e-30f ? kBins * (1 - 1e-6f) / extent : 0.0f;
    }
    return binning;
}

struct Choice {
    int axis = -1, bin = 0;  // bins below `bin` go left
    float cost = 0;
};

Choice BestSplit(const Bins& bins, const Binning& binning, const SplitRules& rules) {
    Choice best;
    for (int axis = 0; axis < 3; ++axis) {
        if (binning.scale[axis] == 0) continue;
        float rightCost[kBins];
        uint32_t rightCount[kBins];
        BoxUnion box;
        uint32_t count = 0;
        for (int i = kBins - 1; i > 0; --i) {
            box.Include(bins.box[axis][i]);
            rightCount[i] = count += bins.count[axis][i];
            rightCost[i] = count == 0 ? 0.0f : box.HalfArea() * static_cast<float>(count);
        }
        box = {};
        count = 0;
        for (int i = 1; i < kBins; ++i) {
            box.Include(bins.box[axis][i - 1]);
            count += bins.count[axis][i - 1];
            if (count == 0 || rightCount[i] == 0 || !rules.Allow(count, rightCount[i])) continue;
            const float cost = box.HalfArea() * static_cast<float>(count) + rightCost[i];
            if (best.axis < 0 || cost < best.cost) best = {axis, i, cost};
        }
    }
    return best;
}

// If no plane between bins is allowed: by count along the longest axis of the centers, a multiple of `leaf` on the
// left.
uint32_t SplitByCount(std::span<TriangleBox> boxes, const Binning& binning, const SplitRules& rules) {
    int axis = 0;
    float best = -1;
    for (int i = 0; i < 3; ++i) {
        const float extent = binning.scale[i] > 0 ? 1 / binning.scale[i] : 0.0f;
        if (extent > best) best = extent, axis = i;
    }
    std::sort(boxes.begin(), boxes.end(), [&](const TriangleBox& a, const TriangleBox& b) {
        const float x = a.Center(axis), y = b.Center(axis);
        return x != y ? x < y : a.Id() < b.Id();
    });
    const uint32_t count = static_cast<uint32_t>(boxes.size());
    if (rules.leaf == 0 || count <= rules.leaf) return count / 2;
    return (count / rules.leaf + 1) / 2 * rules.leaf;
}

}  // namespace

BoxUnion UnionOf(std::span<const TriangleBox> boxes, const ParallelLoop& parallel) {
    return OverChunks<BoxUnion>(boxes, parallel, [](BoxUnion& sum, const TriangleBox& box) { sum.Include(box); });
}

void Split(std::span<TriangleBox> boxes, const BoxSet& set, const SplitRules& rules, const ParallelLoop& parallel,
           BoxSet& left, BoxSet& right) {
    const std::span<TriangleBox> range = boxes.subspan(set.begin, set.Count());
    const Binning binning = BinningOf(range, parallel);
    Choice choice;
    if (!rules.byCount) {
        const Bins bins = OverChunks<Bins>(range, parallel, [&](Bins& sum, const TriangleBox& box) {
            for (int axis = 0; axis < 3; ++axis) {
                const int bin = binning.BinOf(box, axis);
                sum.box[axis][bin].Include(box);
                ++sum.count[axis][bin];
            }
        });
        choice = BestSplit(bins, binning, rules);
    }
    uint32_t middle = 0;
    if (choice.axis < 0) {
        middle = SplitByCount(range, binning, rules);
    } else {
        uint32_t end = set.Count();
        while (middle < end) {
            if (binning.BinOf(range[middle], choice.axis) < choice.bin) ++middle;
            else std::swap(range[middle], range[--end]);
        }
    }
    left = {set.begin, set.begin + middle, UnionOf(range.first(middle), parallel)};
    right = {set.begin + middle, set.end, UnionOf(range.subspan(middle), parallel)};
}

}  // namespace fulcrum
