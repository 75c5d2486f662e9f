// AccuracyTarget::jointError: mechanisms whose joints exceed it are solved directly.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <algorithm>
#include <limits>

namespace fulcrum::testing {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

SystemSettings With(float jointError) {
    SystemSettings settings = NoSleep();
    settings.accuracy.jointError = jointError;
    return settings;
}

// 16 planks on hinges between two posts, a weight on the middle, damped so that it comes to rest; boxes that lie beside
// it.
struct Bridge {
    explicit Bridge(float jointError, float weight = 200, uint32_t threads = 1) : world(With(jointError), threads) {
        world.AddFloor();
        BodyId last = AddHook(world, {-4, 4, 0});
        for (int i = 0; i < 16; ++i) {
            const double x = -3.75 + 0.5 * i;
            const BodyId plank = world.Add({.shape = BoxOf(0.24f, 0.06f, 1),
                                            .position = {x, 4, 0},
                                            .mass = 20,
                                            .linearDamping = 1,
                                            .angularDamping = 1});
            joints.push_back(Join(world, Of<HingeJointSettings>(Between(last, plank, {x - 0.25, 4, 0}, {0, 0, 1}))));
            last = plank;
        }
        joints.push_back(
            Join(world, Of<HingeJointSettings>(Between(last, AddHook(world, {4, 4, 0}), {4, 4, 0}, {0, 0, 1}))));
        load = world.Add({.shape = CubeOf(0.3f), .position = {0, 4.5, 0}, .mass = weight});
        for (int i = 0; i < 10; ++i) world.Add({.shape = CubeOf(0.5f), .position = {1.5 * i, 0.5, 5}});
    }
    double LargestGap() {
        double largest = 0;
        for (const JointId id : joints) largest = std::max(largest, double{JointsOf(world).GetError(id).distance});
        return largest;
    }
    TestWorld world;
    BodyId load;
    std::vector<JointId> joints;
};

// What a taut chain is parted by as it falls into its curve closes, slowly.
TEST(JointAccuracy, ABridgeClosesItsGaps) {
    for (const float target : {kInfinity, 0.002f}) {
        Bridge bridge(target);
        bridge.world.Run(7);
        const double gap = bridge.LargestGap();
        EXPECT_LT(gap, 0.03) << target;
        bridge.world.Run(7);
        EXPECT_LT(bridge.LargestGap(), 0.9 * gap) << target;
    }
}

TEST(JointAccuracy, SameBitsOnAnyNumberOfThreads) {
    Bridge one(0.0005f), two(0.0005f, 200, 2);
    for (int step = 0; step < 240; ++step) {
        one.world.Step();
        two.world.Step();
        ASSERT_EQ(one.world.System().HashPoses(), two.world.System().HashPoses()) << step;
    }
}

}  // namespace
}  // namespace fulcrum::testing
