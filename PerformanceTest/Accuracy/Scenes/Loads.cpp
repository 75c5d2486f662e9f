// Heavy bodies on light ones, tall stacks, small and large bodies: stability and penetration.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kContacts{.contacts = true};

// At most 1, for what has fallen or passed through.
double Sink(double missing) { return std::clamp(missing, 0.0, 1.0); }

// A cube of 1 m and 1000 kg, on it one of so many times the mass: overlap with the ground and of the two.
void HeavyOnLight(LabRun& run) {
    LabWorld world(run);
    world.AddFloor();
    const ShapePtr cube = BoxOf(0.5, 0.5, 0.5);
    const BodyId light = world.Add({.shape = cube, .position = {0, 0.5, 0}});
    const BodyId heavy =
        world.Add({.shape = cube, .position = {0, 1.5, 0}, .mass = static_cast<float>(1000 * run.parameter)});
    double deepest = 0;
    for (int i = run.Steps(run.Seconds(10, 5)); i > 0; --i) {
        world.Step();
        const double ofLight = 0.5 - world.At(light).y(), ofHeavy = 1 - (world.At(heavy) - world.At(light)).norm();
        const bool hasFallen = world.At(heavy).y() < 1;
        deepest = std::max({deepest, Sink(ofLight), Sink(ofHeavy), hasFallen ? 1.0 : 0.0});
    }
    run.Error("depth", deepest);
    run.Require(deepest <= 0.004, "overlap at most 4 mm");
    run.Observe(world.At(heavy).y());
}

// A flat pyramid with ten boxes at its base, the top one 200 times as heavy.
void HeavyTop(LabRun& run) {
    constexpr int kBase = 10;
    LabWorld world(run);
    world.AddFloor();
    const std::vector<BodyId> boxes = AddPyramid(world, kBase, 1, 1.05, 1, 200 * 1000);
    const BodyId heavy = boxes.back();
    const double top = kBase - 0.5;
    world.Steps(run.Seconds(10, 5));
    const Position at = world.At(heavy);
    const double off = (at - Position(0, top, 0)).norm();
    run.Error("sink", std::min(off, 1.0));
    run.Require(off <= 0.004 * kBase, "sinks by at most 4 mm a layer");
    run.Observe(at.y() / top);
}

// Boxes of 1 m up to 1 cm out of line: stand, drift by less than 5 % of an edge, and sleep.
void TallStack(LabRun& run) {
    const int count = static_cast<int>(run.parameter);
    LabWorld world(run, kDown, LabWorld::Sleeps);
    world.AddFloor();
    const std::vector<BodyId> boxes = AddStack(world, count, 1, 0.01, run.random);
    std::vector<Position> starts;
    for (const BodyId id : boxes) starts.push_back(world.At(id));
    double asleepAfter = -1;
    for (int i = run.Steps(run.Seconds(60, 10)); i > 0 && asleepAfter < 0; --i) {
        world.Step();
        if (world.AwakeBodies() == 0) asleepAfter = world.Time();
    }
    double drift = 0;
    for (size_t i = 0; i < boxes.size(); ++i) {
        Position way = world.At(boxes[i]) - starts[i];
        if (std::abs(way.y()) < 0.5) way.y() = 0;  // what sinks is no drift, what falls is
        drift = std::max(drift, way.norm());
    }
    run.Error("drift", std::min(drift, 1.0));
    run.Error("sink", Sink(starts.back().y() - world.At(boxes.back()).y()));
    run.Figure("asleep_after_s", asleepAfter);
    run.Require(drift < 0.05, "drifts by less than 5 % of an edge");
    if (!run.isQuick) run.Require(asleepAfter >= 0, "sleeps");
    run.Observe(world.At(boxes.back()).y() / (count - 0.5));
}

// A wall of ten layers of small cubes: how far its top sinks, in edges.
void Tiny(LabRun& run) {
    const double edge = run.parameter;
    LabWorld world(run);
    world.AddFloor(0.5f, 0, 10);
    const std::vector<BodyId> boxes = AddPyramid(world, 10, edge);
    const Position start = world.At(boxes.back());
    world.Steps(run.Seconds(10, 3));
    const double off = (world.At(boxes.back()) - start).norm() / edge;
    run.Error("sink", std::min(off, 10.0));
    run.Require(off < 0.5, "stands");
    run.Observe(std::min(off, 10.0));
}

// A box of 1 km, 10 m high, on four boxes of 1 m: its weight is 10^7 times that of one, and it stands or comes down.
void HugeBox(LabRun& run) {
    LabWorld world(run);
    world.AddFloor(0.5f, 0, 2000);
    const ShapePtr cube = BoxOf(0.5, 0.5, 0.5);
    for (const double x : {-400.0, 400.0})
        for (const double z : {-400.0, 400.0}) world.Add({.shape = cube, .position = {x, 0.5, z}});
    const BodyId slab = world.Add({.shape = BoxOf(500, 5, 500), .position = {0, 6, 0}});
    world.Steps(run.Seconds(10, 3));
    const double sink = 6 - world.At(slab).y();
    run.Error("sink", std::min(std::abs(sink), 10.0));
    run.Require(sink < 0.5, "stands");
    run.Observe(std::clamp(sink, -10.0, 10.0));
}

// A stack of five boxes on a ground of 10^6 m, a kilometer from its middle.
void HugeGround(LabRun& run) {
    LabWorld world(run);
    world.AddFloor(0.5f, 0, 1e6);
    const std::vector<BodyId> boxes = AddStack(world, 5, 1, 0, run.random, {1000, 0, 1000});
    world.Steps(run.Seconds(10, 3));
    const double off = (world.At(boxes.back()) - Position(1000, 4.5, 1000)).norm();
    run.Error("sink", std::min(off, 10.0));
    run.Require(off < 0.5, "stands");
    run.Observe(off);
}

LabScene OnLight(const char* variant, double times) {
    return {.name = "heavy_on_light",
            .variant = variant,
            .what = "a cube of 1 m, on it one of so many times the mass, 10 s",
            .error = "deepest overlap over an edge; 1: passed through",
            .parameter = times,
            .influences = kContacts,
            .isExtreme = true,
            .testBound = 0.05,
            .run = HeavyOnLight};
}

LabScene Stack(const char* variant, int count) {
    return {.name = "tall_stack",
            .variant = variant,
            .what = "so many boxes of 1 m up to 1 cm out of line, 60 s or until they sleep",
            .error = "largest drift over an edge; 1: fell",
            .parameter = static_cast<double>(count),
            .influences = kContacts,
            .isExtreme = true,
            .isSlow = true,
            .seeds = 32,
            .quickSeeds = 1,
            .testBound = 0.05,
            .run = TallStack};
}

LabScene Cubes(const char* variant, double edge) {
    return {.name = "tiny",
            .variant = variant,
            .what = "a wall of ten layers of cubes, edge in the name, 10 s",
            .error = "sink of the top in edges",
            .parameter = edge,
            .influences = kContacts,
            .isExtreme = true,
            .isSlow = true,
            .testBound = 0.05,
            .run = Tiny};
}

}  // namespace

std::vector<LabScene> LoadScenes() {
    return {
        OnLight("10", 10),
        OnLight("100", 100),
        OnLight("1000", 1000),
        OnLight("10000", 10'000),
        {.name = "heavy_on_light",
         .variant = "pyramid",
         .what = "a flat pyramid of ten layers, its top 200 times as heavy, 10 s",
         .error = "way of the top over an edge; 1: fell",
         .influences = kContacts,
         .isExtreme = true,
         .isSlow = true,
         .testBound = 0.1,
         .run = HeavyTop},
        Stack("15", 15),
        Stack("20", 20),
        Stack("50", 50),
        Stack("100", 100),
        Cubes("5cm", 0.05),
        Cubes("1cm", 0.01),
        Cubes("1mm", 0.001),
        {.name = "huge",
         .variant = "box",
         .what = "a slab of 1 km on four boxes of 1 m, 10 s",
         .error = "sink in edges of the small boxes",
         .influences = kContacts,
         .isExtreme = true,
         .testBound = 10.1,
         .run = HugeBox},
        {.name = "huge",
         .variant = "ground",
         .what = "a stack of five boxes on a ground of 10^6 m, 10 s",
         .error = "way of the top over an edge",
         .influences = kContacts,
         .isExtreme = true,
         .testBound = 0.01,
         .run = HugeGround},
    };
}

}  // namespace fulcrum::accuracy
