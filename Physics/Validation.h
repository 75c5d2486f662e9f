// Checks of arguments. Each returns an error with the field's name, its value and the valid range.
#pragma once

#include <Fulcrum/Physics/Settings.h>

#include <limits>
#include <optional>

namespace fulcrum {

MaybeError CheckFinite(const char* field, const Vector3& value);
MaybeError CheckFinite(const char* field, const Position& value);
// Finite, and within 1e18 m, so that squares fit a float.
MaybeError CheckPosition(const char* field, const Position& value);
// The error of a value that is out of range. Those that are inline are most of what the creation of a body checks.
Error RangeError(const char* field, double value, double low, double high);
Error PositiveError(const char* field, double value);
Error NegativeError(const char* field, double value);
inline constexpr double kLargestNumber = std::numeric_limits<double>::max();
inline MaybeError CheckRange(const char* field, double value, double low, double high) {  // both ends included
    if (value >= low && value <= high && value >= -kLargestNumber && value <= kLargestNumber) [[likely]]
        return std::nullopt;
    return RangeError(field, value, low, high);
}
inline MaybeError CheckPositive(const char* field, double value) {
    if (value > 0 && value <= kLargestNumber) [[likely]]
        return std::nullopt;
    return PositiveError(field, value);
}
inline MaybeError CheckNotNegative(const char* field, double value) {
    if (value >= 0 && value <= kLargestNumber) [[likely]]
        return std::nullopt;
    return NegativeError(field, value);
}
MaybeError CheckTarget(const char* field, double value);               // 0: none of its own; may be infinite
MaybeError CheckRotation(const char* field, const Quaternion& value);  // finite, of length 1 within 1e-3
// One of the enumerators, from 0 to `last`; for masks, a combination of them.
template <class E>
MaybeError CheckEnum(const char* field, E value, E last) {
    return CheckRange(field, static_cast<double>(value), 0, static_cast<double>(last));
}
// Mass, kg, and moments of inertia, kg m2, must have inverses that are normal floats; the fields are those from which
// they are computed.
MaybeError CheckInverses(const char* massField, const char* inertiaField, float mass, const Vector3& inertia);
// Not null; for a dynamic body, with a volume.
MaybeError CheckShape(const Shape* shape, MotionType motion);
// So that the product of two, which CombineRule::Multiply takes, times a normal impulse is a float.
inline constexpr float kMostFriction = 1e6f;
MaybeError Check(const Material& material);
MaybeError CheckContinuous(ContinuousCollision continuous, const Shape& shape);
MaybeError CheckSensor(SensorSees sees);
MaybeError Check(const BodySettings& settings);
MaybeError Check(const SystemSettings& settings);

Error Unknown(BodyId id);

// The first error of several checks, if any.
template <class... Checks>
MaybeError FirstOf(Checks&&... checks) {
    MaybeError first;
    ((first || !checks ? void() : void(first = std::forward<Checks>(checks))), ...);
    return first;
}

}  // namespace fulcrum
