// The overhead of scheduling: jobs and phases without work in them, and scratch memory.
#include <Fulcrum/Jobs/Phases.h>
#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Jobs/ThreadPool.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <vector>

namespace fulcrum {
namespace {

// Arguments: workers, items.
void EmptyParallelFor(benchmark::State& state) {
    ThreadPool pool(static_cast<uint32_t>(state.range(0)));
    const auto count = static_cast<uint32_t>(state.range(1));
    for (auto _ : state) pool.ParallelFor(count, 1, [](JobRange range) { benchmark::DoNotOptimize(range); });
}
BENCHMARK(EmptyParallelFor)->ArgNames({"workers", "items"})->ArgsProduct({{1, 2}, {2, 16, 1000}})->UseRealTime();

// The first job after a pause in which the helpers went to sleep: a cost of each step.
void ParallelForAfterSleep(benchmark::State& state) {
    ThreadPool pool(2);
    for (auto _ : state) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const auto start = std::chrono::steady_clock::now();
        pool.ParallelFor(2, 1, [](JobRange range) { benchmark::DoNotOptimize(range); });
        state.SetIterationTime(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
}
BENCHMARK(ParallelForAfterSleep)->UseManualTime()->Iterations(500);

// A fixed amount of arithmetic, since the clock's resolution is too coarse. Not inlined, so that all callers run the
// same code.
[[gnu::noinline]] void Work(uint32_t steps) {
    uint32_t x = steps;
    for (uint32_t i = 0; i < steps; ++i) benchmark::DoNotOptimize(x = x * 1664525u + 1013904223u);
}

uint32_t StepsOfAMicrosecond() {
    static const uint32_t steps = [] {
        constexpr uint32_t kSample = 100'000;
        double best = 1e9;
        for (int i = 0; i < 20; ++i) {
            const auto start = std::chrono::steady_clock::now();
            Work(kSample);
            best = std::min(
                best, std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
        }
        return static_cast<uint32_t>(kSample / best);
    }();
    return steps;
}

// Arguments: workers, blocks a phase, microseconds a block. "barrier" is the time of a phase beyond its share of the
// work.
void Phases(benchmark::State& state) {
    constexpr uint32_t kPhases = 200;
    const auto workers = static_cast<uint32_t>(state.range(0)), blocks = static_cast<uint32_t>(state.range(1));
    const uint32_t steps = static_cast<uint32_t>(state.range(2)) * StepsOfAMicrosecond();
    ThreadPool pool(workers);
    const std::vector<uint32_t> counts(kPhases, blocks);
    std::vector<double> times;
    for (auto _ : state) {
        const auto start = std::chrono::steady_clock::now();
        RunPhases(pool, counts, [steps](uint32_t, uint32_t, uint32_t) { Work(steps); });
        times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::nth_element(times.begin(), times.begin() + static_cast<ptrdiff_t>(times.size() / 2), times.end());
    const double phase = times[times.size() / 2] / kPhases;
    const uint32_t blocksInSequence = (blocks + workers - 1) / workers;
    state.counters["barrier"] = phase - blocksInSequence * static_cast<double>(state.range(2)) * 1e-6;
}
BENCHMARK(Phases)->ArgNames({"workers", "blocks", "us"})->ArgsProduct({{1, 2}, {1, 2, 16}, {0, 2, 10}})->UseRealTime();

void ArenaStep(benchmark::State& state) {
    ScratchArena arena;
    constexpr int kPieces = 100;
    for (auto _ : state) {
        for (int i = 0; i < kPieces; ++i) benchmark::DoNotOptimize(arena.Allocate<float>(1000).data());
        arena.Reset();
    }
    state.SetItemsProcessed(state.iterations() * kPieces);
}
BENCHMARK(ArenaStep);

}  // namespace
}  // namespace fulcrum
