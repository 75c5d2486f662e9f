// Rotation angle of a body about an axis fixed in it (gears, pinions), counted over any number of revolutions without
// drift, also if the axis itself moves. Called by gear and rack-and-pinion joints. A view of five numbers of a joint's
// state; not thread-safe.
//
// With frame = reference swing twist (twist first, about x), the angle is that of the twist plus whole revolutions,
// which are found from the rotation of the last step. The swing takes the reference's axis to the frame's by the
// shortest rotation and so adds no twist. The reference is kept, so that no error accumulates, until the axis deviates
// from it by some degrees; then the swing is merged into it.
#pragma once

#include <Fulcrum/Constraints/Joints/JointAngles.h>

namespace fulcrum {

class BearingAngle {
public:
    static constexpr size_t kNumbers = 5;  // reference quaternion x y z w, angle in rad

    explicit BearingAngle(std::span<double, kNumbers> numbers) : numbers_(numbers) {}

    // Sets the angle to zero at this frame: world space, unit.
    void Start(const Quaternion& frame) {
        SetReference(frame);
        numbers_[4] = 0.0;
    }
    // Advances to the current frame, which has rotated by approximately `turned`, rad, about x since the last call.
    // Returns the angle, rad.
    double Advance(const Quaternion& frame, float turned) {
        const Quaternion rotation = Reference().Conjugate() * frame;
        const float twist = TwistAngle(rotation);
        numbers_[4] = NearestTurn(twist, numbers_[4] + turned);
        // sin^2 of half the swing: beyond 0.1 rad.
        if (rotation.y * rotation.y + rotation.z * rotation.z > 2.5e-3f) {
            const SineCosine<float> half = SinCos(0.5f * twist);
            SetReference(Normalized(Reference() * rotation * Quaternion{-half.sine, 0.0f, 0.0f, half.cosine}));
        }
        return numbers_[4];
    }

private:
    Quaternion Reference() const {
        return {static_cast<float>(numbers_[0]), static_cast<float>(numbers_[1]), static_cast<float>(numbers_[2]),
                static_cast<float>(numbers_[3])};
    }
    void SetReference(const Quaternion& q) {
        numbers_[0] = q.x, numbers_[1] = q.y, numbers_[2] = q.z, numbers_[3] = q.w;
    }

    std::span<double, kNumbers> numbers_;
};

}  // namespace fulcrum
