// Bodies that are created inside each other.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kContacts{.contacts = true};

// The fastest motion of bodies, from their displacements: penetration recovery moves bodies without velocity.
class MotionMeter {
public:
    MotionMeter(LabWorld& world, std::vector<BodyId> bodies) : world_(world), bodies_(std::move(bodies)) {
        for (const BodyId id : bodies_) last_.push_back(world_.At(id));
    }
    void Step(double dt) {
        world_.Step();
        for (size_t i = 0; i < bodies_.size(); ++i) {
            const Position now = world_.At(bodies_[i]);
            fastest = std::max(fastest, (now - last_[i]).norm() / dt);
            last_[i] = now;
        }
    }
    double fastest = 0;  // m/s

private:
    LabWorld& world_;
    std::vector<BodyId> bodies_;
    std::vector<Position> last_;
};

// A flat pyramid of 36 cubes of 1 m on the ground whose centers are so much nearer to each other, without gravity:
// their largest speed as they come apart, over the largest push of contacts; and how fast they are moved, speed or not.
void OverlappingPyramid(LabRun& run) {
    LabWorld world(run, kNoGravity);
    world.AddFloor();
    const double closeness = 1 - run.parameter;
    MotionMeter meter(world, AddPyramid(world, 8, 1, closeness, closeness));
    double fastest = 0;
    for (int i = run.Steps(3); i > 0; --i) {
        meter.Step(run.Dt());
        fastest = std::max(fastest, world.FastestBody());
    }
    const double limit = SystemSettings{}.contactPushSpeed;
    run.Error("exit_speed", fastest / limit);
    run.Error("motion", meter.fastest / limit);
    run.Require(fastest <= limit, "exit speed at most contactPushSpeed");
    run.Observe(fastest / limit);
}

// 64 balls of 1 m in a closed box of 3 m, which has room for fewer: none leaves it.
void SealedBox(LabRun& run) {
    constexpr double kHalf = 1.5, kWall = 0.5;
    LabWorld world(run);
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            Position half(kHalf + 2 * kWall, kHalf + 2 * kWall, kHalf + 2 * kWall), at = Position::Zero();
            half[axis] = kWall;
            at[axis] = side * (kHalf + kWall);
            world.Add({.shape = BoxOf(half.x(), half.y(), half.z()), .motion = MotionType::Static, .position = at});
        }
    const ShapePtr ball = SphereOf(0.5);
    std::vector<BodyId> balls;
    for (int i = 0; i < 64; ++i) {
        const Position cell(i % 4 - 1.5, i / 4 % 4 - 1.5, i / 16 - 1.5);
        balls.push_back(world.Add({.shape = ball, .position = cell * 0.66}));
    }
    double fastest = 0;
    for (int i = run.Steps(5); i > 0; --i) {
        world.Step();
        fastest = std::max(fastest, world.FastestBody());
    }
    double outside = 0;
    for (const BodyId id : balls) outside += !world.At(id).cwiseAbs().isAtMost(Position::Constant(kHalf));
    run.Error("escaped", outside / 64);
    run.Figure("fastest_m_s", fastest);
    run.Require(outside == 0, "confined bodies stay inside");
    run.Observe(outside / 64);
}

// So many balls of 1 m at one point, without gravity: the part that still overlaps another one by more than a tenth.
void Coincident(LabRun& run) {
    const int count = static_cast<int>(run.parameter);
    LabWorld world(run, kNoGravity);
    const PhysicsSystem& ours = world.Ours("its pairs and the memory that it uses");
    const ShapePtr ball = SphereOf(0.5);
    std::vector<BodyId> balls;
    for (int i = 0; i < count; ++i) balls.push_back(world.Add({.shape = ball}));
    // The balls fill a ball of the radius count^(1/3): they take time in proportion to get there.
    const double seconds = run.isQuick ? 3 : 2 + std::cbrt(double(count));
    double fastest = 0, pairs = 0;
    for (int i = run.Steps(seconds); i > 0; --i) {
        world.Step();
        fastest = std::max(fastest, world.FastestBody());
        pairs = std::max(pairs, double(ours.Report().pairs));
    }
    std::vector<Position> places;
    for (const BodyId id : balls) places.push_back(world.At(id));
    double overlapping = 0;
    for (size_t i = 0; i < places.size(); ++i) {
        bool overlaps = false;
        for (size_t j = 0; j < places.size() && !overlaps; ++j)
            overlaps = i != j && (places[i] - places[j]).squaredNorm() < 0.9 * 0.9;
        overlapping += overlaps;
    }
    const double bytes = static_cast<double>(ours.MemoryUsed()) / count;
    run.Error("overlapping", overlapping / count);
    run.Figure("fastest_m_s", fastest);
    run.Figure("most_pairs", pairs);
    run.Figure("bytes_a_body", bytes);
    run.Require(bytes < 1e5, "bounded memory");
    run.Observe(overlapping / count);
}

LabScene Pyramid(const char* variant, double overlap) {
    return {.name = "overlap",
            .variant = variant,
            .what = "a flat pyramid of 36 cubes created with such an overlap, no gravity, 3 s",
            .error = "exit speed over contactPushSpeed (3 m/s)",
            .parameter = overlap,
            .influences = kContacts,
            .isExtreme = true,
            .isSlow = true,
            .testBound = 2,
            .run = OverlappingPyramid};
}

LabScene AtOnePoint(const char* variant, int count) {
    return {.name = "coincident",
            .variant = variant,
            .what = "so many balls of 1 m at one point, no gravity",
            .error = "part that still overlaps another by more than a tenth",
            .parameter = static_cast<double>(count),
            .influences = kContacts,
            .isExtreme = true,
            .isSlow = true,
            .testBound = 1.01,
            .run = Coincident};
}

}  // namespace

std::vector<LabScene> OverlapScenes() {
    return {
        Pyramid("25", 0.25),
        Pyramid("50", 0.5),
        Pyramid("100", 1),
        {.name = "overlap",
         .variant = "sealed",
         .what = "64 balls of 1 m in a closed box of 3 m, 5 s",
         .error = "part that leaves the box",
         .influences = kContacts,
         .isExtreme = true,
         .isSlow = true,
         .testBound = 1e-9,
         .run = SealedBox},
        AtOnePoint("128", 128),
        AtOnePoint("4096", 4096),
    };
}

}  // namespace fulcrum::accuracy
