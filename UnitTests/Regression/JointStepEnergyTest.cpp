// A joint that neither drives nor stores energy takes some away, whatever the velocities before: limits and friction
// are solved after the locks, as their effective masses assume. Solved before them they reacted to motion that the
// locks have yet to stop, with an impulse up to four times too large; between contacts iterations diverged: a ragdoll
// in a pile gained a hundred times its energy within a substep, the more the more iterations.
#include <Fulcrum/UnitTests/Support/RandomPoses.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {
namespace {

constexpr AxisControl kStiff{.friction = 1e9f};

template <class Settings>
Settings WithFriction();
template <>
HingeJointSettings WithFriction() {
    HingeJointSettings s;
    s.angle = kStiff;
    return s;
}
template <>
SliderJointSettings WithFriction() {
    SliderJointSettings s;
    s.slide = kStiff;
    return s;
}
template <>
SwingTwistJointSettings WithFriction() {
    SwingTwistJointSettings s;
    s.twist = s.swingY = s.swingZ = kStiff;
    return s;
}
template <>
SixDofJointSettings WithFriction() {
    SixDofJointSettings s;
    for (const JointAxis axis : {JointAxis::LinearX, JointAxis::LinearY, JointAxis::LinearZ})
        s[axis] = {.limited = true, .limits = {0, 0}};
    for (const JointAxis axis : {JointAxis::AngularX, JointAxis::AngularY, JointAxis::AngularZ}) s[axis] = kStiff;
    return s;
}

template <class Settings>
class JointStepEnergy : public ::testing::Test {};
using Kinds = ::testing::Types<HingeJointSettings, SliderJointSettings, SwingTwistJointSettings, SixDofJointSettings>;
TYPED_TEST_SUITE(JointStepEnergy, Kinds);

// A rod that is held at one end is hit there, so that its velocity violates the lock and the friction, and solved in a
// single iteration. It gained up to three times its energy.
TYPED_TEST(JointStepEnergy, IsNeverGained) {
    for (uint32_t seed = 0; seed < 200; ++seed) {
        RandomPoses random(seed);
        SystemSettings settings = NoGravity();
        settings.solver = {.substeps = 1, .velocityIterations = 1, .positionIterations = 0};
        settings.exactJointLoad = std::numeric_limits<float>::infinity();  // no trees
        TestWorld world(settings);
        const BodyId base = world.Add({.shape = CubeOf(0.1f), .motion = MotionType::Static});
        const BodyId rod = world.Add({.shape = CapsuleOf(0.5f, 0.05f), .position = {0, 0.5, 0}});
        TypeParam joint = WithFriction<TypeParam>();
        joint.bodyA = base;
        joint.bodyB = rod;
        ASSERT_TRUE(world.System().Joints().Create(joint));
        const Vector3 impulse = random.InBox(10);
        ASSERT_TRUE(world.Bodies().AddImpulse(rod, impulse));
        ASSERT_TRUE(world.Bodies().AddAngularImpulse(rod, Cross(Vector3(0, -0.5f, 0), impulse)));
        const double before = world.Bodies().GetKineticEnergy(rod);
        world.Step(1e-4);
        EXPECT_LE(world.Bodies().GetKineticEnergy(rod), before * 1.001) << "seed " << seed;
    }
}

}  // namespace
}  // namespace fulcrum::testing
