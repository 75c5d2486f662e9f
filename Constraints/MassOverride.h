// Other masses than their own that two bodies have for one joint or one contact. Set by users (JointSettings.h,
// ContactListener.h), applied where its rows are set up; plain data.
#pragma once

namespace fulcrum {

struct MassOverride {
    // The inverse mass and the inverse inertia of bodies A and B times these, 0..1e6: below 1 a body is heavier, above
    // 1 lighter than it is. 0: it does not move, or turn, for this joint or contact; where neither body can move, that
    // does nothing.
    float inverseMassScaleA = 1, inverseInertiaScaleA = 1;
    float inverseMassScaleB = 1, inverseInertiaScaleB = 1;

    static constexpr float kLargestScale = 1e6f;
    // Both bodies are as they are.
    bool IsNone() const { return *this == MassOverride{}; }
    bool IsValid() const {
        const auto isValid = [](float scale) { return scale >= 0 && scale <= kLargestScale; };
        return isValid(inverseMassScaleA) && isValid(inverseInertiaScaleA) && isValid(inverseMassScaleB) &&
               isValid(inverseInertiaScaleB);
    }
    // The same with the bodies the other way round.
    MassOverride Swapped() const {
        return {inverseMassScaleB, inverseInertiaScaleB, inverseMassScaleA, inverseInertiaScaleA};
    }
    friend bool operator==(const MassOverride&, const MassOverride&) = default;
};

}  // namespace fulcrum
