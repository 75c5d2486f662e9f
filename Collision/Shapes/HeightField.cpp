#include <Fulcrum/Collision/Shapes/HeightField.h>

#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/SurfaceLimits.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Math/Wide.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

HeightField::HeightField() : SurfaceShape(ShapeType::HeightField) {}
HeightField::~HeightField() = default;

Status HeightField::CheckGrid(const HeightFieldSettings& s) {
    if (s.sampleCountX < 2 || s.sampleCountZ < 2 || uint64_t{s.sampleCountX} * s.sampleCountZ > 1u << 30) {
        return Error{ErrorCode::OutOfRange, Message("%u x %u samples: at least 2 each way, at most 2^30 in all",
                                                    s.sampleCountX, s.sampleCountZ)};
    }
    if (!std::isfinite(s.cellSizeX) || !std::isfinite(s.cellSizeZ) || !IsFinite(s.origin) ||
        !std::isfinite(s.lowestHeight) || !std::isfinite(s.highestHeight) || !std::isfinite(s.activeEdgeCosine)) {
        return Error{ErrorCode::NonFinite,
                     "a cell size, the origin, a limit of height or activeEdgeCosine is not finite"};
    }
    if (!(s.cellSizeX > 0) || !(s.cellSizeZ > 0)) {
        return Error{ErrorCode::NonPositive, Message("the cell size is %g x %g m: it must be larger than 0",
                                                     double{s.cellSizeX}, double{s.cellSizeZ})};
    }
    if (!(std::fabs(s.activeEdgeCosine) <= 1)) {
        return Error{ErrorCode::OutOfRange,
                     Message("activeEdgeCosine is %g: it must be -1 to 1", double{s.activeEdgeCosine})};
    }
    if (s.precision != HeightPrecision::Float && s.precision != HeightPrecision::Steps16) {
        return Error{ErrorCode::OutOfRange, Message("precision %d is unknown", static_cast<int>(s.precision))};
    }
    const float limit = Max(std::fabs(s.lowestHeight), std::fabs(s.highestHeight));
    if (s.lowestHeight > s.highestHeight || !(limit <= kLargestCoordinate)) {
        return Error{ErrorCode::OutOfRange,
                     Message("lowestHeight is %g m, highestHeight %g m: the first must be the lower, neither "
                             "beyond %g m",
                             double{s.lowestHeight}, double{s.highestHeight}, double{kLargestCoordinate})};
    }
    // Neighboring grid lines must differ by several units in the last place.
    const double sizes[2] = {double{s.cellSizeX}, double{s.cellSizeZ}};
    const double ends[2] = {std::fabs(double{s.origin.x()}) + sizes[0] * s.sampleCountX,
                            std::fabs(double{s.origin.z()}) + sizes[1] * s.sampleCountZ};
    for (int i = 0; i < 2; ++i) {
        if (ends[i] <= double{kLargestCoordinate} && sizes[i] > ends[i] * 0x1p-20 && sizes[i] > 1e-15) continue;
        return Error{ErrorCode::OutOfRange, Message("cells of %g m that reach %g m from the origin: floats cannot tell "
                                                    "them apart, or they are beyond %g m",
                                                    sizes[i], ends[i], double{kLargestCoordinate})};
    }
    if (!(std::fabs(s.origin.y()) <= kLargestCoordinate)) {
        return Error{ErrorCode::OutOfRange, Message("the origin is at y = %g m: at most %g m", double{s.origin.y()},
                                                    double{kLargestCoordinate})};
    }
    return Done{};
}

Status HeightField::CheckHeights(std::span<const float> heights) const {
    const bool isFloat = precision_ == HeightPrecision::Float;
    const float low = isFloat ? -kLargestCoordinate : lowestHeight_,
                high = isFloat ? kLargestCoordinate : highestHeight_;
    for (size_t i = 0; i < heights.size(); ++i) {
        if (!std::isfinite(heights[i])) {
            return Error{ErrorCode::NonFinite, Message("height %zu is %g: it must be finite", i, double{heights[i]})};
        }
        if (heights[i] < low || heights[i] > high) {
            return Error{ErrorCode::OutOfRange, Message("height %zu is %g m: it must be %g to %g m", i,
                                                        double{heights[i]}, double{low}, double{high})};
        }
    }
    return Done{};
}

Status HeightField::CheckCells(std::span<const uint8_t> cells) const {
    for (size_t i = 0; i < cells.size() && !materials_.empty(); ++i) {
        if (cells[i] == kHoleCell || cells[i] < materials_.size()) continue;
        return Error{ErrorCode::OutOfRange,
                     Message("material %d of cell %zu: there are %zu", int{cells[i]}, i, materials_.size())};
    }
    return Done{};
}

Result<std::shared_ptr<HeightField>> HeightField::Prepare(const HeightFieldSettings& s) {
    if (const Status status = CheckGrid(s); !status) return status.GetError();
    if (const Status status = CheckMaterials(s.materials); !status) return status.GetError();
    const size_t cells = size_t{s.sampleCountX - 1} * (s.sampleCountZ - 1);
    if (!s.cells.empty() && s.cells.size() != cells) {
        return Error{ErrorCode::OutOfRange, Message("%zu cells: it must be %zu or none", s.cells.size(), cells)};
    }
    const std::shared_ptr<HeightField> field(new HeightField);
    field->sampleCountX_ = s.sampleCountX;
    field->sampleCountZ_ = s.sampleCountZ;
    field->cellSizeX_ = s.cellSizeX;
    field->cellSizeZ_ = s.cellSizeZ;
    field->origin_ = s.origin;
    field->precision_ = s.precision;
    field->activeEdgeCosine_ = s.activeEdgeCosine;
    field->isTwoSided_ = s.isTwoSided;
    field->materials_.assign(s.materials.begin(), s.materials.end());
    if (s.precision == HeightPrecision::Steps16) {
        field->lowestHeight_ = s.lowestHeight;
        field->highestHeight_ = s.highestHeight;
        field->heightStep_ = static_cast<float>((double{s.highestHeight} - double{s.lowestHeight}) / 65535);
    }
    if (const Status status = field->CheckCells(s.cells); !status) return status.GetError();
    field->cells_.assign(s.cells.begin(), s.cells.end());
    field->holeCount_ = static_cast<uint32_t>(std::count(s.cells.begin(), s.cells.end(), kHoleCell));
    return field;
}

void HeightField::Finish() {
    MakeLevels();
    UpdateRanges({0, CellCountX() - 1}, {0, CellCountZ() - 1});
    UpdateBounds();
}

Result<std::shared_ptr<HeightField>> HeightField::Create(const HeightFieldSettings& settings) {
    const DefaultFloats floats;
    HeightFieldSettings s = settings;
    if (const Status status = CheckGrid(s); !status) return status.GetError();
    const size_t samples = size_t{s.sampleCountX} * s.sampleCountZ;
    if (s.heights.size() != samples) {
        return Error{ErrorCode::OutOfRange, Message("%zu heights: it must be %zu", s.heights.size(), samples)};
    }
    for (size_t i = 0; i < samples; ++i) {
        if (std::isfinite(s.heights[i])) continue;
        return Error{ErrorCode::NonFinite, Message("height %zu is %g: it must be finite", i, double{s.heights[i]})};
    }
    if (s.precision == HeightPrecision::Steps16 && s.lowestHeight == s.highestHeight) {
        const auto [low, high] = std::minmax_element(s.heights.begin(), s.heights.end());
        s.lowestHeight = *low;
        s.highestHeight = *high;
    }
    const Result<std::shared_ptr<HeightField>> prepared = Prepare(s);
    if (!prepared) return prepared.GetError();
    const std::shared_ptr<HeightField>& field = prepared.Value();
    if (const Status status = field->CheckHeights(s.heights); !status) return status.GetError();
    if (field->TriangleCount() == 0) return Error{ErrorCode::Degenerate, "every cell is a hole"};
    if (s.precision == HeightPrecision::Float) field->heights_.resize(samples);
    else field->steps_.resize(samples);
    for (uint32_t i = 0; i < samples; ++i) field->StoreHeight(i, s.heights[i]);
    field->Finish();
    return field;
}

uint16_t HeightField::StepOf(float height) const {
    const double steps = heightStep_ > 0 ? (double{height} - double{lowestHeight_}) / double{heightStep_} : 0.0;
    return static_cast<uint16_t>(std::clamp(std::floor(steps + 0.5), 0.0, 65535.0));
}

void HeightField::StoreHeight(uint32_t sample, float height) {
    if (precision_ == HeightPrecision::Float) heights_[sample] = height + 0.0f;  // no negative zeros
    else steps_[sample] = StepOf(height);
}

bool HeightField::HasHeight(uint32_t sample, float height) const {
    return precision_ == HeightPrecision::Float ? heights_[sample] == height : steps_[sample] == StepOf(height);
}

// ---- The min/max pyramid

void HeightField::MakeLevels() {
    uint32_t countX = (CellCountX() + kBlock - 1) / kBlock, countZ = (CellCountZ() + kBlock - 1) / kBlock, first = 0;
    for (;;) {
        levels_.push_back({countX, countZ, first});
        first += countX * countZ;
        if (countX == 1 && countZ == 1) break;
        countX = (countX + 1) / 2;
        countZ = (countZ + 1) / 2;
    }
    levels_.shrink_to_fit();
    ranges_.resize(first);
}

// Range of the samples around a block of level 0; includes those of holes.
HeightField::Range HeightField::RangeOfBlock(uint32_t blockX, uint32_t blockZ) const {
    Range range{INFINITY, -INFINITY};
    const uint32_t endX = std::min(sampleCountX_, (blockX + 1) * kBlock + 1);
    const uint32_t endZ = std::min(sampleCountZ_, (blockZ + 1) * kBlock + 1);
    for (uint32_t z = blockZ * kBlock; z < endZ; ++z) {
        for (uint32_t x = blockX * kBlock; x < endX; ++x) {
            const float height = Height(x, z);
            range = {std::min(range.low, height), std::max(range.high, height)};
        }
    }
    return range;
}

// Called after heights of these cells changed.
void HeightField::UpdateRanges(CellRange x, CellRange z) {
    x = {x.first / kBlock, x.last / kBlock};
    z = {z.first / kBlock, z.last / kBlock};
    for (uint32_t level = 0; level < levels_.size(); ++level) {
        const Level& here = levels_[level];
        for (uint32_t bz = z.first; bz <= z.last; ++bz) {
            for (uint32_t bx = x.first; bx <= x.last; ++bx) {
                Range range{INFINITY, -INFINITY};
                if (level == 0) {
                    range = RangeOfBlock(bx, bz);
                } else {
                    const Level& below = levels_[level - 1];
                    for (uint32_t cz = 2 * bz; cz < std::min(2 * bz + 2, below.countZ); ++cz) {
                        for (uint32_t cx = 2 * bx; cx < std::min(2 * bx + 2, below.countX); ++cx) {
                            const Range& child = RangeOf(level - 1, cx, cz);
                            range = {std::min(range.low, child.low), std::max(range.high, child.high)};
                        }
                    }
                }
                ranges_[here.first + bz * here.countX + bx] = range;
            }
        }
        x = {x.first / 2, x.last / 2};
        z = {z.first / 2, z.last / 2};
    }
}

void HeightField::UpdateBounds() {
    const Range& all = ranges_.back();
    bounds_.lower = Vector3(X(0), origin_.y() + all.low, Z(0));
    bounds_.upper = Vector3(X(sampleCountX_ - 1), origin_.y() + all.high, Z(sampleCountZ_ - 1));
    const Position far = bounds_.lower.cwiseAbs().cwiseMax(bounds_.upper.cwiseAbs()).cast<double>();
    outerRadius_ = RoundUp(std::sqrt(Dot(far, far)));
}

Bounds HeightField::BoundsOfCells(CellRange x, CellRange z) const {
    Bounds bounds;
    for (uint32_t i = z.first; i <= z.last + 1; ++i)
        for (uint32_t k = x.first; k <= x.last + 1; ++k) bounds.Include(Vertex(k, i));
    return bounds;
}

// ---- Edits

Status HeightField::CheckRectangle(uint32_t x0, uint32_t z0, uint32_t countX, uint32_t countZ, size_t count,
                                   uint32_t limitX, uint32_t limitZ) const {
    const bool isInside =
        countX > 0 && countZ > 0 && uint64_t{x0} + countX <= limitX && uint64_t{z0} + countZ <= limitZ;
    if (!isInside || uint64_t{countX} * countZ != count) {
        return Error{ErrorCode::OutOfRange,
                     Message("%zu values for (%u, %u) and %u x %u from there: it must be inside %u x %u", count, x0, z0,
                             countX, countZ, limitX, limitZ)};
    }
    return Done{};
}

void HeightField::Changed::Include(uint32_t atX, uint32_t atZ) {
    x = {std::min(x.first, atX), std::max(x.last, atX)};
    z = {std::min(z.first, atZ), std::max(z.last, atZ)};
}

// More edits than this between two steps of a world share boxes, and then wake more bodies than they must; old heights
// and cells are kept of the last edits, up to so many for each sample of the field, but for so many in any case. Of an
// edit whose old heights are gone nobody is lifted.
constexpr size_t kMostEdits = 1024, kMostOldValues = 3, kFewOldValues = 1 << 16;

HeightField::Edit HeightField::MakeEdit(const Changed& part, bool isOfCells) {
    if (edits_.size() == edits_.capacity()) edits_.reserve(std::max(size_t{8}, 2 * edits_.size()));
    Edit edit;
    edit.part = part;
    if (isOfCells) edit.cells.reserve(part.Count());
    else edit.heights.reserve(part.Count());
    for (uint32_t z = part.z.first; z <= part.z.last; ++z)
        for (uint32_t x = part.x.first; x <= part.x.last; ++x)
            if (isOfCells) edit.cells.push_back(Cell(x, z));
            else edit.heights.push_back(Height(x, z));
    return edit;
}

void HeightField::LogEdit(Edit&& edit, const Bounds& changed) {
    NoteEdit();
    edit.version = version_;
    edit.changed = changed;
    oldValues_ += edit.part.Count();
    edits_.push_back(std::move(edit));
    const auto forget = [&](Edit& old) {
        oldValues_ -= old.part.Count();
        old.part = {};
        old.heights = std::vector<float>();  // with their memory
        old.cells = std::vector<uint8_t>();
    };
    const size_t most = std::max(kFewOldValues, kMostOldValues * sampleCountX_ * sampleCountZ_);
    for (size_t i = 0; oldValues_ > most && i + 1 < edits_.size(); ++i) forget(edits_[i]);
    if (edits_.size() <= kMostEdits) return;
    // Many at once: each moves all that are left.
    constexpr size_t kShared = kMostEdits / 4;
    for (size_t i = 0; i <= kShared; ++i) forget(edits_[i]);
    for (size_t i = 0; i < kShared; ++i) edits_[kShared].changed.Include(edits_[i].changed);
    edits_.erase(edits_.begin(), edits_.begin() + kShared);
}

size_t HeightField::FirstEditAfter(uint64_t version) const {
    const auto after = [&](const Edit& edit) { return edit.version <= version; };
    return static_cast<size_t>(std::partition_point(edits_.begin(), edits_.end(), after) - edits_.begin());
}

HeightField::EditedPart HeightField::NextEdit(uint64_t version) const {
    const size_t next = FirstEditAfter(version);
    if (next == edits_.size()) return {};
    return {edits_[next].version, edits_[next].changed};
}

float HeightField::HeightAfter(uint64_t version, uint32_t x, uint32_t z) const {
    for (size_t i = FirstEditAfter(version); i < edits_.size(); ++i)
        if (!edits_[i].heights.empty() && edits_[i].part.Contains(x, z))
            return edits_[i].heights[edits_[i].part.PlaceOf(x, z)];
    return Height(x, z);
}

uint8_t HeightField::CellAfter(uint64_t version, uint32_t x, uint32_t z) const {
    for (size_t i = FirstEditAfter(version); i < edits_.size(); ++i)
        if (!edits_[i].cells.empty() && edits_[i].part.Contains(x, z))
            return edits_[i].cells[edits_[i].part.PlaceOf(x, z)];
    return Cell(x, z);
}

HeightField::SurfaceChange HeightField::ChangeOf(uint64_t version, float x, float z) const {
    const DefaultFloats floats;
    const float alongX = (x - origin_.x()) / cellSizeX_, alongZ = (z - origin_.z()) / cellSizeZ_;
    const size_t index = FirstEditAfter(version - 1);
    if (index == edits_.size() || edits_[index].version != version || edits_[index].heights.empty()) return {};
    if (!(alongX >= 0 && alongX <= static_cast<float>(CellCountX()) && alongZ >= 0 &&
          alongZ <= static_cast<float>(CellCountZ())))
        return {};
    const uint32_t atX = std::min(static_cast<uint32_t>(alongX), CellCountX() - 1),
                   atZ = std::min(static_cast<uint32_t>(alongZ), CellCountZ() - 1);
    const float u = alongX - static_cast<float>(atX), v = alongZ - static_cast<float>(atZ);
    const auto heightAfter = [&](uint64_t of) {
        const float onX = HeightAfter(of, atX + 1, atZ), onZ = HeightAfter(of, atX, atZ + 1);
        if (u + v <= 1) {
            const float corner = HeightAfter(of, atX, atZ);
            return origin_.y() + (corner + u * (onX - corner) + v * (onZ - corner));
        }
        const float corner = HeightAfter(of, atX + 1, atZ + 1);
        return origin_.y() + (corner + (1 - u) * (onZ - corner) + (1 - v) * (onX - corner));
    };
    return {heightAfter(version - 1), heightAfter(version)};
}

bool HeightField::HadTriangles(uint64_t version, const Bounds& rectangle) const {
    const DefaultFloats floats;
    CellRange x, z;
    if (!FindCells({Vector3(rectangle.lower.x(), -INFINITY, rectangle.lower.z()),
                    Vector3(rectangle.upper.x(), INFINITY, rectangle.upper.z())},
                   x, z))
        return false;
    for (uint32_t atZ = z.first; atZ <= z.last; ++atZ)
        for (uint32_t atX = x.first; atX <= x.last; ++atX)
            if (CellAfter(version, atX, atZ) != kHoleCell) return true;
    return false;
}

Result<Bounds> HeightField::SetHeights(uint32_t x0, uint32_t z0, uint32_t countX, uint32_t countZ,
                                       std::span<const float> heights) {
    const DefaultFloats floats;
    if (const Status status = CheckRectangle(x0, z0, countX, countZ, heights.size(), sampleCountX_, sampleCountZ_);
        !status)
        return status.GetError();
    if (const Status status = CheckHeights(heights); !status) return status.GetError();
    Changed samples;
    for (uint32_t i = 0; i < countZ; ++i)
        for (uint32_t k = 0; k < countX; ++k)
            if (!HasHeight((z0 + i) * sampleCountX_ + x0 + k, heights[size_t{i} * countX + k]))
                samples.Include(x0 + k, z0 + i);
    if (samples.IsNone()) return Bounds{};
    Edit edit = MakeEdit(samples, false);  // the only call that may throw
    // The cells that touch a changed sample.
    const auto cellsAt = [](CellRange of, uint32_t count) {
        return CellRange{of.first == 0 ? 0 : of.first - 1, std::min(of.last, count - 1)};
    };
    const CellRange x = cellsAt(samples.x, CellCountX()), z = cellsAt(samples.z, CellCountZ());
    Bounds changed = BoundsOfCells(x, z);
    for (uint32_t i = 0; i < countZ; ++i)
        for (uint32_t k = 0; k < countX; ++k)
            StoreHeight((z0 + i) * sampleCountX_ + x0 + k, heights[size_t{i} * countX + k]);
    changed.Include(BoundsOfCells(x, z));
    UpdateRanges(x, z);
    UpdateBounds();
    LogEdit(std::move(edit), changed);
    return changed;
}

Result<Bounds> HeightField::SetCells(uint32_t x0, uint32_t z0, uint32_t countX, uint32_t countZ,
                                     std::span<const uint8_t> cells) {
    const DefaultFloats floats;
    if (const Status status = CheckRectangle(x0, z0, countX, countZ, cells.size(), CellCountX(), CellCountZ()); !status)
        return status.GetError();
    if (const Status status = CheckCells(cells); !status) return status.GetError();
    Changed changed;
    for (uint32_t i = 0; i < countZ; ++i)
        for (uint32_t k = 0; k < countX; ++k)
            if (Cell(x0 + k, z0 + i) != cells[size_t{i} * countX + k]) changed.Include(x0 + k, z0 + i);
    if (changed.IsNone()) return Bounds{};
    Edit edit = MakeEdit(changed, true);
    if (cells_.empty()) cells_.assign(size_t{CellCountX()} * CellCountZ(), 0);
    for (uint32_t i = 0; i < countZ; ++i) {
        for (uint32_t k = 0; k < countX; ++k) {
            uint8_t& cell = cells_[size_t{z0 + i} * CellCountX() + x0 + k];
            holeCount_ -= cell == kHoleCell ? 1 : 0;
            cell = cells[size_t{i} * countX + k];
            holeCount_ += cell == kHoleCell ? 1 : 0;
        }
    }
    const Bounds bounds = BoundsOfCells(changed.x, changed.z);
    LogEdit(std::move(edit), bounds);
    return bounds;
}

size_t HeightField::MemoryUsed() const {
    size_t ofEdits = edits_.capacity() * sizeof(Edit);
    for (const Edit& edit : edits_) ofEdits += edit.heights.capacity() * sizeof(float) + edit.cells.capacity();
    return sizeof(HeightField) + heights_.capacity() * sizeof(float) + steps_.capacity() * sizeof(uint16_t) +
           cells_.capacity() + ranges_.capacity() * sizeof(Range) + levels_.capacity() * sizeof(Level) +
           materials_.capacity() * sizeof(SurfaceMaterial) + ofEdits;
}

}  // namespace fulcrum
