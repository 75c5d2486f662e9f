// Building convex hulls, and the support query that GJK calls in its inner loop.
#include <Fulcrum/Collision/Shapes/ConvexHull.h>

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>

namespace fulcrum {
namespace {

// Spread evenly on a sphere of 2 m: every point is a vertex, the worst case for building.
std::vector<Vector3> FibonacciSphere(int count) {
    std::vector<Vector3> points;
    for (int n = 0; n < count; ++n) {
        const double y = 1 - (2.0 * n + 1) / count, angle = n * 3.14159265358979 * (3 - std::sqrt(5.0));
        const double radius = std::sqrt(1 - y * y);
        points.push_back((Position(radius * std::cos(angle), y, radius * std::sin(angle)) * 2).cast<float>());
    }
    return points;
}

void BuildHull(benchmark::State& state) {
    const std::vector<Vector3> points = FibonacciSphere(static_cast<int>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(ConvexHull::Create(points));
}
BENCHMARK(BuildHull)->Arg(32)->Arg(1000)->Arg(10000)->Unit(benchmark::kMicrosecond);

// Each direction depends on the support before, as in GJK: this measures latency, not throughput.
void SupportOfHull(benchmark::State& state) {
    const auto hull = ConvexHull::Create(FibonacciSphere(static_cast<int>(state.range(0)))).Value();
    std::array<Vector3, 64> directions;
    for (size_t i = 0; i < directions.size(); ++i) directions[i] = FibonacciSphere(64)[i];
    size_t next = 0;
    Vector3 last = Vector3::Zero();
    for (auto _ : state) {
        last = hull->SupportCore(directions[next++ % directions.size()] + last * 0.1f);
        benchmark::DoNotOptimize(last);
    }
}
BENCHMARK(SupportOfHull)->Arg(8)->Arg(32)->Arg(64);

}  // namespace
}  // namespace fulcrum
