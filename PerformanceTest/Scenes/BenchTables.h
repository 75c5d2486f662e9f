// The tables that the benchmark prints of timed scenes.
#pragma once

#include <Fulcrum/PerformanceTest/Scenes/TimedScene.h>

#include <memory>
#include <vector>

namespace fulcrum {

// `peer` may be null.
void PrintTimesHeading(const Peer* peer);
void PrintTimes(const TimedScene& scene, const Peer* peer, const PeerRuns& peerRuns);
void PrintAccuracy(const std::vector<std::unique_ptr<TimedScene>>& scenes);

}  // namespace fulcrum
