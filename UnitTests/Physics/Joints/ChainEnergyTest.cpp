// Chains that swing: they never gain energy, and what turns fast about its own axis stays together.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cmath>
#include <limits>

namespace fulcrum::testing {
namespace {

double LargestGap(TestWorld& world, const std::vector<JointId>& joints) {
    double gap = 0;
    for (const JointId id : joints) gap = std::max(gap, double(JointsOf(world).GetError(id).distance));
    return gap;
}

TEST(ChainEnergy, RodsOnBallJointsGainNone) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120}) {
        for (const int count : {1, 2, 3, 4, 6}) {
            TestWorld world(NoSleep());
            BodyId last = AddHook(world);
            std::vector<JointId> joints;
            for (int i = 0; i < count; ++i) {
                const BodyId next =
                    world.Add({.shape = BoxOf(0.45f, 0.05f, 0.05f), .position = {i + 0.5, 0, 0}, .mass = 1});
                joints.push_back(Join(world, PointJointSettings{Between(last, next, {1.0 * i, 0, 0})}));
                last = next;
            }
            const double start = world.System().GetEnergy(), falls = kGravity * count * count / 2;
            double highest = start, gap = 0;
            for (int i = 0; i < 10 / dt; ++i) {
                world.Step(dt);
                highest = std::max(highest, world.System().GetEnergy());
                gap = std::max(gap, LargestGap(world, joints));
            }
            // Within a swing the energy wavers with h w, h being the substep: 1.6, 0.8 and 0.4 % of what falls.
            EXPECT_LT(highest - start, 0.45 * dt * falls) << count << " rods, dt " << dt;
            EXPECT_LT(gap, 0.01 + 0.9 * dt) << count << " rods, dt " << dt;
        }
    }
}

// A ball of up to 3 10^5 times the mass of the links, which sway under its weight many times in a substep.
TEST(ChainEnergy, LightLinksCarryAnyLoadAtAnyTimeStep) {
    for (const float mass : {1e4f, 3e5f})
        for (const double dt : {1.0 / 60, 1.0 / 240, 1.0 / 300}) {
            TestWorld world(NoSleep());
            BodyId last = AddHook(world);
            std::vector<JointId> joints;
            for (int i = 0; i <= 16; ++i) {
                const bool isBall = i == 16;
                const BodyId next = world.Add({.shape = isBall ? SphereOf(0.4f) : BoxOf(0.45f, 0.05f, 0.05f),
                                               .position = {i + 0.5, 0, 0},
                                               .mass = isBall ? mass : 1,
                                               .mask = 0});
                joints.push_back(Join(world, PointJointSettings{Between(last, next, {1.0 * i, 0, 0})}));
                last = next;
            }
            double gap = 0;
            for (int i = 0; i < 2.5 / dt; ++i) {
                world.Step(dt);
                gap = std::max(gap, LargestGap(world, joints));
            }
            EXPECT_LT(gap, 1e-3) << mass << " kg, dt " << dt;
            // It has swung to the other side of its lowest place.
            EXPECT_LT(world.PositionOf(last).x(), 2) << mass << " kg, dt " << dt;
        }
}

// The joints are off the axes of the links, whose inertia about these is 1/40 of the others: a tension of tons spins
// them fast. What substeps do not resolve of that, the stiffness of the joints' arms damps.
void HangLinksBesideTheirAxes(int substeps, double mostChange) {
    for (const double aside : {0.001, 0.01, 0.03}) {
        SystemSettings settings = NoSleep();
        settings.solver.substeps = substeps;
        settings.layerCollides[1] &= ~2u;
        TestWorld world(settings);
        BodyId last =
            world.Add({.shape = SphereOf(0.01f), .motion = MotionType::Static, .position = {0, 0, aside}, .layer = 1});
        std::vector<JointId> joints;
        for (int i = 0; i <= 6; ++i) {
            const BodyId next = world.Add({.shape = i == 6 ? SphereOf(0.4f) : BoxOf(0.23f, 0.05f, 0.05f),
                                           .position = {0.5 * i + 0.25, 0, 0},
                                           .mass = i == 6 ? 100.0f : 1.0f,
                                           .layer = 1});
            joints.push_back(Join(world, PointJointSettings{Between(last, next, {0.5 * i, 0, aside})}));
            last = next;
        }
        const double start = world.System().GetEnergy(), falls = 100 * kGravity * 3.25;
        double gap = 0, change = 0;
        for (int i = 0; i < 120; ++i) {
            world.Step();
            gap = std::max(gap, LargestGap(world, joints));
            change = std::max(change, std::fabs(world.System().GetEnergy() - start) / falls);
        }
        EXPECT_LT(gap, 1e-4) << aside;
        EXPECT_LT(change, mostChange) << aside;
    }
}
TEST(ChainEnergy, LinksHungUpBesideTheirAxesUnderAHeavyLoad) {
    HangLinksBesideTheirAxes(4, 0.03);
    HangLinksBesideTheirAxes(9, 2e-3);
}

// Rods that hang from a hook, let go at 30 degrees.
struct Rope {
    BodyBits end;
    double gap = 0;
};
Rope SwingRope(int count, float exactJointLoad) {
    SystemSettings settings = NoSleep();
    settings.exactJointLoad = exactJointLoad;
    settings.layerCollides[1] &= ~2u;
    TestWorld world(settings);
    BodyId last = world.Add({.shape = SphereOf(0.01f), .motion = MotionType::Static, .layer = 1});
    std::vector<JointId> joints;
    const Position along(0.5 * std::sin(kPi / 6), -0.5 * std::cos(kPi / 6), 0);
    for (int i = 0; i < count; ++i) {
        const BodyId next = world.Add({.shape = BoxOf(0.05f, 0.23f, 0.05f),
                                       .position = along * (i + 0.5),
                                       .rotation = RotationAbout({0, 0, 1}, kPi / 6),
                                       .mass = 1,
                                       .layer = 1});
        joints.push_back(Join(world, PointJointSettings{Between(last, next, along * double(i))}));
        last = next;
    }
    Rope rope;
    for (int i = 0; i < 180; ++i) {
        world.Step();
        rope.gap = std::max(rope.gap, LargestGap(world, joints));
    }
    rope.end = BitsOf(world, last);
    return rope;
}

TEST(ChainEnergy, RopesAreTreesOnlyWhereMoreSubstepsWouldStretchThem) {
    const float never = std::numeric_limits<float>::infinity(), usual = SystemSettings{}.exactJointLoad;
    for (const int count : {10, 20}) {
        const Rope rope = SwingRope(count, usual);
        EXPECT_EQ(rope.end, SwingRope(count, never).end) << count;
        EXPECT_LT(rope.gap, 6e-3) << count;
    }
    // Longer ones have more substeps, up to three times as many,
    EXPECT_LT(SwingRope(50, usual).gap, 6e-3);
    EXPECT_GT(SwingRope(50, never).gap, 8e-3);
    // and where that is not enough they are trees.
    EXPECT_LT(SwingRope(200, usual).gap, 5e-3);
    EXPECT_GT(SwingRope(200, never).gap, 3e-2);
}

}  // namespace
}  // namespace fulcrum::testing
