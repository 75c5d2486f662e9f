// How tests of the lab's scenes call them.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/LabScene.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <ostream>
#include <string>

namespace fulcrum::accuracy {

// For gtest's messages.
inline void PrintTo(const LabScene& scene, std::ostream* stream) { *stream << scene.FullName(); }

inline std::string TestName(const ::testing::TestParamInfo<LabScene>& tested) {
    std::string name = tested.param.FullName();
    std::replace_if(
        name.begin(), name.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return name;
}

}  // namespace fulcrum::accuracy
