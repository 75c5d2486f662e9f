#include <Fulcrum/Collision/NarrowPhase/InternalEdges.h>

#include <Fulcrum/Collision/NarrowPhase/Features.h>
#include <Fulcrum/Collision/NarrowPhase/TriangleFaceContact.h>
#include <Fulcrum/Collision/NarrowPhase/TriangleSide.h>

#include <algorithm>
#include <cstddef>

namespace fulcrum {

namespace {

// Feature ids that last from step to step: corners of A are the same on every triangle, corners of the surface on all
// triangles around them.
uint32_t SurfaceFeature(uint32_t feature, const TriangleView& view) {
    const uint32_t kind = feature & kCrossing;
    if (kind == kVertexOfA) return feature;
    if (kind == kVertexOfB) return kVertexOfB | (view.vertexIds[(feature & 255u) % 3] & ~kCrossing);
    return kCrossing | ((feature * 0x9E3779B1u ^ view.id * 0x85EBCA6Bu) >> 2);
}

SurfaceManifold WithSurfaceFeatures(const TriangleView& view, const Manifold& manifold) {
    SurfaceManifold result{manifold, view.id, view.material};
    for (int i = 0; i < manifold.pointCount; ++i)
        result.manifold.points[i].feature = SurfaceFeature(manifold.points[i].feature, view);
    return result;
}

}  // namespace

void InternalEdgeFilter::Begin(bool facesAhead) {
    facesAhead_ = facesAhead;
    deferred_.clear();
    covered_.clear();
    contacts_.clear();
}

void InternalEdgeFilter::AddFace(const TriangleView& view, const Manifold& manifold) {
    contacts_.push_back(WithSurfaceFeatures(view, manifold));
    covered_.insert(covered_.end(), view.vertexIds, view.vertexIds + 3);
}

void InternalEdgeFilter::AddNearest(const TriangleView& view, const Vector3& axis, bool overlaps,
                                    const Manifold& onFace, const Manifold& nearest) {
    if (Dot(axis, view.normal) > 0) {
        // The axis leads out through the back, where a surface has no contacts.
        if (overlaps && onFace.pointCount > 0) AddFace(view, onFace);
        return;
    }
    if (nearest.pointCount == 0) return;
    // The nearest feature at a side may lie along the face: then the points farther along it count, too.
    if (-Dot(axis, view.normal) > kFaceCosine) AddFace(view, onFace.pointCount > nearest.pointCount ? onFace : nearest);
    else Defer(view, axis, nearest, onFace);
}

void InternalEdgeFilter::Defer(const TriangleView& view, const Vector3& axis, const Manifold& manifold,
                               const Manifold& onFace) {
    const TriangleFeature feature = FeatureAlong(view.vertices, view.activeEdges, axis);
    DeferredContact deferred;
    deferred.active = feature.isActive;
    // Also at an edge that counts as flat: use all points along the face, if there are more.
    const bool isFlat = !deferred.active && -Dot(axis, view.normal) > kFlatCosine;
    const bool isAtEdge = deferred.active || (isFlat && onFace.pointCount <= manifold.pointCount);
    deferred.active |= isFlat;
    if (!deferred.active && onFace.pointCount == 0) return;
    deferred.vertices[0] = view.vertexIds[feature.corners[0]];
    deferred.vertices[1] = view.vertexIds[feature.corners[feature.count >= 2 ? 1 : 0]];
    deferred.onFace = WithSurfaceFeatures(view, onFace);
    deferred.isOnFace = !isAtEdge;
    deferred.contact = isAtEdge ? WithSurfaceFeatures(view, manifold) : deferred.onFace;
    deferred.separation = DeepestSeparation(deferred.contact.manifold);
    deferred_.push_back(deferred);
}

bool InternalEdgeFilter::DeferToNeighbor(const TriangleView& view, const TriangleInShape& triangle, float slop,
                                         const Manifold& onFace) {
    int deepest = 0;
    for (int i = 1; i < onFace.pointCount; ++i)
        if (onFace.points[i].separation < onFace.points[deepest].separation) deepest = i;
    const Vector3& point = onFace.points[deepest].positionOnA;
    int sides[3], count = 0;
    for (int i = 0; i < 3; ++i)
        if (Dot(triangle.outwards[i], Vector3(point - triangle.corners[i])) >= -slop) sides[count++] = i;
    if (count != 1 && count != 2) return false;
    // Side i ends where side i + 1 begins.
    const int first = count == 1 ? sides[0] : (sides[1] - sides[0] == 1 ? sides[1] : 0);
    DeferredContact deferred;
    deferred.contact = deferred.onFace = WithSurfaceFeatures(view, onFace);
    deferred.vertices[0] = view.vertexIds[first];
    deferred.vertices[1] = view.vertexIds[count == 1 ? (first + 1) % 3 : first];
    deferred.separation = DeepestSeparation(onFace);
    deferred.active = false;
    deferred.isOnFace = true;
    deferred_.push_back(deferred);
    return true;
}

Array<SurfaceManifold>& InternalEdgeFilter::Resolve() {
    if (deferred_.empty()) return contacts_;
    // In one array: the sorted vertices of face contacts; the sorted vertices of deferred contacts, each once; for each
    // of these whether it is covered. Sorted, since a large shape may touch any number of them.
    Array<uint32_t>& covered = covered_;
    std::sort(covered.begin(), covered.end());
    const ptrdiff_t faces = static_cast<ptrdiff_t>(covered.size());
    for (const DeferredContact& deferred : deferred_)
        covered.insert(covered.end(), deferred.vertices, deferred.vertices + 2);
    std::sort(covered.begin() + faces, covered.end());
    covered.erase(std::unique(covered.begin() + faces, covered.end()), covered.end());
    const ptrdiff_t asked = static_cast<ptrdiff_t>(covered.size()) - faces;
    covered.resize(covered.size() + static_cast<size_t>(asked));
    for (ptrdiff_t i = 0; i < asked; ++i)
        covered[static_cast<size_t>(faces + asked + i)] =
            std::binary_search(covered.begin(), covered.begin() + faces, covered[static_cast<size_t>(faces + i)]);
    const auto isCovered = [&](uint32_t vertex) -> uint32_t& {
        return *(std::lower_bound(covered.begin() + faces, covered.begin() + faces + asked, vertex) + asked);
    };
    std::sort(deferred_.begin(), deferred_.end(), [](const auto& x, const auto& y) {
        if (x.active != y.active) return x.active;
        return x.separation < y.separation || (x.separation == y.separation && x.contact.triangle < y.contact.triangle);
    });
    for (const DeferredContact& deferred : deferred_) {
        const bool isEdgeCovered = isCovered(deferred.vertices[0]) && isCovered(deferred.vertices[1]);
        // Points on the face are kept, although the neighbor is closer: without them a shape across two faces would
        // rock.
        const bool isFace = isEdgeCovered || deferred.isOnFace;
        if (!isFace) contacts_.push_back(deferred.contact);
        if ((isFace || facesAhead_) && deferred.onFace.manifold.pointCount > 0) contacts_.push_back(deferred.onFace);
        isCovered(deferred.vertices[0]) = isCovered(deferred.vertices[1]) = 1;
    }
    return contacts_;
}

size_t InternalEdgeFilter::MemoryUsed() const {
    return deferred_.capacity() * sizeof(DeferredContact) + covered_.capacity() * sizeof(uint32_t) +
           contacts_.capacity() * sizeof(SurfaceManifold);
}

}  // namespace fulcrum
