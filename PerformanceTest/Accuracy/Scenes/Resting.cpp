// Resting bodies: penetration, contact forces, and what still moves.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::accuracy {
namespace {

// 216 balls just above each other fall apart into a heap: none may be in another one, or in the ground. Depths are
// from the centers; RMS over all touching pairs, mean over ten times of the second half.
void RestingCube(LabRun& run) {
    constexpr double kRadius = 0.5, kSpacing = 1.02;
    const double seconds = run.Seconds(10, 2);
    LabWorld world(run);
    world.AddFloor();
    const ShapePtr shape = SphereOf(kRadius);
    std::vector<BodyId> balls;
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 6; ++x)
            for (int z = 0; z < 6; ++z) {
                const double dx = run.random.Between(-1e-3, 1e-3), dz = run.random.Between(-1e-3, 1e-3);
                balls.push_back(world.Add({.shape = shape,
                                           .position = {kSpacing * (x - 2.5) + dx, kRadius + kSpacing * y + 0.01,
                                                        kSpacing * (z - 2.5) + dz}}));
            }
    world.Steps(seconds / 2);
    double squares = 0, touching = 0, deepest = 0;
    const auto add = [&](double depth) {
        if (depth <= 0) return;
        squares += depth * depth;
        touching += 1;
        deepest = std::max(deepest, depth);
    };
    for (int sample = 0; sample < 10; ++sample) {
        world.Steps(seconds / 20);
        for (size_t i = 0; i < balls.size(); ++i) {
            const Position at = world.At(balls[i]);
            add(kRadius - at.y());
            for (size_t j = 0; j < i; ++j) add(2 * kRadius - (at - world.At(balls[j])).norm());
        }
    }
    const double rms = touching > 0 ? std::sqrt(squares / touching) : 0;
    run.Error("depth", rms / kRadius);
    run.Error("deepest", deepest / kRadius);
    run.Figure("mean_squared_depth_m2", rms * rms);
    run.Observe(rms / kRadius);
}

// Eight balls that can only move up and down and not turn, as in a tube without friction: interface k of them carries
// (N - k) m g, the floor all. dt is 0.3 of the grid's, so that it is 5 ms at the default. The impulse of a contact is
// that of the last substep: the system's own, since islands get no more substeps here.
void Weight(LabRun& run) {
    constexpr int kBalls = 8;
    constexpr double kRadius = 0.05, kMass = 5;
    const double dt = 0.3 * run.Dt(), substep = dt / run.setting.solver.substeps;
    LabWorld world(run, kDown, [](SystemSettings& settings) {
        settings.accuracy.penetration = std::numeric_limits<float>::infinity();
    });
    const PhysicsSystem& ours = world.Ours("the forces of contacts");
    world.AddFloor();
    std::vector<BodyId> balls;
    for (int i = 0; i < kBalls; ++i)
        balls.push_back(
            world.Add({.shape = SphereOf(kRadius),
                       .position = {0, kRadius * (2 * i + 1), 0},
                       .mass = kMass,
                       .lockedAxes = LockedAxes::TranslationX | LockedAxes::TranslationZ | LockedAxes::Rotation}));
    const int settling = std::max(1, static_cast<int>(std::lround(0.25 / dt)));
    for (int i = 0; i < settling; ++i) world.Step(dt);
    // After 0.25 s: mean over ten steps.
    std::vector<double> force(kBalls, 0);
    for (int i = 0; i < 10; ++i) {
        world.Step(dt);
        ours.VisitContacts([&](const ContactView& contact) {
            double impulse = 0;
            for (const ContactView::Point& point : contact.points) impulse += point.impulse;
            // Interface k is below ball k.
            int k = 0;
            for (int ball = 1; ball < kBalls; ++ball)
                if (contact.bodyA == balls[ball] || contact.bodyB == balls[ball]) k = ball;
            force[static_cast<size_t>(k)] += impulse / substep / 10;
        });
    }
    double sum = 0;
    for (int k = 0; k < kBalls; ++k) {
        const double reference = (kBalls - k) * kMass * kGravity;
        sum += Relative(force[static_cast<size_t>(k)], reference) / kBalls;
        run.Observe(force[static_cast<size_t>(k)] / reference);
    }
    run.Error("mean_force", sum);
    run.Error("floor_force", Relative(force[0], kBalls * kMass * kGravity));
}

// In the order x, y, z, whatever the order in which a compiler evaluates arguments.
Position RandomPoint(Random& random, const Position& low, const Position& high) {
    Position point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = random.Between(low[axis], high[axis]);
    return point;
}

// A box, a plate or a convex hull of 40 cm or so, by turns.
ShapePtr MakePiece(int i, Random& random) {
    if (i % 3 < 2) {
        const bool isPlate = i % 3 == 1;
        const Position half = isPlate ? RandomPoint(random, {0.2, 0.025, 0.15}, {0.3, 0.025, 0.25})
                                      : RandomPoint(random, {0.1, 0.1, 0.1}, {0.2, 0.2, 0.2});
        return BoxOf(half.x(), half.y(), half.z());
    }
    std::vector<Vector3> points;
    for (int corner = 0; corner < 12; ++corner) {
        Position point = RandomPoint(random, {-1, -1, -1}, {1, 1, 1});
        point *= random.Between(0.15, 0.25) / std::max(0.1, point.norm());
        points.push_back(point.cast<float>());
    }
    return ConvexHull::Create(points).Value();
}

struct Motion {
    double drift = 0, speed = 0;  // m, m/s
};

// 40 pieces fall into a bin of 2 x 2 x 8 m, of five boxes, and may not sleep: how far and how fast those that move most
// still go in the last second.
Motion FillBin(LabRun& run) {
    constexpr int kPieces = 40;
    constexpr double kHalf = 1, kHeight = 4, kWall = 0.25;
    LabWorld world(run);
    world.Add({.shape = BoxOf(kHalf, kWall, kHalf), .motion = MotionType::Static, .position = {0, -kWall, 0}});
    for (const double side : {-1.0, 1.0})
        for (const bool isAlongX : {true, false}) {
            const double out = side * (kHalf + kWall), along = kHalf + 2 * kWall;
            world.Add({.shape = isAlongX ? BoxOf(along, kHeight, kWall) : BoxOf(kWall, kHeight, kHalf),
                       .motion = MotionType::Static,
                       .position = {isAlongX ? 0 : out, kHeight, isAlongX ? out : 0}});
        }
    std::vector<BodyId> pieces;
    for (int i = 0; i < kPieces; ++i) {
        const int column = i % 4;
        const ShapePtr shape = MakePiece(i, run.random);
        const Vector3 axis = RandomPoint(run.random, {-1, 1, -1}, {1, 1, 1}).cast<float>();
        pieces.push_back(world.Add({.shape = shape,
                                    .position = {column % 2 - 0.5, 0.5 + 0.65 * (i / 4), column / 2 - 0.5},
                                    .rotation = RotationAbout(Normalized(axis), run.random.Between(0, 2 * kPi))}));
    }
    world.Steps(14);
    std::vector<Position> starts;
    for (const BodyId id : pieces) starts.push_back(world.At(id));
    Motion most;
    for (int i = run.Steps(1); i > 0; --i) {
        world.Step();
        most.speed = std::max(most.speed, world.FastestBody());
    }
    int inside = 0;
    for (size_t i = 0; i < pieces.size(); ++i) {
        const Position at = world.At(pieces[i]);
        most.drift = std::max(most.drift, (at - starts[i]).norm());
        // A hull's position need not be inside of it.
        inside += std::abs(at.x()) < kHalf + kWall && std::abs(at.z()) < kHalf + kWall && at.y() > -kWall;
    }
    run.Require(inside == kPieces, "all are in the bin");
    return most;
}

// Most bins come to rest, some do not: the errors are of the worst one, and the share of those that move.
void Bins(LabRun& run) {
    constexpr double kSize = 0.4, kFast = 0.003;  // m, m/s
    const int count = run.Count(32, 6);
    Motion most;
    int restless = 0;
    for (int bin = 0; bin < count; ++bin) {
        const Motion motion = FillBin(run);
        most.drift = std::max(most.drift, motion.drift);
        most.speed = std::max(most.speed, motion.speed);
        restless += motion.speed > kFast;
    }
    run.Error("drift", most.drift / kSize);
    run.Error("speed", most.speed / kSize);
    run.Error("restless", static_cast<double>(restless) / count);
    run.Observe(most.drift / kSize);
}

}  // namespace

std::vector<LabScene> RestingScenes() {
    return {
        {.name = "resting_cube",
         .what = "6 x 6 x 6 balls of 0.5 m just above each other, 10 s",
         .error = "RMS depth over a ball's radius",
         .influences = {.contacts = true},
         .isSlow = true,
         .seeds = 32,
         .quickSeeds = 1,
         .testBound = 0.05,
         .run = RestingCube},
        {.name = "weight",
         .what = "8 balls of 5 kg and 5 cm stacked in a tube, dt 0.3 of the setting's, after 0.25 s",
         .error = "mean relative error of the forces at the interfaces",
         .influences = {.contacts = true},
         .testBound = 0.05,
         .run = Weight},
        {.name = "bins",
         .what = "32 bins (short: 6), each with 40 boxes, plates and convex hulls of 40 cm, after 15 s without sleep",
         .error = "way of the body that goes farthest in the last second, over 40 cm",
         .influences = {.contacts = true},
         .isSlow = true,
         .testBound = 0.05,
         .run = Bins},
    };
}

}  // namespace fulcrum::accuracy
