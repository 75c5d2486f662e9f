// The energy in the springs of joints: k x^2 / 2 of the force law or of the frequency, and kept by what swings.
#include <Fulcrum/Samples/Scenes/JointShorthands.h>
#include <Fulcrum/Samples/Scenes/SpringEnergy.h>

#include <gtest/gtest.h>

#include <cmath>

namespace fulcrum {
namespace {

void NoGravity(SystemSettings& settings) {
    settings.gravity = Vector3::Zero();
    settings.solver.substeps = 16;
}

// A cube of 2 kg on a slider, drawn out by half a meter, on an undamped spring of 1 Hz.
void BuildSlider(SceneWorld& world) {
    const BodyId cube = world.Add({.shape = world.BoxOf(0.2f, 0.2f, 0.2f), .position = {0.5, 0, 0}, .mass = 2});
    auto slider = JointOfTwo<SliderJointSettings>(AddHook(world, {0, 3, 0}), cube, {0, 0, 0}, {0.5, 0, 0}, {1, 0, 0});
    slider.slide = Limited(0, 0, 1, 0);
    world.Join(slider);
}

// A rod of 3 kg and 2 m on a hinge at its end that turns at 2 rad/s into a soft limit at 0.5 rad: its inertia there is
// m l^2 / 3 and that of its thickness.
void BuildHinge(SceneWorld& world) {
    const BodyId rod = world.Add({.shape = world.BoxOf(1, 0.05f, 0.05f),
                                  .position = {1, 0, 0},
                                  .linearVelocity = {0, 2, 0},
                                  .angularVelocity = {0, 0, 2},
                                  .mass = 3});
    auto hinge = JointOf<HingeJointSettings>(AddHook(world, {0, 0, 0}), rod, {0, 0, 0}, {0, 0, 1});
    hinge.angle = Limited(-0.5f, 0.5f, 0.5f, 0);
    world.Join(hinge);
}

// Two balls of 1 and 3 kg, a meter farther apart than a spring of 40 N/m wants.
void BuildDistance(SceneWorld& world) {
    const ShapePtr ball = world.SphereOf(0.1f);
    const BodyId a = world.Add({.shape = ball, .mass = 1}),
                 b = world.Add({.shape = ball, .position = {3, 0, 0}, .mass = 3});
    auto spring = JointOfTwo<DistanceJointSettings>(a, b, {0, 0, 0}, {3, 0, 0});
    spring.minDistance = spring.maxDistance = 2.0f;
    spring.spring = {.mode = SpringMode::StiffnessAndDamping, .stiffness = 40};
    world.Join(spring);
}

struct Range {
    double lowest = 1e300, highest = -1e300, mostInSprings = 0;
};

// Of two seconds at 240 Hz.
Range RangeOf(void (*build)(SceneWorld&), double expectedAtStart) {
    const Scene scene{
        .name = "springs_of_a_test", .description = "a spring", .sleeping = false, .adjust = NoGravity, .build = build};
    auto world = SceneWorld::Create(scene);
    if (!world) {
        ADD_FAILURE() << world.GetError().message;
        return {};
    }
    const PhysicsSystem& system = world.Value()->System();
    EXPECT_NEAR(SpringEnergy(system), expectedAtStart, 1e-4 * std::max(1.0, expectedAtStart));
    Range range;
    for (int step = 0; step < 480; ++step) {
        EXPECT_TRUE(world.Value()->Step(1.0 / 240));
        range.lowest = std::min(range.lowest, TotalEnergy(system));
        range.highest = std::max(range.highest, TotalEnergy(system));
        range.mostInSprings = std::max(range.mostInSprings, SpringEnergy(system));
    }
    return range;
}

// Undamped springs keep the energy but for the damping of the implicit form, w h / 2: the force law's loses
// 1 - exp(-w^2 h t) = 2.7 % in two seconds, with w^2 = 40 / 0.75 and h = 1 / 3840 s.
void ExpectKept(void (*build)(SceneWorld&), double atStart, double total) {
    const Range range = RangeOf(build, atStart);
    EXPECT_NEAR(range.lowest, total, 0.03 * total);
    EXPECT_NEAR(range.highest, total, 0.03 * total);
    EXPECT_NEAR(range.mostInSprings, total, 0.03 * total);
}

TEST(SpringEnergy, OfAFrequencyIsThatOfTheMassOnIt) {
    const double omega = 2 * kPi, total = 0.5 * 2 * omega * omega * 0.25;
    ExpectKept(BuildSlider, total, total);
}

TEST(SpringEnergy, OfASoftStopTakesTheSpinOfTheRod) {
    const double inertia = 3 * (4.0 / 3 + 0.05 * 0.05 / 3), total = 0.5 * inertia * 4;
    ExpectKept(BuildHinge, 0, total);
}

TEST(SpringEnergy, OfAForceLawNeedsNoMass) { ExpectKept(BuildDistance, 20, 20); }

}  // namespace
}  // namespace fulcrum
