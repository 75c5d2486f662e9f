// Snapshots of a heap of so many bodies, all awake: to save, to restore what was two steps ago, from the caches and
// from memory, to hash; deltas from step to step.
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <benchmark/benchmark.h>

namespace fulcrum {
namespace {

using testing::RandomPoses;
using Bytes = std::vector<std::byte>;

constexpr double kStep = 1.0 / 60;

// Falls into a box, and is still moving.
std::unique_ptr<PhysicsSystem> MakeHeap(int64_t count) {
    SystemSettings settings;
    settings.sleep.enabled = false;
    std::unique_ptr<PhysicsSystem> system = PhysicsSystem::Create(settings).Value();
    const auto add = [&](const ShapePtr& shape, MotionType motion, const Position& position, const Quaternion& q) {
        const auto id =
            system->Bodies().Create({.shape = shape, .motion = motion, .position = position, .rotation = q});
        if (!id) AbortWith("a body of the heap: ", id.GetError().message);
    };
    const auto addWall = [&](const Vector3& half, const Position& position) {
        add(Box::Create(half).Value(), MotionType::Static, position, {});
    };
    addWall(Vector3(50, 1, 50), {0, -1, 0});
    for (const double side : {-6.5, 6.5}) {
        addWall(Vector3(0.5f, 20, 7), {side, 20, 0});
        addWall(Vector3(7, 20, 0.5f), {0, 20, side});
    }
    const ShapePtr shapes[] = {Box::Create(Vector3(0.5f, 0.3f, 0.4f)).Value(), Sphere::Create(0.4f).Value(),
                               Capsule::Create(0.3f, 0.3f).Value(), Box::Create(Vector3(0.4f, 0.4f, 0.4f)).Value()};
    RandomPoses random(1);
    for (int64_t i = 0; i < count; ++i)
        add(shapes[i % 4], MotionType::Dynamic,
            Position(1.0 * static_cast<double>(i % 10) - 4.5, 0.6 + 1.0 * static_cast<double>(i / 100),
                     1.0 * static_cast<double>(i / 10 % 10) - 4.5) +
                (random.InCube() * 0.05f).cast<double>(),
            random.Rotation());
    for (int step = 0; step < 60; ++step)
        if (!system->Update(kStep)) AbortWith("a step", "");
    return system;
}

void Save(const PhysicsSystem& system, Bytes& bytes) {
    if (const Status saved = system.SaveSnapshot(bytes); !saved) AbortWith("saving: ", saved.GetError().message);
}

void Step(benchmark::State& state, PhysicsSystem& system) {
    state.PauseTiming();
    if (!system.Update(kStep)) AbortWith("a step", "");
    state.ResumeTiming();
}

void SaveSnapshot(benchmark::State& state) {
    const auto system = MakeHeap(state.range(0));
    Bytes bytes;
    Save(*system, bytes);
    for (auto _ : state) {
        Step(state, *system);
        Save(*system, bytes);
    }
    state.counters["bytes"] = static_cast<double>(bytes.size());
}
BENCHMARK(SaveSnapshot)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond);

void RestoreSnapshot(benchmark::State& state) {
    const auto system = MakeHeap(state.range(0));
    Bytes bytes;
    Save(*system, bytes);
    for (auto _ : state) {
        Step(state, *system);
        Step(state, *system);
        if (const Status restored = system->RestoreSnapshot(bytes); !restored)
            AbortWith("restoring: ", restored.GetError().message);
    }
}
BENCHMARK(RestoreSnapshot)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond);

// Two snapshots in turn. evicts: other data has displaced them and the world from the caches each time.
void RestoreSnapshotInTurn(benchmark::State& state, bool evicts) {
    const auto system = MakeHeap(state.range(0));
    Bytes snapshots[2];
    Save(*system, snapshots[0]);
    for (int step = 0; step < 2; ++step)
        if (!system->Update(kStep)) AbortWith("a step", "");
    Save(*system, snapshots[1]);
    std::vector<char> others(evicts ? 64 << 20 : 0);
    size_t turn = 0;
    for (auto _ : state) {
        if (evicts) {
            state.PauseTiming();
            for (size_t i = 0; i < others.size(); i += 64) ++others[i];
            benchmark::ClobberMemory();
            state.ResumeTiming();
        }
        if (const Status restored = system->RestoreSnapshot(snapshots[turn++ % 2]); !restored)
            AbortWith("restoring: ", restored.GetError().message);
    }
}
BENCHMARK_CAPTURE(RestoreSnapshotInTurn, InCache, false)->Arg(1000)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(RestoreSnapshotInTurn, FromMemory, true)->Arg(1000)->Unit(benchmark::kMicrosecond);

void HashState(benchmark::State& state) {
    const auto system = MakeHeap(state.range(0));
    for (auto _ : state) {
        Step(state, *system);
        benchmark::DoNotOptimize(system->HashState());
    }
}
BENCHMARK(HashState)->Arg(1000)->Arg(3000)->Unit(benchmark::kMicrosecond);

void MakeDelta(benchmark::State& state) {
    const auto system = MakeHeap(state.range(0));
    Bytes before, after, delta;
    Save(*system, before);
    if (!system->Update(kStep)) AbortWith("a step", "");
    Save(*system, after);
    for (auto _ : state)
        if (!MakeSnapshotDelta(before, after, delta)) AbortWith("a delta", "");
    state.counters["bytes"] = static_cast<double>(delta.size());
}
BENCHMARK(MakeDelta)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fulcrum
