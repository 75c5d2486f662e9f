// Closest hits of rays in the world: for single rays and for packets of coherent rays, with bit-identical results.
// Called by QueryInterface under the world's lock. Thread-safe; allocates nothing.
//
// A ray's hit with a collider does not depend on earlier hits, and the closest hit is the minimum by fraction, body,
// child. So the result depends neither on the order of the colliders nor on the other rays of the packet.
#pragma once

#include <Fulcrum/Physics/Queries/ColliderSearch.h>

namespace fulcrum {

inline WorldRayHit ToWorld(const ColliderSearch& search, uint32_t collider, const Ray& ray, const RayHit& hit) {
    WorldRayHit result;
    result.body = search.IdOf(collider);
    result.subShape = {search.ChildOf(collider), hit.subShape.triangle};
    result.fraction = hit.fraction;
    result.normal = hit.normal;
    result.position = ray.origin + ray.displacement.cast<double>() * double{hit.fraction};
    result.isBackFace = hit.isBackFace;
    return result;
}

// Calls found(collider) for all colliders whose bounds the ray hits up to `limit`, which `found` may lower.
template <class Found>
void AlongRay(const ColliderSearch& search, const TreeRay& ray, float& limit, const Found& found) {
    search.Run([&](const BoundsTree& tree, const auto& visit) { tree.CastRay(ray, limit, visit); }, found);
}

// The closest hit of a ray so far.
struct ClosestCollider {
    static constexpr uint32_t kNone = ~0u;
    RayHit hit;
    uint32_t collider = kNone;

    // Takes a hit not beyond `limit` if it precedes the current one, and lowers `limit`.
    void Take(const ColliderSearch& search, uint32_t of, const RayHit& found, float& limit) {
        if (found.fraction > limit) return;
        if (collider != kNone && found.fraction == hit.fraction && search.ComesBefore(collider, of)) return;
        hit = found;
        collider = of;
        limit = found.fraction;
    }
};

// Returns false if there is none; then `hit` is unchanged.
bool CastClosest(const ColliderSearch& search, const Ray& ray, const RayCastSettings& settings, WorldRayHit& hit);

// Casts the rays with the indices `which`, at most RayCaster::kMostRays, and writes their hits; {} for none. Fast if
// they are close together.
void CastClosest(const ColliderSearch& search, std::span<const Ray> rays, std::span<const uint32_t> which,
                 const RayCastSettings& settings, std::span<WorldRayHit> hits);

}  // namespace fulcrum
