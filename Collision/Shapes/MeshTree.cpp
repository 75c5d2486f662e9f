#include <Fulcrum/Collision/Shapes/MeshTree.h>

#include <Fulcrum/Math/Assert.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

// The smallest step of a grid that reaches from `low` to `high` in 255, as its exponent. It is no finer than the floats
// there, so that all grid lines are exact in double; and no finer than 2^-40, so that a ray's fractions stay finite.
int StepExponent(float low, float high) {
    const double extent = double{high} - double{low}, size = std::max(std::fabs(double{low}), std::fabs(double{high}));
    const double wanted = std::max({extent / 255, size * 0x1p-24, 0x1p-40});
    int exponent = static_cast<int>(std::bit_cast<uint64_t>(wanted) >> 52) - 1023;
    while (double{low} + 255 * static_cast<double>(std::bit_cast<float>(static_cast<uint32_t>(exponent + 127) << 23)) <
           double{high})
        ++exponent;
    return exponent;
}

}  // namespace

void SetBoxes(MeshNode& node, std::span<const Bounds> boxes) {
    Bounds all;
    for (const Bounds& box : boxes) all.Include(box);
    for (int axis = 0; axis < 3; ++axis) {
        node.origin[axis] = all.lower[axis];
        node.exponent[axis] = static_cast<uint8_t>(StepExponent(all.lower[axis], all.upper[axis]) + 127);
        const double origin = node.origin[axis], step = node.Step(axis);
        for (size_t i = 0; i < MeshNode::kWidth; ++i) {
            if (i >= boxes.size()) {
                node.lower[axis][i] = 255;
                node.upper[axis][i] = 0;
                continue;
            }
            const double low = boxes[i].lower[axis], high = boxes[i].upper[axis];
            int from = std::clamp(static_cast<int>((low - origin) / step), 0, 255);
            int to = std::clamp(static_cast<int>((high - origin) / step), 0, 255);
            while (from > 0 && origin + from * step > low) --from;
            while (to < 255 && origin + to * step < high) ++to;
            FULCRUM_ASSERT(origin + from * step <= low && origin + to * step >= high);
            node.lower[axis][i] = static_cast<uint8_t>(from);
            node.upper[axis][i] = static_cast<uint8_t>(to);
        }
    }
}

void PackIndices(MeshTree& tree, std::span<const uint32_t> corners) {
    constexpr uint32_t kPage = 1u << MeshTree::kPageBits;
    tree.triangleCount = static_cast<uint32_t>(corners.size() / 3);
    tree.pages.clear();
    tree.indices.clear();
    tree.pages.reserve((tree.triangleCount + kPage - 1) / kPage);
    tree.indices.reserve(corners.size());
    for (uint32_t first = 0; first < tree.triangleCount; first += kPage) {
        const uint32_t count = std::min(kPage, tree.triangleCount - first);
        const std::span<const uint32_t> page = corners.subspan(3 * size_t{first}, 3 * size_t{count});
        const auto [low, high] = std::minmax_element(page.begin(), page.end());
        const bool isNarrow = *high - *low <= 0xFFFF;
        const uint32_t offset = static_cast<uint32_t>(tree.indices.size());
        tree.pages.push_back({isNarrow ? *low : MeshTree::kWideIndices, offset});
        for (const uint32_t corner : page) {
            const uint32_t index = isNarrow ? corner - *low : corner;
            tree.indices.push_back(static_cast<uint16_t>(index & 0xFFFF));
            if (!isNarrow) tree.indices.push_back(static_cast<uint16_t>(index >> 16));
        }
    }
    tree.indices.shrink_to_fit();
}

}  // namespace fulcrum
