// Chains under load, and long ones: gaps of all joints together over the chain's length.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kJoints{.joints = true};

// 16 links of 1 kg and a ball of so many kg, swung down from horizontal: through the lowest point after a quarter of
// the period, 2.4 s.
void HeavyChain(LabRun& run) {
    LabWorld world(run);
    const Chain chain = AddChain(world, 16, run.parameter);
    const double start = world.Energy();
    // Energy is from where the ball hangs lowest.
    const double scale = run.parameter * kGravity * chain.length;
    double stretch = 0, rise = 0;
    for (int i = run.Steps(run.Seconds(10, 5)); i > 0; --i) {
        world.Step();
        stretch = std::max(stretch, world.SumOfGaps() / chain.length);
        rise = std::max(rise, (world.Energy() - start) / scale);
    }
    run.Error("stretch", stretch);
    run.Error("energy_rise", rise);
    run.Require(rise <= 0.01, "energy at most 1.01 of the start");
    run.Require(stretch < 0.1, "stretches by less than 10 %");
    run.Observe(world.At(chain.bodies.back()).x() / chain.length);
    run.Observe(world.At(chain.bodies.back()).y() / chain.length);
}

// Links alone, released horizontal; or created twice as long as they are.
void LongChain(LabRun& run) {
    const bool isStretched = run.parameter < 0;
    LabWorld world(run);
    const Chain chain = AddChain(world, static_cast<int>(std::abs(run.parameter)), 0, isStretched ? 2 : 1);
    double largest = 0, fastest = 0;
    for (int i = run.Steps(run.Seconds(10, 3)); i > 0; --i) {
        world.Step();
        largest = std::max(largest, world.SumOfGaps() / chain.length);
        fastest = std::max(fastest, world.FastestBody());
    }
    const double end = world.SumOfGaps() / chain.length;
    // One that was stretched is judged when it has had time to contract.
    run.Error("stretch", isStretched ? end : largest);
    run.Error("largest_stretch", largest);
    run.Figure("fastest_m_s", fastest);
    // Free fall through the chain's length, twice over: the end of a whip is faster than what falls.
    run.Require(fastest <= 4 * std::sqrt(2 * kGravity * chain.length), "does not explode");
    run.Observe(world.At(chain.bodies.back()).x() / chain.length);
}

LabScene Heavy(const char* variant, double mass, double bound) {
    return {.name = "heavy_chain",
            .variant = variant,
            .what = "16 links of 1 kg and a ball, mass in the name, swung from horizontal, 10 s",
            .error = "largest sum of gaps over the length",
            .parameter = mass,
            .influences = kJoints,
            .isExtreme = true,
            .isSlow = true,
            .testBound = bound,
            .run = HeavyChain};
}

// count < 0: created twice as long.
LabScene Long(const char* variant, double count, double bound) {
    return {.name = "long_chain",
            .variant = variant,
            .what = count < 0 ? "a chain of 100 links created twice as long as it is, 10 s"
                              : "a chain of so many links of 1 m released horizontal, 10 s",
            .error = count < 0 ? "sum of gaps over the length, at the end" : "largest sum of gaps over the length",
            .parameter = count,
            .influences = kJoints,
            .isExtreme = true,
            .isSlow = true,
            .testBound = bound,
            .run = LongChain};
}

}  // namespace

std::vector<LabScene> ChainScenes() {
    return {
        Heavy("100", 100, 0.01), Heavy("1000", 1000, 0.01), Heavy("10000", 10'000, 0.01), Long("50", 50, 0.01),
        Long("100", 100, 0.01),  Long("500", 500, 0.01),    Long("stretched", -100, 1),
    };
}

}  // namespace fulcrum::accuracy
