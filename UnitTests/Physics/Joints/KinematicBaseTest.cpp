// Joints to bodies that move as they are told: loads on kinematic bases follow, and feel what a moving frame makes them
// feel.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// A base that moves at 3 m/s and turns at 2 rad/s about y.
struct Carousel {
    explicit Carousel(const SystemSettings& settings = NoSleep()) : world(settings) {
        base = world.Add({.shape = BoxOf(0.5f, 0.1f, 0.5f), .motion = MotionType::Kinematic});
    }
    void Step() {
        ++steps;
        const double time = steps * kStep;
        EXPECT_TRUE(world.Bodies().MoveKinematic(base, {3 * time, 0, 0}, RotationAbout({0, 1, 0}, 2 * time),
                                                 static_cast<float>(kStep)));
        world.Step();
    }

    TestWorld world;
    BodyId base;
    int steps = 0;
};

TEST(KinematicBase, AFixedLoadRidesAlong) {
    Carousel carousel;
    TestWorld& world = carousel.world;
    // On the circle from the start, so that nothing is thrown off: v = (3, 0, 0) + (0, 2, 0) x (1, 0, 0).
    const BodyId load = world.Add(
        {.shape = CubeOf(0.2f), .position = {1, 0, 0}, .linearVelocity = {3, 0, -2}, .angularVelocity = {0, 2, 0}});
    const JointId joint = Join(world, FixedJointSettings{Between(carousel.base, load, {0.5, 0, 0})});
    for (int i = 0; i < 300; ++i) {
        carousel.Step();
        ASSERT_LT(JointsOf(world).GetError(joint).distance, 2e-3f) << "step " << i;
        ASSERT_LT(JointsOf(world).GetError(joint).angle, 5e-3f) << "step " << i;
    }
    EXPECT_NEAR(world.Bodies().GetAngularVelocity(load).y(), 2, 0.01);
}

TEST(KinematicBase, AHingeThatMovesAndTurnsCarriesItsLoad) {
    Carousel carousel;
    TestWorld& world = carousel.world;
    // The axis points outwards, away from the carousel's own: the load hangs and is carried about.
    const BodyId load = world.Add({.shape = SphereOf(0.1f),
                                   .position = {0.5, -1, 0},
                                   .linearVelocity = {3, 0, -1},
                                   .angularVelocity = {0, 2, 0}});
    const JointId hinge = Join(world, HingeJointSettings{Between(carousel.base, load, {0.5, 0, 0}, {1, 0, 0})});
    for (int i = 0; i < 300; ++i) {
        carousel.Step();
        // A ball at the end of a 1 m arm has a hundredth of the inertia about the hinge: the rows of the point and of
        // the axis disturb each other.
        ASSERT_LT(JointsOf(world).GetError(hinge).distance, 7e-3f) << "step " << i;
        ASSERT_LT(JointsOf(world).GetError(hinge).angle, 7e-3f) << "step " << i;
        // In the plane of the hinge the centrifugal force is w^2 x, smaller than g / l: hanging is stable and it stays
        // there.
        ASSERT_LT(std::fabs(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX)), 0.05) << "step " << i;
    }
}

TEST(KinematicBase, AGovernorRisesToTheAngleOfItsSpeed) {
    // A ball on a hinge at the axis of a base that turns at w: cos(a) = g / (w^2 l).
    TestWorld world(NoSleep());
    const BodyId base =
        world.Add({.shape = SphereOf(0.05f), .motion = MotionType::Kinematic, .angularVelocity = {0, 5, 0}});
    const double cosine = kGravity / 25, angle = std::acos(cosine);
    const BodyId ball = world.Add({.shape = SphereOf(0.1f),
                                   .position = {std::sin(angle + 0.1), -std::cos(angle + 0.1), 0},
                                   .linearVelocity = {0, 0, static_cast<float>(-5 * std::sin(angle + 0.1))},
                                   .angularVelocity = {0, 5, 0}});
    HingeJointSettings settings{Between(base, ball, {0, 0, 0}, {0, 0, 1})};
    settings.angle.friction = 0.5f;  // N m on 4.2 kg: it settles up to friction / (m w^2 l^2 sin^2) = 0.6 % off
    Join(world, settings);
    world.Run(20);
    EXPECT_NEAR(-world.PositionOf(ball).y(), cosine, 0.01);
}

TEST(KinematicBase, ASliderOnALiftWeighsMoreWhileTheLiftRisesFaster) {
    TestWorld world(NoSleep());
    const BodyId lift = world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Kinematic});
    const BodyId load = world.Add({.shape = CubeOf(0.1f), .position = {1, 0, 0}, .mass = 10});
    const JointId slider = Join(world, SliderJointSettings{Between(lift, load, {1, 0, 0}, {0, 1, 0}),
                                                           Limited(0, 0, StiffnessSpring(1000, 200))});
    for (int i = 0; i < 240; ++i) {
        const double time = (i + 1) * kStep;
        ASSERT_TRUE(world.Bodies().MoveKinematic(lift, {0, 0.5 * 2 * time * time, 0}, {}, static_cast<float>(kStep)));
        world.Step();
    }
    EXPECT_NEAR(JointsOf(world).GetCoordinate(slider, JointAxis::LinearX), -10 * (kGravity + 2) / 1000, 0.01 * 0.118);
}

TEST(KinematicBase, StaticAndKinematicAtRestAreTheSame) {
    std::vector<Position> places;
    for (const MotionType motion : {MotionType::Static, MotionType::Kinematic}) {
        TestWorld world(NoSleep());
        const BodyId base = world.Add({.shape = SphereOf(0.05f), .motion = motion});
        const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0.5, 0, 0}});
        Join(world, HingeJointSettings{Between(base, rod, {0, 0, 0}, {0, 0, 1})});
        world.Run(3);
        places.push_back(world.PositionOf(rod));
    }
    EXPECT_LT((places[0] - places[1]).norm(), 1e-5);
}

TEST(KinematicBase, TheOrderOfTheBodiesDoesNotMatter) {
    std::vector<Position> places;
    for (const bool swapped : {false, true}) {
        TestWorld world(NoSleep());
        const BodyId base = AddHook(world),
                     rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0.5, 0, 0}});
        HingeJointSettings settings{swapped ? Between(rod, base, {0, 0, 0}, {0, 0, -1})
                                            : Between(base, rod, {0, 0, 0}, {0, 0, 1})};
        settings.angle = Limited(-1.2, 3);
        settings.angle.friction = 0.3f;
        Join(world, settings);
        world.Run(3);
        places.push_back(world.PositionOf(rod));
    }
    EXPECT_LT((places[0] - places[1]).norm(), 1e-3);
}

}  // namespace
}  // namespace fulcrum::testing
