// How far a body has turned about an axis that it carries: gears, pinions. Counted over any number of turns without
// drift, whether the axis stands still or is carried about. Called by the joint types that mesh. A view of five numbers
// of a joint's state; no threads.
//
// With frame = reference swing twist (twist first, about x), the angle is that of the twist, up to whole turns, which
// the way of the last step tells. The swing takes the reference's axis to the frame's along the shortest way and so
// adds no turn of its own. The reference is kept, so that nothing accumulates, until the axis has left it by some
// degrees; then the swing joins it.
#pragma once

#include <Fulcrum/Constraints/Joints/JointAngles.h>

namespace fulcrum {

class BearingAngle {
public:
    static constexpr size_t kNumbers = 5;  // the reference x y z w, rad

    explicit BearingAngle(std::span<double, kNumbers> numbers) : numbers_(numbers) {}

    // Zero here. frame: world space, unit.
    void Start(const Quaternion& frame) {
        SetReference(frame);
        numbers_[4] = 0.0;
    }
    // To the frame of now; it turned by about `turned` about x since. Both in rad, as what is returned.
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
