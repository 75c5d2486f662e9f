// Continuous collision: fast balls at thin walls, a turning rod at thin posts.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

// Balls of 0.1 m at 200, 600 and 1000 m/s, aimed at random from 10 m at a wall so thick; they do not see each other.
void BallsAtWall(LabRun& run) {
    const double thickness = run.parameter;
    const int count = run.Count(10'000, 600);
    LabWorld world(run, kNoGravity);
    world.Add({.shape = BoxOf(thickness / 2, 50, 50), .motion = MotionType::Static, .category = 2, .mask = 1});
    const ShapePtr shape = SphereOf(0.1);
    std::vector<BodyId> balls;
    for (int i = 0; i < count; ++i) {
        const double speed = 200.0 + 400 * (i % 3);
        const double z = run.random.Between(-20, 20), y = run.random.Between(-20, 20);
        const Position from(-10 - run.random.Unit(), y, z);
        const double aside = run.random.Between(-10, 10), up = run.random.Between(-10, 10);
        const Position to(0, y + up, z + aside);
        balls.push_back(world.Add({.shape = shape,
                                   .position = from,
                                   .linearVelocity = ((to - from).normalized() * speed).cast<float>(),
                                   .category = 1,
                                   .mask = 2,
                                   .continuous = ContinuousCollision::Linear}));
    }
    world.Steps(0.2);
    const double passed = static_cast<double>(
        std::count_if(balls.begin(), balls.end(), [&](BodyId id) { return !(world.At(id).x() < 0); }));
    run.Error("passed", passed / count);
    run.Figure("aims", count);
    run.Require(passed == 0, "none passes through");
    run.Observe(passed / count);
}

// Rods of 4 m that turn at 100 rad/s about their middle, each with a thin post in its way: one that still turns as fast
// as before when it must have hit passed it.
void RodAtPost(LabRun& run) {
    constexpr double kSpin = 100, kReach = 1.5;
    const int count = run.Count(1000, 50);
    LabWorld world(run, kNoGravity);
    const ShapePtr shape = BoxOf(2, 0.05, 0.05), post = BoxOf(0.02, 1, 0.02);
    std::vector<BodyId> rods;
    for (int i = 0; i < count; ++i) {
        const Position middle(10.0 * (i % 40), 0, 10.0 * (i / 40));
        const double ahead = run.random.Between(0.2, 1.4);  // rad, until it hits
        world.Add({.shape = post,
                   .motion = MotionType::Static,
                   .position = middle + Position(kReach * std::cos(ahead), 0, -kReach * std::sin(ahead))});
        rods.push_back(world.Add({.shape = shape,
                                  .position = middle,
                                  .angularVelocity = {0, static_cast<float>(kSpin), 0},
                                  .continuous = ContinuousCollision::LinearAndAngular}));
    }
    for (int i = run.Steps(1.5 / kSpin) + 2; i > 0; --i) world.Step();
    const double passed = static_cast<double>(
        std::count_if(rods.begin(), rods.end(), [&](BodyId id) { return !(world.Turn(id).y() < 0.99 * kSpin); }));
    run.Error("passed", passed / count);
    run.Figure("aims", count);
    run.Require(passed == 0, "none passes through");
    run.Observe(passed / count);
}

LabScene Wall(const char* variant, double thickness) {
    return {.name = "bullet",
            .variant = variant,
            .what = "balls of 0.1 m at 200, 600 and 1000 m/s at a wall, thickness in the name; 10^4 random aims",
            .error = "part that passes through",
            .parameter = thickness,
            .influences = {.contacts = true},
            .isExtreme = true,
            .isSlow = true,
            .testBound = 1e-9,
            .run = BallsAtWall};
}

}  // namespace

std::vector<LabScene> FastScenes() {
    return {
        Wall("wall_0.1", 0.1),
        Wall("wall_0.01", 0.01),
        {.name = "bullet",
         .variant = "rod",
         .what = "rods of 4 m turning at 100 rad/s at posts of 4 cm",
         .error = "part that passes through",
         .influences = {.contacts = true},
         .isExtreme = true,
         .isSlow = true,
         .testBound = 1e-9,
         .run = RodAtPost},
    };
}

}  // namespace fulcrum::accuracy
