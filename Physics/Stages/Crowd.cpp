#include <Fulcrum/Physics/Stages/Crowd.h>

#include <Fulcrum/Collision/BroadPhase/BoundsTreeCasts.h>
#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/Queries/RayCast.h>
#include <Fulcrum/Physics/Islands/UnionFind.h>
#include <Fulcrum/Physics/Stages/BodyLimits.h>
#include <Fulcrum/Physics/State/BodyPairs.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace fulcrum {

namespace {

// The hair, as a part of the sum of the inner radii.
constexpr float kHair = 1e-3f;
// Two whose centers are nearer than this part of the sum of their inner radii stand in each other.
constexpr float kDeepNearness = 0.8f;
// So many others are many. What is packed as densely as balls can be has twelve neighbors, and stands in none of them.
constexpr size_t kMany = 6;
// So many fill a ball by a plan; fewer take ways at random, since they may come one by one.
constexpr size_t kWhole = 32;
// The part of the ball's volume that they fill, as far as one can tell beforehand.
constexpr double kPacking = 0.6;
// Those that all start within so many radii of the ball that they will fill go to its very places.
constexpr double kNear = 1.5;
// Walls that leave less of the ball than this allows, as a multiple of its radius, are not foreseen.
constexpr double kMostCut = 2;
// s, that they wait at their places for the last to come.
constexpr float kPatience = 0.5f;
// Those that start together have room when no more than one of so many overlaps somebody.
constexpr uint32_t kNearlyAll = 32;
// The speed at the surface of the ball, as a multiple of contactPushSpeed.
constexpr float kSpread = 1.5f;
// Those that have dispersed are crowded as long as they overlap by more than this part of the sum of the inner radii.
constexpr float kOverlap = 0.01f;
// The part of an overlap with what does not move that goes within a substep.
constexpr float kPushedOut = 0.125f;

// A finalizer of MurmurHash3's kind: every bit of the input turns about half of the output.
uint64_t Mix(uint64_t x) {
    x ^= x >> 33;
    x *= 0xFF51AFD7ED558CCDull;
    x ^= x >> 33;
    x *= 0xC4CEB9FE1A85EC53ull;
    return x ^ x >> 33;
}

float InnerRadii(const Shape& a, const Shape& b) { return a.InnerRadius() + b.InnerRadius(); }

Position CenterOf(const WorldState& world, uint32_t collider) {
    const uint32_t body = world.colliders.colliders[collider].body;
    const Position center = world.bodies.CentreOf(body);
    if (!world.colliders.shapes[collider].offset) return center;
    return center + Rotate(world.bodies.RotationOf(body), LocalOf(world, collider).position).cast<double>();
}

bool AreDynamic(const WorldState& world, uint32_t collider, uint32_t other) {
    const auto isDynamic = [&](uint32_t index) { return world.bodies.dynamics[world.colliders.colliders[index].body].motion == MotionType::Dynamic; };
    return isDynamic(collider) && isDynamic(other);
}

// m^2, of the centers.
float SquareBetween(const WorldState& world, uint32_t collider, uint32_t other) {
    return LengthSquared(Vector3((CenterOf(world, other) - CenterOf(world, collider)).cast<float>()));
}

Pose PoseOf(const WorldState& world, uint32_t collider) {
    const Pose body = world.bodies.CentrePoseOf(world.colliders.colliders[collider].body);
    return world.colliders.shapes[collider].offset ? body * LocalOf(world, collider) : body;
}

// World space, from A to B.
Vector3 NormalOf(const WorldState& world, uint32_t pair) {
    const float(&n)[3] = world.pairs.records[pair].normal;
    return Rotate(world.bodies.RotationOf(world.pairs.pairs[pair].bodyA), Vector3(n[0], n[1], n[2]));
}

// m, as the step began: the least of a manifold's points.
float SeparationOf(const WorldState& world, uint32_t index, const Vector3& normal) {
    const Pair& pair = world.pairs.pairs[index];
    const Pose a = world.bodies.CentrePoseOf(pair.bodyA), b = world.bodies.CentrePoseOf(pair.bodyB);
    float least = std::numeric_limits<float>::infinity();
    for (int i = 0; i < pair.pointCount; ++i) {
        const ContactRecord::Point& p = world.pairs.records[index].points[i];
        const Position onA = a.Transform(Vector3(p.onA[0], p.onA[1], p.onA[2])), onB = b.Transform(Vector3(p.onB[0], p.onB[1], p.onB[2]));
        least = std::min(least, Dot<float>(normal, Vector3((onB - onA).cast<float>())));
    }
    return least;
}

// Calls visit(pair) for the manifolds of a body with what does not move.
template <class Visit>
void VisitFixedContacts(const WorldState& world, uint32_t body, const Visit& visit) {
    VisitColliders(world, body, [&](uint32_t collider) {
        world.pairs.VisitOf(collider, [&](uint32_t first) {
            for (uint32_t pair = first; pair != PairStore::kNone; pair = world.pairs.pairs[pair].more)
                if (world.pairs.pairs[pair].fixedB && world.pairs.pairs[pair].touching) visit(pair);
        });
    });
}

// Whether it is a body that can disperse at all.
bool MovesFreely(const WorldState& world, uint32_t body) {
    const BodyDynamics& d = world.bodies.dynamics[body];
    const BodyCold& cold = world.bodies.cold[body];
    return cold.exists && !cold.removed && !cold.isSensor && d.awake && !d.frozen && d.motion == MotionType::Dynamic;
}

// Of bodies that joints hold together, the one with the lowest index. Such a structure goes one way, and what stands in itself was
// made so.
class Structures {
public:
    explicit Structures(WorldState& world) {
        if (world.joints.Count() == 0) return;
        roots_ = world.scratch.Allocate<uint32_t>(world.bodies.Size());
        UnionFind sets(roots_);
        for (const Joint& joint : world.joints.joints)
            if (joint.exists && joint.enabled && !joint.still[0] && !joint.still[1]) sets.Unite(joint.body[0], joint.body[1]);
        for (uint32_t body = 0; body < roots_.size(); ++body) roots_[body] = sets.Find(body);
    }
    uint32_t RootOf(uint32_t body) const { return roots_.empty() ? body : roots_[body]; }

private:
    std::span<uint32_t> roots_;
};

// Whether two colliders, both convex, overlap.
bool Overlap(const WorldState& world, uint32_t collider, uint32_t other) {
    if (!AreDynamic(world, collider, other)) return false;
    const ConvexShape& a = static_cast<const ConvexShape&>(*world.colliders.shapes[collider].shape);
    const ConvexShape& b = static_cast<const ConvexShape&>(*world.colliders.shapes[other].shape);
    const float square = SquareBetween(world, collider, other), inner = InnerRadii(a, b), outer = a.OuterRadius() + b.OuterRadius();
    if (square < inner * inner || square >= outer * outer) return square < inner * inner;
    Manifold manifold;
    PairCache cache;
    CollideCounters counters;
    Collide(a, b, Relative(PoseOf(world, collider), PoseOf(world, other)), {.method = world.settings.narrowPhase}, cache, manifold, counters);
    return std::any_of(manifold.points, manifold.points + manifold.pointCount, [](const ManifoldPoint& point) { return point.separation < 0; });
}

// Of the bodies that a body is near to, in the way of `IsNear`, the number, up to kMost.
template <size_t kMost, bool (*IsNear)(const WorldState&, uint32_t, uint32_t)>
size_t CountNear(const WorldState& world, const Structures& structures, uint32_t body) {
    std::array<uint32_t, kMost> others;
    size_t count = 0;
    const auto counts = [&](uint32_t collider, uint32_t index) {
        const uint32_t other = world.colliders.colliders[index].body;
        if (!IsNear(world, collider, index) || structures.RootOf(other) == structures.RootOf(body)) return false;
        if (std::find(others.data(), others.data() + count, other) != others.data() + count) return false;
        return CanCollide(world, body, other) && (world.pairs.Find(collider, index) != PairStore::kNone || ListenerAllows(world, body, other));
    };
    VisitColliders(world, body, [&](uint32_t collider) {
        float distance = 0;  // below zero ends the search
        if (count == kMost) return;
        world.colliders.movingTree.VisitNear(TightBoundsOf(world, collider), distance, [&](uint32_t index) {
            if (counts(collider, index)) others[count++] = world.colliders.colliders[index].body;
            if (count == kMost) distance = -1;
        });
    });
    return count;
}

bool StandInDisperser(const WorldState& world, uint32_t collider, uint32_t other) {
    return world.bodies.dynamics[world.colliders.colliders[other].body].dispersing && StandInEachOther(world, collider, other);
}

// The bodies of which isSo(body) is true, asked by all workers; `bodies` in ascending order, which they keep.
template <class Test>
std::vector<uint32_t> Select(WorldState& world, std::span<const uint32_t> bodies, const Test& isSo) {
    const std::span<uint8_t> is = world.scratch.Allocate<uint8_t>(bodies.size());
    world.jobs->ParallelFor(static_cast<uint32_t>(bodies.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) is[i] = isSo(bodies[i]);
    });
    std::vector<uint32_t> selected;
    for (size_t i = 0; i < bodies.size(); ++i)
        if (is[i]) selected.push_back(bodies[i]);
    return selected;
}

// The nearest of what does not move that a ray from `middle` meets, as a limit of places in a ball of such a radius, m, of bodies
// of radius `margin`, m.
bool FindLimit(const WorldState& world, uint32_t body, const Position& middle, const Vector3& ray, double radius, double margin, PlaceLimit& limit) {
    const RayCaster caster({middle, ray});
    RayHit closest;
    uint32_t met = ~0u;
    float most = 1;
    world.colliders.fixedTree.CastRay(TreeRay(middle - world.colliders.boundsOrigin, ray), most, [&](uint32_t index) {
        RayHit hit;
        if (!CanCollide(world, body, world.colliders.colliders[index].body)) return;
        if (!caster.CastClosest(*world.colliders.shapes[index].shape, PoseOf(world, index), {}, hit)) return;
        if (std::pair(hit.fraction, index) >= std::pair(closest.fraction, met) && met != ~0u) return;
        closest = hit;
        met = index;
        most = std::min(most, hit.fraction);
    });
    const double height = -double{closest.fraction} * Dot<double>(closest.normal.cast<double>(), ray.cast<double>());
    limit = {closest.normal, static_cast<float>((margin - height) / radius)};
    return met != ~0u;
}

// Looks for floor and walls in all directions.
std::vector<PlaceLimit> FindLimits(const WorldState& world, uint32_t body, const Position& middle, double radius, double margin) {
    std::vector<PlaceLimit> limits;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                const Vector3 direction(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                PlaceLimit limit;
                if (direction.isZero(0)) continue;
                if (FindLimit(world, body, middle, direction * static_cast<float>(kMostCut * radius), radius, margin, limit)) limits.push_back(limit);
            }
    return limits;
}

// m: the outer radius that only few exceed.
float NearlyLargest(const WorldState& world, std::span<const uint32_t> bodies) {
    std::vector<float> radii;
    for (const uint32_t body : bodies) radii.push_back(world.bodies.dynamics[body].outerRadius);
    const auto large = radii.end() - 1 - static_cast<ptrdiff_t>(radii.size() / kNearlyAll);
    std::nth_element(radii.begin(), large, radii.end());
    return *large;
}

// Gives each body a place on its side of the others: halves of the bodies to halves of the places, and so on. What coincides is told
// apart by its index.
void Match(const WorldState& world, std::span<uint32_t> bodies, std::span<Vector3> places) {
    if (bodies.size() < 2) return;
    Vector3 lower = places[0], upper = places[0];
    for (const Vector3& place : places) {
        lower = lower.cwiseMin(place);
        upper = upper.cwiseMax(place);
    }
    Eigen::Index axis;
    Vector3(upper - lower).maxCoeff(&axis);
    const size_t half = bodies.size() / 2;
    const auto bodyKey = [&](uint32_t body) { return std::pair(world.bodies.poses[body].position[axis], body); };
    const auto placeKey = [&](const Vector3& p) { return std::tuple(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]); };
    std::nth_element(bodies.begin(), bodies.begin() + half, bodies.end(), [&](uint32_t x, uint32_t y) { return bodyKey(x) < bodyKey(y); });
    std::nth_element(places.begin(), places.begin() + half, places.end(), [&](const Vector3& x, const Vector3& y) { return placeKey(x) < placeKey(y); });
    Match(world, bodies.first(half), places.first(half));
    Match(world, bodies.subspan(half), places.subspan(half));
}

// Where all start near enough to each other their ways lead to the places, whatever theirs are now; else they go that way.
void FindWaysToPlaces(const WorldState& world, std::vector<uint32_t>& bodies, std::vector<Disperser>& ways) {
    const uint32_t count = static_cast<uint32_t>(bodies.size());
    const double large = double{NearlyLargest(world, bodies)}, radius = large * std::cbrt(count / kPacking);
    Position middle = Position::Zero();
    for (const uint32_t body : bodies) middle += world.bodies.CentreOf(body) / static_cast<double>(count);
    const bool areNear = std::all_of(bodies.begin(), bodies.end(), [&](uint32_t body) { return (world.bodies.CentreOf(body) - middle).norm() < kNear * radius; });
    std::vector<Vector3> places;
    if (areNear) places = PlacesInBall(count, FindLimits(world, bodies[0], middle, radius, large));
    if (places.empty()) places = PlacesInBall(count);
    Match(world, bodies, places);
    double longest = 0;
    const size_t first = ways.size();
    for (uint32_t i = 0; i < count; ++i) {
        const Position center = world.bodies.CentreOf(bodies[i]), place = (areNear ? middle : center) + places[i].cast<double>() * radius;
        longest = std::max(longest, (place - center).norm());
        ways.push_back({.body = bodies[i], .way = PlaceInCrowd(bodies[i]), .hasPlace = true, .place = place});
    }
    const float seconds = static_cast<float>(longest) / (kSpread * world.settings.contactPushSpeed);
    for (Disperser& disperser : std::span(ways).subspan(first)) disperser.seconds = seconds;
}

std::vector<Disperser> FindWays(const WorldState& world, const Structures& structures, std::span<const uint32_t> bodies) {
    std::vector<Disperser> ways;
    std::vector<uint32_t> single;
    for (const uint32_t body : bodies) {
        if (world.joints.HasAny(body)) ways.push_back({body, PlaceInCrowd(structures.RootOf(body))});
        else single.push_back(body);
    }
    if (single.size() >= kWhole) FindWaysToPlaces(world, single, ways);
    else for (const uint32_t body : single) ways.push_back({body, PlaceInCrowd(body)});
    return ways;
}

void RemoveDynamicPairs(WorldState& world, std::span<const uint32_t> bodies) {
    VisitPairsOf(world, bodies, [&](uint32_t pair) {
        if (world.pairs.pairs[pair].fixedB) return;
        if (pair < world.changes.size()) world.changes[pair] = PairChange::None;
        RemovePair(world, pair);
    });
}

// Those that started to disperse in one step.
struct Together {
    uint32_t count = 0, overlapping = 0;
    bool isBlocked = false;  // one of them overlaps many
    bool HaveRoom() const { return !isBlocked && overlapping * kNearlyAll <= count; }
};

void AddGravity(WorldState& world, uint32_t body, float factor) {
    const Vector3 gravity = world.settings.gravity * (factor * world.bodies.dynamics[body].gravityFactor);
    for (int k = 0; k < 3; ++k) world.bodies.poses[body].acceleration[k] += gravity[k];
}

// What does not move turns the way back.
void Reflect(const WorldState& world, Disperser& disperser) {
    VisitFixedContacts(world, disperser.body, [&](uint32_t pair) {
        const Vector3 normal = NormalOf(world, pair);
        const float into = Dot<float>(normal, disperser.way);
        if (into > 0) disperser.way -= normal * (2 * into);
    });
}

void Push(WorldState& world, Disperser& disperser, float dt) {
    const BodyDynamics& d = world.bodies.dynamics[disperser.body];
    Vector3 turn = Vector3::Zero();
    const float fastest = kSpread * world.settings.contactPushSpeed;
    disperser.own = world.bodies.LinearVelocityOf(disperser.body);
    if (disperser.hasPlace) {
        const Position left = disperser.place - world.bodies.CentreOf(disperser.body);
        disperser.push = (left / double{std::max(disperser.seconds, dt)}).cast<float>();
        disperser.place += (disperser.own * dt).cast<double>();
    } else {
        Reflect(world, disperser);
        disperser.push = disperser.way * fastest;
    }
    LimitLength(disperser.push, std::min(fastest, d.maxLinearSpeed));
    d.Lock(disperser.push, turn);
    world.bodies.SetVelocity(disperser.body, disperser.own + disperser.push, world.bodies.AngularVelocityOf(disperser.body));
}

// Those that were removed, put to sleep, frozen or made kinematic meanwhile.
void ForgetStopped(WorldState& world) {
    std::erase_if(world.dispersing, [&](const Disperser& disperser) {
        BodyDynamics& d = world.bodies.dynamics[disperser.body];
        d.dispersing &= MovesFreely(world, disperser.body);
        return !d.dispersing;
    });
}

void Gather(WorldState& world, std::vector<uint32_t> WorkerFindings::* list, std::vector<uint32_t>& all) {
    all.clear();
    for (WorkerFindings& findings : world.findings) {
        all.insert(all.end(), (findings.*list).begin(), (findings.*list).end());
        (findings.*list).clear();
    }
    std::sort(all.begin(), all.end());
}

}  // namespace

Vector3 PlaceInCrowd(uint32_t body) {
    for (uint64_t seed = body;; seed += uint64_t(1) << 32) {
        const uint64_t bits = Mix(seed + 1);
        Vector3 place;
        for (int k = 0; k < 3; ++k)
            place[k] = static_cast<float>(static_cast<int32_t>(bits >> (21 * k) & 0x1FFFFF) - 0x100000) * 0x1p-20f;
        if (LengthSquared(place) <= 1) return place;
    }
}

// Those of a face-centered cubic lattice (integers of which the sum is even) that are nearest to the middle of a cube.
std::vector<Vector3> PlacesInBall(uint32_t count, std::span<const PlaceLimit> limits) {
    struct Point {
        int32_t square, x, y, z;  // twice the distance from the middle
        auto operator<=>(const Point&) const = default;
        Vector3 Place() const { return Vector3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) * 0.5f; }
    };
    constexpr double kBall = 4.18879;  // of radius one
    const double whole = std::cbrt(2 * count / kBall);  // a unit of volume has half a point
    const int reach = static_cast<int>(limits.empty() ? whole : kMostCut * whole) + 2;
    const float scale = static_cast<float>(1 / whole);
    std::vector<Point> points;
    for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
            for (int z = -reach + ((x + y + reach) & 1); z <= reach; z += 2) {
                const int dx = 2 * x - 1, dy = 2 * y - 1, dz = 2 * z - 1;
                const Point point = {dx * dx + dy * dy + dz * dz, dx, dy, dz};
                const auto allows = [&](const PlaceLimit& limit) { return Dot<float>(limit.normal, point.Place()) * scale >= limit.offset; };
                if (point.square <= 4 * reach * reach && std::all_of(limits.begin(), limits.end(), allows)) points.push_back(point);
            }
    if (points.size() < count) return {};
    std::sort(points.begin(), points.end());
    std::vector<Vector3> places;
    for (uint32_t i = 0; i < count; ++i) places.push_back(points[i].Place() * scale);
    return places;
}

RelativePose WithDistinctCenters(const WorldState& world, const Pair& pair, const RelativePose& bInA) {
    const float hair = kHair * InnerRadii(*pair.shapeA, *pair.shapeB);
    if (LengthSquared(bInA.position) > hair * hair) return bInA;
    Vector3 away = PlaceInCrowd(pair.bodyB) - PlaceInCrowd(pair.bodyA);
    away = InverseRotate(world.bodies.RotationOf(pair.bodyA), away);
    if (pair.offset) away = InverseRotate(world.colliders.shapes[pair.colliderA].local.rotation, away);
    return {bInA.position + Normalized(away, Vector3(0, 1, 0)) * hair, bInA.rotation};
}

void PushDispersing(WorldState& world, float dt) {
    if (world.dispersing.empty()) return;
    ForgetStopped(world);
    world.jobs->ParallelFor(static_cast<uint32_t>(world.dispersing.size()), 64, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            Disperser& disperser = world.dispersing[i];
            Push(world, disperser, dt);
            disperser.seconds -= dt;
            // Who finds no room at its place looks for it elsewhere.
            disperser.hasPlace &= disperser.seconds > -kPatience;
        }
    });
}

Vector3 OwnVelocity(const WorldState& world, uint32_t body, const Vector3& v, float dt) {
    const auto disperser = std::lower_bound(world.dispersing.begin(), world.dispersing.end(), body,
                                            [](const Disperser& d, uint32_t index) { return d.body < index; });
    const float* a = world.bodies.poses[body].acceleration;
    return NoFasterThan(v - disperser->push, disperser->own + Vector3(a[0], a[1], a[2]) * dt);
}

bool StandInEachOther(const WorldState& world, uint32_t collider, uint32_t other) {
    if (!AreDynamic(world, collider, other)) return false;
    const float reach = kDeepNearness * InnerRadii(*world.colliders.shapes[collider].shape, *world.colliders.shapes[other].shape);
    return SquareBetween(world, collider, other) < reach * reach;
}

void StartDispersing(WorldState& world, std::vector<uint32_t>& bodies) {
    std::sort(bodies.begin(), bodies.end());
    bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
    const Structures structures(world);
    const auto mayStart = [&](uint32_t body) { return MovesFreely(world, body) && !world.bodies.dynamics[body].dispersing; };
    std::vector<uint32_t> starting =
        Select(world, bodies, [&](uint32_t body) { return mayStart(body) && CountNear<kMany, StandInEachOther>(world, structures, body) == kMany; });
    for (const uint32_t body : starting) world.bodies.dynamics[body].dispersing = true;
    // What stands in few of them, or of these, would only be in their way.
    for (std::vector<uint32_t> joining = starting; !joining.empty();) {
        joining = Select(world, bodies, [&](uint32_t body) { return mayStart(body) && CountNear<1, StandInDisperser>(world, structures, body) > 0; });
        for (const uint32_t body : joining) world.bodies.dynamics[body].dispersing = true;
        starting.insert(starting.end(), joining.begin(), joining.end());
    }
    std::sort(starting.begin(), starting.end());
    RemoveDynamicPairs(world, starting);
    for (const Disperser& disperser : FindWays(world, structures, starting)) {
        BodyDynamics& d = world.bodies.dynamics[disperser.body];
        d.dispersing = d.crowded = true;
        AddGravity(world, disperser.body, -1);
        world.dispersing.push_back(disperser);
        world.dispersing.back().own = world.bodies.LinearVelocityOf(disperser.body);
        world.dispersing.back().start = world.report.step;
    }
    std::sort(world.dispersing.begin(), world.dispersing.end(), [](const Disperser& a, const Disperser& b) { return a.body < b.body; });
}

void EndDispersing(WorldState& world) {
    if (world.dispersing.empty()) return;
    const Structures structures(world);
    const std::span<uint8_t> overlaps = world.scratch.Allocate<uint8_t>(world.dispersing.size());
    world.jobs->ParallelFor(static_cast<uint32_t>(overlaps.size()), 16, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) overlaps[i] = CountNear<1, Overlap>(world, structures, world.dispersing[i].body) > 0;
    });
    std::map<uint64_t, Together> all;
    for (size_t i = 0; i < overlaps.size(); ++i) {
        Together& together = all[world.dispersing[i].start];
        ++together.count;
        together.overlapping += overlaps[i];
    }
    for (size_t i = 0; i < overlaps.size(); ++i) {
        Together& together = all[world.dispersing[i].start];
        if (overlaps[i] && together.HaveRoom()) together.isBlocked = CountNear<kMany, Overlap>(world, structures, world.dispersing[i].body) == kMany;
    }
    for (size_t i = 0; i < overlaps.size(); ++i) {
        const Disperser& disperser = world.dispersing[i];
        const bool hasDispersed = all[disperser.start].HaveRoom() || (!disperser.hasPlace && !overlaps[i]);
        world.bodies.dynamics[disperser.body].dispersing = !hasDispersed;
    }
    std::erase_if(world.dispersing, [&](const Disperser& disperser) {
        if (world.bodies.dynamics[disperser.body].dispersing) return false;
        AddGravity(world, disperser.body, 1);
        world.bodies.SetVelocity(disperser.body, disperser.own, world.bodies.AngularVelocityOf(disperser.body));
        RequeueColliders(world, disperser.body);
        return true;
    });
}

void NoteStanding(const WorldState& world, uint32_t index, const RelativePose& bInA, WorkerFindings& findings) {
    const Pair& pair = world.pairs.pairs[index];
    if (pair.fixedB) return;
    const float radii = InnerRadii(*pair.shapeA, *pair.shapeB);
    if (LengthSquared(bInA.position) < kDeepNearness * kDeepNearness * radii * radii)
        for (const uint32_t body : {pair.bodyA, pair.bodyB}) findings.standing.push_back(body);
    const auto isCrowded = [&](uint32_t body) { return world.bodies.dynamics[body].crowded; };
    if (!isCrowded(pair.bodyA) && !isCrowded(pair.bodyB)) return;
    if (SeparationOf(world, index, NormalOf(world, index)) > -kOverlap * radii) return;
    for (const uint32_t body : {pair.bodyA, pair.bodyB})
        if (isCrowded(body)) findings.overlapping.push_back(body);
}

void NoteCrowd(WorldState& world) {
    for (const uint32_t body : world.crowded) world.bodies.dynamics[body].crowded = false;
    Gather(world, &WorkerFindings::overlapping, world.crowded);
    for (const Disperser& disperser : world.dispersing) world.crowded.push_back(disperser.body);
    for (const uint32_t body : world.crowded) world.bodies.dynamics[body].crowded = true;
    std::vector<uint32_t>& standing = world.standing;
    Gather(world, &WorkerFindings::standing, standing);
    size_t most = 0;
    for (size_t begin = 0, end = 0; begin < standing.size(); begin = end) {
        while (end < standing.size() && standing[end] == standing[begin]) ++end;
        most = std::max(most, end - begin);
    }
    if (most < kMany) standing.clear();
}

void LimitPush(WorldState& world, uint32_t body, float h) {
    const float* free = world.bodies.unconstrained[body].row;
    const Vector3 freeV(free[0], free[1], free[2]), freeW(free[3], free[4], free[5]);
    Vector3 push = world.bodies.LinearVelocityOf(body) - freeV, spin = world.bodies.AngularVelocityOf(body) - freeW;
    const float fastest = world.settings.contactPushSpeed;
    LimitLength(push, fastest);
    LimitLength(spin, fastest / world.bodies.dynamics[body].outerRadius);
    Vector3 v = freeV + push;
    const float(&moved)[3] = world.bodies.states[body].deltaPosition;
    VisitFixedContacts(world, body, [&](uint32_t pair) {
        const Vector3 normal = NormalOf(world, pair);
        const float gap = SeparationOf(world, pair, normal) - Dot<float>(normal, Vector3(moved[0], moved[1], moved[2]));
        const float most = gap >= 0 ? gap / h : std::max(gap * kPushedOut / h, -fastest);
        const float into = Dot<float>(normal, Vector3(v - world.bodies.LinearVelocityOf(world.pairs.pairs[pair].bodyB)));
        if (into > most) v -= normal * (into - most);
    });
    world.bodies.SetVelocity(body, v, freeW + spin);
}

}  // namespace fulcrum
