// A scene with a number of threads that is timed in several runs, each between two of the reference kernel. Used by the
// benchmark; one thread besides the pool that it makes.
#pragma once

#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/PerformanceTest/Peers/Peer.h>
#include <Fulcrum/PerformanceTest/Scenes/BenchOptions.h>
#include <Fulcrum/PerformanceTest/Scenes/ReferenceKernel.h>

#include <nlohmann/json_fwd.hpp>

#include <optional>
#include <string>
#include <vector>

namespace fulcrum {

// The runs of a scene in another engine.
struct PeerRuns {
    std::vector<double> ms;  // of each run: the median
    double accuracy = 0;     // of the last run
    std::string whyNot;      // not empty: the scene cannot be run
};

class TimedScene {
public:
    TimedScene(const Scene& scene, int threads, const BenchOptions& options);

    // 1 untimed step, then the timed ones, as benchmarks of other engines do it; or the scene's batch of queries.
    Status Run(const ReferenceKernel& kernel);
    // In another engine.
    void RunPeer(const Peer& peer, PeerRuns& runs) const;
    // After the runs: what needs runs of its own. It does not depend on the threads, so that those of another number
    // of them can be taken over.
    Status AddAccuracyRuns();
    void TakeAccuracyRuns(const TimedScene& other);

    const Scene& Definition() const { return scene_; }
    int Threads() const { return threads_; }
    // Of the run with the lowest median.
    const RunFigures& Figures() const { return *best_; }
    // Median over the runs of this engine's time over the peer's, run by run.
    static double RatioTo(const PeerRuns& peer, const TimedScene& scene);
    // As saved runs have it; `peer` may be null.
    nlohmann::ordered_json ToJson(uint64_t seed, const Peer* peer, const PeerRuns& peerRuns) const;

private:
    JobSystem* Jobs() { return pool_ ? &*pool_ : nullptr; }
    // A batch is timed after exactly the scene's steps.
    int UntimedSteps() const { return scene_.query ? 0 : 1; }

    const Scene& scene_;
    int threads_;
    SceneInput input_;
    std::optional<ThreadPool> pool_;
    int steps_;
    double dt_;
    std::optional<RunFigures> best_;
    std::vector<double> runMs_, relativeTimes_;  // of each run
};

}  // namespace fulcrum
