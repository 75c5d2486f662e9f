// A motor that was switched off kept the force of its last step, and began with it when it was switched on again,
// unless a joint with rows happened to be beside it in the lanes.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

namespace fulcrum::testing {
namespace {

TEST(MotorSwitchedOff, HasNoForceAndBeginsFromRest) {
    TestWorld world(Weightless());
    const BodyId wheel = world.Add({.shape = CubeOf(0.5f)});
    auto hinge = Of<HingeJointSettings>(Between(AddHook(world), wheel, {0, 0, 0}));
    hinge.angle.motor = SpeedMotor(5, 100);
    const JointId joint = Join(world, hinge);
    world.Steps(2);
    EXPECT_NEAR(JointsOf(world).GetAxisForces(joint, JointAxis::AngularX).motor, 100, 1e-3);
    ASSERT_TRUE(JointsOf(world).SetMotor(joint, JointAxis::AngularX, {}));
    world.Step();
    EXPECT_EQ(JointsOf(world).GetAxisForces(joint, JointAxis::AngularX).motor, 0);
    EXPECT_EQ(JointsOf(world).GetTorque(joint), Vector3(0, 0, 0));
    const Vector3 before = world.Bodies().GetAngularVelocity(wheel);
    // At the speed that it has there is nothing to do.
    ASSERT_TRUE(JointsOf(world).SetMotor(joint, JointAxis::AngularX, SpeedMotor(double(before.x()), 100)));
    world.Step();
    EXPECT_NEAR(Length(Vector3(world.Bodies().GetAngularVelocity(wheel) - before)), 0, 1e-6);
}

}  // namespace
}  // namespace fulcrum::testing
