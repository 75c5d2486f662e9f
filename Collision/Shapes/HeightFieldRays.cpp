// Rays against a height field: down the min/max pyramid, nearest blocks first, then along the rows of cells of a block.
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/RayTriangle.h>
#include <Fulcrum/Collision/Shapes/SurfaceNormal.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>

namespace fulcrum {
namespace {

constexpr float kSlack = 1.0f + 0x1p-18f;  // of fractions; covers all rounding together with the pad

struct Interval {
    float from, to;  // fractions
    bool IsEmpty() const { return !(from <= to * kSlack); }
};

// A ray, and the pad by which boxes are enlarged for its rounding: 2^-20 of the largest coordinate.
struct PaddedRay {
    Vector3 origin, displacement, inverse;
    float pad;

    // The interval in which it is between two planes perpendicular to an axis.
    Interval Between(int axis, float low, float high, Interval within) const {
        const bool forward = inverse[axis] >= 0;
        const float first = forward ? low - pad : high + pad, second = forward ? high + pad : low - pad;
        return {Max(within.from, (first - origin[axis]) * inverse[axis]),
                Min(within.to, (second - origin[axis]) * inverse[axis])};
    }
    // The coordinates that it passes in an interval.
    void Extent(int axis, Interval interval, float& low, float& high) const {
        const float a = origin[axis] + displacement[axis] * interval.from,
                    b = origin[axis] + displacement[axis] * interval.to;
        low = Min(a, b) - pad;
        high = Max(a, b) + pad;
    }
};

uint32_t CellAt(float place, float origin, float size, uint32_t first, uint32_t last) {
    const float cell = (place - origin) / size;
    if (!(cell > static_cast<float>(first))) return first;
    return cell >= static_cast<float>(last) ? last : static_cast<uint32_t>(cell);
}

}  // namespace

// Calls visit(id, fraction, isBackFace) for triangles that the ray hits; it returns the new largest fraction, negative
// to stop.
template <class Visitor>
void HeightField::Traverse(const SurfaceRay& ray, float maxFraction, Visitor&& visit) const {
    if (!IsUsable(ray.origin, ray.displacement) || !(maxFraction >= 0)) return;
    const ShearedRay sheared(ray.origin, ray.displacement);
    const bool fromBehind = ray.backFaces || isTwoSided_;
    const PaddedRay padded{ray.origin, ray.displacement, BoundedInverse(ray.displacement),
                           0x1p-20f * (LargestCoordinate(bounds_.lower) + LargestCoordinate(bounds_.upper) +
                                       LargestCoordinate(ray.origin))};

    const auto clipToBox = [&](CellRange x, CellRange z, float low, float high, Interval within) {
        within = padded.Between(0, X(x.first), X(x.last + 1), within);
        within = padded.Between(2, Z(z.first), Z(z.last + 1), within);
        return padded.Between(1, origin_.y() + low, origin_.y() + high, within);
    };
    const auto cellsAlong = [&](int axis, Interval within, CellRange range) -> CellRange {
        float low, high;
        padded.Extent(axis, within, low, high);
        const float from = axis == 0 ? origin_.x() : origin_.z(), size = axis == 0 ? cellSizeX_ : cellSizeZ_;
        return {CellAt(low, from, size, range.first, range.last), CellAt(high, from, size, range.first, range.last)};
    };
    // Tests the two triangles of a cell, unless it is a hole or the ray passes above or below them.
    const auto testCell = [&](uint32_t x, uint32_t z, Interval within) {
        const uint32_t cell = z * CellCountX() + x, sample = z * sampleCountX_ + x;
        if (CellOf(cell) == kHoleCell) return;
        const float a = HeightOf(sample), b = HeightOf(sample + 1), c = HeightOf(sample + sampleCountX_),
                    d = HeightOf(sample + sampleCountX_ + 1), y = origin_.y();
        float low, high;
        padded.Extent(1, within, low, high);
        if (y + Min(Min(a, b), Min(c, d)) > high || y + Max(Max(a, b), Max(c, d)) < low) return;
        const Vector3 atB(X(x + 1), y + b, Z(z)), atC(X(x), y + c, Z(z + 1));
        const Vector3 others[2] = {Vector3(atC.x(), y + a, atB.z()), Vector3(atB.x(), y + d, atC.z())};
        for (uint32_t half = 0; half < 2 && maxFraction >= 0; ++half) {
            float fraction;
            bool isBack;
            const bool isHit =
                half == 0 ? IntersectTriangle(sheared, others[0], atC, atB, fromBehind, maxFraction, fraction, isBack)
                          : IntersectTriangle(sheared, atB, atC, others[1], fromBehind, maxFraction, fraction, isBack);
            if (isHit) maxFraction = visit(2 * cell + half, fraction, isBack);
        }
    };
    const auto testBlock = [&](CellRange x, CellRange z, Interval within) {
        const CellRange rows = cellsAlong(2, within, z);
        for (uint32_t row = rows.first; row <= rows.last; ++row) {
            const Interval inRow = padded.Between(2, Z(row), Z(row + 1), within);
            if (inRow.IsEmpty()) continue;
            const CellRange cells = cellsAlong(0, inRow, x);
            for (uint32_t cell = cells.first; cell <= cells.last; ++cell) {
                const Interval inCell = padded.Between(0, X(cell), X(cell + 1), inRow);
                if (!inCell.IsEmpty()) testCell(cell, row, inCell);
                if (maxFraction < 0) return;
            }
        }
    };

    const CellRange allX{0, CellCountX() - 1}, allZ{0, CellCountZ() - 1};
    const Interval whole = clipToBox(allX, allZ, ranges_.back().low, ranges_.back().high, {0, maxFraction});
    if (whole.IsEmpty()) return;

    struct Entry {
        Interval within;
        uint32_t level, x, z;
    };
    constexpr int kMostLevels = 31;
    Entry stack[3 * kMostLevels + 4];
    int top = 0;
    // Pushes blocks firstX .. lastX, firstZ .. lastZ of a level, at most two by two, onto the stack, the nearest on
    // top.
    const auto push = [&](uint32_t level, CellRange x, CellRange z, Interval within) {
        const int base = top;
        const uint32_t size = kBlock << level;
        for (uint32_t bz = z.first; bz <= z.last; ++bz) {
            for (uint32_t bx = x.first; bx <= x.last; ++bx) {
                const CellRange cellsX{bx * size, std::min(bx * size + (size - 1), allX.last)};
                const CellRange cellsZ{bz * size, std::min(bz * size + (size - 1), allZ.last)};
                const Range& range = RangeOf(level, bx, bz);
                const Interval inBlock = clipToBox(cellsX, cellsZ, range.low, range.high, within);
                if (inBlock.IsEmpty()) continue;
                int at = top++;
                for (; at > base && stack[at - 1].within.from < inBlock.from; --at) stack[at] = stack[at - 1];
                stack[at] = {inBlock, level, bx, bz};
            }
        }
    };
    const CellRange x = cellsAlong(0, whole, allX), z = cellsAlong(2, whole, allZ);
    const uint32_t level = CoarsestNeeded(x, z), size = kBlock << level;
    push(level, {x.first / size, x.last / size}, {z.first / size, z.last / size}, whole);
    while (top > 0) {
        Entry entry = stack[--top];
        entry.within.to = Min(entry.within.to, maxFraction);
        if (entry.within.IsEmpty()) continue;
        const Level& below = levels_[entry.level == 0 ? 0 : entry.level - 1];
        if (entry.level == 0) {
            testBlock({entry.x * kBlock, std::min(entry.x * kBlock + (kBlock - 1), allX.last)},
                      {entry.z * kBlock, std::min(entry.z * kBlock + (kBlock - 1), allZ.last)}, entry.within);
            if (maxFraction < 0) return;
        } else {
            push(entry.level - 1, {2 * entry.x, std::min(2 * entry.x + 1, below.countX - 1)},
                 {2 * entry.z, std::min(2 * entry.z + 1, below.countZ - 1)}, entry.within);
        }
    }
}

Vector3 HeightField::NormalOf(uint32_t id) const {
    uint32_t x[3], z[3];
    CornersOf(id, x, z);
    return TriangleNormal(Vertex(x[0], z[0]), Vertex(x[1], z[1]), Vertex(x[2], z[2]));
}

bool HeightField::CastRay(const SurfaceRay& ray, SurfaceHit& hit, float maxFraction) const {
    const DefaultFloats floats;
    ClosestHit best{maxFraction};
    Traverse(ray, maxFraction,
             [&](uint32_t id, float fraction, bool isBackFace) { return best.Take(id, fraction, isBackFace); });
    if (best.triangle == kNoTriangle) return false;
    hit = best.ToHit(NormalOf(best.triangle));
    return true;
}

bool HeightField::IsHit(const SurfaceRay& ray, float maxFraction) const {
    const DefaultFloats floats;
    bool isHit = false;
    Traverse(ray, maxFraction, [&](uint32_t, float, bool) {
        isHit = true;
        return -1.0f;
    });
    return isHit;
}

void HeightField::SearchRay(const SurfaceRay& ray, float maxFraction, void* context, HitFunction found) const {
    const DefaultFloats floats;
    Traverse(ray, maxFraction, [&](uint32_t id, float fraction, bool isBackFace) {
        const ClosestHit hit{fraction, id, isBackFace};
        return found(context, hit.ToHit(NormalOf(id))) ? maxFraction : -1.0f;
    });
}

}  // namespace fulcrum
