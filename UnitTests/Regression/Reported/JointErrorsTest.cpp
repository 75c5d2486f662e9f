// A rope of rods that a heavy weight stretches: how much longer it is, is what the errors of its joints say.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {
namespace {

constexpr int kLinks = 16;
constexpr double kLength = 0.5;  // m, of a rod

TEST(RopeOfRods, ErrsByWhatItIsLonger) {
    TestWorld world(NoSleep());
    std::vector<BodyId> ends = {AddHook(world)};
    std::vector<JointId> rods;
    for (int i = 1; i <= kLinks; ++i) {
        ends.push_back(world.Add(
            {.shape = SphereOf(0.05f), .position = {0, -i * kLength, 0}, .mass = i < kLinks ? 1.0f : 1000.0f}));
        DistanceJointSettings rod{UprightBetween(ends[ends.size() - 2], ends.back(), world.PositionOf(ends.end()[-2]))};
        rod.anchorB = AnchorAt(world.PositionOf(ends.back()));
        rods.push_back(Join(world, rod));
    }
    const auto lengthOf = [&](size_t i) { return (world.PositionOf(ends[i + 1]) - world.PositionOf(ends[i])).norm(); };
    double longest = 0;
    for (int step = 0; step < 120; ++step) {
        double off = 0;  // the largest, before the step
        for (size_t i = 0; i < rods.size(); ++i) {
            const double apart = std::fabs(lengthOf(i) - kLength);
            // Floats at up to 30 m.
            ASSERT_NEAR(JointsOf(world).GetError(rods[i]).distance, apart, 1e-5) << step;
            off = std::max(off, apart);
        }
        world.Step();
        ASSERT_NEAR(world.Report().largestJointError, off, 1e-5) << step;
        EXPECT_EQ(world.Report().largestJointAngle, 0);
        longest = std::max(longest, off);
    }
    // The weight shows in all that counts it: what the rope is longer by, in sum.
    double length = 0, errors = 0;
    for (size_t i = 0; i < rods.size(); ++i) {
        length += lengthOf(i);
        errors += static_cast<double>(JointsOf(world).GetError(rods[i]).distance);
    }
    EXPECT_GT(longest, 0);
    EXPECT_NEAR(errors, length - kLinks * kLength, 1e-3 + 1e-3 * errors);
}

}  // namespace
}  // namespace fulcrum::testing
