// Limits of swing and twist, solved as joints do: by position passes of rows about their axes, from anywhere.
#include "AllLimits.h"
#include "RandomBodies.h"

#include <Fulcrum/Constraints/Parts/AnglePart.h>
#include <Fulcrum/Constraints/Parts/SwingTwist.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

using testing::AnyRotation;
using testing::CollectLimits;
using testing::RandomPoses;

constexpr float kPi = 3.14159265f;
constexpr float kDegree = kPi / 180.0f;

Quaternion Swung(float y, float z, float twist) {
    return RotationFromVector(Vector3(0, y, z)) * RotationFromVector(Vector3(twist, 0, 0));
}

// A pair of bodies with joint frames fixed in them.
struct Joint {
    Quaternion frame1, frame2;  // world
    Vector3 inverseInertia1, inverseInertia2;
    SwingTwistLimits limits;

    Joint(RandomPoses& random, const Quaternion& relative)
        : frame1(AnyRotation(random)), frame2(Normalized(frame1 * relative)) {
        for (int k = 0; k < 3; ++k) {
            inverseInertia1[k] = random.Between(0.5f, 3.0f);
            inverseInertia2[k] = random.Between(0.5f, 3.0f);
        }
    }
    InverseMass<float> Mass1() const { return {0.7f, RotatedDiagonal(ToMatrix(frame1), inverseInertia1)}; }
    InverseMass<float> Mass2() const { return {1.3f, RotatedDiagonal(ToMatrix(frame2), inverseInertia2)}; }
    RotationLimitList Limits() const { return CollectLimits(Normalized(frame1.Conjugate() * frame2), limits); }
    float Violation() const {
        float worst = 0.0f;
        for (const RotationLimit& limit : Limits())
            worst = std::max(worst, limit.isLocked ? std::fabs(limit.error) : -limit.error);
        return worst;
    }
    // Passes until no limit is exceeded by more than 1e-5.
    int CountPasses(int most = 100) {
        for (int count = 0; count < most; ++count) {
            if (Violation() < 1e-5f) return count;
            Twist<float> moved1, moved2;
            Pass(moved1, moved2);
            frame1 = Normalized(RotationFromVector(moved1.angular) * frame1);
            frame2 = Normalized(RotationFromVector(moved2.angular) * frame2);
        }
        return most;
    }

private:
    // One pass over a row for each range, one after the other: of a range's two ends the nearer one, and none where it
    // is kept.
    void Pass(Twist<float>& moved1, Twist<float>& moved2) const {
        const RotationLimit* rows[3] = {};
        const RotationLimitList list = Limits();
        for (const RotationLimit& limit : list) {
            const RotationLimit*& row = rows[limit.slot / 2];
            if (limit.isLocked || !row || limit.error < row->error) row = &limit;
        }
        for (const RotationLimit* limit : rows) {
            if (!limit) continue;
            RowPart<float> part;
            part.SetJacobian(AngleJacobian(Rotate(frame1, limit->axis)));
            part.CalculateProperties(Mass1(), Mass2());
            // The rows before have changed the error.
            const float error = limit->error + RelativeMotion(part.GetJacobian(), moved1, moved2);
            if (limit->isLocked || error < 0.0f) part.SolvePosition(moved1, moved2, error, 1.0f);
        }
    }
};

AngleRange RandomRange(RandomPoses& random, float widest) {
    const float kind = random.Between(0.0f, 1.0f);
    if (kind < 0.2f) return {0.0f, 0.0f};
    const float low = random.Between(2.0f, widest), high = random.Between(2.0f, widest);
    return {-low * kDegree, high * kDegree};
}
// Of every third one the x axes start opposite.
Joint RandomJoint(RandomPoses& random, int i) {
    const float alpha = i % 3 == 0 ? kPi : random.Between(0.0f, kPi), psi = random.Between(-kPi, kPi);
    return Joint(random, Swung(alpha * Cos(psi), alpha * Sin(psi), random.Between(-kPi, kPi)));
}

TEST(SwingTwistPasses, PositionPassesReachTheLimitsFromAnywhere) {
    RandomPoses random(7);
    int worst = 0, sum = 0;
    constexpr int kJoints = 2000;
    for (int i = 0; i < kJoints; ++i) {
        Joint joint = RandomJoint(random, i);
        joint.limits.shape = i % 2 ? SwingShape::Ellipse : SwingShape::Pyramid;
        joint.limits.swingY = RandomRange(random, 80.0f);
        joint.limits.swingZ = RandomRange(random, 80.0f);
        joint.limits.twist = i % 4 < 2 ? AngleRange{} : RandomRange(random, 175.0f);
        const int passes = joint.CountPasses();
        worst = std::max(worst, passes);
        sum += passes;
    }
    EXPECT_LE(worst, 40);
    EXPECT_LE(sum, 5 * kJoints);
}

// Up to 180 degrees the swing comes back at once. Near there a turn of the swing's direction is a twist as well, so
// that a narrow twist and a wide swing push against each other, and some of both are slow.
TEST(SwingTwistPasses, PositionPassesReachSwingLimitsUpToHalfATurn) {
    RandomPoses random(16);
    int worstAlone = 0, slow = 0;
    constexpr int kJoints = 2000;
    for (int i = 0; i < kJoints; ++i) {
        Joint joint = RandomJoint(random, i);
        joint.limits.shape = i % 2 ? SwingShape::Ellipse : SwingShape::Pyramid;
        joint.limits.swingY = RandomRange(random, 179.0f);
        joint.limits.swingZ = RandomRange(random, 179.0f);
        Joint alone = joint;
        worstAlone = std::max(worstAlone, alone.CountPasses());
        joint.limits.twist = RandomRange(random, 175.0f);
        slow += joint.CountPasses() > 30;
    }
    EXPECT_LE(worstAlone, 10);
    EXPECT_LT(slow, kJoints / 5);
}

}  // namespace
}  // namespace fulcrum
