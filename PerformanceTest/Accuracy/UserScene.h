// A user's own scene, from a scene file or the samples, as a scene of the lab, for advise. One at a time; not
// thread-safe while it is chosen, any number of runs afterwards.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/LabScene.h>

#include <Fulcrum/Math/Result.h>

namespace fulcrum::accuracy {

// A file (FILE.json, FILE.cbor), or a name of ./fulcrum list, as the scene begins. It has no closed form. Its error is
// what a user sees of it: the largest overlap of two bodies over the smaller one's inner radius, or the largest error
// of a joint (GetError), as a distance over the outer radius of its smaller body or an angle in rad, whichever is
// larger, exceeded in one of twenty steps after the first half second. It is not measured where in none of these steps
// bodies touch or a joint has an error. Errors: those of reading or exporting it, in one line.
Result<const LabScene*> LoadUserScene(const std::string& name);
// The one that is loaded, by the name of its file or its own; null: it is not that.
const LabScene* FindUserScene(const std::string& name);

}  // namespace fulcrum::accuracy
