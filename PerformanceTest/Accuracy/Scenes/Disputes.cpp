// Contradictory joints, and joints created far outside their limits.
#include <Fulcrum/PerformanceTest/Accuracy/LabWorld.h>
#include <Fulcrum/PerformanceTest/Accuracy/Scenes/Families.h>
#include <Fulcrum/Samples/Scenes/JointShorthands.h>

#include <algorithm>

namespace fulcrum::accuracy {
namespace {

constexpr Influences kJoints{.joints = true};

// Observes a body for the given time: the error is its motion in the second half, relative to `size`.
void WatchDispute(LabRun& run, LabWorld& world, BodyId body, double size) {
    const double seconds = run.Seconds(20, 6);
    double force = 0;
    const auto go = [&] {
        for (int i = run.Steps(seconds / 2); i > 0; --i) {
            world.Step();
            if (world.IsPeer()) continue;  // its forces are not known
            const JointInterface& joints = world.Ours("").Joints();
            joints.Visit([&](JointId id) { force = std::max(force, double(Length(joints.GetForce(id)))); });
        }
        return world.At(body);
    };
    const Position half = go(), end = go();
    run.Error("drift", (end - half).norm() / size);
    if (!world.IsPeer()) {
        run.Figure("largest_force_n", force);
        run.Require(std::isfinite(force), "bounded impulses");
    }
    run.Require((end - half).norm() < 0.01 * size, "no drift growth");
    run.Observe(end.x() / size);
    run.Observe(end.y() / size);
}

// Two fixed joints whose targets for one body are half a meter apart.
void TwoFixed(LabRun& run) {
    LabWorld world(run);
    const BodyId hook = AddHook(world), box = world.Add({.shape = BoxOf(0.5, 0.5, 0.5), .position = {1, 0, 0}});
    for (const double x : {1.0, 1.5}) {
        FixedJointSettings joint = JointOf<FixedJointSettings>(hook, box, {x, 0, 0});
        joint.anchorB = JointAnchor{.point = {1, 0, 0}};
        world.Join(joint);
    }
    WatchDispute(run, world, box, 0.5);
}

// A door of 1 x 2 m on three hinges, the middle one 5 cm out of line.
void Door(LabRun& run) {
    LabWorld world(run);
    const BodyId hook = AddHook(world), door = world.Add({.shape = BoxOf(0.5, 1, 0.03), .position = {0.5, 0, 0}});
    for (const double y : {-0.8, 0.0, 0.8})
        world.Join(JointOf<HingeJointSettings>(hook, door, {0, y, y == 0 ? 0.05 : 0.0}, {0, 1, 0}));
    WatchDispute(run, world, door, 1);
}

// Bodies not involved are bit-identical with and without the conflict.
void Others(LabRun& run) {
    LabWorld world(run);
    world.AddFloor();
    const std::vector<BodyId> stack = AddStack(world, 3, 1, 0, run.random, {50, 0, 0});
    LabWorld twin(run);
    twin.AddFloor();
    const std::vector<BodyId> same = AddStack(twin, 3, 1, 0, run.random, {50, 0, 0});
    const BodyId hook = AddHook(world), box = world.Add({.shape = BoxOf(0.5, 0.5, 0.5), .position = {1, 5, 0}});
    for (const double x : {1.0, 1.5}) {
        FixedJointSettings joint = JointOf<FixedJointSettings>(hook, box, {x, 5, 0});
        joint.anchorB = JointAnchor{.point = {1, 5, 0}};
        world.Join(joint);
    }
    world.Steps(1);
    twin.Steps(1);
    double off = 0;
    for (size_t i = 0; i < stack.size(); ++i) off = std::max(off, (world.At(stack[i]) - twin.At(same[i])).norm());
    run.Error("others", off);
    run.Require(off == 0, "others have the same bits");
    run.Observe(off);
}

enum Kind { kHinge = 0, kFixed = 1, kCone0 = 2, kCone180 = 3 };

// A joint created far from where it holds, without gravity: how far from its limits it is after 5 s, rad.
void Singular(LabRun& run) {
    const Kind kind = static_cast<Kind>(static_cast<int>(run.parameter));
    LabWorld world(run, kNoGravity);
    const double turned = kind == kFixed ? kPi : kind == kHinge ? 3.0 : kPi / 2;
    const Vector3 about = kind == kHinge ? Vector3(1, 0, 0) : Vector3(0, 1, 0);
    const BodyId hook = AddHook(world);
    const BodyId box = world.Add({.shape = BoxOf(0.4, 0.1, 0.2), .rotation = RotationAbout(about, turned)});
    JointSettings frames;
    frames.bodyA = hook;
    frames.bodyB = box;
    frames.space = JointSpace::Body;
    frames.anchorA.normal = Vector3(0, 1, 0);
    frames.anchorB = frames.anchorA;
    JointId joint;
    if (kind == kFixed) joint = world.Join(Of<FixedJointSettings>(frames));
    if (kind == kHinge) {
        HingeJointSettings hinge = Of<HingeJointSettings>(frames);
        hinge.angle.limited = true;
        hinge.angle.limits = {-0.01f, 0.01f};
        joint = world.Join(hinge);
    }
    if (kind == kCone0 || kind == kCone180) {
        ConeJointSettings cone = Of<ConeJointSettings>(frames);
        cone.halfAngle = kind == kCone0 ? 0.0f : static_cast<float>(kPi);
        joint = world.Join(cone);
    }
    // From the frames: of fixed joints the whole turn, of cones that of the axes.
    const auto outside = [&] {
        const Quaternion a = world.Joints().GetFrameA(joint).rotation, b = world.Joints().GetFrameB(joint).rotation;
        if (kind == kHinge) return std::abs(world.Joints().GetCoordinate(joint, JointAxis::AngularX)) - 0.01;
        if (kind == kFixed) return 2 * std::asin(std::min(1.0, double((a.Conjugate() * b).Imaginary().norm())));
        const Position x = Rotate(a, Vector3(1, 0, 0)).cast<double>(), y = Rotate(b, Vector3(1, 0, 0)).cast<double>();
        return std::atan2(x.cross(y).norm(), x.dot(y)) - (kind == kCone0 ? 0.0 : kPi);
    };
    run.Figure("rad_at_first", outside());
    world.Steps(5);
    const double angle = std::max(0.0, outside());
    run.Error("angle_rad", angle);
    run.Error("gap", world.SumOfGaps());
    run.Require(angle < 0.01, "back within its limits in 5 s");
    run.Observe(angle);
}

LabScene Made(const char* variant, Kind kind) {
    return {.name = "singular",
            .variant = variant,
            .what = "a joint made 90 to 180 degrees outside its limits, no gravity, 5 s",
            .error = "rad outside its limits at the end",
            .parameter = static_cast<double>(kind),
            .influences = kJoints,
            .isExtreme = true,
            .testBound = 0.01,
            .run = Singular};
}

}  // namespace

std::vector<LabScene> DisputeScenes() {
    return {
        {.name = "contradictory",
         .variant = "fixed",
         .what = "two fixed joints that want a body half a meter apart",
         .error = "way of the body in the second half over half a meter",
         .influences = kJoints,
         .isExtreme = true,
         .testBound = 0.01,
         .run = TwoFixed},
        {.name = "contradictory",
         .variant = "door",
         .what = "a door on three hinges, one 5 cm out of line",
         .error = "way of the door in the second half over its width",
         .influences = kJoints,
         .isExtreme = true,
         .testBound = 0.01,
         .run = Door},
        {.name = "contradictory",
         .variant = "others",
         .what = "a stack beside a body that two fixed joints want half a meter apart",
         .error = "distance of the stack from one that is alone, m",
         .influences = {.contacts = true, .joints = true},
         .isExtreme = true,
         .testBound = 1e-12,
         .run = Others},
        Made("hinge", kHinge),
        Made("fixed", kFixed),
        Made("cone_0", kCone0),
        Made("cone_180", kCone180),
    };
}

}  // namespace fulcrum::accuracy
