// Which setting to take for a scene, from its runs. Pure functions.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/Output.h>

namespace fulcrum::accuracy {

// Of the envelope: the cheapest setting with an error of at most `error`, its neighbors on the envelope, and the lines
// to paste; or that there is none, and the best that there is.
std::string AdviceForError(const SceneRuns& scene, double error);
// The same for a budget, ms of work per frame of 1/60 s.
std::string AdviceForBudget(const SceneRuns& scene, double milliseconds);

}  // namespace fulcrum::accuracy
