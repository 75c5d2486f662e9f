// Batches of queries on the world's job system. Each item runs the single query, so results are bit-identical; the
// calling thread holds the world's lock for all of them.
#include <Fulcrum/Physics/Queries/RayOrder.h>
#include <Fulcrum/Physics/Queries/RaySearch.h>
#include <Fulcrum/Physics/QueryInterface.h>

#include <algorithm>

namespace fulcrum {

namespace {
// Enough to amortize the overhead of a job: a few microseconds.
constexpr uint32_t kRaysPerJob = 64;
constexpr uint32_t kShapesPerJob = 8;

template <class T>
void Prefetch(T& item) {
    __builtin_prefetch(&item, std::is_const_v<T> ? 0 : 1);
    __builtin_prefetch(reinterpret_cast<const char*>(&item + 1) - 1, std::is_const_v<T> ? 0 : 1);
}
}  // namespace

template <class Hits, class Item>
void QueryInterface::ForEach(size_t count, Hits&& hits, uint32_t minimumRange, const Item& item) const {
    const QueryScope scope(world_);
    if (!scope) {
        for (size_t i = 0; i < count; ++i) hits[i] = {};
        return;
    }
    world_.jobs->ParallelFor(static_cast<uint32_t>(count), minimumRange, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) item(i);
    });
}

void QueryInterface::CastRays(std::span<const Ray> rays, std::span<WorldRayHit> hits, const RayCastSettings& settings,
                              const QueryFilter& filter) const {
    rays = rays.first(std::min(rays.size(), hits.size()));
    const QueryScope scope(world_);
    if (!scope) return std::fill_n(hits.begin(), rays.size(), WorldRayHit{}), void();
    const ColliderSearch search(world_, filter);
    // Moved out while in use, because callbacks of a query may run queries, too.
    thread_local RayOrder kept;
    RayOrder order = std::move(kept);
    constexpr uint32_t kRays = RayCaster::kMostRays;
    order.Sort(rays, kRays);
    const std::span<const uint32_t> numbers = order.Numbers();
    const uint32_t count = static_cast<uint32_t>(rays.size());
    const auto packetOf = [&](uint32_t i) {
        const uint32_t first = std::min(i * kRays, count);
        return numbers.subspan(first, std::min(kRays, count - first));
    };
    world_.jobs->ParallelFor((count + kRays - 1) / kRays, kRaysPerJob / kRays, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            // Prefetch: rays that are close in space are far apart in memory.
            for (const uint32_t number : packetOf(i + 1)) {
                Prefetch(rays[number]);
                Prefetch(hits[number]);
            }
            CastClosest(search, rays, packetOf(i), settings, hits);
        }
    });
    kept = std::move(order);
}

void QueryInterface::AreHit(std::span<const Ray> rays, std::span<uint8_t> hits, const RayCastSettings& settings,
                            const QueryFilter& filter) const {
    ForEach(std::min(rays.size(), hits.size()), hits, kRaysPerJob,
            [&](size_t i) { hits[i] = IsHit(rays[i], settings, filter); });
}

void QueryInterface::CastRaysAll(std::span<const Ray> rays, std::vector<std::vector<WorldRayHit>>& hits,
                                 const RayCastSettings& settings, const QueryFilter& filter) const {
    hits.resize(rays.size());
    ForEach(rays.size(), hits, kRaysPerJob, [&](size_t i) { CastRayAll(rays[i], hits[i], settings, filter); });
}

void QueryInterface::CastShapes(std::span<const MovingShape> shapes, std::span<WorldShapeHit> hits,
                                const ShapeCastSettings& settings, const QueryFilter& filter) const {
    ForEach(std::min(shapes.size(), hits.size()), hits, kShapesPerJob, [&](size_t i) {
        if (!CastShape(shapes[i], hits[i], settings, filter)) hits[i] = {};
    });
}

void QueryInterface::AreHit(std::span<const MovingShape> shapes, std::span<uint8_t> hits,
                            const ShapeCastSettings& settings, const QueryFilter& filter) const {
    ForEach(std::min(shapes.size(), hits.size()), hits, kShapesPerJob,
            [&](size_t i) { hits[i] = IsHit(shapes[i], settings, filter); });
}

void QueryInterface::CastShapesAll(std::span<const MovingShape> shapes, std::vector<std::vector<WorldShapeHit>>& hits,
                                   const ShapeCastSettings& settings, const QueryFilter& filter) const {
    hits.resize(shapes.size());
    ForEach(shapes.size(), hits, kShapesPerJob, [&](size_t i) { CastShapeAll(shapes[i], hits[i], settings, filter); });
}

void QueryInterface::AreOverlapping(std::span<const PlacedShape> shapes, std::span<uint8_t> hits,
                                    const QueryFilter& filter) const {
    ForEach(std::min(shapes.size(), hits.size()), hits, kShapesPerJob,
            [&](size_t i) { hits[i] = IsOverlapping(shapes[i], filter); });
}

void QueryInterface::FindOverlaps(std::span<const PlacedShape> shapes, std::vector<std::vector<OverlapHit>>& hits,
                                  const QueryFilter& filter) const {
    hits.resize(shapes.size());
    ForEach(shapes.size(), hits, kShapesPerJob, [&](size_t i) { FindOverlaps(shapes[i], hits[i], filter); });
}

void QueryInterface::FindBodiesAt(std::span<const Position> points, std::vector<std::vector<OverlapHit>>& hits,
                                  const QueryFilter& filter) const {
    hits.resize(points.size());
    ForEach(points.size(), hits, kRaysPerJob, [&](size_t i) { FindBodiesAt(points[i], hits[i], filter); });
}

void QueryInterface::FindClosest(std::span<const Position> points, float maxDistance, std::span<WorldClosest> closest,
                                 const QueryFilter& filter) const {
    ForEach(std::min(points.size(), closest.size()), closest, kShapesPerJob, [&](size_t i) {
        if (!FindClosest(points[i], maxDistance, closest[i], filter)) closest[i] = {};
    });
}

void QueryInterface::FindClosest(std::span<const PlacedShape> shapes, float maxDistance,
                                 std::span<WorldClosest> closest, const QueryFilter& filter) const {
    ForEach(std::min(shapes.size(), closest.size()), closest, kShapesPerJob, [&](size_t i) {
        if (!FindClosest(shapes[i], maxDistance, closest[i], filter)) closest[i] = {};
    });
}

}  // namespace fulcrum
