#include <Fulcrum/Collision/NarrowPhase/SurfaceManifold.h>

#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/ManifoldReduction.h>

#include <algorithm>
#include <cstddef>

namespace fulcrum {

namespace {

// Contacts with normals this close are merged: 2 degrees.
constexpr float kSameDirection = 0.9994f;
// Only this many of the deepest are kept, enough for any shape; a huge one may touch thousands of triangles with
// different normals.
constexpr size_t kMostManifolds = 128;

// Points of several manifolds, along one normal.
class PointMerger {
public:
    PointMerger(const Vector3& normal, float innerRadius, const Vector3& motion)
        : normal_(normal),
          u_(Perpendicular(normal)),
          v_(Cross<float>(normal, u_)),
          slop_(1e-3f * innerRadius),
          weighting_(WeightsOnSurfaces(Dot(normal, motion), innerRadius)) {}

    void Add(const Manifold& manifold) {
        for (int i = 0; i < manifold.pointCount; ++i) Add(manifold.points[i], manifold.normal);
    }
    void Write(Manifold& manifold) {
        Reduce();
        manifold.pointCount = count_;
        std::copy(points_, points_ + count_, manifold.points);
    }

private:
    static constexpr int kRoom = 64;

    // Of points with the same feature id the deepest is kept.
    void Add(ManifoldPoint point, const Vector3& itsNormal) {
        point.separation *= Dot(itsNormal, normal_);
        for (int i = 0; i < count_; ++i) {
            if (points_[i].feature != point.feature) continue;
            if (point.separation < points_[i].separation) points_[i] = point;
            return;
        }
        if (count_ == kRoom) Reduce();
        points_[count_++] = point;
    }
    void Reduce() {
        // Corners of the shape first: the reduction prefers earlier points, and they persist while it slides from
        // triangle to triangle.
        int order[kRoom], n = 0;
        for (const bool corners : {true, false})
            for (int i = 0; i < count_; ++i)
                if (((points_[i].feature & kCrossing) == kVertexOfA) == corners) order[n++] = i;
        FlatPoints<kRoom> flat;
        for (int i = 0; i < count_; ++i) {
            const ManifoldPoint& point = points_[order[i]];
            flat.Add(Dot(u_, point.positionOnA), Dot(v_, point.positionOnA), point.separation);
        }
        int chosen[4];
        count_ = ChooseFour(flat, slop_, chosen, weighting_);
        ManifoldPoint kept[4];
        for (int i = 0; i < count_; ++i) kept[i] = points_[order[chosen[i]]];
        std::copy(kept, kept + count_, points_);
    }

    Vector3 normal_, u_, v_;
    float slop_;
    PointWeights weighting_;
    ManifoldPoint points_[kRoom];
    int count_ = 0;
};

// Contact `first`, merged with all later ones in its direction, which are left without points.
SurfaceManifold MergeSimilar(Array<SurfaceManifold>& contacts, size_t first, float innerRadius, const Vector3& motion) {
    SurfaceManifold merged = contacts[first];
    contacts[first].manifold.pointCount = 0;
    const auto isSame = [&](const SurfaceManifold& other) {
        return other.manifold.pointCount > 0 && other.material == merged.material &&
               Dot(other.manifold.normal, merged.manifold.normal) >= kSameDirection;
    };
    if (std::none_of(contacts.begin() + static_cast<ptrdiff_t>(first) + 1, contacts.end(), isSame)) return merged;
    PointMerger points(merged.manifold.normal, innerRadius, motion);
    points.Add(merged.manifold);
    for (size_t i = first + 1; i < contacts.size(); ++i) {
        if (!isSame(contacts[i])) continue;
        points.Add(contacts[i].manifold);
        contacts[i].manifold.pointCount = 0;
    }
    points.Write(merged.manifold);
    return merged;
}

}  // namespace

SurfaceManifold& AppendManifold(Array<SurfaceManifold>& manifolds, size_t& count) {
    if (manifolds.size() == count) manifolds.emplace_back();
    return manifolds[count++];
}

void MergeContacts(Array<SurfaceManifold>& contacts, float innerRadius, const Vector3& motion,
                   Array<SurfaceManifold>& manifolds, size_t& count) {
    if (contacts.size() > 1)
        std::sort(contacts.begin(), contacts.end(), [](const SurfaceManifold& x, const SurfaceManifold& y) {
            const float dx = DeepestSeparation(x.manifold), dy = DeepestSeparation(y.manifold);
            return dx < dy || (dx == dy && x.triangle < y.triangle);
        });
    count = 0;
    for (size_t i = 0; i < contacts.size() && count < kMostManifolds; ++i) {
        if (contacts[i].manifold.pointCount == 0) continue;  // merged into another
        AppendManifold(manifolds, count) = MergeSimilar(contacts, i, innerRadius, motion);
    }
}

}  // namespace fulcrum
