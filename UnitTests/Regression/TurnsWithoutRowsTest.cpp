// A hinge without limits, motor and friction has no rows. Solved in the lanes beside hinges that have some, it counted
// turns all the same, and kept how far its bodies had turned: what its coordinate was depended on the joints that
// happened to share a batch with it, and so on the number of lanes.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

double AngleAfterTurns(int othersWithMotors) {
    TestWorld world(NoGravity());
    const auto addHinge = [&](double place, const AxisControl& angle, float speed) {
        const BodyId base = world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Static, .position = {0, 0, place}});
        const BodyId wheel = world.Add({.shape = SphereOf(0.5f),
                                        .position = {0, 0, place},
                                        .angularVelocity = {speed, 0, 0},
                                        .allowSleep = false});
        HingeJointSettings hinge;
        hinge.bodyA = base;
        hinge.bodyB = wheel;
        hinge.anchorA.point = {0, 0, place};
        hinge.angle = angle;
        return world.System().Joints().Create(hinge).Value();
    };
    const JointId free = addHinge(0, {}, 10);
    AxisControl driven;
    driven.motor = {.mode = MotorMode::ToVelocity, .targetSpeed = 1};
    for (int i = 0; i < othersWithMotors; ++i) addHinge(3.0 * (i + 1), driven, 0);
    world.Steps(120);
    return world.System().Joints().GetCoordinate(free, JointAxis::AngularX);
}

TEST(TurnsWithoutRows, DoNotDependOnTheJointsBeside) {
    const double alone = AngleAfterTurns(0);
    for (const int others : {1, 3, 7}) EXPECT_EQ(AngleAfterTurns(others), alone) << others;
}

}  // namespace
}  // namespace fulcrum::testing
