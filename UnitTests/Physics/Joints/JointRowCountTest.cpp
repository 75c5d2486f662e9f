// No joint adds more rows than it says: there is room for no more.
#include <Fulcrum/Physics/Joints/JointKinds.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

AxisControl RandomControl(RandomPoses& random, const LimitBounds& bounds) {
    AxisControl control;
    const float low = std::clamp(random.Between(-1.5f, 0), bounds.lowest, bounds.highestMin),
                high = std::clamp(random.Between(0, 1.5f), bounds.lowestMax, bounds.highest);
    control.limited = random.Chance(0.7f);
    control.limits.min = low;
    control.limits.max = high;
    if (bounds.symmetric) control.limits.min = -high;
    // Locked, many of them at 0 and hard, which some kinds make a lock of the joint.
    const bool isLocked = random.Chance(0.4f);
    if (isLocked && bounds.lowest <= 0 && bounds.highest >= 0)
        control.limits.min = control.limits.max = bounds.symmetric || random.Chance(0.7f) ? 0 : high;
    if (random.Chance(0.3f)) control.limits.spring.frequency = 5;
    control.motor.mode = static_cast<MotorMode>(random.Below(3));
    control.motor.targetSpeed = random.Between(-10, 10);
    control.motor.targetPosition = random.Between(-2, 2);
    if (random.Chance(0.5f)) control.friction = 10;
    return control;
}

JointPose RandomPose(RandomPoses& random) {
    JointPose pose;
    pose.armA = random.InBox(1);
    pose.armB = random.InBox(1);
    pose.offset = random.InBox(random.Chance(0.5f) ? 0.01f : 3);
    pose.frameA = random.Rotation();
    pose.frameB = random.Chance(0.3f) ? pose.frameA : random.Rotation();
    pose.velocityA = {random.InBox(5), random.InBox(20)};
    pose.velocityB = {random.InBox(5), random.InBox(20)};
    pose.dt = 1.0f / 60;
    pose.substepDt = 1.0f / 240;
    return pose;
}

template <class Settings>
void ExpectNoMoreRowsThanSaid(const Settings& settings) {
    RandomPoses random(3);
    uint32_t most = 0;
    for (int i = 0; i < 5000; ++i) {
        const std::unique_ptr<JointType> type = MakeType(settings);
        for (int k = 0; k < 6; ++k) {
            const auto axis = static_cast<JointAxis>(k);
            if (AxisControl* control = type->Control(axis)) *control = RandomControl(random, type->BoundsOf(axis));
        }
        type->Start(RandomPose(random));
        const uint32_t said = type->MaxRows();
        if (said == 0) continue;
        for (int step = 0; step < 3; ++step) {
            JointRowList rows;
            type->CollectRows(RandomPose(random), rows);
            ASSERT_LE(rows.count, said) << type->Kind() << " " << i;
            most = std::max(most, rows.count);
        }
    }
    const bool hasRows = MakeType(settings)->MaxRows() > 0;
    EXPECT_TRUE(most > 0 || !hasRows);
}

// A hinge that its limits lock in place, with a motor and friction, added these two rows as it was bent beyond a right
// angle, and wrote beyond its room.
#define FULCRUM_TEST_ROWS(kind) \
    TEST(JointRowCount, kind##HasNoMoreThanItSays) { ExpectNoMoreRowsThanSaid(kind##JointSettings{}); }
FULCRUM_TEST_ROWS(Distance)
FULCRUM_TEST_ROWS(Hinge)
FULCRUM_TEST_ROWS(Slider)
FULCRUM_TEST_ROWS(Cone)
FULCRUM_TEST_ROWS(SwingTwist)
FULCRUM_TEST_ROWS(SixDof)
FULCRUM_TEST_ROWS(Gear)
FULCRUM_TEST_ROWS(RackAndPinion)
FULCRUM_TEST_ROWS(Pulley)
FULCRUM_TEST_ROWS(Path)
FULCRUM_TEST_ROWS(Wheel)
#undef FULCRUM_TEST_ROWS

}  // namespace
}  // namespace fulcrum::testing
