// Scenes far from the origin, unusual time steps, long runs.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kBoth{.contacts = true, .joints = true};

// A trunk with head, arms and legs on cones, lying in the air.
void AddFigure(LabWorld& world, const Position& origin, std::vector<BodyId>& bodies) {
    const BodyId trunk = world.Add({.shape = Capsule::Create(0.25f, 0.15f).Value(), .position = origin});
    bodies.push_back(trunk);
    const Position limbs[] = {{0, 0.6, 0}, {0.45, 0.2, 0}, {-0.45, 0.2, 0}, {0.15, -0.75, 0}, {-0.15, -0.75, 0}};
    for (const Position& place : limbs) {
        const BodyId limb = world.Add({.shape = Capsule::Create(0.15f, 0.08f).Value(), .position = origin + place});
        ConeJointSettings cone = JointOf<ConeJointSettings>(trunk, limb, origin + place * 0.6, {0, 1, 0});
        cone.halfAngle = 0.6f;
        world.Join(cone);
        bodies.push_back(limb);
    }
}

// A stack of six, a chain and a figure that falls, near `origin`; their places against it after 3 s, and when the stack
// fell asleep.
struct FarPlaces {
    std::vector<Position> stack, chain, figure;
    double asleepAfter = -1;
};

FarPlaces RunAt(LabRun& run, const Position& origin) {
    LabWorld world(run, kDown, LabWorld::Sleeps);
    world.AddFloor(0.5f, 0, 100, origin);
    Random random(1);
    const std::vector<BodyId> stack = AddStack(world, 6, 1, 0.005, random, origin);
    const Chain chain = AddChain(world, 8, 0, 1, origin + Position(10, 12, 0));
    std::vector<BodyId> figure;
    AddFigure(world, origin + Position(-10, 3, 0), figure);
    FarPlaces places;
    for (int i = run.Steps(3); i > 0; --i) {
        world.Step();
        if (places.asleepAfter < 0 && !world.Bodies().IsAwake(stack[0])) places.asleepAfter = world.Time();
    }
    const auto relative = [&](const std::vector<BodyId>& bodies) {
        std::vector<Position> all;
        for (const BodyId id : bodies) all.push_back(world.At(id) - origin);
        return all;
    };
    places.stack = relative(stack);
    places.chain = relative(chain.bodies);
    places.figure = relative(figure);
    return places;
}

double LargestDistance(const std::vector<Position>& a, const std::vector<Position>& b) {
    double largest = 0;
    for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
    return largest;
}

// Poses as those at the origin, to 1 mm, and the same sleep step. The origin is one that doubles have, so that nothing
// is lost as bodies are placed.
void FarAway(LabRun& run) {
    const FarPlaces near = RunAt(run, {0, 0, 0}), far = RunAt(run, {run.parameter, 0, -run.parameter});
    const double stack = LargestDistance(near.stack, far.stack), chain = LargestDistance(near.chain, far.chain),
                 figure = LargestDistance(near.figure, far.figure);
    run.Error("stack", stack);
    run.Error("chain", chain);
    run.Error("figure", figure);
    run.Require(std::max({stack, chain, figure}) <= 1e-3, "poses are the same to 1 mm");
    run.Require(near.asleepAfter == far.asleepAfter, "falls asleep in the same step");
    run.Observe(far.figure[0].y());
}

enum Steps { kZero = 0, kShort = 1, kLong = 2, kAlternating = 3 };

// A stack of five while steps are zero every other time, 10 us, 0.1 s, or alternate between 1/30 and 1/240 s.
void TimeStep(LabRun& run) {
    const Steps steps = static_cast<Steps>(static_cast<int>(run.parameter));
    LabWorld world(run);
    world.AddFloor();
    const std::vector<BodyId> boxes = AddStack(world, 5, 1, 0.005, run.random);
    const Position start = world.At(boxes.back());
    const double seconds = steps == kShort ? run.Seconds(0.5, 0.1) : run.Seconds(30, 10);
    for (int i = 0; world.Time() < seconds; ++i) {
        if (steps == kZero) world.Step(i % 2 == 0 ? 0 : 1.0 / 60);
        if (steps == kShort) world.Step(1e-5);
        if (steps == kLong) world.Step(0.1);
        if (steps == kAlternating) world.Step(i % 2 == 0 ? 1.0 / 30 : 1.0 / 240);
    }
    const double off = (world.At(boxes.back()) - start).norm();
    run.Error("drift", std::min(off, 10.0));
    run.Require(off < 0.25, "the stack survives");
    run.Observe(std::min(off, 10.0));
}

// 10^6 steps of a stack, a pendulum and a ball that rolls in a pit: no energy gain, rotations stay normalized, memory
// stays constant.
void Soak(LabRun& run) {
    LabWorld world(run);
    world.AddFloor();
    AddStack(world, 5, 1, 0.005, run.random);
    const Chain chain = AddChain(world, 4, 5, 1, {10, 12, 0});
    std::vector<BodyId> figure;
    AddFigure(world, {-10, 3, 0}, figure);
    for (const double side : {-1.0, 1.0}) {
        world.Add({.shape = BoxOf(0.5, 1, 5), .motion = MotionType::Static, .position = {side * 4, 1, 20}});
        world.Add({.shape = BoxOf(5, 1, 0.5), .motion = MotionType::Static, .position = {0, 1, 20 + side * 4}});
    }
    const BodyId ball = world.Add({.shape = SphereOf(0.5),
                                   .position = {0, 0.5, 20},
                                   .linearVelocity = {3, 0, 2},
                                   .material = {.restitution = 1}});
    const PhysicsSystem& ours = world.Ours("the memory that it uses");
    const double start = world.Energy();
    const int steps = run.Count(1'000'000, 5'000);
    double energy = start, rise = 0, lowest = start, unit = 0, memory = 0;
    for (int i = 0; i < steps; ++i) {
        world.Step();
        if (i % 16 == 0) {
            energy = world.Energy();
            lowest = std::min(lowest, energy);
            rise = std::max(rise, energy - lowest);
            for (const BodyId id : {ball, chain.bodies[0], figure[0]})
                unit =
                    std::max(unit, std::abs(std::sqrt(double(LengthSquared(world.Bodies().GetPose(id).rotation))) - 1));
        }
        if (i == steps / 10) memory = static_cast<double>(ours.MemoryUsed());
    }
    run.Error("energy_rise", rise / start);
    run.Error("rotation", unit);
    run.Figure("memory_growth", static_cast<double>(ours.MemoryUsed()) / memory - 1);
    run.Require(rise <= 0.01 * start, "energy at most 1.01 of the start");
    run.Require(unit <= 1e-5, "rotations are unit to 1e-5");
    run.Require(static_cast<double>(ours.MemoryUsed()) <= 1.1 * memory, "memory stays within 10 %");
    run.Observe(energy / start);
}

LabScene Far(const char* variant, double distance) {
    return {.name = "far_away",
            .variant = variant,
            .what = "a stack, a chain and a figure so far from the origin, 3 s",
            .error = "largest distance of the stack from its places at the origin, over 1 m",
            .parameter = distance,
            .influences = kBoth,
            .isExtreme = true,
            .testBound = 1e-3,
            .run = FarAway};
}

LabScene OddSteps(const char* variant, Steps steps) {
    return {.name = "time_step",
            .variant = variant,
            .what = "a stack of five boxes under such steps",
            .error = "way of the top over an edge",
            .parameter = static_cast<double>(steps),
            .influences = {.timeStep = false, .contacts = true},
            .isExtreme = true,
            .isSlow = steps == kShort,
            .testBound = 0.25,
            .run = TimeStep};
}

}  // namespace

std::vector<LabScene> PlaceScenes() {
    return {
        Far("10km", 1e4),
        Far("1000km", 1e6),
        Far("10000km", 1e7),
        Far("1e9m", 1e9),
        OddSteps("zero", kZero),
        OddSteps("1e-5", kShort),
        OddSteps("0.1", kLong),
        OddSteps("alternating", kAlternating),
        {.name = "soak",
         .what = "10^6 steps of a stack, a pendulum, a figure and a ball in a pit",
         .error = "largest rise of the energy, relative",
         .influences = kBoth,
         .isExtreme = true,
         .isSlow = true,
         .testBound = 0.01,
         .run = Soak},
    };
}

}  // namespace fulcrum::accuracy
