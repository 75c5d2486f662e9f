// What joints cost and must not: no allocation while motors are driven, no effort for other islands, the same bits for
// any number of threads.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>

#include <cmath>
#include <limits>

namespace fulcrum::testing {
namespace {

// Many machines of every kind of joint, thrown together: chains, doors, pistons, ragged figures, gears, pulleys,
// springs.
class Machines {
public:
    Machines(TestWorld& world, int count) : world_(world) {
        world.AddFloor();
        for (int i = 0; i < count; ++i) AddMachine({4.0 * (i % 6), 6, 4.0 * (i / 6)}, i);
    }
    // Another target for every motor.
    void Drive(int step) {
        const double time = step * kStep;
        for (size_t i = 0; i < doors_.size(); ++i) {
            EXPECT_TRUE(JointsOf(world_).SetMotor(doors_[i], JointAxis::AngularX,
                                                  SpeedMotor(3 * std::sin(time + double(i)), 20)));
            EXPECT_TRUE(
                JointsOf(world_).SetMotor(pistons_[i], JointAxis::LinearX,
                                          PositionMotor(0.3 * std::sin(2 * time + double(i)), FrequencySpring(3, 1))));
            EXPECT_TRUE(
                JointsOf(world_).SetTargetOrientation(shoulders_[i], RotationAbout({0, 0, 1}, 0.5 * std::sin(time))));
            EXPECT_TRUE(
                JointsOf(world_).SetTargetOrientation(sixes_[i], RotationAbout({1, 0, 0}, 0.5 * std::sin(time))));
            EXPECT_TRUE(JointsOf(world_).SetMotor(sixes_[i], JointAxis::LinearX, SpeedMotor(0.1 * std::sin(time), 20)));
            EXPECT_TRUE(JointsOf(world_).SetMotor(wheels_[i], JointAxis::AngularX, SpeedMotor(5 * std::sin(time), 20)));
            EXPECT_TRUE(JointsOf(world_).SetMotor(wheels_[i], JointAxis::AngularY,
                                                  PositionMotor(0.3 * std::sin(time), FrequencySpring(3, 1))));
            EXPECT_TRUE(JointsOf(world_).SetMotor(beads_[i], JointAxis::LinearX, SpeedMotor(0.3 * std::sin(time), 20)));
            EXPECT_TRUE(JointsOf(world_).SetMotor(ropes_[i], JointAxis::LinearX,
                                                  PositionMotor(2 + 0.2 * std::sin(time), FrequencySpring(3, 1))));
            EXPECT_TRUE(
                JointsOf(world_).SetMotor(winches_[i], JointAxis::LinearX, SpeedMotor(0.2 * std::sin(time), 20)));
            EXPECT_TRUE(JointsOf(world_).SetLimits(doors_[i], JointAxis::AngularX,
                                                   JointLimits{-2, 1 + 0.1f * static_cast<float>(std::sin(time)), {}}));
            EXPECT_TRUE(JointsOf(world_).SetLimits(shoulders_[i], JointAxis::AngularX, JointLimits{-0.5f, 0.6f, {}}));
            EXPECT_TRUE(JointsOf(world_).SetFriction(doors_[i], JointAxis::AngularX,
                                                     0.5f + 0.1f * static_cast<float>(std::sin(time))));
        }
    }

private:
    BodyId AddBox(const Position& position) {
        return world_.Add({.shape = BoxOf(0.3f, 0.1f, 0.1f), .position = position});
    }
    void AddMachine(const Position& at, int number) {
        const BodyId hook = AddHook(world_, at);
        const BodyId arm = AddBox(at + Position(0.3, 0, 0)), hand = AddBox(at + Position(0.9, 0, 0)),
                     finger = AddBox(at + Position(1.5, 0, 0));
        HingeJointSettings door{Between(hook, arm, at, {0, 0, 1}), Limited(-2, 1)};
        door.angle.motor = SpeedMotor(1, 20);
        door.angle.friction = 0.5f;
        doors_.push_back(Join(world_, door));
        SwingTwistJointSettings shoulder{Between(arm, hand, at + Position(0.6, 0, 0))};
        shoulder.twist = Limited(-0.5, 0.5);
        shoulder.swingY = Limited(-0.8, 0.8);
        shoulder.swingZ = Limited(-0.4, 0.4);
        for (AxisControl* axis : {&shoulder.twist, &shoulder.swingY, &shoulder.swingZ})
            axis->motor = PositionMotor(0, FrequencySpring(3, 0.7));
        shoulders_.push_back(Join(world_, shoulder));
        if (number % 2) Join(world_, ConeJointSettings{Between(hand, finger, at + Position(1.2, 0, 0))});
        else Join(world_, FixedJointSettings{Between(hand, finger, at + Position(1.2, 0, 0))});
        const BodyId piston = AddBox(at + Position(0, 1, 0));
        SliderJointSettings slider{Between(hook, piston, at + Position(0, 1, 0), {0, 1, 0}), Limited(-0.4, 0.4)};
        slider.slide.motor = PositionMotor(0, FrequencySpring(3, 1));
        pistons_.push_back(Join(world_, slider));
        // A chain of ball joints down to the floor, a weight on a spring, and another one over a pulley.
        BodyId last = hook;
        for (int i = 0; i < 4; ++i) {
            const BodyId link =
                world_.Add({.shape = CapsuleOf(0.2f, 0.08f), .position = at + Position(0, -0.3 - 0.6 * i, 0)});
            Join(world_, PointJointSettings{Between(last, link, at + Position(0, -0.6 * i, 0))});
            last = link;
        }
        const BodyId ball = world_.Add({.shape = SphereOf(0.2f), .position = at + Position(-1, -1, 0)});
        const BodyId weight = world_.Add({.shape = SphereOf(0.25f), .position = at + Position(-1, -2, 0.5)});
        DistanceJointSettings spring{Between(hook, ball, at)};
        spring.anchorB = AnchorAt(at + Position(-1, -1, 0));
        spring.minDistance = spring.maxDistance = 1.2f;
        spring.spring = FrequencySpring(2, 0.2);
        Join(world_, spring);
        PulleyJointSettings pulley{Between(ball, weight, at + Position(-1, -1, 0))};
        pulley.anchorB = AnchorAt(at + Position(-1, -2, 0.5));
        pulley.fixedPointA = at + Position(-1, 2, 0);
        pulley.fixedPointB = at + Position(-1, 2, 0.5);
        Join(world_, pulley);
        AddWinch(hook, at);
        AddCart(hook, at);
        // Two gears.
        BodyId gears[2];
        for (int i = 0; i < 2; ++i) {
            const Position center = at + Position(i, 1, 1.5);
            gears[i] =
                world_.Add({.shape = SphereOf(0.3f), .position = center, .angularVelocity = {0, 0, i ? 3.0f : 0.0f}});
            Join(world_, HingeJointSettings{Between(hook, gears[i], center, {0, 0, 1})});
        }
        GearJointSettings gear{Between(gears[0], gears[1], at + Position(0, 1, 1.5), {0, 0, 1})};
        gear.anchorB = AnchorAt(at + Position(1, 1, 1.5), {0, 0, 1});
        gear.ratio = 2;
        Join(world_, gear);
        SixDofJointSettings six{Between(gears[0], AddBox(at + Position(0.3, 1, 2)), at + Position(0, 1, 2))};
        six[JointAxis::LinearX] = Limited(-0.1, 0.1);
        six[JointAxis::LinearY] = six[JointAxis::LinearZ] = kLockedAxis;
        six[JointAxis::AngularX] = Limited(-1, 1);
        six[JointAxis::AngularY] = Limited(-0.3, 0.3);
        six[JointAxis::AngularZ] = Limited(-0.3, 0.3);
        for (AxisControl& axis : six.axes) axis.motor = PositionMotor(0, FrequencySpring(3, 1));
        six[JointAxis::LinearX].motor = SpeedMotor(0.1, 20);
        sixes_.push_back(Join(world_, six));
    }
    // A weight on a driven rope, and two on one that is wound.
    void AddWinch(BodyId hook, const Position& at) {
        const BodyId load = world_.Add({.shape = SphereOf(0.2f), .position = at + Position(1.5, -2, 1)});
        DistanceJointSettings rope{Between(hook, load, at + Position(1.5, 0, 1))};
        rope.anchorB = AnchorAt(at + Position(1.5, -2, 1));
        rope.maxDistance = 3.0f;
        ropes_.push_back(Join(world_, rope));
        const BodyId left = world_.Add({.shape = SphereOf(0.2f), .position = at + Position(2.2, -1, 1)});
        const BodyId right = world_.Add({.shape = SphereOf(0.2f), .position = at + Position(2.2, -1, 2)});
        PulleyJointSettings pulley{Between(left, right, at + Position(2.2, -1, 1))};
        pulley.anchorB = AnchorAt(at + Position(2.2, -1, 2));
        pulley.fixedPointA = at + Position(2.2, 1, 1);
        pulley.fixedPointB = at + Position(2.2, 1, 2);
        winches_.push_back(Join(world_, pulley));
    }
    // A steered wheel, and a bead on a wire.
    void AddCart(BodyId hook, const Position& at) {
        const BodyId wheel = world_.Add({.shape = SphereOf(0.2f), .position = at + Position(2.9, -1, 1)});
        WheelJointSettings settings = Of<WheelJointSettings>(Between(hook, wheel, at + Position(2.9, -1, 1)));
        settings.anchorA.normal = Vector3(0, 1, 0);
        settings.isSteered = true;
        settings.spin.motor = SpeedMotor(5, 20);
        wheels_.push_back(Join(world_, settings));
        const BodyId bead = world_.Add({.shape = SphereOf(0.1f), .position = at + Position(2.9, 0.5, 1)});
        PathJointSettings wire{Between(hook, bead, at + Position(2.9, 0.5, 1), {0, 1, 0})};
        wire.along.motor = SpeedMotor(0.3, 20);
        beads_.push_back(Join(world_, wire));
    }

    TestWorld& world_;
    std::vector<JointId> doors_, pistons_, shoulders_, sixes_, ropes_, winches_, wheels_, beads_;
};

TEST(JointDeterminism, TheSameBitsForAnyNumberOfThreads) {
    // One large island too: a curtain of ball joints.
    const auto run = [](uint32_t threads) {
        TestWorld world({}, threads);
        Machines machines(world, 24);
        constexpr int kSide = 24;
        std::vector<BodyId> balls;
        for (int k = 0; k < kSide; ++k)
            for (int i = 0; i < kSide; ++i) {
                const Position place(30 + k, 30 - i, 0);
                balls.push_back(world.Add({.shape = SphereOf(0.3f),
                                           .motion = i == 0 ? MotionType::Static : MotionType::Dynamic,
                                           .position = place,
                                           .linearVelocity = {0, 0, i == 0 ? 0 : static_cast<float>(k % 5)}}));
                const size_t last = balls.size() - 1;
                if (i > 0)
                    Join(world, PointJointSettings{Between(balls[last - 1], balls[last], place + Position(0, 0.5, 0))});
                if (i > 0 && k > 0)
                    Join(world,
                         PointJointSettings{Between(balls[last - kSide], balls[last], place - Position(0.5, 0, 0))});
            }
        std::vector<uint64_t> hashes;
        for (int step = 0; step < 120; ++step) {
            machines.Drive(step);
            world.Step();
            if (step % 10 == 9) hashes.push_back(world.System().HashPoses());
        }
        EXPECT_TRUE(world.AllFinite());
        return hashes;
    };
    const std::vector<uint64_t> one = run(1);
    EXPECT_EQ(run(1), one);
    EXPECT_EQ(run(2), one);
    EXPECT_EQ(run(4), one);
}

TEST(JointCost, ASettledStepOfRunningMotorsAllocatesNothing) {
    for (const uint32_t threads : {1u, 2u}) {
        TestWorld world(NoSleep(), threads);
        Machines machines(world, 12);
        // Buffers grow until the machines have been in all their states.
        for (int step = 0; step < 600; ++step) {
            machines.Drive(step);
            world.Step();
        }
        const uint64_t before = AllocationCount();
        for (int step = 600; step < 700; ++step) {
            machines.Drive(step);
            if (!world.System().Update(kStep)) ADD_FAILURE();
        }
        EXPECT_EQ(AllocationCount() - before, 0u) << threads << " threads";
    }
}

// A chain of eight rods that falls, with a ball of fifty times a rod's mass at its end.
struct Chain {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
};
Chain AddChain(TestWorld& world, double z) {
    Chain chain;
    chain.bodies.push_back(AddHook(world, {0, 0, z}));
    for (int i = 0; i < 9; ++i) {
        const Position place(i + 0.5, 0, z);
        const bool isRod = i < 8;
        chain.bodies.push_back(world.Add({.shape = isRod ? BoxOf(0.45f, 0.05f, 0.05f) : SphereOf(0.3f),
                                          .position = place,
                                          .mass = isRod ? 1.0f : 50.0f}));
        chain.joints.push_back(
            Join(world, PointJointSettings{Between(chain.bodies[i], chain.bodies[i + 1], {double(i), 0, z})}));
    }
    return chain;
}
double LargestGap(TestWorld& world, const Chain& chain) {
    double gap = 0;
    for (const JointId id : chain.joints) gap = std::max(gap, double(JointsOf(world).GetError(id).distance));
    return gap;
}

TEST(JointEffort, OfOneJointRaisesItsIslandAlone) {
    std::vector<BodyBits> others, own;
    std::vector<double> gaps;
    for (const bool raised : {false, true}) {
        SystemSettings settings = NoSleep();
        settings.exactJointLoad = std::numeric_limits<float>::infinity();
        TestWorld world(settings);
        const Chain left = AddChain(world, 0), right = AddChain(world, 20);
        if (raised) {
            ASSERT_TRUE(JointsOf(world).SetEffort(left.joints[3], {16, 4, 1}));
        }
        double gap = 0;
        for (int i = 0; i < 120; ++i) {
            world.Step();
            gap = std::max(gap, LargestGap(world, left));
        }
        gaps.push_back(gap);
        own.push_back(BitsOf(world, left.bodies.back()));
        others.push_back(BitsOf(world, right.bodies.back()));
    }
    EXPECT_EQ(others[0], others[1]);
    EXPECT_NE(own[0], own[1]);
    EXPECT_LT(gaps[1], 0.5 * gaps[0]);
}

TEST(JointEffort, InTheSettingsIsTheSameAsSetLater) {
    std::vector<BodyBits> bits;
    for (const bool later : {false, true}) {
        TestWorld world(NoSleep());
        const BodyId box = world.Add({.shape = CubeOf(0.2f), .position = {1, 0, 0}});
        PointJointSettings settings{Between(AddHook(world), box, {0, 0, 0})};
        if (!later) settings.substeps = 12;
        const JointId joint = Join(world, settings);
        if (later) {
            ASSERT_TRUE(JointsOf(world).SetEffort(joint, {12, 0, 0}));
        }
        world.Run(1);
        bits.push_back(BitsOf(world, box));
    }
    EXPECT_EQ(bits[0], bits[1]);
}

TEST(JointEffort, MayBeTakenBack) {
    TestWorld plain(NoSleep()), changed(NoSleep());
    const Chain a = AddChain(plain, 0), b = AddChain(changed, 0);
    ASSERT_TRUE(JointsOf(changed).SetEffort(b.joints[0], {32, 8, 2}));
    ASSERT_TRUE(JointsOf(changed).SetEffort(b.joints[0], {0, 0, 0}));
    plain.Run(1);
    changed.Run(1);
    EXPECT_EQ(BitsOf(plain, a.bodies.back()), BitsOf(changed, b.bodies.back()));
}

TEST(JointOverflow, AHubOfManyJointsStaysTogether) {
    // More joints at one body than there are colors.
    TestWorld world(NoSleep());
    const BodyId hub = world.Add({.shape = SphereOf(1), .mass = 500});
    Join(world, FixedJointSettings{Between(AddHook(world), hub, {0, 0, 0})});
    std::vector<JointId> joints;
    for (int i = 0; i < 80; ++i) {
        const double angle = i * 2 * kPi / 80;
        const Vector3 out(static_cast<float>(std::cos(angle)), 0, static_cast<float>(std::sin(angle)));
        const BodyId spoke = world.Add({.shape = SphereOf(0.02f), .position = 1.5 * out.cast<double>(), .mass = 1});
        joints.push_back(Join(world, FixedJointSettings{Between(hub, spoke, 1.0 * out.cast<double>())}));
    }
    world.Run(5);
    EXPECT_TRUE(world.AllFinite());
    for (const JointId id : joints) EXPECT_LT(JointsOf(world).GetError(id).distance, 2e-3f);
    EXPECT_LT(Length(world.VelocityOf(hub)), 0.01f);
}

}  // namespace
}  // namespace fulcrum::testing
