// Errors with their path in the document, and the names of the kinds of joints. Pure functions.
#pragma once

#include <Fulcrum/Assets/SceneDescription.h>

#include <array>
#include <string>
#include <string_view>

namespace fulcrum {

// An error whose message begins with the path of what is wrong.
inline Error WrongAt(const std::string& path, const std::string& what) {
    return {ErrorCode::Unsupported, (path.empty() ? "the document" : path) + ": " + what};
}

// Why what earlier versions had under this path is not needed any more; null if they had nothing there.
inline const char* FormerName(std::string_view path) {
    struct Former {
        std::string_view path;
        const char* why;
    };
    constexpr const char* kHard = "locks of joints are hard";
    constexpr const char* kDirect = "what would miss a target is solved directly";
    constexpr Former kAll[] = {{"settings.jointFrequency", kHard},
                               {"settings.jointDampingRatio", kHard},
                               {"settings.accuracy.drift", kDirect},
                               {"settings.accuracy.mostSubsteps", kDirect},
                               {"settings.accuracy.largeIslands", kDirect}};
    for (const Former& former : kAll)
        if (former.path == path) return former.why;
    return nullptr;
}

// The names of the kinds of a variant of joint settings, in its order.
template <class Joint>
inline constexpr std::array<const char*, 0> kJointKindNames{};
template <>
inline constexpr std::array kJointKindNames<RagdollJoint> = {"Point", "Fixed", "Hinge", "Cone", "SwingTwist", "SixDof"};
template <>
inline constexpr std::array kJointKindNames<AnyJointSettings> = {
    "Point",  "Fixed", "Distance",      "Hinge",  "Slider", "Cone", "SwingTwist",
    "SixDof", "Gear",  "RackAndPinion", "Pulley", "Path",   "Wheel"};
static_assert(kJointKindNames<RagdollJoint>.size() == std::variant_size_v<RagdollJoint>);
static_assert(kJointKindNames<AnyJointSettings>.size() == std::variant_size_v<AnyJointSettings>);

}  // namespace fulcrum
