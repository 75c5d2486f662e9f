// Joints where things go wrong or far: frozen bodies, places far away, locked axes, mass ratios.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

namespace fulcrum::testing {
namespace {

// Rods of a meter on ball joints, from a hook at `origin` along x.
struct RodChain {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
};
RodChain AddRodChain(TestWorld& world, int count, const Position& origin = Position::Zero(),
                     LockedAxes locked = LockedAxes::None) {
    RodChain chain;
    chain.bodies.push_back(AddHook(world, origin));
    for (int i = 0; i < count; ++i) {
        chain.bodies.push_back(world.Add({.shape = BoxOf(0.45f, 0.05f, 0.05f),
                                          .position = origin + Position(i + 0.5, 0, 0),
                                          .mass = 1,
                                          .lockedAxes = locked,
                                          .maxLinearSpeed = 3e38f,
                                          .maxAngularSpeed = 3e38f}));
        chain.joints.push_back(
            Join(world, PointJointSettings{Between(chain.bodies[i], chain.bodies[i + 1], origin + Position(i, 0, 0))}));
    }
    return chain;
}
double LargestGap(TestWorld& world, const RodChain& chain) {
    double gap = 0;
    for (const JointId id : chain.joints) gap = std::max(gap, double(JointsOf(world).GetError(id).distance));
    return gap;
}

TEST(JointExtremes, NeighborsOfAFrozenBodyGoOn) {
    TestWorld world(NoSleep());
    const RodChain chain = AddRodChain(world, 5);
    world.Run(0.2);
    for (int i = 0; i < 2; ++i) {
        ASSERT_TRUE(world.Bodies().AddForce(chain.bodies[3], {3e38f, 3e38f, 0}));
    }
    world.Step();
    EXPECT_EQ(world.Report().frozenBodies, 1u);
    world.Run(3);
    EXPECT_TRUE(world.Bodies().IsFrozen(chain.bodies[3]));
    for (const size_t i : {1u, 2u, 4u, 5u}) {
        EXPECT_FALSE(world.Bodies().IsFrozen(chain.bodies[i]));
        EXPECT_TRUE(IsFinite(world.PositionOf(chain.bodies[i])));
    }
    EXPECT_LT(LargestGap(world, chain), 0.02);
    // Revived, it hangs in the chain again.
    ASSERT_TRUE(world.Bodies().SetPose(chain.bodies[3], world.PositionOf(chain.bodies[3]), {}));
    world.Run(5);
    EXPECT_LT(LargestGap(world, chain), 0.02);
    EXPECT_LT(world.PositionOf(chain.bodies[3]).y(), -1.4);
}

TEST(JointExtremes, AFrozenBodyHoldsLikeAStaticOne) {
    // A heavy chain is solved as a tree: the frozen body must leave it.
    TestWorld world(NoSleep());
    const BodyId hook = AddHook(world), rod = world.Add({.shape = CubeOf(0.1f), .position = {0, -1, 0}, .mass = 1});
    const BodyId ball = world.Add({.shape = SphereOf(0.2f), .position = {0, -2, 0}, .mass = 1000});
    Join(world, PointJointSettings{Between(hook, rod, {0, 0, 0})});
    const JointId lower = Join(world, PointJointSettings{Between(rod, ball, {0, -1, 0})});
    world.Run(0.5);
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(world.Bodies().AddForce(rod, {3e38f, 3e38f, 0}));
    world.Step();
    ASSERT_TRUE(world.Bodies().IsFrozen(rod));
    world.Run(2);
    EXPECT_LT(JointsOf(world).GetError(lower).distance, 1e-3f);
    EXPECT_NEAR(JointsOf(world).GetForce(lower).y(), 1000 * kGravity, 98.1);
    // What is joined to it later finds it at rest as well.
    const BodyId other = world.Add({.shape = CubeOf(0.1f), .position = {1, -1, 0}, .mass = 1});
    const JointId late = Join(world, PointJointSettings{Between(rod, other, {0.5, -1, 0})});
    world.Run(2);
    EXPECT_LT(JointsOf(world).GetError(late).distance, 5e-3f);
    EXPECT_TRUE(world.Bodies().IsFrozen(rod));
}

TEST(JointExtremes, AFrozenBodyThatSleepsStillHolds) {
    SystemSettings settings;
    settings.sleep.seconds = 0;
    TestWorld world(settings);
    const BodyId a = world.Add({.shape = CubeOf(0.1f), .position = {0, -1, 0}});
    const BodyId b = world.Add({.shape = CubeOf(0.1f), .position = {0, -2, 0}, .allowSleep = false});
    Join(world, PointJointSettings{Between(AddHook(world), a, {0, 0, 0})});
    const JointId joint = Join(world, PointJointSettings{Between(a, b, {0, -1, 0})});
    // One more that is kept from its sleep: islands are looked at in every step.
    const BodyId rests = world.Add({.shape = CubeOf(0.1f), .position = {9, 0, 0}, .gravityFactor = 0});
    const BodyId sleepless =
        world.Add({.shape = CubeOf(0.1f), .position = {10, 0, 0}, .gravityFactor = 0, .allowSleep = false});
    Join(world, FixedJointSettings{Between(rests, sleepless, {9.5, 0, 0})});
    world.Run(2);
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(world.Bodies().AddForce(a, {3e38f, 3e38f, 0}));
    world.Step();
    ASSERT_TRUE(world.Bodies().IsFrozen(a));
    world.Run(0.5);
    EXPECT_FALSE(world.Bodies().IsAwake(a));
    EXPECT_TRUE(world.Bodies().IsAwake(b));
    EXPECT_LT(JointsOf(world).GetError(joint).distance, 1e-3f);
}

TEST(JointExtremes, TimeStepsOfAnyLength) {
    TestWorld world(NoSleep());
    const RodChain chain = AddRodChain(world, 6);
    const double steps[] = {1.0 / 30, 1.0 / 240, 0, 1e-5, 1.0 / 60, 0.05, 1.0 / 120};
    for (int i = 0; i < 350; ++i) {
        world.Step(steps[i % 7]);
        ASSERT_TRUE(world.AllFinite()) << "step " << i;
        // In a twentieth of a second the end moves by half a meter: what that leaves apart is pulled together within
        // the next steps.
        ASSERT_LT(world.PositionOf(chain.bodies[6]).norm(), 9) << "step " << i;
    }
    world.Run(1);
    EXPECT_LT(LargestGap(world, chain), 0.02);
}

TEST(JointExtremes, AChainThatHangsStaysCalmWhateverTheTimeSteps) {
    // The impulses of a short step, scaled up to a long one, must not throw it about.
    for (const std::vector<double>& steps :
         {std::vector<double>{1.0 / 30, 1.0 / 240, 0, 1e-5, 1.0 / 60, 0.05, 1.0 / 120},
          {1.0 / 60, 1e-5},
          {0.05, 1.0 / 240}}) {
        TestWorld world(NoSleep());
        RodChain chain;
        chain.bodies.push_back(AddHook(world));
        for (int i = 0; i < 6; ++i) {
            chain.bodies.push_back(
                world.Add({.shape = BoxOf(0.05f, 0.45f, 0.05f), .position = {0, -i - 0.5, 0}, .mass = 1}));
            chain.joints.push_back(
                Join(world, PointJointSettings{Between(chain.bodies[i], chain.bodies[i + 1], {0, -1.0 * i, 0})}));
        }
        for (size_t i = 0; i < 350; ++i) {
            world.Step(steps[i % steps.size()]);
            // In 0.05 s the topmost joint falls by 1.2 cm. Where each long step begins with the impulses of one that is
            // a twelfth as long, what it leaves adds up to two and a half times that.
            ASSERT_LT(LargestGap(world, chain), 0.032) << "step " << i;
            ASSERT_NEAR(world.PositionOf(chain.bodies[6]).x(), 0, 1e-3) << "step " << i;
        }
    }
}

TEST(JointExtremes, AChainFarAwayMovesLikeTheOneAtTheOrigin) {
    for (const double far : {1e4, 1e7, 1e9}) {
        TestWorld here(NoSleep()), there(NoSleep());
        const Position origin(far, -far, 0.5 * far);
        const RodChain a = AddRodChain(here, 4), b = AddRodChain(there, 4, origin);
        here.Run(2);
        there.Run(2);
        // Doubles at 10^9 m have steps of 1.2e-7 m; a chain of four multiplies what differs by some hundred in two
        // seconds.
        const double tolerance = 1e-4 + far * 1.2e-16 * 1000;
        for (size_t i = 1; i < a.bodies.size(); ++i)
            EXPECT_LT((there.PositionOf(b.bodies[i]) - origin - here.PositionOf(a.bodies[i])).norm(), tolerance) << far;
    }
}

TEST(JointExtremes, LockedAxesStayLocked) {
    TestWorld world(NoSleep());
    const RodChain chain = AddRodChain(world, 4, Position::Zero(), LockedAxes::Plane2D);
    ASSERT_TRUE(world.Bodies().AddImpulse(chain.bodies[4], {0, 0, 5}));
    for (int i = 0; i < 180; ++i) {
        world.Step();
        for (size_t k = 1; k < chain.bodies.size(); ++k) ASSERT_NEAR(world.PositionOf(chain.bodies[k]).z(), 0, 1e-5);
        ASSERT_LT(LargestGap(world, chain), 0.01);
    }
}

TEST(JointExtremes, AWeightOfAThousandLinksHangsStill) {
    TestWorld world(NoSleep());
    BodyId last = AddHook(world);
    std::vector<JointId> joints;
    for (int i = 0; i <= 8; ++i) {
        const bool isWeight = i == 8;
        const BodyId next = world.Add({.shape = isWeight ? SphereOf(0.45f) : BoxOf(0.05f, 0.45f, 0.05f),
                                       .position = {0, -i - 0.5, 0},
                                       .mass = isWeight ? 1000.0f : 1.0f});
        joints.push_back(Join(world, PointJointSettings{Between(last, next, {0, -1.0 * i, 0})}));
        last = next;
    }
    world.Run(5);
    double gap = 0;
    for (const JointId id : joints) gap += double(JointsOf(world).GetError(id).distance);
    EXPECT_LT(gap, 0.01 * 9);
    EXPECT_LT(Length(world.VelocityOf(last)), 0.01f);
    EXPECT_NEAR(JointsOf(world).GetForce(joints[0]).y(), 1008 * kGravity, 0.01 * 1008 * kGravity);
}

TEST(JointExtremes, ManyJointsBetweenTheSameTwoBodies) {
    TestWorld world(NoSleep());
    const BodyId hook = AddHook(world), box = world.Add({.shape = CubeOf(0.5f), .position = {0, -1, 0}});
    for (int i = 0; i < 6; ++i) Join(world, FixedJointSettings{Between(hook, box, {0.1 * i, -0.5, 0})});
    world.Run(5);
    EXPECT_LT((world.PositionOf(box) - Position(0, -1, 0)).norm(), 1e-3);
    EXPECT_LT(Length(world.VelocityOf(box)), 1e-3f);
    // They share the weight.
    Vector3 sum = Vector3::Zero();
    JointsOf(world).VisitOf(box, [&](JointId id) { sum += JointsOf(world).GetForce(id); });
    EXPECT_NEAR(sum.y(), 1000 * kGravity, 0.01 * 9810);
}

}  // namespace
}  // namespace fulcrum::testing
