#include <Fulcrum/PerformanceTest/Scenes/ReferenceKernel.h>

#include <Fulcrum/PerformanceTest/Scenes/SampleStatistics.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <thread>

namespace fulcrum {
namespace {

constexpr size_t kFloats = size_t(1) << 22;  // 16 MB
constexpr size_t kUnits = 600;               // a thread
constexpr int kSweeps = 180;                 // over the floats in cache
constexpr int kReads = 12'000;               // of places anywhere in memory

// Of all rows of `count` units.
double MedianSum(size_t count, const std::vector<std::vector<double>>& sequences) {
    std::vector<double> sums;
    for (const std::vector<double>& units : sequences) {
        double sum = 0;
        for (size_t i = 0; i < units.size(); ++i) {
            sum += units[i];
            if (i + 1 > count) sum -= units[i - count];
            if (i + 1 >= count) sums.push_back(sum);
        }
    }
    return MedianOf(std::move(sums));
}

}  // namespace

ReferenceKernel::ReferenceKernel() : memory_(kFloats) {
    for (size_t i = 0; i < memory_.size(); ++i) memory_[i] = 1.0f / static_cast<float>(1 + i % 1000);
}

float ReferenceKernel::Work(uint32_t& place) const {
    // Each value depends on its last one, but not on the other ones: as the rows of a color.
    std::array<float, 1024> values;
    for (size_t i = 0; i < values.size(); ++i) values[i] = memory_[i + place % 1024];
    for (int sweep = 0; sweep < kSweeps; ++sweep)
        for (float& value : values) value = value * 0.999f + 0.001f;
    // Addresses that no prefetcher guesses, all known ahead: as bodies of contacts. The generator is that of Numerical
    // Recipes.
    float sum = 0;
    for (int read = 0; read < kReads; ++read) {
        place = place * 1664525u + 1013904223u;
        sum += memory_[place >> 10];
    }
    for (float value : values) sum += value;
    return sum;
}

std::vector<double> ReferenceKernel::Time(int threads) const {
    using Clock = std::chrono::steady_clock;
    const auto count = static_cast<size_t>(threads);
    std::atomic<size_t> taken = 0;
    std::vector<std::vector<Clock::time_point>> ends(count);
    std::vector<float> sums(count);
    // As workers of a pool: whoever is there takes the next unit, nobody waits for a thread that is interrupted.
    const auto work = [&](size_t thread) {
        auto place = static_cast<uint32_t>(thread);
        while (taken++ < kUnits * count) {
            sums[thread] += Work(place);
            ends[thread].push_back(Clock::now());
        }
    };
    std::vector<Clock::time_point> all{Clock::now()};
    std::vector<std::thread> others;
    for (size_t thread = 1; thread < count; ++thread) others.emplace_back(work, thread);
    work(0);
    for (std::thread& other : others) other.join();
    volatile float kept = sums[0];  // so that the work is not left out
    static_cast<void>(kept);

    for (const auto& own : ends) all.insert(all.end(), own.begin(), own.end());
    std::sort(all.begin(), all.end());
    std::vector<double> ms;
    for (size_t i = count; i < all.size(); i += count)
        ms.push_back(std::chrono::duration<double, std::milli>(all[i] - all[i - count]).count());
    return ms;
}

double UnitsIn(double ms, const std::vector<std::vector<double>>& sequences) {
    size_t longest = 0;
    for (const std::vector<double>& units : sequences) longest = std::max(longest, units.size());
    // The sums grow with the number: low units are shorter than ms, high ones are not, if there are so many.
    size_t low = 0, high = longest + 1;
    double lowSum = 0, highSum = 0;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        const double sum = MedianSum(middle, sequences);
        (sum < ms ? low : high) = middle;
        (sum < ms ? lowSum : highSum) = sum;
    }
    const auto count = static_cast<double>(low);
    if (high > longest) return count * ms / lowSum;
    return count + (ms - lowSum) / (highSum - lowSum);
}

}  // namespace fulcrum
