// Scales of the masses and inertias that two bodies have for one joint or one contact. Set by users (JointSettings.h,
// ContactListener.h), applied where its rows are set up; plain data.
#pragma once

#include <Fulcrum/Math/NeedsCpp20.h>

namespace fulcrum {

struct MassOverride {
    // Factors of the inverse mass and inverse inertia of bodies A and B, 0..1e6: below 1 a body acts heavier, above 1
    // lighter. 0: infinite mass or inertia for this joint or contact; it is inactive if neither body can move.
    float inverseMassScaleA = 1, inverseInertiaScaleA = 1;
    float inverseMassScaleB = 1, inverseInertiaScaleB = 1;

    static constexpr float kLargestScale = 1e6f;
    // True if it changes nothing.
    bool IsNone() const { return *this == MassOverride{}; }
    bool IsValid() const {
        const auto isValid = [](float scale) { return scale >= 0 && scale <= kLargestScale; };
        return isValid(inverseMassScaleA) && isValid(inverseInertiaScaleA) && isValid(inverseMassScaleB) &&
               isValid(inverseInertiaScaleB);
    }
    // The same with bodies A and B swapped.
    MassOverride Swapped() const {
        return {inverseMassScaleB, inverseInertiaScaleB, inverseMassScaleA, inverseInertiaScaleA};
    }
    friend bool operator==(const MassOverride&, const MassOverride&) = default;
};

}  // namespace fulcrum
