// Height field: a grid of heights over the x-z plane, two triangles a cell, with holes and a material a cell. For
// static and kinematic bodies. Queries may run on any number of threads at once. Mutable: SetHeights and SetCells must
// not run while another thread may access the shape, in a step or in a query; PhysicsSystem::HoldForChanges keeps the
// other threads of a world out. Worlds need not be told of an edit: queries see it at once, the next step of each wakes
// the bodies at the changed part and lifts those on ground that was raised, and snapshots and hashes of the state are
// of the content that there is.
#pragma once

#include <Fulcrum/Collision/Shapes/SurfaceShape.h>
#include <Fulcrum/Math/List.h>

namespace fulcrum {

// Storage of a height: a float, or 16 bits as one of 65,536 steps between two limits.
enum class HeightPrecision : uint8_t { Float, Steps16 };

// The material of a cell without triangles.
inline constexpr uint8_t kHoleCell = 255;

struct HeightFieldSettings {
    uint32_t sampleCountX = 0;           // >= 2; their product at most 2^30
    uint32_t sampleCountZ = 0;           // >= 2
    List<float> heights{};               // m; sample (x, z) is heights[z * sampleCountX + x]
    float cellSizeX = 1, cellSizeZ = 1;  // m, > 0
    Vector3 origin = Vector3::Zero();    // m: where sample (0, 0) lies at height 0
    // One a cell, cell (x, z) at [z * (sampleCountX - 1) + x]: an index into `materials`, or kHoleCell. None: all 0.
    List<uint8_t> cells{};
    List<SurfaceMaterial> materials{};  // the palette, at most 255; none: the body's own material everywhere
    HeightPrecision precision = HeightPrecision::Float;
    // The limits of Steps16, in m; equal: those of `heights`. Float ignores them.
    float lowestHeight = 0, highestHeight = 0;
    bool isTwoSided = false;          // otherwise only the upper side collides and is hit
    float activeEdgeCosine = 0.996f;  // -1 .. 1: edges whose normals have a larger cosine (5 degrees) count as flat
};

// Cell (x, z) has the number z * (sampleCountX - 1) + x. It is cut from sample (x, z + 1) to (x + 1, z): triangle 2 *
// cell has the corners (x, z), (x, z + 1), (x + 1, z), triangle 2 * cell + 1 the corners (x + 1, z), (x, z + 1), (x +
// 1, z + 1). The id of a vertex is the number of its sample.
class HeightField final : public SurfaceShape {
public:
    ~HeightField() override;

    // The caller may keep the pointer to edit the field; bodies use it like any shape.
    // Errors: NonFinite (names the sample), NonPositive (a cell size), OutOfRange (counts, lengths of the spans, a
    // material, a height beyond the limits, coordinates that are no floats), Degenerate (every cell is a hole).
    static Result<std::shared_ptr<HeightField>> Create(const HeightFieldSettings& settings);

    // Replace the heights of the samples x0 .. x0 + countX - 1, z0 .. z0 + countZ - 1, or the same of cells, row by row
    // along x. Return the bounds of the part in which something changed, before and after; empty, and the version is
    // the same, if nothing did. LocalBounds() may change. Errors as in Create, and OutOfRange for a rectangle that is
    // not inside; then nothing has changed. SetCells may make all cells holes.
    Result<Bounds> SetHeights(uint32_t x0, uint32_t z0, uint32_t countX, uint32_t countZ,
                              std::span<const float> heights);
    Result<Bounds> SetCells(uint32_t x0, uint32_t z0, uint32_t countX, uint32_t countZ, std::span<const uint8_t> cells);
    // The box around all that the first edit after a version changed, with the version of that edit; 0: there was none.
    // Versions are those of this shape, or any that LatestShapeVersion gave. Of many edits the older ones share a box.
    struct EditedPart {
        uint64_t version = 0;
        Bounds changed{};
    };
    EditedPart NextEdit(uint64_t version) const;
    // Heights of the surface over a point of the shape's x-z plane, y, before and after the edit with a version; equal
    // if it changed none there, or is so long ago that its heights are not known any more. Holes count as filled.
    struct SurfaceChange {
        float before = 0, after = 0;
    };
    SurfaceChange ChangeOf(uint64_t version, float x, float z) const;
    // Whether a rectangle of the x-z plane had triangles after that edit.
    bool HadTriangles(uint64_t version, const Bounds& rectangle) const;

    uint32_t TriangleIdEnd() const override { return 2 * CellCountX() * CellCountZ(); }
    uint32_t TriangleCount() const override { return TriangleIdEnd() - 2 * holeCount_; }
    TriangleView GetTriangle(uint32_t id) const override;
    void GetTriangles(std::span<const uint32_t> ids, TriangleView* views) const override;
    bool CastRay(const SurfaceRay& ray, SurfaceHit& hit, float maxFraction = 1) const override;
    bool IsHit(const SurfaceRay& ray, float maxFraction = 1) const override;
    size_t MemoryUsed() const override;

    uint32_t SampleCountX() const { return sampleCountX_; }
    uint32_t SampleCountZ() const { return sampleCountZ_; }
    uint32_t CellCountX() const { return sampleCountX_ - 1; }
    uint32_t CellCountZ() const { return sampleCountZ_ - 1; }
    float CellSizeX() const { return cellSizeX_; }
    float CellSizeZ() const { return cellSizeZ_; }
    const Vector3& Origin() const { return origin_; }
    HeightPrecision Precision() const { return precision_; }
    float ActiveEdgeCosine() const { return activeEdgeCosine_; }
    // The stored height: for Steps16, the step nearest to the given height.
    float Height(uint32_t x, uint32_t z) const { return HeightOf(z * sampleCountX_ + x); }
    uint8_t Cell(uint32_t x, uint32_t z) const { return CellOf(z * CellCountX() + x); }
    bool IsHole(uint32_t x, uint32_t z) const { return Cell(x, z) == kHoleCell; }
    // Of a sample, in the shape's frame.
    Vector3 Vertex(uint32_t x, uint32_t z) const { return Vector3(X(x), origin_.y() + Height(x, z), Z(z)); }

private:
    friend struct ShapeFileAccess;
    HeightField();
    void SearchBox(const Bounds& box, void* context, BatchFunction found) const override;
    void SearchNear(const Bounds& box, const float& maxDistance, void* context, BatchFunction found) const override;
    void SearchRay(const SurfaceRay& ray, float maxFraction, void* context, HitFunction found) const override;

    // The lowest and highest samples of a square of cells (min/max pyramid). Those of level 0 are kBlock cells wide,
    // those of each further level twice as wide as the one below; the last level has one.
    struct Range {
        float low, high;
    };
    struct Level {
        uint32_t countX, countZ;  // blocks
        uint32_t first;           // in ranges_
    };
    static constexpr uint32_t kBlock = 8;

    // Cells first .. last along an axis.
    struct CellRange {
        uint32_t first, last;
    };
    // Samples or cells of a rectangle that an edit changes; none if first > last.
    struct Changed {
        CellRange x{~0u, 0}, z{~0u, 0};
        bool IsNone() const { return x.first > x.last; }
        size_t Count() const { return IsNone() ? 0 : size_t{x.last - x.first + 1} * (z.last - z.first + 1); }
        bool Contains(uint32_t atX, uint32_t atZ) const {
            return atX >= x.first && atX <= x.last && atZ >= z.first && atZ <= z.last;
        }
        size_t PlaceOf(uint32_t atX, uint32_t atZ) const {
            return size_t{atZ - z.first} * (x.last - x.first + 1) + (atX - x.first);
        }
        void Include(uint32_t atX, uint32_t atZ);
    };
    struct Edit {
        uint64_t version = 0;
        Bounds changed{};
        Changed part{};  // the samples or cells with these old values, row by row; none: not known
        std::vector<float> heights{};
        std::vector<uint8_t> cells{};
    };

    static Status CheckGrid(const HeightFieldSettings& settings);
    Status CheckHeights(std::span<const float> heights) const;
    Status CheckCells(std::span<const uint8_t> cells) const;
    Status CheckRectangle(uint32_t x0, uint32_t z0, uint32_t countX, uint32_t countZ, size_t count, uint32_t limitX,
                          uint32_t limitZ) const;
    // Checks the settings and sets all members except heights, ranges and bounds.
    static Result<std::shared_ptr<HeightField>> Prepare(const HeightFieldSettings& settings);
    void Finish();
    uint16_t StepOf(float height) const;
    bool HasHeight(uint32_t sample, float height) const;
    void StoreHeight(uint32_t sample, float height);
    // An edit that is about to be made, with room to log it.
    Edit MakeEdit(const Changed& part, bool isOfCells);
    void LogEdit(Edit&& edit, const Bounds& changed);
    size_t FirstEditAfter(uint64_t version) const;
    // As it was after the edit with a version.
    float HeightAfter(uint64_t version, uint32_t x, uint32_t z) const;
    uint8_t CellAfter(uint64_t version, uint32_t x, uint32_t z) const;
    void MakeLevels();
    void UpdateRanges(CellRange x, CellRange z);
    void UpdateBounds();
    Range RangeOfBlock(uint32_t blockX, uint32_t blockZ) const;
    Bounds BoundsOfCells(CellRange x, CellRange z) const;

    bool FindCells(const Bounds& box, CellRange& x, CellRange& z) const;
    uint32_t CoarsestNeeded(CellRange x, CellRange z) const;
    template <class Block>
    void DescendInto(uint32_t level, uint32_t blockX, uint32_t blockZ, CellRange x, CellRange z, float low, float high,
                     Block&& block) const;
    template <class Visitor>
    void Traverse(const SurfaceRay& ray, float maxFraction, Visitor&& visit) const;
    Vector3 NormalOf(uint32_t id) const;

    struct Slopes {
        float x, z;  // rise along the axes
    };
    Slopes SlopesOf(uint32_t x, uint32_t z, int half) const;
    bool HasTriangles(int64_t x, int64_t z) const;
    uint8_t ActiveEdges(uint32_t x, uint32_t z, int half) const;
    void CornersOf(uint32_t id, uint32_t (&x)[3], uint32_t (&z)[3]) const;
    void FillView(uint32_t id, TriangleView& view) const;

    float X(uint32_t x) const { return origin_.x() + cellSizeX_ * static_cast<float>(x); }
    float Z(uint32_t z) const { return origin_.z() + cellSizeZ_ * static_cast<float>(z); }
    const Range& RangeOf(uint32_t level, uint32_t x, uint32_t z) const {
        return ranges_[levels_[level].first + z * levels_[level].countX + x];
    }
    float HeightOf(uint32_t sample) const {
        if (precision_ == HeightPrecision::Float) return heights_[sample];
        return lowestHeight_ + heightStep_ * static_cast<float>(steps_[sample]);
    }
    uint8_t CellOf(uint32_t cell) const { return cells_.empty() ? uint8_t{0} : cells_[cell]; }

    uint32_t sampleCountX_ = 0, sampleCountZ_ = 0;
    float cellSizeX_ = 1, cellSizeZ_ = 1;
    Vector3 origin_ = Vector3::Zero();
    HeightPrecision precision_ = HeightPrecision::Float;
    float lowestHeight_ = 0, highestHeight_ = 0, heightStep_ = 0;
    float activeEdgeCosine_ = 1;
    uint32_t holeCount_ = 0;
    std::vector<float> heights_;  // one of these two
    std::vector<uint16_t> steps_;
    std::vector<uint8_t> cells_;  // empty: all 0
    std::vector<Range> ranges_;
    std::vector<Level> levels_;
    std::vector<Edit> edits_;  // ascending versions
    size_t oldValues_ = 0;     // in all of them
};

}  // namespace fulcrum
