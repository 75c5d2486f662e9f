// The list of the kinds of joints. Each kind is one file with its settings, their check, its type with locks and rows,
// its name and its drawing. The interface, the viewer and the tests use this list.
#pragma once

#include <Fulcrum/Physics/Joints/ConeJoint.h>
#include <Fulcrum/Physics/Joints/CustomJoint.h>
#include <Fulcrum/Physics/Joints/DistanceJoint.h>
#include <Fulcrum/Physics/Joints/FixedJoint.h>
#include <Fulcrum/Physics/Joints/GearJoint.h>
#include <Fulcrum/Physics/Joints/HingeJoint.h>
#include <Fulcrum/Physics/Joints/PathJoint.h>
#include <Fulcrum/Physics/Joints/PointJoint.h>
#include <Fulcrum/Physics/Joints/PulleyJoint.h>
#include <Fulcrum/Physics/Joints/RackAndPinionJoint.h>
#include <Fulcrum/Physics/Joints/SixDofJoint.h>
#include <Fulcrum/Physics/Joints/SliderJoint.h>
#include <Fulcrum/Physics/Joints/SwingTwistJoint.h>
#include <Fulcrum/Physics/Joints/WheelJoint.h>

// Calls a macro with the name of every kind.
#define FULCRUM_FOR_EACH_JOINT_KIND(call)                                                                    \
    call(Point) call(Fixed) call(Distance) call(Hinge) call(Slider) call(Cone) call(SwingTwist) call(SixDof) \
        call(Gear) call(RackAndPinion) call(Pulley) call(Path) call(Wheel) call(Custom)

namespace fulcrum {

// Whether a structure has the settings of a kind of joint: JointSettings alone, which all kinds share, are of none.
#define FULCRUM_IS_SAME(kind) || std::is_same_v<Settings, kind##JointSettings>
template <class Settings>
inline constexpr bool kIsOfAKindOfJoint = false FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_IS_SAME);
#undef FULCRUM_IS_SAME
template <class Settings>
concept SettingsOfAKindOfJoint = kIsOfAKindOfJoint<Settings>;

}  // namespace fulcrum
