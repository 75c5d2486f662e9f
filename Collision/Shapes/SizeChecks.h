// Checks of the sizes given by users. Used by the Create functions of the shapes.
#pragma once

#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/Shape.h>

#include <cmath>

namespace fulcrum {

inline constexpr double kPi = 3.14159265358979323846;

// Squares of distances must be finite floats.
inline constexpr float kFarthestPlace = 1e18f;  // m

namespace detail {

inline Status CheckNotTooLarge(const char* name, float size) {
    if (size <= kFarthestPlace) return Done{};
    return Error{ErrorCode::OutOfRange,
                 Message("%s is %g m: it must be at most %g m", name, double{size}, double{kFarthestPlace})};
}

}  // namespace detail

// Ok if the size is positive and at most kFarthestPlace; otherwise an Error that names it.
inline Status CheckSize(const char* name, float size) {
    if (!std::isfinite(size))
        return Error{ErrorCode::NonFinite, Message("%s is %g: it must be finite", name, double{size})};
    if (!(size > 0))
        return Error{ErrorCode::NonPositive, Message("%s is %g m: it must be larger than 0", name, double{size})};
    return detail::CheckNotTooLarge(name, size);
}

// The same for a size that may be 0.
inline Status CheckSizeOrZero(const char* name, float size) {
    if (!std::isfinite(size))
        return Error{ErrorCode::NonFinite, Message("%s is %g: it must be finite", name, double{size})};
    if (!(size >= 0))
        return Error{ErrorCode::Negative, Message("%s is %g m: it must be 0 or more", name, double{size})};
    return detail::CheckNotTooLarge(name, size);
}

// Ok if the center lies within kFarthestPlace.
inline Status CheckPlace(const char* name, const Vector3& center) {
    if (IsFinite(center) && center.cwiseAbs().maxCoeff() < kFarthestPlace) return Done{};
    return Error{ErrorCode::OutOfRange,
                 Message("the center of %s is farther away than %g m", name, double{kFarthestPlace})};
}

// 0 to `most`, which the message calls `mostName`.
inline Status CheckConvexRadius(float convexRadius, float most, const char* mostName) {
    if (!std::isfinite(convexRadius)) {
        return Error{ErrorCode::NonFinite, Message("convexRadius is %g: it must be finite", double{convexRadius})};
    }
    if (convexRadius < 0 || convexRadius > most) {
        return Error{ErrorCode::OutOfRange, Message("convexRadius is %g m: it must be 0 to %s, %g m",
                                                    double{convexRadius}, mostName, double{most})};
    }
    return Done{};
}

}  // namespace fulcrum
