#include <Fulcrum/PerformanceTest/Scenes/ReferenceKernel.h>

#include <algorithm>
#include <array>
#include <barrier>
#include <chrono>
#include <thread>

namespace fulcrum {
namespace {

constexpr size_t kFloats = size_t(1) << 22;  // 16 MB
constexpr int kRepetitions = 9;
constexpr int kSweeps = 4500;    // over the floats in cache
constexpr int kReads = 300'000;  // of places anywhere in memory

}  // namespace

ReferenceKernel::ReferenceKernel() : memory_(kFloats) {
    for (size_t i = 0; i < memory_.size(); ++i) memory_[i] = 1.0f / static_cast<float>(1 + i % 1000);
}

float ReferenceKernel::Work(uint32_t seed) const {
    // Each value depends on its last one, but not on the other ones: as the rows of a color.
    std::array<float, 1024> values;
    for (size_t i = 0; i < values.size(); ++i) values[i] = memory_[i] + static_cast<float>(seed);
    for (int sweep = 0; sweep < kSweeps; ++sweep)
        for (float& value : values) value = value * 0.999f + 0.001f;
    // Addresses that no prefetcher guesses, all known ahead: as bodies of contacts. The generator is that of Numerical
    // Recipes.
    float sum = 0;
    uint32_t place = seed;
    for (int read = 0; read < kReads; ++read) {
        place = place * 1664525u + 1013904223u;
        sum += memory_[place >> 10];
    }
    for (float value : values) sum += value;
    return sum;
}

double ReferenceKernel::Time(int threads) const {
    std::array<double, kRepetitions> ms{};
    std::barrier together(threads);
    std::vector<float> sums(static_cast<size_t>(threads));
    const auto repeat = [&](size_t thread) {
        for (double& time : ms) {
            together.arrive_and_wait();
            const auto begin = std::chrono::steady_clock::now();
            sums[thread] += Work(static_cast<uint32_t>(thread));
            together.arrive_and_wait();
            if (thread == 0)
                time = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
        }
    };
    std::vector<std::thread> others;
    for (int thread = 1; thread < threads; ++thread) others.emplace_back(repeat, static_cast<size_t>(thread));
    repeat(0);
    for (std::thread& other : others) other.join();
    volatile float kept = sums[0];  // so that the work is not left out
    static_cast<void>(kept);
    std::nth_element(ms.begin(), ms.begin() + kRepetitions / 2, ms.end());
    return ms[kRepetitions / 2];
}

}  // namespace fulcrum
