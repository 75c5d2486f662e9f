// The searches of a triangle mesh: what overlaps a box, what a ray meets.
#include <Fulcrum/Collision/Shapes/MeshTree.h>
#include <Fulcrum/Collision/Shapes/RayTriangle.h>
#include <Fulcrum/Collision/Shapes/SurfaceNormal.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>

#include <algorithm>
#include <array>
#include <limits>

namespace fulcrum {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kBeyond = 1e18f;  // farther than any coordinate

Wide<4> LoadFour(const Vector3& v) { return Wide<4>::Load(v.data()); }

// The box in the unscaled coordinates of the tree, with what the division may round in hand; finite.
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

float Largest(const Vector3& v) { return Max(Abs(v.x()), Max(Abs(v.y()), Abs(v.z()))); }

// The corners of up to eight triangles by lanes; lanes beyond repeat the first.
inline void LoadCorners(const MeshTree& tree, uint32_t begin, uint32_t count, Vec3<Wide<8>> (&corners)[3]) {
    const float* rows[3][8];
    const Vector3* const vertices = tree.vertices.data();
    uint32_t ids[3];
    for (uint32_t i = 0; i < count; ++i) {
        tree.CornersOf(begin + i, ids);
        for (int k = 0; k < 3; ++k) rows[k][i] = vertices[ids[k]].data();
    }
    for (uint32_t i = count; i < 8; ++i)
        for (int k = 0; k < 3; ++k) rows[k][i] = rows[k][0];
    for (int k = 0; k < 3; ++k) {
        Wide<8> columns[3];
        GatherPoints<8>(rows[k], columns);
        for (int axis = 0; axis < 3; ++axis) corners[k][axis] = columns[axis];
    }
}

}  // namespace

void TriangleMesh::SearchBox(const Bounds& box, void* context, BatchFunction found) const {
    if (!(box.lower.array() <= box.upper.array()).all()) return;
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
            const Wide<4> a = LoadFour(tree.vertices[corner[0]]) * scale, b = LoadFour(tree.vertices[corner[1]]) * scale,
                          c = LoadFour(tree.vertices[corner[2]]) * scale;
            const auto overlaps = (Min(Min(a, b), c) <= upper) & (Max(Max(a, b), c) >= lower);
            ids[count] = id;
            count += overlaps.All() ? 1 : 0;
        }
        if (count > 0) found(context, ids, count);
    });
}

// Calls visit(id, fraction, isBackFace), which returns the largest fraction that is still of interest, or a negative one.
template <class Visitor>
void TriangleMesh::Traverse(const SurfaceRay& ray, float maxFraction, Visitor&& visit) const {
    if (!IsUsable(ray.origin, ray.displacement) || !(maxFraction >= 0)) return;
    const ShearedRay sheared(ray.origin, ray.displacement);
    const bool fromBehind = ray.backFaces || isTwoSided_;
    Vector3 origin = ray.origin, displacement = ray.displacement;
    float relativePad = 0x1p-20f;
    if (isScaled_) {
        origin = origin.cwiseQuotient(scale_);
        displacement = displacement.cwiseQuotient(scale_);
        // Where one axis is stretched, the rounding of the test along it counts for more along the others.
        const Vector3 size = scale_.cwiseAbs();
        relativePad *= size.maxCoeff() / size.minCoeff();
    }
    const MeshTreeRay inTree(origin, BoundedInverse(displacement), relativePad * (treeExtent_ + Largest(origin)));
    const MeshTree& tree = *tree_;
    tree.SearchRay(inTree, maxFraction, [&](uint32_t begin, uint32_t end) {
        Vec3<Wide<8>> corners[3];
        LoadCorners(tree, begin, end - begin, corners);
        if (isScaled_) {
            for (auto& corner : corners)
                for (int axis = 0; axis < 3; ++axis) corner[axis] = corner[axis] * Wide<8>(scale_[axis]);
            if (isMirrored_) std::swap(corners[1], corners[2]);
        }
        TriangleMeetings meetings;
        MeetTriangles(sheared, corners, fromBehind, maxFraction, meetings);
        for (uint32_t bits = meetings.met & ((1u << (end - begin)) - 1u); bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            if (meetings.fraction[i] > maxFraction) continue;
            maxFraction = visit(begin + static_cast<uint32_t>(i), meetings.fraction[i], (meetings.backFaces >> i & 1) != 0);
            if (maxFraction < 0) break;
        }
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
    ClosestHit best{maxFraction};
    Traverse(ray, maxFraction, [&](uint32_t id, float fraction, bool isBackFace) { return best.Take(id, fraction, isBackFace); });
    if (best.triangle == kNoTriangle) return false;
    hit = best.ToHit(NormalOf(best.triangle));
    return true;
}

bool TriangleMesh::IsHit(const SurfaceRay& ray, float maxFraction) const {
    bool isHit = false;
    Traverse(ray, maxFraction, [&](uint32_t, float, bool) {
        isHit = true;
        return -1.0f;
    });
    return isHit;
}

void TriangleMesh::SearchRay(const SurfaceRay& ray, void* context, HitFunction found) const {
    Traverse(ray, 1, [&](uint32_t id, float fraction, bool isBackFace) {
        const ClosestHit hit{fraction, id, isBackFace};
        return found(context, hit.ToHit(NormalOf(id))) ? 1.0f : -1.0f;
    });
}

}  // namespace fulcrum
