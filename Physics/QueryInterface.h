// Asks where things are: rays, moving shapes, overlaps, closest points, bounds. From PhysicsSystem::Queries().
// Any number of threads at once, also while one changes the world through Bodies() and Joints() or steps it: a query
// then waits, and sees the world before or after, never in between. Bodies are found where they are now. Hold() keeps
// the world still over several queries, and while their results are looked up in Bodies(). What a query calls back may
// query, but not change the world: that is refused. Within what a step or a change calls back (contact listeners and
// the like) no query is allowed. Such a query, and one with a null shape, finds nothing and is reported, see Misuse.h.
// Input that is not finite finds nothing.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/Physics/QueryTypes.h>
#include <Fulcrum/Physics/World/WorldLock.h>

#include <span>
#include <vector>

namespace fulcrum {

struct WorldState;

class QueryInterface {
public:
    explicit QueryInterface(WorldState& world) : world_(world) {}

    // Nothing changes as long as the object lives; queries of this thread cost less meanwhile. Changes by
    // other threads wait, those by this one are refused.
    [[nodiscard]] WorldLock::Shared Hold() const;

    // Rays, see RayCast.h. Of hits equally close the lowest body, child, triangle counts.
    bool CastRay(const Ray& ray, WorldRayHit& hit, const RayCastSettings& settings = {},
                 const QueryFilter& filter = {}) const;
    bool IsHit(const Ray& ray, const RayCastSettings& settings = {}, const QueryFilter& filter = {}) const;
    // All, by fraction, then body, child, triangle. Replaces what is in `hits`.
    void CastRayAll(const Ray& ray, std::vector<WorldRayHit>& hits, const RayCastSettings& settings = {},
                    const QueryFilter& filter = {}) const;
    // In no order. `visit` returns up to which fraction hits are of interest still: 1 for all of them, its own for
    // closer ones, less than 0 to end the search.
    void VisitRay(const Ray& ray, FunctionRef<float(const WorldRayHit&)> visit, const RayCastSettings& settings = {},
                  const QueryFilter& filter = {}) const;

    // The same for moving shapes, see ShapeCast.h. Of what overlaps at the start the deepest counts.
    bool CastShape(const MovingShape& shape, WorldShapeHit& hit, const ShapeCastSettings& settings = {},
                   const QueryFilter& filter = {}) const;
    bool IsHit(const MovingShape& shape, const ShapeCastSettings& settings = {}, const QueryFilter& filter = {}) const;
    void CastShapeAll(const MovingShape& shape, std::vector<WorldShapeHit>& hits,
                      const ShapeCastSettings& settings = {}, const QueryFilter& filter = {}) const;
    void VisitShape(const MovingShape& shape, FunctionRef<float(const WorldShapeHit&)> visit,
                    const ShapeCastSettings& settings = {}, const QueryFilter& filter = {}) const;

    // What the shape overlaps, touching included, by body and child.
    bool IsOverlapping(const PlacedShape& shape, const QueryFilter& filter = {}) const;
    void FindOverlaps(const PlacedShape& shape, std::vector<OverlapHit>& hits, const QueryFilter& filter = {}) const;
    // In no order, until `visit` returns false.
    void VisitOverlaps(const PlacedShape& shape, FunctionRef<bool(const OverlapHit&)> visit,
                       const QueryFilter& filter = {}) const;
    // All contacts of a shape, convex or a compound, as the narrow phase makes them: what the shape would feel there.
    // With points up to `maxSeparation` m apart, >= 0. By body, its child, the shape's child, triangle, normal. Of
    // surfaces those of internal edges are left out; one-sided triangles count from the front. Other shapes touch
    // nothing, which is reported.
    void CollideShape(const PlacedShape& shape, float maxSeparation, std::vector<WorldContact>& contacts,
                      const QueryFilter& filter = {}) const;
    // What a point is inside of; nothing is inside a mesh or a height field.
    void FindBodiesAt(const Position& point, std::vector<OverlapHit>& hits, const QueryFilter& filter = {}) const;

    // The body closest to a point or shape within `maxDistance` m, >= 0; of those that overlap the shape, the deepest.
    bool FindClosest(const Position& point, float maxDistance, WorldClosest& closest,
                     const QueryFilter& filter = {}) const;
    bool FindClosest(const PlacedShape& shape, float maxDistance, WorldClosest& closest,
                     const QueryFilter& filter = {}) const;

    // The broad phase alone: bodies and children whose bounds, which are a little larger than they, meet a box, a ray,
    // or a moving box. Fast; by body and child.
    void FindInBox(const Position& lower, const Position& upper, std::vector<OverlapHit>& hits,
                   const QueryFilter& filter = {}) const;
    void FindOnRay(const Ray& ray, std::vector<OverlapHit>& hits, const QueryFilter& filter = {}) const;
    void FindOnSweep(const Position& lower, const Position& upper, const Vector3& displacement,
                     std::vector<OverlapHit>& hits, const QueryFilter& filter = {}) const;

    // Whether two bodies collide where they meet: by their kinds of motion, layers, masks, groups and joints. A contact
    // listener is not asked; sensors, and ids that are not valid, collide with nothing.
    bool MayCollide(BodyId a, BodyId b) const;

    // Batches, over the world's job system: answer i is that of the single query i, the same bits. Results of another
    // length than the queries: only what both have is done. A list of results is given their length and keeps its
    // lists' memory.
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
