// The triangles of a height field: their corners, which of their edges are active, which overlap a box.
#include <Fulcrum/Collision/Shapes/BoxDistance.h>
#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Collision/Shapes/SurfaceNormal.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace fulcrum {

void HeightField::CornersOf(uint32_t id, uint32_t (&x)[3], uint32_t (&z)[3]) const {
    const uint32_t cell = id / 2, cellZ = cell / CellCountX(), cellX = cell - cellZ * CellCountX();
    const uint32_t half = id & 1;
    x[0] = cellX + half;
    z[0] = cellZ;
    x[1] = cellX;
    z[1] = cellZ + 1;
    x[2] = cellX + 1;
    z[2] = cellZ + half;
}

HeightField::Slopes HeightField::SlopesOf(uint32_t x, uint32_t z, int half) const {
    const float across = Height(x + 1, z), along = Height(x, z + 1);
    if (half == 0) {
        const float corner = Height(x, z);
        return {(across - corner) / cellSizeX_, (along - corner) / cellSizeZ_};
    }
    const float corner = Height(x + 1, z + 1);
    return {(corner - along) / cellSizeX_, (corner - across) / cellSizeZ_};
}

bool HeightField::HasTriangles(int64_t x, int64_t z) const {
    return x >= 0 && z >= 0 && x < CellCountX() && z < CellCountZ() &&
           !IsHole(static_cast<uint32_t>(x), static_cast<uint32_t>(z));
}

// An edge is convex where the slope across it falls. The three edges of the lower half (0) face -x, the diagonal and
// -z; those of the upper half the diagonal, +z and +x.
uint8_t HeightField::ActiveEdges(uint32_t x, uint32_t z, int half) const {
    const Slopes own = SlopesOf(x, z, half);
    const auto isActive = [&](const Slopes& other, bool isConvex) {
        // Normals (-slope x, 1, -slope z), by the cosine of their angle.
        const float dot = 1 + own.x * other.x + own.z * other.z;
        const float lengths =
            std::sqrt((1 + own.x * own.x + own.z * own.z) * (1 + other.x * other.x + other.z * other.z));
        return dot < activeEdgeCosine_ * lengths && (isTwoSided_ || isConvex);
    };
    const Slopes partner = SlopesOf(x, z, 1 - half);
    const bool isRidge = Height(x + 1, z) + Height(x, z + 1) > Height(x, z) + Height(x + 1, z + 1);
    const bool diagonal = isActive(partner, isRidge);
    if (half == 0) {
        bool atX = true, atZ = true;
        if (HasTriangles(int64_t{x} - 1, z)) {
            const Slopes other = SlopesOf(x - 1, z, 1);
            atX = isActive(other, other.x > own.x);
        }
        if (HasTriangles(x, int64_t{z} - 1)) {
            const Slopes other = SlopesOf(x, z - 1, 1);
            atZ = isActive(other, other.z > own.z);
        }
        return static_cast<uint8_t>((atX ? 1 : 0) | (diagonal ? 2 : 0) | (atZ ? 4 : 0));
    }
    bool atX = true, atZ = true;
    if (HasTriangles(x, int64_t{z} + 1)) {
        const Slopes other = SlopesOf(x, z + 1, 0);
        atZ = isActive(other, own.z > other.z);
    }
    if (HasTriangles(int64_t{x} + 1, z)) {
        const Slopes other = SlopesOf(x + 1, z, 0);
        atX = isActive(other, own.x > other.x);
    }
    return static_cast<uint8_t>((diagonal ? 1 : 0) | (atZ ? 2 : 0) | (atX ? 4 : 0));
}

inline void HeightField::FillView(uint32_t id, TriangleView& view) const {
    uint32_t x[3], z[3];
    CornersOf(id, x, z);
    for (int i = 0; i < 3; ++i) {
        view.vertices[i] = Vertex(x[i], z[i]);
        view.vertexIds[i] = z[i] * sampleCountX_ + x[i];
    }
    view.normal = TriangleNormal(view.vertices[0], view.vertices[1], view.vertices[2]);
    view.id = id;
    view.activeEdges = ActiveEdges(x[1], z[0], static_cast<int>(id & 1));
    view.material = CellOf(id / 2);
}

TriangleView HeightField::GetTriangle(uint32_t id) const {
    const DefaultFloats floats;
    TriangleView view;
    FillView(id, view);
    return view;
}

void HeightField::GetTriangles(std::span<const uint32_t> ids, TriangleView* views) const {
    for (const uint32_t id : ids) FillView(id, *views++);
}

// ---- Boxes

namespace {

// The first and the last of `count` cells, whose borders `at(0)` .. `at(count)` increase, that touch low .. high: from
// a guess to the exact comparison. False: none.
template <class At>
bool TouchedCells(float low, float high, float origin, float size, uint32_t count, At&& at, uint32_t& first,
                  uint32_t& last) {
    if (!(low <= at(count)) || !(high >= at(0))) return false;
    const auto guess = [&](float place) {
        const double cell = (double{place} - double{origin}) / double{size};
        return static_cast<uint32_t>(std::clamp(cell, 0.0, static_cast<double>(count - 1)));
    };
    first = guess(low);
    while (first > 0 && at(first) >= low) --first;
    while (at(first + 1) < low) ++first;
    last = guess(high);
    while (last + 1 < count && at(last + 1) <= high) ++last;
    while (at(last) > high) --last;
    return true;
}

}  // namespace

bool HeightField::FindCells(const Bounds& box, CellRange& x, CellRange& z) const {
    return TouchedCells(
               box.lower.x(), box.upper.x(), origin_.x(), cellSizeX_, CellCountX(), [this](uint32_t i) { return X(i); },
               x.first, x.last) &&
           TouchedCells(
               box.lower.z(), box.upper.z(), origin_.z(), cellSizeZ_, CellCountZ(), [this](uint32_t i) { return Z(i); },
               z.first, z.last);
}

// The lowest level at which the cells lie in at most two blocks either way.
uint32_t HeightField::CoarsestNeeded(CellRange x, CellRange z) const {
    uint32_t level = 0, size = kBlock;
    while (x.last / size - x.first / size > 1 || z.last / size - z.first / size > 1) ++level, size *= 2;
    return level;
}

// Calls block(x, z, cells x, cells z) for all blocks of level 0 below one that hold some of the cells and heights.
template <class Block>
void HeightField::DescendInto(uint32_t level, uint32_t blockX, uint32_t blockZ, CellRange x, CellRange z, float low,
                              float high, Block&& block) const {
    const Range& range = RangeOf(level, blockX, blockZ);
    if (origin_.y() + range.low > high || origin_.y() + range.high < low) return;
    const uint32_t size = kBlock << level;
    x = {std::max(x.first, blockX * size), std::min(x.last, blockX * size + (size - 1))};
    z = {std::max(z.first, blockZ * size), std::min(z.last, blockZ * size + (size - 1))};
    if (level == 0) {
        block(x, z);
        return;
    }
    const uint32_t half = size / 2;
    for (uint32_t bz = z.first / half; bz <= z.last / half; ++bz)
        for (uint32_t bx = x.first / half; bx <= x.last / half; ++bx)
            DescendInto(level - 1, bx, bz, x, z, low, high, block);
}

void HeightField::SearchBox(const Bounds& box, void* context, BatchFunction found) const {
    CellRange x, z;
    if (!box.lower.isAtMost(box.upper) || !FindCells(box, x, z)) return;
    const float low = box.lower.y(), high = box.upper.y();
    uint32_t ids[kMaxBatch];
    int count = 0;
    const auto searchCells = [&](CellRange cellsX, CellRange cellsZ) {
        for (uint32_t cz = cellsZ.first; cz <= cellsZ.last; ++cz) {
            for (uint32_t cx = cellsX.first; cx <= cellsX.last; ++cx) {
                const uint32_t cell = cz * CellCountX() + cx, sample = cz * sampleCountX_ + cx;
                if (CellOf(cell) == kHoleCell) continue;
                const float y = origin_.y();
                const float a = y + HeightOf(sample), b = y + HeightOf(sample + 1),
                            c = y + HeightOf(sample + sampleCountX_), d = y + HeightOf(sample + sampleCountX_ + 1);
                // Both have the cell's own bounds along x and z.
                const float edgeLow = std::min(b, c), edgeHigh = std::max(b, c);
                ids[count] = 2 * cell;
                count += std::min(a, edgeLow) <= high && std::max(a, edgeHigh) >= low ? 1 : 0;
                ids[count] = 2 * cell + 1;
                count += std::min(d, edgeLow) <= high && std::max(d, edgeHigh) >= low ? 1 : 0;
                if (count + 2 > kMaxBatch) {
                    found(context, ids, count);
                    count = 0;
                }
            }
        }
    };
    const uint32_t level = CoarsestNeeded(x, z), size = kBlock << level;
    for (uint32_t bz = z.first / size; bz <= z.last / size; ++bz)
        for (uint32_t bx = x.first / size; bx <= x.last / size; ++bx)
            DescendInto(level, bx, bz, x, z, low, high, searchCells);
    if (count > 0) found(context, ids, count);
}

// Down the min/max pyramid, the nearest blocks first.
void HeightField::SearchNear(const Bounds& box, const float& maxDistance, void* context, BatchFunction found) const {
    if (!box.lower.isAtMost(box.upper)) return;
    const auto square = [&](CellRange x, CellRange z, float low, float high) {
        Bounds cells;
        cells.lower = Vector3(X(x.first), origin_.y() + low, Z(z.first));
        cells.upper = Vector3(X(x.last + 1), origin_.y() + high, Z(z.last + 1));
        return SquaredDistance(cells, box);
    };
    const auto searchCells = [&](CellRange x, CellRange z) {
        for (uint32_t cz = z.first; cz <= z.last; ++cz) {
            uint32_t ids[kMaxBatch];
            int count = 0;
            const float maxSquare = SquareOfReach(maxDistance);
            for (uint32_t cx = x.first; cx <= x.last; ++cx) {
                const uint32_t cell = cz * CellCountX() + cx, sample = cz * sampleCountX_ + cx;
                if (CellOf(cell) == kHoleCell) continue;
                const float a = HeightOf(sample), b = HeightOf(sample + 1), c = HeightOf(sample + sampleCountX_),
                            d = HeightOf(sample + sampleCountX_ + 1);
                // Both have the cell's own bounds along x and z.
                const float edgeLow = std::min(b, c), edgeHigh = std::max(b, c);
                const float corners[2] = {a, d};
                for (uint32_t half = 0; half < 2; ++half) {
                    const float low = std::min(corners[half], edgeLow), high = std::max(corners[half], edgeHigh);
                    ids[count] = 2 * cell + half;
                    count += square({cx, cx}, {cz, cz}, low, high) <= maxSquare ? 1 : 0;
                }
            }
            if (count > 0) found(context, ids, count);
        }
    };
    struct Entry {
        float square;
        uint32_t level, x, z;
    };
    constexpr int kMostLevels = 31;
    Entry stack[3 * kMostLevels + 4];
    int top = 0;
    stack[top++] = {0, static_cast<uint32_t>(levels_.size()) - 1, 0, 0};
    while (top > 0) {
        const Entry entry = stack[--top];
        const float maxSquare = SquareOfReach(maxDistance);
        if (!(entry.square <= maxSquare)) continue;
        const auto cellsOf = [](uint32_t level, uint32_t block, uint32_t count) {
            const uint32_t size = kBlock << level;
            return CellRange{block * size, std::min(block * size + (size - 1), count - 1)};
        };
        if (entry.level == 0) {
            searchCells(cellsOf(0, entry.x, CellCountX()), cellsOf(0, entry.z, CellCountZ()));
            continue;
        }
        const uint32_t level = entry.level - 1;
        const Level& below = levels_[level];
        const int base = top;
        for (uint32_t z = 2 * entry.z; z < std::min(2 * entry.z + 2, below.countZ); ++z) {
            for (uint32_t x = 2 * entry.x; x < std::min(2 * entry.x + 2, below.countX); ++x) {
                const Range& range = RangeOf(level, x, z);
                const Entry child{
                    square(cellsOf(level, x, CellCountX()), cellsOf(level, z, CellCountZ()), range.low, range.high),
                    level, x, z};
                if (!(child.square <= maxSquare)) continue;
                int at = top++;
                for (; at > base && stack[at - 1].square < child.square; --at) stack[at] = stack[at - 1];
                stack[at] = child;
            }
        }
    }
}

}  // namespace fulcrum
