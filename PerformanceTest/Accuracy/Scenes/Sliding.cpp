// Coulomb friction: sliding, sticking, in all directions, and rolling.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kContacts{.contacts = true};

// A half space that rises towards -x, so that bodies go down towards +x.
struct Slope {
    Slope(LabWorld& world, double degrees, double friction) : angle(degrees * kPi / 180) {
        world.Add({.shape = Plane::Create(Normal().cast<float>()).Value(),
                   .motion = MotionType::Static,
                   .material = {.friction = static_cast<float>(friction)}});
    }
    Position Normal() const { return {std::sin(angle), std::cos(angle), 0}; }
    Position Down() const { return {std::cos(angle), -std::sin(angle), 0}; }
    Quaternion Rotation() const { return RotationAbout({0, 0, 1}, -angle); }

    double angle;
};

BodyId AddBoxOn(LabWorld& world, const Slope& slope, double friction) {
    return world.Add({.shape = BoxOf(0.5, 0.25, 0.5),
                      .position = slope.Normal() * 0.25,
                      .rotation = slope.Rotation(),
                      .material = {.friction = static_cast<float>(friction)}});
}

// Slides with a = g (sin - mu cos).
void Slide(LabRun& run) {
    LabWorld world(run);
    const Slope slope(world, 30, 0.3);
    const BodyId box = AddBoxOn(world, slope, 0.3);
    const double reference = kGravity * (std::sin(slope.angle) - 0.3 * std::cos(slope.angle));
    world.Steps(1);
    const double time = world.Time(), speed = world.Speed(box).dot(slope.Down());
    world.Steps(2);
    const double acceleration = (world.Speed(box).dot(slope.Down()) - speed) / (world.Time() - time);
    const double way = world.At(box).dot(slope.Down()), expected = 0.5 * reference * world.Time() * world.Time();
    run.Error("acceleration", Relative(acceleration, reference));
    run.Error("way", Relative(way, expected));
    run.Observe(way / expected);
}

// Sticks where mu >= tan: creep of a box of 1 m, apart from the first five seconds.
void Stick(LabRun& run) {
    LabWorld world(run);
    const Slope slope(world, 40, 0.9);
    const BodyId box = AddBoxOn(world, slope, 0.9);
    world.Steps(5);
    const Position start = world.At(box);
    world.Steps(run.Seconds(55, 10));
    run.Error("creep", (world.At(box) - start).norm());
    run.Figure("slid_at_first_m", (start - slope.Normal() * 0.25).norm());
    run.Observe(world.At(box).dot(slope.Down()));
}

// 32 boxes with the same orientation, headings pi/16 apart: all stop after v^2 / (2 mu g), straight, unturned.
void FrictionIsotropy(LabRun& run) {
    constexpr int kBoxes = 32;
    constexpr double kSpeed = 25, kFriction = 0.6;
    LabWorld world(run);
    world.AddFloor(static_cast<float>(kFriction));
    const ShapePtr shape = BoxOf(0.5, 0.25, 0.5);
    std::vector<BodyId> boxes;
    std::vector<Position> starts, headings;
    for (int i = 0; i < kBoxes; ++i) {
        const double heading = i * kPi / 16;
        headings.push_back({std::cos(heading), 0, std::sin(heading)});
        starts.push_back(headings.back() * 10.0 + Position(0, 0.25, 0));
        boxes.push_back(world.Add({.shape = shape,
                                   .position = starts.back(),
                                   .linearVelocity = (headings.back() * kSpeed).cast<float>(),
                                   .material = {.friction = static_cast<float>(kFriction)}}));
    }
    world.Steps(6);
    const double reference = kSpeed * kSpeed / (2 * kFriction * kGravity);
    double squares = 0, sum = 0, least = 1e300, most = 0, yaw = 0;
    for (int i = 0; i < kBoxes; ++i) {
        const Position way = world.At(boxes[i]) - starts[i];
        const double along = way.dot(headings[i]);
        squares += (way - headings[i] * reference).squaredNorm();
        sum += along;
        least = std::min(least, along);
        most = std::max(most, along);
        const Quaternion q = world.Bodies().GetPose(boxes[i]).rotation;
        yaw = std::max(yaw, 2 * std::abs(std::atan2(double(q.y), double(q.w))));
        run.Observe(along / reference);
    }
    run.Error("distance", std::sqrt(squares / kBoxes) / reference);
    run.Error("mean", Relative(sum / kBoxes, reference));
    run.Error("spread", (most - least) / reference);
    run.Error("yaw", yaw);
}

// A ball with I = 2/5 m r^2: its slip falls with 7/2 mu g, so that it rolls at 5/7 v0 from t = 2 v0 / (7 mu g) on.
void SlideToRoll(LabRun& run) {
    constexpr double kSpeed = 10, kFriction = 0.3, kRadius = 0.5;
    LabWorld world(run);
    world.AddFloor(static_cast<float>(kFriction));
    const BodyId ball = world.Add({.shape = SphereOf(kRadius),
                                   .position = {0, kRadius, 0},
                                   .linearVelocity = {kSpeed, 0, 0},
                                   .material = {.friction = static_cast<float>(kFriction)}});
    // Down to 1 % of the first slip, before which it falls in proportion to time.
    Crossings rolls;
    rolls.Sample(0, 0.99 * kSpeed);
    for (int i = run.Steps(2); i > 0; --i) {
        world.Step();
        const double slip = world.Speed(ball).x() + world.Turn(ball).z() * kRadius;
        rolls.Sample(world.Time(), slip - 0.01 * kSpeed);
    }
    const double time = 2 * kSpeed / (7 * kFriction * kGravity), rolling = 5.0 / 7 * kSpeed;
    const double way = kSpeed * time - 0.5 * kFriction * kGravity * time * time + rolling * (world.Time() - time);
    run.Error("way", Relative(world.At(ball).x(), way));
    run.Error("speed", Relative(world.Speed(ball).x(), rolling));
    run.Error("time", rolls.Times().empty() ? 1 : Relative(rolls.Times()[0], 0.99 * time));
    run.Observe(world.At(ball).x() / way);
}

// Rolls without slip: a = g sin / (1 + I / (m r^2)), 2 s. The parameter is I / (m r^2): 2/5, 1/2, 1. The hoop is a ball
// with the inertia m r^2.
void Rolling(LabRun& run) {
    constexpr double kRadius = 0.5;
    LabWorld world(run);
    const Slope slope(world, 15, 0.9);
    const bool isCylinder = run.parameter == 0.5, isHoop = run.parameter == 1;
    BodySettings body{.shape = isCylinder ? ShapePtr(Cylinder::Create(0.5f, kRadius).Value()) : SphereOf(kRadius),
                      .position = slope.Normal() * kRadius,
                      .mass = 1,
                      .material = {.friction = 0.9f}};
    if (isCylinder) body.rotation = RotationAbout({1, 0, 0}, kPi / 2);  // its axis along z
    if (isHoop) body.inertia = Vector3::Constant(kRadius * kRadius);
    const BodyId id = world.Add(body);
    world.Steps(2);
    const double reference = kGravity * std::sin(slope.angle) / (1 + run.parameter), t = world.Time();
    const double way = world.At(id).dot(slope.Down());
    run.Error("way", Relative(way, 0.5 * reference * t * t));
    run.Error("speed", Relative(world.Speed(id).dot(slope.Down()), reference * t));
    run.Observe(way / (0.5 * reference * t * t));
}

LabScene Roll(const char* variant, double inertia) {
    return {.name = "rolling",
            .variant = variant,
            .what = "rolls down 15 degrees from rest, 2 s",
            .error = "way, relative",
            .parameter = inertia,
            .influences = kContacts,
            .testBound = 0.01,
            .run = Rolling};
}

}  // namespace

std::vector<LabScene> SlidingScenes() {
    return {
        {.name = "incline",
         .variant = "slide",
         .what = "a box on a slope of 30 degrees, friction 0.3, from the first to the third second",
         .error = "acceleration, relative (2.3563 m/s2)",
         .influences = kContacts,
         .testBound = 1e-3,
         .run = Slide},
        {.name = "incline",
         .variant = "stick",
         .what = "a box of 1 m on a slope of 40 degrees, friction 0.9, from the fifth second on",
         .error = "creep over its edge",
         .influences = kContacts,
         .testBound = 1e-3,
         .run = Stick},
        {.name = "friction_isotropy",
         .what = "32 boxes at 25 m/s in all headings, friction 0.6, until they stand",
         .error = "RMS distance from where they stop, over the way of 53.09 m",
         .influences = kContacts,
         .testBound = 0.01,
         .run = FrictionIsotropy},
        {.name = "slide_to_roll",
         .what = "a ball set down at 10 m/s without spin, friction 0.3, 2 s",
         .error = "way, relative (15.67 m)",
         .influences = kContacts,
         .testBound = 1e-3,
         .run = SlideToRoll},
        Roll("sphere", 0.4),
        Roll("cylinder", 0.5),
        Roll("hoop", 1),
    };
}

}  // namespace fulcrum::accuracy
