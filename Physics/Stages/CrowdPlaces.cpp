#include <Fulcrum/Physics/Stages/CrowdPlaces.h>

#include <Fulcrum/Collision/BroadPhase/BoundsTreeCasts.h>
#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/Physics/Stages/StepState.h>
#include <Fulcrum/Physics/World/Filters.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace fulcrum {

namespace {

// The fraction of the ball's volume filled by the bounding spheres of bodies. Touching spheres on the lattice fill 0.74
// of it; with 0.6 their surfaces are 7 % of a diameter apart.
constexpr double kPacking = 0.6;
// In radii of the ball. Bodies whose centers are all this close to their common center move to positions about that
// center.
constexpr double kNear = 1.5;
// In radii of the ball: largest distance of positions from its center; floors and walls farther away are ignored. A
// floor that cuts off half the ball needs 1.26.
constexpr double kFarthestPlace = 2;
// The lattice spacing fits all bodies except the largest one in this many; sizing it for a few large ones would spread
// all others.
constexpr size_t kLargeOnes = 32;

// The finalizer of MurmurHash3: every bit of the input changes about half of the bits of the result.
uint64_t Mix(uint64_t x) {
    x ^= x >> 33;
    x *= 0xFF51AFD7ED558CCDull;
    x ^= x >> 33;
    x *= 0xC4CEB9FE1A85EC53ull;
    return x ^ x >> 33;
}

// The ball to be filled with bodies.
struct Ball {
    Position middle;
    double radius;  // m
    double margin;  // m: the radius of a body; centers keep this distance from floor and walls
};

// Finds the first floor or wall, among those with which `body` collides, that a ray from the ball's center hits.
// Returns false if there is none.
bool FindLimit(const CollisionView& view, uint32_t body, const Ball& ball, const Vector3& ray, PlaceLimit& limit) {
    const RayCaster caster({ball.middle, ray});
    RayHit closest;
    uint32_t met = ~0u;
    float most = 1;
    view.colliders.staticTree.CastRay(
        TreeRay(ball.middle - view.colliders.boundsOrigin, ray), most, [&](uint32_t index) {
            RayHit hit;
            if (!CanCollide(view, body, view.colliders.colliders[index].body)) return;
            if (!caster.CastClosest(*view.colliders.shapes[index].shape,
                                    ColliderPoseOf(view.bodies, view.colliders, index), {}, hit))
                return;
            // Ties are resolved by the lowest index, independent of the tree's structure.
            if (std::pair(hit.fraction, index) >= std::pair(closest.fraction, met) && met != ~0u) return;
            closest = hit;
            met = index;
            most = std::min(most, hit.fraction);
        });
    const double height = -double{closest.fraction} * Dot<double>(closest.normal.cast<double>(), ray.cast<double>());
    limit = {closest.normal, static_cast<float>((ball.margin - height) / ball.radius)};
    return met != ~0u;
}

// Finds floors and walls in 26 directions.
Array<PlaceLimit> FindLimits(const CollisionView& view, uint32_t body, const Ball& ball) {
    Array<PlaceLimit> limits;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                const Vector3 direction(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                PlaceLimit limit;
                if (direction.isZero(0)) continue;
                if (FindLimit(view, body, ball, direction * static_cast<float>(kFarthestPlace * ball.radius), limit))
                    limits.push_back(limit);
            }
    return limits;
}

// m: the outer radius that only one body in kLargeOnes exceeds.
float NearlyLargestRadius(const CollisionView& view, std::span<const uint32_t> bodies) {
    Array<float> radii;
    for (const uint32_t body : bodies) radii.push_back(view.bodies.dynamics[body].outerRadius);
    const auto large = radii.end() - 1 - static_cast<ptrdiff_t>(radii.size() / kLargeOnes);
    std::nth_element(radii.begin(), large, radii.end());
    return *large;
}

// Reorders bodies and positions so that body i gets position i, with few crossing paths: along the axis of the largest
// extent the lower half of the bodies gets the lower half of the positions, recursively. Equal coordinates are ordered
// by the bodies' indices.
void MatchPlaces(const CollisionView& view, std::span<uint32_t> bodies, std::span<Vector3> places) {
    if (bodies.size() < 2) return;
    Vector3 lower = places[0], upper = places[0];
    for (const Vector3& place : places) {
        lower = lower.cwiseMin(place);
        upper = upper.cwiseMax(place);
    }
    const Vector3 extent = upper - lower;
    const int axis = static_cast<int>(std::max_element(extent.data(), extent.data() + 3) - extent.data());
    const size_t half = bodies.size() / 2;
    const auto bodyKey = [&](uint32_t body) { return std::pair(view.bodies.poses[body].position[axis], body); };
    const auto placeKey = [&](const Vector3& p) { return std::tuple(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]); };
    std::nth_element(bodies.begin(), bodies.begin() + half, bodies.end(),
                     [&](uint32_t x, uint32_t y) { return bodyKey(x) < bodyKey(y); });
    std::nth_element(places.begin(), places.begin() + half, places.end(),
                     [&](const Vector3& x, const Vector3& y) { return placeKey(x) < placeKey(y); });
    MatchPlaces(view, bodies.first(half), places.first(half));
    MatchPlaces(view, bodies.subspan(half), places.subspan(half));
}

}  // namespace

Vector3 PointInBall(uint32_t body) {
    for (uint64_t seed = body;; seed += uint64_t(1) << 32) {
        const uint64_t bits = Mix(seed + 1);
        Vector3 point;
        for (int k = 0; k < 3; ++k)
            point[k] = static_cast<float>(static_cast<int32_t>(bits >> (21 * k) & 0x1FFFFF) - 0x100000) * 0x1p-20f;
        if (LengthSquared(point) <= 1) return point;
    }
}

// Points of a face-centered cubic lattice (integers with an even sum) nearest to the center of one of its cubes.
Array<Vector3> PlacesInBall(uint32_t count, std::span<const PlaceLimit> limits) {
    struct Point {
        int32_t square, x, y, z;  // twice the point relative to that center, and its squared length
        auto operator<=>(const Point&) const = default;
        Vector3 Place() const {
            return Vector3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) * 0.5f;
        }
    };
    constexpr double kUnitBall = 4.18879;  // its volume
    const double whole =
        std::cbrt(2 * count / kUnitBall);  // radius in lattice units; the lattice has half a point per unit volume
    const int reach = static_cast<int>(limits.empty() ? whole : kFarthestPlace * whole) + 2;
    const float scale = static_cast<float>(1 / whole);
    Array<Point> points;
    for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
            for (int z = -reach + ((x + y + reach) & 1); z <= reach; z += 2) {
                const int dx = 2 * x - 1, dy = 2 * y - 1, dz = 2 * z - 1;
                const Point point = {dx * dx + dy * dy + dz * dz, dx, dy, dz};
                const auto allows = [&](const PlaceLimit& limit) {
                    return Dot<float>(limit.normal, point.Place()) * scale >= limit.offset;
                };
                if (point.square <= 4 * reach * reach && std::all_of(limits.begin(), limits.end(), allows))
                    points.push_back(point);
            }
    if (points.size() < count) return {};
    std::sort(points.begin(), points.end());
    Array<Vector3> places;
    for (uint32_t i = 0; i < count; ++i) places.push_back(points[i].Place() * scale);
    return places;
}

void AssignPlaces(const CollisionView& view, std::span<uint32_t> bodies, Array<DispersingBody>& dispersing) {
    const uint32_t count = static_cast<uint32_t>(bodies.size());
    const double margin = double{NearlyLargestRadius(view, bodies)}, radius = margin * std::cbrt(count / kPacking);
    Position middle = Position::Zero();
    for (const uint32_t body : bodies) middle += view.bodies.CenterOf(body) / static_cast<double>(count);
    const bool areNear = std::all_of(bodies.begin(), bodies.end(), [&](uint32_t body) {
        return (view.bodies.CenterOf(body) - middle).norm() < kNear * radius;
    });
    Array<Vector3> places;
    if (areNear) places = PlacesInBall(count, FindLimits(view, bodies[0], {middle, radius, margin}));
    if (places.empty()) places = PlacesInBall(count);
    MatchPlaces(view, bodies, places);
    double longest = 0;
    const size_t first = dispersing.size();
    for (uint32_t i = 0; i < count; ++i) {
        const Position center = view.bodies.CenterOf(bodies[i]),
                       place = (areNear ? middle : center) + places[i].cast<double>() * radius;
        longest = std::max(longest, (place - center).norm());
        dispersing.push_back(
            {.body = bodies[i], .direction = PointInBall(bodies[i]), .hasPlace = true, .place = place});
    }
    const float seconds = static_cast<float>(longest) / DispersingSpeed(view.step.settings);
    for (DispersingBody& each : std::span(dispersing).subspan(first)) each.secondsLeft = seconds;
}

}  // namespace fulcrum
