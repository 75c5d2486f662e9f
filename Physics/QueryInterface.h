// Spatial queries: ray casts, shape casts, overlaps, closest points, bounds. From PhysicsSystem::Queries(). Any number
// of threads may query at once, also while another thread changes the world through Bodies() and Joints() or steps it:
// a query sees the world before or after, never in between. During a step queries see the state of the last one; they
// wait only while the step writes bounds, at its start, and poses, at its end. A change waits for the queries that run,
// and the reverse. Hold() locks the world for several queries and while their results are looked up in Bodies().
// Callbacks of a query may query, but not change the world: that returns an error. Callbacks of a step or of a change
// (contact listeners etc.) must not query. Such a query, and one with a null shape, finds nothing and is reported, see
// Misuse.h. Input that is not finite finds nothing.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/Physics/QueryTypes.h>
#include <Fulcrum/Physics/World/WorldLock.h>

#include <span>
#include <vector>

namespace fulcrum {

struct WorldState;

// What for the world is held still: for queries and what LockingBodies() reads during a step, or for everything that
// can be read, for which the end of a step must be awaited.
enum class HoldFor : uint8_t { Queries, Everything };

class QueryInterface {
public:
    explicit QueryInterface(WorldState& world) : world_(world) {}

    // Locks the world for reading as long as the object lives; queries of this thread are cheaper meanwhile. Changes by
    // other threads wait, and so does a step, at the latest at its end; changes by this one return an error. Holds of a
    // thread may end in any order, but must end on it.
    [[nodiscard]] WorldLock::Shared Hold(HoldFor purpose = HoldFor::Everything) const;

    // Rays, see RayCast.h. Ties are resolved by the lowest body, child, triangle.
    bool CastRay(const Ray& ray, WorldRayHit& hit, const RayCastSettings& settings = {},
                 const QueryFilter& filter = {}) const;
    bool IsHit(const Ray& ray, const RayCastSettings& settings = {}, const QueryFilter& filter = {}) const;
    // All hits, sorted by fraction, then body, child, triangle. Replaces the contents of `hits`.
    void CastRayAll(const Ray& ray, std::vector<WorldRayHit>& hits, const RayCastSettings& settings = {},
                    const QueryFilter& filter = {}) const;
    // All hits, in no particular order. `visit` returns the fraction up to which further hits are wanted: 1 for all,
    // the hit's own for closer ones, negative to stop.
    void VisitRay(const Ray& ray, FunctionRef<float(const WorldRayHit&)> visit, const RayCastSettings& settings = {},
                  const QueryFilter& filter = {}) const;

    // The same for moving shapes, see ShapeCast.h. Of bodies that overlap at the start the deepest is the hit.
    bool CastShape(const MovingShape& shape, WorldShapeHit& hit, const ShapeCastSettings& settings = {},
                   const QueryFilter& filter = {}) const;
    bool IsHit(const MovingShape& shape, const ShapeCastSettings& settings = {}, const QueryFilter& filter = {}) const;
    void CastShapeAll(const MovingShape& shape, std::vector<WorldShapeHit>& hits,
                      const ShapeCastSettings& settings = {}, const QueryFilter& filter = {}) const;
    void VisitShape(const MovingShape& shape, FunctionRef<float(const WorldShapeHit&)> visit,
                    const ShapeCastSettings& settings = {}, const QueryFilter& filter = {}) const;

    // The bodies that the shape overlaps or touches, sorted by body and child.
    bool IsOverlapping(const PlacedShape& shape, const QueryFilter& filter = {}) const;
    void FindOverlaps(const PlacedShape& shape, std::vector<OverlapHit>& hits, const QueryFilter& filter = {}) const;
    // In no particular order, until `visit` returns false.
    void VisitOverlaps(const PlacedShape& shape, FunctionRef<bool(const OverlapHit&)> visit,
                       const QueryFilter& filter = {}) const;
    // All contacts of a shape, convex or a compound, as the narrow phase makes them for a body there. With points up to
    // `maxSeparation` m apart, >= 0. Ordered by body, its child, the shape's child, triangle and normal. Contacts with
    // internal edges of surfaces are omitted; one-sided triangles collide from the front only. Other shapes have no
    // contacts, and are reported as misuse.
    void CollideShape(const PlacedShape& shape, float maxSeparation, std::vector<WorldContact>& contacts,
                      const QueryFilter& filter = {}) const;
    // The bodies that contain a point; nothing is inside a mesh or a height field.
    void FindBodiesAt(const Position& point, std::vector<OverlapHit>& hits, const QueryFilter& filter = {}) const;

    // The body closest to a point or shape within `maxDistance` m, >= 0; if some overlap the shape, the deepest.
    bool FindClosest(const Position& point, float maxDistance, WorldClosest& closest,
                     const QueryFilter& filter = {}) const;
    bool FindClosest(const PlacedShape& shape, float maxDistance, WorldClosest& closest,
                     const QueryFilter& filter = {}) const;

    // Broad phase only: bodies and children whose fat bounds intersect a box, a ray, or a moving box. Fast; sorted by
    // body and child.
    void FindInBox(const Position& lower, const Position& upper, std::vector<OverlapHit>& hits,
                   const QueryFilter& filter = {}) const;
    void FindOnRay(const Ray& ray, std::vector<OverlapHit>& hits, const QueryFilter& filter = {}) const;
    void FindOnSweep(const Position& lower, const Position& upper, const Vector3& displacement,
                     std::vector<OverlapHit>& hits, const QueryFilter& filter = {}) const;

    // Whether two bodies may collide, by motion types, layers, masks, groups and joints. The contact listener is not
    // called; sensors and invalid ids collide with nothing.
    bool MayCollide(BodyId a, BodyId b) const;

    // Batches, on the world's job system: result i is bit-identical to that of single query i. If spans have different
    // lengths, the shorter one counts. A vector of results is resized and reuses the memory of its elements.
    void CastRays(std::span<const Ray> rays, std::span<WorldRayHit> hits, const RayCastSettings& settings = {},
                  const QueryFilter& filter = {}) const;
    void AreHit(std::span<const Ray> rays, std::span<uint8_t> hits, const RayCastSettings& settings = {},
                const QueryFilter& filter = {}) const;
    void CastRaysAll(std::span<const Ray> rays, std::vector<std::vector<WorldRayHit>>& hits,
                     const RayCastSettings& settings = {}, const QueryFilter& filter = {}) const;
    void CastShapes(std::span<const MovingShape> shapes, std::span<WorldShapeHit> hits,
                    const ShapeCastSettings& settings = {}, const QueryFilter& filter = {}) const;
    void AreHit(std::span<const MovingShape> shapes, std::span<uint8_t> hits, const ShapeCastSettings& settings = {},
                const QueryFilter& filter = {}) const;
    void CastShapesAll(std::span<const MovingShape> shapes, std::vector<std::vector<WorldShapeHit>>& hits,
                       const ShapeCastSettings& settings = {}, const QueryFilter& filter = {}) const;
    void AreOverlapping(std::span<const PlacedShape> shapes, std::span<uint8_t> hits,
                        const QueryFilter& filter = {}) const;
    void FindOverlaps(std::span<const PlacedShape> shapes, std::vector<std::vector<OverlapHit>>& hits,
                      const QueryFilter& filter = {}) const;
    void FindBodiesAt(std::span<const Position> points, std::vector<std::vector<OverlapHit>>& hits,
                      const QueryFilter& filter = {}) const;
    void FindClosest(std::span<const Position> points, float maxDistance, std::span<WorldClosest> closest,
                     const QueryFilter& filter = {}) const;
    void FindClosest(std::span<const PlacedShape> shapes, float maxDistance, std::span<WorldClosest> closest,
                     const QueryFilter& filter = {}) const;

private:
    template <class Hits, class Item>
    void ForEach(size_t count, Hits&& hits, uint32_t minimumRange, const Item& item) const;

    WorldState& world_;
};

}  // namespace fulcrum
