// Box and ray queries of a triangle mesh.
#include <Fulcrum/Collision/BroadPhase/RayLanes.h>
#include <Fulcrum/Collision/Shapes/MeshTree.h>
#include <Fulcrum/Collision/Shapes/RayTriangle.h>
#include <Fulcrum/Collision/Shapes/SurfaceNormal.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Math/FloatEnvironment.h>

#include <algorithm>
#include <array>
#include <limits>

namespace fulcrum {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kBeyond = 1e18f;  // farther than any coordinate

Wide<4> LoadFour(const Vector3& v) { return Wide<4>::Load(v.data()); }

// The box in the unscaled coordinates of the tree, enlarged by the rounding of the division; finite.
Bounds Unscaled(const Bounds& box, const Vector3& scale, bool isScaled) {
    Bounds result;
    for (int axis = 0; axis < 3; ++axis) {
        const float low = Clamp(box.lower[axis], -kBeyond, kBeyond), high = Clamp(box.upper[axis], -kBeyond, kBeyond);
        if (!isScaled) {
            result.lower[axis] = low;
            result.upper[axis] = high;
            continue;
        }
        const float a = low / scale[axis], b = high / scale[axis];
        const float slack = 0x1p-21f * Max(Abs(a), Abs(b)) + 1e-30f;
        result.lower[axis] = Max(Min(a, b) - slack, -kBeyond);
        result.upper[axis] = Min(Max(a, b) + slack, kBeyond);
    }
    return result;
}

}  // namespace

void TriangleMesh::SearchBox(const Bounds& box, void* context, BatchFunction found) const {
    if (!box.lower.isAtMost(box.upper)) return;
    const MeshTree& tree = *tree_;
    const Wide<4> lower = Wide<4>::Load(std::array{box.lower.x(), box.lower.y(), box.lower.z(), -kInfinity}.data());
    const Wide<4> upper = Wide<4>::Load(std::array{box.upper.x(), box.upper.y(), box.upper.z(), kInfinity}.data());
    const Wide<4> scale = Wide<4>::Load(std::array{scale_.x(), scale_.y(), scale_.z(), 1.0f}.data());
    tree.SearchBox(Unscaled(box, scale_, isScaled_), [&](uint32_t begin, uint32_t end) {
        uint32_t ids[MeshNode::kMaxLeaf];
        int count = 0;
        for (uint32_t id = begin; id < end; ++id) {
            uint32_t corner[3];
            tree.CornersOf(id, corner);
            const Wide<4> a = LoadFour(tree.vertices[corner[0]]) * scale,
                          b = LoadFour(tree.vertices[corner[1]]) * scale,
                          c = LoadFour(tree.vertices[corner[2]]) * scale;
            const auto overlaps = (Min(Min(a, b), c) <= upper) & (Max(Max(a, b), c) >= lower);
            ids[count] = id;
            count += overlaps.All() ? 1 : 0;
        }
        if (count > 0) found(context, ids, count);
    });
}

void TriangleMesh::SearchNear(const Bounds& box, const float& maxDistance, void* context, BatchFunction found) const {
    if (!box.lower.isAtMost(box.upper)) return;
    const MeshTree& tree = *tree_;
    tree.SearchNear(Unscaled(box, scale_, isScaled_), scale_.cwiseAbs(), maxDistance,
                    [&](uint32_t begin, uint32_t end) {
                        uint32_t ids[MeshNode::kMaxLeaf];
                        int count = 0;
                        const float maxSquare = SquareOfReach(maxDistance);
                        for (uint32_t id = begin; id < end; ++id) {
                            uint32_t corner[3];
                            tree.CornersOf(id, corner);
                            Bounds triangle;
                            for (const uint32_t vertex : corner)
                                triangle.Include(tree.vertices[vertex].cwiseProduct(scale_));
                            ids[count] = id;
                            count += SquaredDistance(triangle, box) <= maxSquare ? 1 : 0;
                        }
                        if (count > 0) found(context, ids, count);
                    });
}

// Rays in the unscaled coordinates of the tree.
inline Vector3 TriangleMesh::InTree(const Vector3& v) const { return isScaled_ ? Vector3(v.cwiseQuotient(scale_)) : v; }

// Enlargement of boxes for rays from origins of this size, in the tree's coordinates.
inline float TriangleMesh::PadFor(float largestOrigin) const {
    // If one axis is stretched, rounding errors along it are larger relative to the others.
    const Vector3 size = scale_.cwiseAbs();
    return 0x1p-20f * (isScaled_ ? size.maxCoeff() / size.minCoeff() : 1.0f) * (treeExtent_ + largestOrigin);
}

// Loads up to eight triangles into lanes; remaining lanes repeat the first.
inline void TriangleMesh::LoadCorners(uint32_t begin, uint32_t end, Vec3<Wide<8>> (&corners)[3]) const {
    const MeshTree& tree = *tree_;
    const float* rows[3][8];
    uint32_t ids[3];
    for (uint32_t i = 0; i < end - begin; ++i) {
        tree.CornersOf(begin + i, ids);
        for (int k = 0; k < 3; ++k) rows[k][i] = tree.vertices[ids[k]].data();
    }
    for (uint32_t i = end - begin; i < 8; ++i)
        for (int k = 0; k < 3; ++k) rows[k][i] = rows[k][0];
    for (int k = 0; k < 3; ++k) {
        Wide<8> columns[3];
        GatherPoints<8>(rows[k], columns);
        for (int axis = 0; axis < 3; ++axis)
            corners[k][axis] = isScaled_ ? columns[axis] * Wide<8>(scale_[axis]) : columns[axis];
    }
    if (isMirrored_) std::swap(corners[1], corners[2]);
}

namespace {

// Calls visit(id, fraction, isBackFace) for the triangles of a leaf that a ray hits; it returns the new largest
// fraction, negative to stop. Returns the last such fraction.
template <class Visitor>
inline float IntersectLeaf(const ShearedRay& ray, const Vec3<Wide<8>> (&corners)[3], uint32_t begin, uint32_t end,
                           bool fromBehind, float maxFraction, Visitor&& visit) {
    TriangleHits hits;
    IntersectTriangles(ray, corners, fromBehind, maxFraction, hits);
    for (uint32_t bits = hits.bits & ((1u << (end - begin)) - 1u); bits != 0; bits &= bits - 1) {
        const int i = std::countr_zero(bits);
        if (hits.fraction[i] > maxFraction) continue;
        maxFraction = visit(begin + static_cast<uint32_t>(i), hits.fraction[i], (hits.backFaces >> i & 1) != 0);
        if (maxFraction < 0) break;
    }
    return maxFraction;
}

}  // namespace

// Calls visit(id, fraction, isBackFace) for triangles that the ray hits; it returns the new largest fraction, negative
// to stop.
template <class Visitor>
void TriangleMesh::Traverse(const SurfaceRay& ray, float maxFraction, Visitor&& visit) const {
    if (!IsUsable(ray.origin, ray.displacement) || !(maxFraction >= 0)) return;
    const ShearedRay sheared(ray.origin, ray.displacement);
    const bool fromBehind = ray.backFaces || isTwoSided_;
    const Vector3 origin = InTree(ray.origin);
    const MeshTreeRay treeRay(origin, BoundedInverse(InTree(ray.displacement)), PadFor(LargestCoordinate(origin)));
    tree_->SearchRay(treeRay, maxFraction, [&](const MeshNode& node, int child) {
        const uint32_t begin = node.LeafBegin(child), end = node.LeafEnd(child);
        Vec3<Wide<8>> corners[3];
        LoadCorners(begin, end, corners);
        maxFraction = IntersectLeaf(sheared, corners, begin, end, fromBehind, maxFraction, visit);
        return maxFraction;
    });
}

inline Vector3 TriangleMesh::NormalOf(uint32_t id) const {
    uint32_t corner[3];
    tree_->CornersOf(id, corner);
    if (isMirrored_) std::swap(corner[1], corner[2]);
    const Vector3* const vertices = tree_->vertices.data();
    return TriangleNormal(vertices[corner[0]].cwiseProduct(scale_), vertices[corner[1]].cwiseProduct(scale_),
                          vertices[corner[2]].cwiseProduct(scale_));
}

bool TriangleMesh::CastRay(const SurfaceRay& ray, SurfaceHit& hit, float maxFraction) const {
    const DefaultFloats floats;
    ClosestHit best{maxFraction};
    Traverse(ray, maxFraction,
             [&](uint32_t id, float fraction, bool isBackFace) { return best.Take(id, fraction, isBackFace); });
    if (best.triangle == kNoTriangle) return false;
    hit = best.ToHit(NormalOf(best.triangle));
    return true;
}

// Ray packets: the tree is searched with one moving box that contains all rays, and each ray is tested against the
// boxes of the leaves found and their triangles.
uint32_t TriangleMesh::CastRays(std::span<const SurfaceRay> rays, SurfaceHit* hits, const float* maxFractions) const {
    const DefaultFloats floats;
    constexpr float kSlack = 1.0f + 0x1p-18f;
    // If more leaves per ray are found that no ray hits, single casts are faster.
    constexpr int kMostMissedLeaves = 2;
    const MeshTree& tree = *tree_;
    static_assert(kMostRays == RayLanes::kMost);
    RayLanes lanes;
    ShearedRay sheared[kMostRays];
    ClosestHit best[kMostRays];
    uint8_t rayOf[kMostRays];
    Bounds origins, displacements;
    for (size_t i = 0; i < rays.size(); ++i) {
        const SurfaceRay& ray = rays[i];
        if (!IsUsable(ray.origin, ray.displacement) || !(maxFractions[i] >= 0)) continue;
        const Vector3 origin = InTree(ray.origin), displacement = InTree(ray.displacement),
                      inverse = BoundedInverse(displacement);
        origins.Include(origin);
        displacements.Include(displacement);
        sheared[lanes.count] = ShearedRay(ray.origin, ray.displacement);
        best[lanes.count] = {maxFractions[i]};
        rayOf[lanes.count] = static_cast<uint8_t>(i);
        lanes.Add({origin.x(), origin.y(), origin.z()}, {origin.x(), origin.y(), origin.z()},
                  {inverse.x(), inverse.y(), inverse.z()}, maxFractions[i]);
    }
    if (lanes.count == 0) return 0;
    float largest = lanes.LargestLimit();
    if (!(largest <= 1)) return SurfaceShape::CastRays(rays, hits, maxFractions);  // the rays are too far apart
    const float pad = PadFor(Max(LargestCoordinate(origins.lower), LargestCoordinate(origins.upper)));
    lanes.Widen(pad);
    const Vector3 displacement = displacements.Center();
    const Vector3 reach = origins.HalfExtents() + displacements.HalfExtents() + Vector3::Constant(2 * pad) +
                          displacements.lower.cwiseAbs().cwiseMax(displacements.upper.cwiseAbs()) * 0x1p-20f;
    const MeshTreeRay swept(origins.Center(), BoundedInverse(displacement), reach);
    int missedLeaves = 0;
    tree.SearchRay(swept, largest, [&](const MeshNode& node, int child) {
        float lower[3], upper[3];
        for (int axis = 0; axis < 3; ++axis) {
            const float step = node.Step(axis);
            lower[axis] = node.origin[axis] + step * static_cast<float>(node.lower[axis][child]);
            upper[axis] = node.origin[axis] + step * static_cast<float>(node.upper[axis][child]);
        }
        uint32_t hit = lanes.Intersecting(lower, upper, kSlack);
        if (hit == 0) return ++missedLeaves > kMostMissedLeaves * lanes.count ? -1.0f : largest;
        const uint32_t begin = node.LeafBegin(child), end = node.LeafEnd(child);
        Vec3<Wide<8>> corners[3];
        LoadCorners(begin, end, corners);
        for (; hit != 0; hit &= hit - 1) {
            const int i = std::countr_zero(hit);
            const bool fromBehind = isTwoSided_ || rays[rayOf[i]].backFaces;
            lanes.limit[i] = IntersectLeaf(
                sheared[i], corners, begin, end, fromBehind, lanes.limit[i],
                [&](uint32_t id, float fraction, bool isBackFace) { return best[i].Take(id, fraction, isBackFace); });
        }
        return largest = lanes.LargestLimit();
    });
    if (missedLeaves > kMostMissedLeaves * lanes.count) return SurfaceShape::CastRays(rays, hits, maxFractions);
    uint32_t hit = 0;
    for (int k = 0; k < lanes.count; ++k) {
        if (best[k].triangle == kNoTriangle) continue;
        hits[rayOf[k]] = best[k].ToHit(NormalOf(best[k].triangle));
        hit |= 1u << rayOf[k];
    }
    return hit;
}

bool TriangleMesh::IsHit(const SurfaceRay& ray, float maxFraction) const {
    const DefaultFloats floats;
    bool isHit = false;
    Traverse(ray, maxFraction, [&](uint32_t, float, bool) {
        isHit = true;
        return -1.0f;
    });
    return isHit;
}

void TriangleMesh::SearchRay(const SurfaceRay& ray, float maxFraction, void* context, HitFunction found) const {
    const DefaultFloats floats;
    Traverse(ray, maxFraction, [&](uint32_t id, float fraction, bool isBackFace) {
        const ClosestHit hit{fraction, id, isBackFace};
        return found(context, hit.ToHit(NormalOf(id))) ? maxFraction : -1.0f;
    });
}

}  // namespace fulcrum
