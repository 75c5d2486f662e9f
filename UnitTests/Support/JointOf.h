// Settings of a kind of joint with given bodies and anchors. Without a test library, for generators and programs, too.
#pragma once

#include <Fulcrum/Physics/JointInterface.h>

namespace fulcrum::testing {

// Of kinds that are no aggregates, or whose own fields are set later.
template <class Settings>
Settings Of(const JointSettings& between) {
    Settings settings;
    static_cast<JointSettings&>(settings) = between;
    return settings;
}

}  // namespace fulcrum::testing
