// The position errors of joints: how far they are from what their locks and hard rows hold. Noted by the Prepare and
// Store stages for reports, and on demand by JointInterface::GetError. Plain data and free functions, no threads.
#pragma once

#include <Fulcrum/Constraints/Joints/JointError.h>
#include <Fulcrum/Constraints/Joints/JointRow.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

// C as an error, m or rad, >= 0.
inline float ErrorOf(const JointRow& row) {
    if (row.kind == JointRow::Kind::Equal) return std::fabs(row.error);
    return row.kind == JointRow::Kind::AtLeast ? std::max(0.0f, -row.error) : 0.0f;
}

// Whether C is in rad.
inline bool IsAngle(const JointRow& row) {
    const RowJacobian<float>& j = row.jacobian;
    return row.about || row.inRadians || (j.a.linear.isZero(0) && j.b.linear.isZero(0));
}

// Whether the row did all it may against its C: force, N or N m, is its average over the last step. A sum over 255
// substeps, rounded, may be 255 * 2^-24 short of the limit, and less than half as much comes from its scales.
inline bool IsAtForceLimit(float error, float force, float minForce, float maxForce) {
    constexpr float kShare = 1 - 0x1p-15f;
    return error < 0 ? force >= maxForce * kShare : force <= minForce * kShare;
}

// Adds up the errors of a joint's rows.
class RowErrors {
public:
    // error: m or rad, >= 0. Those of a block of locks (isLock) are components of one error.
    void Add(float error, bool isAngle, bool isLock) {
        if (isLock) squaredOfLocks_[isAngle] += error * error;
        else largest_[isAngle] = std::max(largest_[isAngle], error);
    }
    JointError Largest() const { return {Of(false), Of(true)}; }

private:
    float Of(bool isAngle) const { return std::max(largest_[isAngle], std::sqrt(squaredOfLocks_[isAngle])); }

    float largest_[2] = {0, 0}, squaredOfLocks_[2] = {0, 0};
};

}  // namespace fulcrum
