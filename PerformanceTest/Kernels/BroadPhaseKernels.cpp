// Times of the bounds tree on the layouts of the performance scenes: `many_pyramids` (resting boxes), a gas of cubes as
// dense as `drum`, and the floor of `mostly_asleep`. The argument is the number of boxes; "each" is the time a box.
#include <Fulcrum/Collision/BroadPhase/BoundsTree.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

namespace fulcrum {
namespace {

constexpr float kMargin = 0.05f;

Bounds Cube(const Vector3& center, float half) {
    Bounds bounds;
    bounds.lower = center - Vector3::Constant(half);
    bounds.upper = center + Vector3::Constant(half);
    return bounds;
}

class Random {
public:
    float Uniform(float low, float high) {
        return low + (high - low) * static_cast<float>(engine_() >> 8) / 16777216.0f;
    }
    Vector3 Vector(float range) {
        const float x = Uniform(-range, range), y = Uniform(-range, range), z = Uniform(-range, range);
        return Vector3(x, y, z);
    }

private:
    std::mt19937 engine_{1};
};

// Cubes of half 0.2, turned, at random in the volume that the lattice of `drum` fills: a 0.8 m cell each.
struct Gas {
    std::vector<Vector3> centers, velocities;
    float range;
    Random random;

    explicit Gas(int count) : range(0.4f * std::cbrt(static_cast<float>(count))) {
        for (int i = 0; i < count; ++i) {
            centers.push_back(random.Vector(range));
            velocities.push_back(random.Vector(2.0f));
        }
    }
    static Bounds Fat(const Vector3& center) { return Cube(center, 0.3f + kMargin); }
};

std::vector<Bounds> GasBoxes(int count) {
    std::vector<Bounds> boxes;
    for (const Vector3& center : Gas(count).centers) boxes.push_back(Gas::Fat(center));
    return boxes;
}

// Pyramids of base 10, 55 cubes of half 0.5 each, in a square grid 12 m by 10 m.
std::vector<Bounds> PyramidBoxes(int count) {
    std::vector<Bounds> boxes;
    const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<float>(count) / 55.0f)));
    for (int pyramid = 0;; ++pyramid) {
        const Vector3 place(12.0f * static_cast<float>(pyramid % side), 0, 10.0f * static_cast<float>(pyramid / side));
        for (int i = 0; i < 10; ++i) {
            for (int j = i; j < 10; ++j) {
                if (boxes.size() == static_cast<size_t>(count)) return boxes;
                const Vector3 inPyramid(0.5f * static_cast<float>(i + 1) + static_cast<float>(j - i),
                                        static_cast<float>(i) + 0.5f, 0);
                boxes.push_back(Cube(place + inPyramid, 0.5f + kMargin));
            }
        }
    }
}

// Cubes of half 0.25 on a floor, 1.5 m apart, 400 in a row.
std::vector<Bounds> FloorBoxes(int count) {
    std::vector<Bounds> boxes;
    for (int i = 0; i < count; ++i)
        boxes.push_back(Cube(Vector3(1.5f * static_cast<float>(i % 400), 0.25f, 1.5f * static_cast<float>(i / 400)),
                             0.25f + kMargin));
    return boxes;
}

using Layout = std::vector<Bounds> (*)(int count);

BoundsTree TreeOf(const std::vector<Bounds>& boxes) {
    BoundsTree tree;
    for (size_t i = 0; i < boxes.size(); ++i) tree.Insert(static_cast<uint32_t>(i), boxes[i]);
    tree.Rebuild();
    return tree;
}

void ReportEach(benchmark::State& state, int64_t perIteration) {
    state.counters["each"] = benchmark::Counter(
        static_cast<double>(perIteration), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void Rebuild(benchmark::State& state, Layout layout) {
    BoundsTree tree = TreeOf(layout(static_cast<int>(state.range(0))));
    for (auto _ : state) tree.Rebuild();
    ReportEach(state, state.range(0));
    state.counters["cost"] = tree.Cost();
    state.counters["bytesEach"] = static_cast<double>(tree.MemoryUsed()) / static_cast<double>(tree.Size());
}

void InsertAll(benchmark::State& state, Layout layout) {
    const std::vector<Bounds> boxes = layout(static_cast<int>(state.range(0)));
    BoundsTree tree;
    for (auto _ : state) {
        tree.Clear();
        for (size_t i = 0; i < boxes.size(); ++i) tree.Insert(static_cast<uint32_t>(i), boxes[i]);
    }
    ReportEach(state, state.range(0));
}

// The box of each leaf, searched as FindPairs does.
void Query(benchmark::State& state, Layout layout) {
    const std::vector<Bounds> boxes = layout(static_cast<int>(state.range(0)));
    const BoundsTree tree = TreeOf(boxes);
    uint64_t found = 0;
    for (auto _ : state)
        for (const Bounds& box : boxes) tree.Query(box, [&](uint32_t id) { found += 1 + (id >> 31); });
    ReportEach(state, state.range(0));
    state.counters["found"] = static_cast<double>(found) / static_cast<double>(state.iterations() * state.range(0));
}

// Boxes that move by a margin to and fro.
void UpdateAll(benchmark::State& state, Layout layout) {
    std::vector<Bounds> boxes = layout(static_cast<int>(state.range(0)));
    BoundsTree tree = TreeOf(boxes);
    Random random;
    float sign = 1;
    std::vector<Vector3> moves;
    for (size_t i = 0; i < boxes.size(); ++i) moves.push_back(random.Vector(kMargin));
    for (auto _ : state) {
        for (size_t i = 0; i < boxes.size(); ++i) {
            boxes[i].lower += sign * moves[i];
            boxes[i].upper += sign * moves[i];
            tree.Update(static_cast<uint32_t>(i), boxes[i]);
        }
        sign = -sign;
    }
    ReportEach(state, state.range(0));
}

// A whole step of a gas at 1/60 s: boxes that left their fat ones are updated, then Optimize, then each of them is a
// query. The counters are microseconds a step.
void GasStep(benchmark::State& state) {
    Gas gas(static_cast<int>(state.range(0)));
    const size_t count = gas.centers.size();
    std::vector<Vector3> fatCenters = gas.centers;
    BoundsTree tree;
    for (size_t i = 0; i < count; ++i) tree.Insert(static_cast<uint32_t>(i), Gas::Fat(fatCenters[i]));
    tree.Optimize();
    std::vector<uint32_t> moved;
    uint64_t found = 0, queries = 0;
    for (auto _ : state) {
        state.PauseTiming();
        moved.clear();
        for (size_t i = 0; i < count; ++i) {
            for (int axis = 0; axis < 3; ++axis)
                if (std::fabs(gas.centers[i][axis]) > gas.range)
                    gas.velocities[i][axis] = std::copysign(gas.velocities[i][axis], -gas.centers[i][axis]);
            gas.centers[i] += gas.velocities[i] / 60.0f;
            if ((gas.centers[i] - fatCenters[i]).cwiseAbs().maxCoeff() <= kMargin) continue;
            fatCenters[i] = gas.centers[i];
            moved.push_back(static_cast<uint32_t>(i));
        }
        state.ResumeTiming();
        for (uint32_t id : moved) tree.Update(id, Gas::Fat(fatCenters[id]));
        tree.Optimize();
        for (uint32_t id : moved) tree.Query(Gas::Fat(fatCenters[id]), [&](uint32_t other) { found += other != id; });
        queries += moved.size();
    }
    state.counters["queries"] = static_cast<double>(queries) / static_cast<double>(state.iterations());
    state.counters["found"] = static_cast<double>(found) / static_cast<double>(queries);
}

// A hundred boxes that rise and fall among many at rest.
void MostlyAsleepStep(benchmark::State& state) {
    std::vector<Bounds> boxes = FloorBoxes(static_cast<int>(state.range(0)));
    BoundsTree tree = TreeOf(boxes);
    const size_t stride = boxes.size() / 100;
    uint64_t found = 0;
    int step = 0;
    for (auto _ : state) {
        const Vector3 move(0, ++step % 120 < 60 ? 0.15f : -0.15f, 0);
        for (size_t i = 0; i < boxes.size(); i += stride) {
            boxes[i].lower += move;
            boxes[i].upper += move;
            tree.Update(static_cast<uint32_t>(i), boxes[i]);
        }
        tree.Optimize();
        for (size_t i = 0; i < boxes.size(); i += stride) tree.Query(boxes[i], [&](uint32_t) { ++found; });
    }
    benchmark::DoNotOptimize(found);
}

BENCHMARK_CAPTURE(Rebuild, gas, GasBoxes)->Arg(8000)->Arg(100000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Rebuild, pyramids, PyramidBoxes)->Arg(10780)->Arg(100000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(InsertAll, pyramids, PyramidBoxes)->Arg(10780)->Arg(100000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Query, gas, GasBoxes)->Arg(8000)->Arg(100000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Query, pyramids, PyramidBoxes)->Arg(10780)->Arg(100000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Query, floor, FloorBoxes)->Arg(100000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(UpdateAll, gas, GasBoxes)->Arg(8000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(UpdateAll, pyramids, PyramidBoxes)->Arg(10780)->Unit(benchmark::kMicrosecond);
BENCHMARK(GasStep)->Arg(8000)->Unit(benchmark::kMicrosecond)->Iterations(300);
BENCHMARK(MostlyAsleepStep)->Arg(100000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fulcrum
