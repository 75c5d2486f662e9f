#include <Fulcrum/UnitTests/Random/Heaps.h>

#include <Fulcrum/Collision/Shapes/Compound.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace fulcrum::testing {

namespace {

constexpr float kSmallest = 0.06f, kLargest = 0.35f;           // m, half sizes
constexpr double kLeastDensity = 100, kMostDensity = 10000;    // kg/m3
constexpr float kWallHalfHeight = 20, kWallHalfThickness = 1;  // m
constexpr double kGap = 0.01;                                  // m, at least, between bounding spheres at the start
constexpr float kNear = 0.4f, kLinkChance = 0.25f;             // m; bodies that may be jointed, and how many are
constexpr double kDampedSeconds = 5;                           // s, after the fall
constexpr float kDamping = 2;                                  // 1/s
constexpr float kFarChance = 0.3f, kFarthest = 2;              // m: pivots beside the bodies

float Size(RandomPoses& random) { return LogBetween(random, double{kSmallest}, double{kLargest}); }
Vector3 Sizes(RandomPoses& random) {
    const float x = Size(random), y = Size(random), z = Size(random);
    return Vector3(x, y, z);
}

ShapePtr HullOf(RandomPoses& random) {
    const Vector3 half = Sizes(random);
    std::vector<Vector3> points;
    const uint32_t count = 6 + random.Below(11);
    for (uint32_t i = 0; i < count; ++i) points.push_back(random.Direction().cwiseProduct(half));
    return ConvexHull::Create(points).Value();
}

ShapePtr ConvexOf(RandomPoses& random) {
    const float a = Size(random), b = Size(random);
    switch (random.Below(6)) {
        case 0: return Box::Create(Sizes(random)).Value();
        case 1: return Sphere::Create(a).Value();
        case 2: return Capsule::Create(a, b).Value();
        case 3: return Cylinder::Create(a, b).Value();
        case 4: return Cylinder::CreateCone(a, b).Value();
        default: return HullOf(random);
    }
}

ShapePtr SolidOf(RandomPoses& random) {
    if (random.Chance(0.85f)) return ConvexOf(random);
    std::vector<Compound::ChildSettings> children;
    const uint32_t count = 2 + random.Below(2);
    for (uint32_t i = 0; i < count; ++i) {
        const ShapePtr shape = ConvexOf(random);
        const Vector3 place = random.InBox(0.25f);
        children.push_back({shape, place, random.Rotation()});
    }
    return Compound::Create(children).Value();
}

class HeapMaker {
public:
    explicit HeapMaker(uint64_t seed) : random_(RandomOf(seed)) {}

    Heap Make() {
        heap_.halfWidth = random_.Between(1.2f, 2.2f);
        AddPit();
        const uint32_t count = 12 + random_.Below(29);
        for (uint32_t i = 0; i < count; ++i) AddBody();
        for (size_t b = 1; b < balls_.size(); ++b)
            for (size_t a = 0; a < b; ++a)
                if (Distance(a, b) < double{kNear} && random_.Chance(kLinkChance)) Link(a, b);
        return std::move(heap_);
    }

private:
    // A body's bounding sphere, and the body.
    struct Ball {
        Position center;
        double radius;
        BodyId body;
    };

    void AddStatic(const Vector3& half, const Position& place) {
        heap_.mechanism.bodies.push_back(
            {.shape = Box::Create(half).Value(), .motion = MotionType::Static, .position = place});
    }
    void AddPit() {
        const double reach = double{heap_.halfWidth} + double{kWallHalfThickness};
        const float wide = heap_.halfWidth + 2 * kWallHalfThickness;
        AddStatic(Vector3(wide, kWallHalfThickness, wide), Position(0, -double{kWallHalfThickness}, 0));
        for (const double side : {-reach, reach}) {
            AddStatic(Vector3(kWallHalfThickness, kWallHalfHeight, wide), Position(side, double{kWallHalfHeight}, 0));
            AddStatic(Vector3(wide, kWallHalfHeight, kWallHalfThickness), Position(0, double{kWallHalfHeight}, side));
        }
    }
    // As low as the floor and the bodies before allow.
    void AddBody() {
        const ShapePtr shape = SolidOf(random_);
        const Quaternion rotation = random_.Rotation();
        const double radius = double{shape->OuterRadius()};
        const float room = heap_.halfWidth - shape->OuterRadius() - static_cast<float>(kGap);
        const double x = double{random_.Between(-room, room)}, z = double{random_.Between(-room, room)};
        double y = radius + kGap;
        for (const Ball& ball : balls_) {
            const double apart = radius + ball.radius + kGap, dx = x - ball.center.x(), dz = z - ball.center.z();
            const double squared = apart * apart - dx * dx - dz * dz;
            if (squared > 0) y = std::max(y, ball.center.y() + std::sqrt(squared));
        }
        const Position center(x, y, z);
        const Position origin = center - Rotate(rotation, shape->Mass().centerOfMass).cast<double>();
        const float friction = random_.Between(0.2f, 0.9f);
        heap_.mechanism.bodies.push_back({.shape = shape,
                                          .position = origin,
                                          .rotation = rotation,
                                          .density = LogBetween(random_, kLeastDensity, kMostDensity),
                                          .material = {.friction = friction}});
        balls_.push_back({center, radius, BodyBatch::Body(static_cast<uint32_t>(heap_.mechanism.bodies.size() - 1))});
    }
    double Distance(size_t a, size_t b) const {
        return (balls_[b].center - balls_[a].center).norm() - balls_[a].radius - balls_[b].radius;
    }
    // Zero, or up to meters.
    Position Aside() {
        return random_.Chance(kFarChance) ? (random_.Direction() * random_.Between(0, kFarthest)).cast<double>()
                                          : Position::Zero();
    }

    void Link(size_t a, size_t b) {
        JointSettings between;
        between.bodyA = balls_[a].body;
        between.bodyB = balls_[b].body;
        const Position middle = (balls_[a].center + balls_[b].center) * 0.5;
        between.anchorA.point = middle + Aside();
        between.anchorA.axis = random_.Direction();
        switch (random_.Below(4)) {
            case 0: return Add(Of<PointJointSettings>(between));
            case 1: return Add(Of<FixedJointSettings>(between));
            case 2: {
                auto hinge = Of<HingeJointSettings>(between);
                hinge.angle.limited = true;
                hinge.angle.limits.min = random_.Between(-1.5f, -0.1f);
                hinge.angle.limits.max = random_.Between(0.1f, 1.5f);
                return Add(hinge);
            }
            default:
                between.anchorB = between.anchorA;
                between.anchorA.point = balls_[a].center + Aside();
                between.anchorB->point = balls_[b].center + Aside();
                return Add(Of<DistanceJointSettings>(between));
        }
    }
    template <class Settings>
    void Add(const Settings& settings) {
        heap_.mechanism.joints.push_back(settings);
    }

    RandomPoses random_;
    Heap heap_;
    std::vector<Ball> balls_;
};

bool IsLost(const Heap& heap, const Position& place) {
    const double most = double{heap.halfWidth} + 0.1;
    return !(place.y() > -0.1 && std::abs(place.x()) < most && std::abs(place.z()) < most);
}

// m/s, at most, of any point.
double SpeedOf(const BodyInterface& bodies, BodyId id) {
    const float turning = Length(bodies.GetAngularVelocity(id)) * bodies.GetShape(id)->OuterRadius();
    return static_cast<double>(Length(bodies.GetLinearVelocity(id)) + turning);
}

int StepsOf(double seconds, const Trial& trial) { return static_cast<int>(std::lround(seconds / trial.dt)); }

}  // namespace

Heap RandomHeap(uint64_t seed) { return HeapMaker(seed).Make(); }

HeapFall DropHeap(const Heap& heap, const Trial& trial) {
    SystemSettings settings = trial.settings;
    settings.sleep.enabled = false;
    BatchIds ids;
    const std::unique_ptr<PhysicsSystem> world = WorldOf(heap.mechanism, settings, ids);
    const BodyInterface& bodies = world->Bodies();
    const double weight = MassesOf(*world, ids).sum * static_cast<double>(Length(settings.gravity));
    HeapFall fall;
    double least = world->GetEnergy();
    const int falling = StepsOf(trial.seconds, trial), steps = falling + StepsOf(kDampedSeconds, trial);
    for (int i = 1; i <= steps; ++i) {
        static_cast<void>(world->Update(trial.dt).Value());
        const double energy = world->GetEnergy();
        least = std::min(least, energy);
        fall.gain = std::isfinite(energy) ? std::max(fall.gain, (energy - least) / weight)
                                          : std::numeric_limits<double>::infinity();
        if (i == falling)
            for (const BodyId id : ids.bodies) static_cast<void>(world->Bodies().SetDamping(id, kDamping, kDamping));
        if (steps - i < StepsOf(1, trial))
            for (const BodyId id : ids.bodies) fall.speed = std::max(fall.speed, SpeedOf(bodies, id));
        if (trial.watch) trial.watch(*world, ids, i * trial.dt);
    }
    for (const BodyId id : ids.bodies)
        if (bodies.GetMotionType(id) == MotionType::Dynamic) fall.lost += IsLost(heap, bodies.GetCenterOfMass(id));
    return fall;
}

}  // namespace fulcrum::testing
