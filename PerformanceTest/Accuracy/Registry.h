// All scenes of the lab. Any thread.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/LabScene.h>

#include <string>
#include <vector>

namespace fulcrum::accuracy {

// In the order of reports: the accuracy scenes, then the extreme ones.
const std::vector<LabScene>& AllLabScenes();
// "incline" and "incline.slide" both name scenes, and so does that which LoadUserScene has loaded; empty for an unknown
// name.
std::vector<const LabScene*> FindLabScenes(const std::string& name);
// Full names, and the names that several share.
std::vector<std::string> LabSceneNames();

}  // namespace fulcrum::accuracy
