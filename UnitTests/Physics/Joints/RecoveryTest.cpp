// Joints made meters or half a turn out of place pull together without an explosion, on any kind of body.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

// jointPushSpeed, the fastest pull, 20 m/s and 20 rad/s; a body that is turned about an anchor half a meter off moves
// faster by half of that, and two pulls may add up.
constexpr float kFastest = 65;

struct Pair {
    explicit Pair(MotionType motionOfA, const SystemSettings& settings = NoGravity()) : world(settings) {
        a = world.Add({.shape = BoxOf(0.5f, 0.2f, 0.1f), .motion = motionOfA});
        b = world.Add({.shape = BoxOf(0.5f, 0.2f, 0.1f), .position = {1, 0, 0}});
    }
    // The joint holds B's left end at A's right end, B turned by `turn` against that and moved by `away`.
    template <class Settings>
    void MakeOutOfPlace(const Quaternion& turn, const Position& away) {
        ASSERT_TRUE(world.Bodies().SetPose(b, Position(1, 0, 0) + away, turn));
        Settings settings;
        settings.bodyA = a;
        settings.bodyB = b;
        settings.space = JointSpace::Body;
        settings.anchorA = AnchorAt({0.5, 0, 0}, {0, 0, 1});
        settings.anchorB = AnchorAt({-0.5, 0, 0}, {0, 0, 1});
        settings.anchorA.normal = settings.anchorB->normal = Vector3(1, 0, 0);
        joint = Join(world, settings);
    }
    void ExpectRecovery(double seconds = 5) {
        float fastest = 0;
        for (int i = 0; i < seconds / kStep; ++i) {
            world.Step();
            for (const BodyId id : {a, b})
                fastest =
                    std::max({fastest, Length(world.VelocityOf(id)), Length(world.Bodies().GetAngularVelocity(id))});
        }
        const JointError error = JointsOf(world).GetError(joint);
        // Of what still turns, a substep leaves the arc of half a meter by r (w h)^2 / 2, and the push takes back 0.37
        // of a gap.
        float spin = 0;
        for (const BodyId id : {a, b})
            spin = std::max(spin, Length(world.Bodies().GetAngularVelocity(id)) * static_cast<float>(kStep / 4));
        EXPECT_LT(error.distance, 1e-3f + 0.25f / 0.37f * spin * spin);
        EXPECT_LT(error.angle, 2e-3f);
        EXPECT_LT(fastest, kFastest);
        EXPECT_TRUE(world.AllFinite());
    }

    TestWorld world;
    BodyId a, b;
    JointId joint;
};

class Recovery : public ::testing::TestWithParam<MotionType> {};
INSTANTIATE_TEST_SUITE_P(OfA, Recovery,
                         ::testing::Values(MotionType::Static, MotionType::Kinematic, MotionType::Dynamic),
                         [](const auto& motion) {
                             return motion.param == MotionType::Static      ? "Static"
                                    : motion.param == MotionType::Kinematic ? "Kinematic"
                                                                            : "Dynamic";
                         });

const Position kHere(0, 0, 0);
const Position kAway[] = {{0, 0.5, 0}, {3, -2, 5}, {-30, 0, 0}, {0, 0, 200}};
const Vector3 kAxes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.6f, 0, 0.8f}};

TEST_P(Recovery, AHingeHalfATurnOutOfPlace) {
    for (const Vector3& axis : {kAxes[0], kAxes[1], kAxes[2]}) {
        Pair pair(GetParam());
        pair.MakeOutOfPlace<HingeJointSettings>(RotationAbout(axis, kPi), kHere);
        pair.ExpectRecovery();
    }
}

TEST_P(Recovery, AFixedJointHalfATurnOutOfPlace) {
    for (const Vector3& axis : kAxes) {
        Pair pair(GetParam());
        pair.MakeOutOfPlace<FixedJointSettings>(RotationAbout(axis, kPi), kHere);
        pair.ExpectRecovery();
    }
}

TEST_P(Recovery, ASliderHalfATurnOutOfPlace) {
    for (const Vector3& axis : kAxes) {
        Pair pair(GetParam());
        pair.MakeOutOfPlace<SliderJointSettings>(RotationAbout(axis, kPi), {0.4, 0.6, 0});
        pair.ExpectRecovery();
    }
}

TEST(RecoveryFromAfar, JointsToTheWorldMetersOutOfPlace) {
    for (const MotionType motion : {MotionType::Static, MotionType::Kinematic})
        for (const Position& away : kAway) {
            // At 20 m/s.
            const double seconds = 5 + away.norm() / 20;
            // They may sleep, but not before they are there.
            Pair fixed(motion), hinge(motion), slider(motion);
            fixed.MakeOutOfPlace<FixedJointSettings>(RotationAbout({0, 1, 0}, 1), away);
            fixed.ExpectRecovery(seconds);
            hinge.MakeOutOfPlace<HingeJointSettings>(RotationAbout({0, 1, 0}, -2), away);
            hinge.ExpectRecovery(seconds);
            slider.MakeOutOfPlace<SliderJointSettings>(RotationAbout({1, 0, 0}, 2), away);
            slider.ExpectRecovery(seconds);
        }
}

TEST(RecoveryOfLimits, NarrowHingeLimitsHalfATurnAway) {
    for (const double start : {kPi, -kPi, 3.0, -1.0}) {
        TestWorld world(NoGravity());
        const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f),
                                      .position = {0.5 * std::cos(start), 0.5 * std::sin(start), 0},
                                      .rotation = RotationAbout({0, 0, 1}, start)});
        HingeJointSettings settings{Between(AddHook(world), rod, {0, 0, 0}, {0, 0, 1}), Limited(-0.01, 0.01)};
        settings.anchorA.normal = Vector3(1, 0, 0);
        settings.anchorB = AnchorAt({0, 0, 0}, {0, 0, 1});
        settings.anchorB->normal = Vector3(static_cast<float>(std::cos(start)), static_cast<float>(std::sin(start)), 0);
        const JointId hinge = Join(world, settings);
        float fastest = 0;
        for (int i = 0; i < 300; ++i) {
            world.Step();
            fastest = std::max(fastest, Length(world.Bodies().GetAngularVelocity(rod)));
        }
        EXPECT_LT(std::fabs(JointsOf(world).GetCoordinate(hinge, JointAxis::AngularX)), 0.01 + 1e-3) << start;
        EXPECT_LT(fastest, kFastest);
        // The pull leaves no speed behind.
        EXPECT_LT(Length(world.Bodies().GetAngularVelocity(rod)), 0.05f);
    }
}

TEST(RecoveryOfLimits, SliderAndConeAndDistanceFarBeyondTheirLimits) {
    TestWorld world(Weightless());
    const BodyId hook = AddHook(world);
    const BodyId box = world.Add({.shape = CubeOf(0.1f), .position = {4, 0, 0}});
    const BodyId rod = world.Add({.shape = BoxOf(0.5f, 0.05f, 0.05f), .position = {0, 5, 0}});
    const BodyId ball = world.Add({.shape = SphereOf(0.1f), .position = {0, -9, 0}});
    SliderJointSettings slide{Between(hook, box, {0, 0, 0}), Limited(-0.5, 0.5)};
    slide.anchorB = AnchorAt({4, 0, 0});
    const JointId slider = Join(world, slide);
    ConeJointSettings swing{Between(hook, rod, {0, 5, 0})};
    swing.anchorB = AnchorAt({0, 5, 0}, {-1, 0, 0});
    swing.halfAngle = 0.2f;
    const JointId cone = Join(world, swing);
    DistanceJointSettings tie{Between(hook, ball, {0, 0, 0})};
    tie.anchorB = AnchorAt({0, -9, 0});
    tie.maxDistance = 1.0f;
    const JointId rope = Join(world, tie);
    world.Run(5);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(slider, JointAxis::LinearX), 0.5, 1e-3);
    EXPECT_LT(JointsOf(world).GetCoordinate(cone, JointAxis::AngularY), 0.2 + 1e-3);
    EXPECT_NEAR(JointsOf(world).GetCoordinate(rope, JointAxis::LinearX), 1, 1e-3);
    for (const BodyId id : {box, rod, ball}) {
        EXPECT_LT(Length(world.VelocityOf(id)), 0.05f);
        EXPECT_LT(Length(world.Bodies().GetAngularVelocity(id)), 0.05f);
    }
}

TEST(Contradiction, TwoFixedJointsThatDisagreeShareTheErrorAndStayCalm) {
    TestWorld world(NoSleep());
    const BodyId hook = AddHook(world), bystander = world.Add({.shape = SphereOf(0.1f), .position = {9, 0, 0}});
    const BodyId box = world.Add({.shape = CubeOf(0.2f), .position = {0, -1, 0}});
    Join(world, FixedJointSettings{Between(hook, box, {0, 0, 0})});
    FixedJointSettings other{Between(hook, box, {0, 0, 0})};
    other.anchorB = AnchorAt({0.1, 0, 0});
    Join(world, other);
    world.Run(10);
    EXPECT_NEAR(world.PositionOf(box).x(), -0.05, 0.05 + 1e-3);
    EXPECT_LT(Length(world.VelocityOf(box)), 0.5f);
    EXPECT_LT(Length(world.Bodies().GetAngularVelocity(box)), 0.5f);
    // What is not joined falls as if alone.
    EXPECT_NEAR(world.PositionOf(bystander).y(), -0.5 * kGravity * 100, 1e-2);
}

// In whichever order the two were made: the joint that is solved last has its way more than the other, and where the
// other one is far apart for that, altogether. Both pull at what can move: a joint to a hook would count as high.
TEST(Contradiction, TheJointOfHigherPriorityWins) {
    for (const bool highFirst : {true, false}) {
        TestWorld world(NoGravity());
        const BodyId rock = world.Add({.shape = SphereOf(0.01f), .mass = 1e6f}),
                     box = world.Add({.shape = CubeOf(0.2f)});
        for (const bool high : {highFirst, !highFirst}) {
            PointJointSettings settings{Between(rock, box, {high ? 0.1 : -0.1, 0, 0})};
            settings.anchorB = AnchorAt({0, 0, 0});
            settings.priority = high ? JointPriority::High : JointPriority::Normal;
            Join(world, settings);
        }
        world.Step();
        for (int i = 0; i < 60; ++i) {
            EXPECT_NEAR(world.PositionOf(box).x(), 0.1, 1e-4) << highFirst << " " << i;
            world.Step();
        }
    }
}

}  // namespace
}  // namespace fulcrum::testing
