// Nanoseconds per narrow-phase query, per pair of shapes, beside libccd on the same poses. Touching pairs overlap by up
// to 1 cm; apart pairs have 5 to 15 cm between them. Cold: with an empty cache. Warm: the pair's last query was for a
// pose about 1 mm and 1 mrad away, as in a running simulation.
#include <Fulcrum/Collision/NarrowPhase/Collide.h>
#include <Fulcrum/Collision/NarrowPhase/Libccd.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/Triangle.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace fulcrum {
namespace {

using ConvexPtr = std::shared_ptr<const ConvexShape>;

enum class Placement { Aligned, FaceContact, Touching, Apart };

struct PosedPair {
    RelativePose poses[2];  // of two steps in a row
    PairCache cache;
};

class Random {
public:
    float Between(float low, float high) { return std::uniform_real_distribution<float>(low, high)(engine_); }
    Vector3 Direction() {
        for (;;) {
            const Vector3 v(Between(-1, 1), Between(-1, 1), Between(-1, 1));
            if (Length(v) > 0.1f && Length(v) < 1) return Normalized(v);
        }
    }
    Quaternion Rotation() {
        for (;;) {
            const Quaternion q{Between(-1, 1), Between(-1, 1), Between(-1, 1), Between(-1, 1)};
            if (LengthSquared(q) > 0.01f && LengthSquared(q) < 1) return Normalized(q);
        }
    }

private:
    std::mt19937 engine_{1};
};

// Points on a sphere of `radius` by the golden angle.
ConvexPtr FibonacciHull(int count, float radius) {
    std::vector<Vector3> points;
    for (int i = 0; i < count; ++i) {
        const double y = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - y * y), angle = i * M_PI * (3 - std::sqrt(5.0));
        points.push_back(Vector3(Position(r * std::cos(angle), y, r * std::sin(angle)).cast<float>() * radius));
    }
    return ConvexHull::Create(points).Value();
}

// Signed distance along `direction` from A's center at which the two shapes just touch, by bisection with libccd.
float TouchingDistance(const ConvexShape& a, const ConvexShape& b, const Quaternion& rotation,
                       const Vector3& direction) {
    float low = 0, high = a.OuterRadius() + b.OuterRadius();
    for (int i = 0; i < 24; ++i) {
        const float middle = 0.5f * (low + high);
        const RelativePose pose{direction * middle, rotation};
        const bool hit = LibccdPenetration(a, b, pose, 0, LibccdAlgorithm::Mpr).status == LibccdResult::Status::Found;
        (hit ? low : high) = middle;
    }
    return high;
}

std::vector<PosedPair> PosePairs(const ConvexShape& a, const ConvexShape& b, Placement placement, int count) {
    Random random;
    std::vector<PosedPair> pairs(static_cast<size_t>(count));
    for (PosedPair& pair : pairs) {
        RelativePose& pose = pair.poses[0];
        Vector3 direction = random.Direction();
        pose.rotation = random.Rotation();
        if (placement == Placement::Aligned || placement == Placement::FaceContact) {  // B stands on A
            direction = Normalized(Vector3{random.Between(-0.3f, 0.3f), 1, random.Between(-0.3f, 0.3f)});
            const float angle = placement == Placement::Aligned ? 0 : random.Between(-3, 3);  // about the vertical
            pose.rotation = {0, std::sin(angle / 2), 0, std::cos(angle / 2)};
        }
        const float gap = placement == Placement::Apart ? random.Between(0.05f, 0.15f) : random.Between(-0.01f, 0);
        pose.position = direction * (TouchingDistance(a, b, pose.rotation, direction) + gap);
        pair.poses[1] = pose;
        pair.poses[1].position += random.Direction() * 0.001f;
        const Vector3 turn = random.Direction() * 0.0005f;
        pair.poses[1].rotation = Normalized(Quaternion{turn.x(), turn.y(), turn.z(), 1} * pose.rotation);
    }
    return pairs;
}

void Query(benchmark::State& state, const ConvexPtr& a, const ConvexPtr& b, Placement placement, bool warm,
           NarrowPhaseMethod method) {
    std::vector<PosedPair> pairs = PosePairs(*a, *b, placement, 512);
    const CollideSettings settings{.method = method};
    CollideCounters counters;
    Manifold manifold;
    size_t step = 0;
    int64_t points = 0;
    const auto round = [&] {
        for (PosedPair& pair : pairs) {
            if (!warm) pair.cache = {};
            Collide(*a, *b, pair.poses[step & 1], settings, pair.cache, manifold, counters);
            points += manifold.pointCount;
            benchmark::DoNotOptimize(manifold);
        }
        ++step;
    };
    round();
    for (auto _ : state) round();
    const double queries = static_cast<double>(step) * static_cast<double>(pairs.size());
    state.counters["points"] = static_cast<double>(points) / queries;
    state.SetItemsProcessed(static_cast<int64_t>(state.iterations()) * static_cast<int64_t>(pairs.size()));
    state.counters["ns"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(pairs.size()) * 1e-9,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void RawMpr(benchmark::State& state, const ConvexPtr& a, const ConvexPtr& b, Placement placement) {
    const std::vector<PosedPair> pairs = PosePairs(*a, *b, placement, 512);
    for (auto _ : state)
        for (const PosedPair& pair : pairs)
            benchmark::DoNotOptimize(LibccdPenetration(*a, *b, pair.poses[0], 0.02, LibccdAlgorithm::Mpr));
    state.counters["ns"] =
        benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(pairs.size()) * 1e-9,
                           benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

struct NamedShape {
    const char* name;
    ConvexPtr shape;
};

void Register(const NamedShape& a, const NamedShape& b, Placement placement, const char* placementName) {
    const std::string name = std::string("NarrowPhase/") + a.name + "-" + b.name + "/" + placementName;
    const auto add = [&](const char* kind, auto run) { benchmark::RegisterBenchmark((name + kind).c_str(), run); };
    const ConvexPtr sa = a.shape, sb = b.shape;
    add("/warm", [=](benchmark::State& s) { Query(s, sa, sb, placement, true, NarrowPhaseMethod::Automatic); });
    add("/cold", [=](benchmark::State& s) { Query(s, sa, sb, placement, false, NarrowPhaseMethod::Automatic); });
    add("/libccd", [=](benchmark::State& s) { Query(s, sa, sb, placement, false, NarrowPhaseMethod::Libccd); });
    add("/libccd_mpr", [=](benchmark::State& s) { RawMpr(s, sa, sb, placement); });
}

// The sizes are those of the pile scenes: cubes of 1 m, hulls of 32 points on a sphere of radius 2 m.
const bool kRegistered = [] {
    const NamedShape sphere{"sphere", Sphere::Create(0.5f).Value()},
        capsule{"capsule", Capsule::Create(0.5f, 0.3f).Value()};
    const NamedShape box{"box", Box::Create(Vector3::Constant(0.5f)).Value()}, hull{"hull32", FibonacciHull(32, 2)};
    const NamedShape floor{"floor", Box::Create(Vector3(50, 1, 50)).Value()};
    const NamedShape* shapes[] = {&sphere, &capsule, &box, &hull};
    for (int i = 0; i < 4; ++i) {
        for (int j = 0; j <= i; ++j) {
            Register(*shapes[i], *shapes[j], Placement::Touching, "touching");
            Register(*shapes[i], *shapes[j], Placement::Apart, "apart");
        }
    }
    Register(box, box, Placement::Aligned, "aligned");
    Register(box, box, Placement::FaceContact, "stacked");
    Register(floor, box, Placement::FaceContact, "stacked");
    Register(floor, hull, Placement::Touching, "touching");
    Register(box, capsule, Placement::FaceContact, "stacked");

    const NamedShape cylinder{"cylinder", Cylinder::Create(0.5f, 0.5f).Value()},
        cone{"cone", Cylinder::CreateCone(0.5f, 0.5f).Value()};
    const NamedShape rounded{"rounded_cylinder", Cylinder::Create(0.5f, 0.5f, 0.05f).Value()};
    const NamedShape drop{"tapered_capsule", TaperedCapsule::Create(0.5f, 0.2f, 0.4f).Value()};
    const NamedShape triangle{"triangle",
                              Triangle::Create(Vector3(-1, 0, -1), Vector3(0, 0, 2), Vector3(1, 0, -1)).Value()};
    for (const NamedShape* other : {&sphere, &capsule, &box, &hull, &cylinder, &rounded, &drop, &triangle}) {
        Register(cylinder, *other, Placement::Touching, "touching");
        Register(triangle, *other, Placement::Touching, "touching");
    }
    for (const NamedShape* standing : {&cylinder, &rounded, &cone, &box})
        Register(floor, *standing, Placement::FaceContact, "stacked");
    Register(cylinder, cylinder, Placement::FaceContact, "stacked");
    Register(rounded, rounded, Placement::Touching, "touching");
    Register(triangle, box, Placement::FaceContact, "stacked");
    return true;
}();

}  // namespace
}  // namespace fulcrum
