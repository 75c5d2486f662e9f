#include <Fulcrum/PerformanceTest/Scenes/TimedScene.h>

#include <Fulcrum/PerformanceTest/Scenes/SampleStatistics.h>
#include <Fulcrum/Samples/Runner/RunReport.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <nlohmann/json.hpp>

namespace fulcrum {

namespace {

constexpr double kSleepLimit = 20;  // s

SceneInput InputOf(const BenchOptions& options) {
    SceneInput input;
    input.seed = options.seed;
    input.solver = options.solver;
    input.narrowPhase = options.narrowPhase;
    return input;
}

}  // namespace

TimedScene::TimedScene(const Scene& scene, int threads, const BenchOptions& options)
    : scene_(scene),
      threads_(threads),
      input_(InputOf(options)),
      steps_(options.steps > 0 ? options.steps : scene.steps),
      dt_(options.dt) {
    if (threads > 1) pool_.emplace(static_cast<uint32_t>(threads));
}

Status TimedScene::Run(const ReferenceKernel& kernel) {
    const auto world = SceneWorld::Create(scene_, input_, Jobs());
    if (!world) return world.GetError();
    std::vector<std::vector<double>> units{kernel.Time(threads_)};
    Result<RunFigures> run = Simulate(
        *world.Value(), UntimedSteps(), steps_, dt_, static_cast<uint32_t>(threads_), [] {}, RestMeters::Off);
    units.push_back(kernel.Time(threads_));
    if (!run) return run.GetError();
    const double median = ComparedMs(run.Value()).median;
    runMs_.push_back(median);
    relativeTimes_.push_back(UnitsIn(median, units));
    if (!best_ || median < ComparedMs(*best_).median) best_ = std::move(run.Value());
    return Done{};
}

void TimedScene::RunPeer(const Peer& peer, PeerRuns& runs) const {
    if (!runs.whyNot.empty()) return;
    const Result<PeerFigures> figures = peer.run(scene_, input_, UntimedSteps(), steps_, dt_);
    if (!figures) {
        runs.whyNot = figures.GetError().message;
        return;
    }
    runs.ms.push_back(figures.Value().ms.median);
    runs.accuracy = figures.Value().accuracy;
}

Status TimedScene::AddAccuracyRuns() {
    RunFigures& figures = *best_;
    const int steps = UntimedSteps() + steps_;
    const Status rest = MeasureRest(scene_, input_, Jobs(), steps, dt_, figures);
    if (!rest) return rest;
    if (scene_.isClosed) {  // what is driven does not sleep
        const Result<SleepTime> sleep = MeasureSleep(scene_, input_, Jobs(), dt_, kSleepLimit);
        if (!sleep) return sleep.GetError();
        figures.sleep = sleep.Value();
    }
    if (scene_.accuracyRuns <= 1) return Done{};
    Result<std::vector<double>> runs = AccuracyOfRuns(scene_, input_, Jobs(), steps, dt_);
    if (!runs) return runs.GetError();
    figures.accuracies = std::move(runs.Value());
    figures.accuracy = Summarize(figures.accuracies).median;
    return Done{};
}

void TimedScene::TakeAccuracyRuns(const TimedScene& other) {
    const RunFigures& from = *other.best_;
    best_->drift = from.drift;
    best_->endSpeed = from.endSpeed;
    best_->energyRise = from.energyRise;
    best_->sleep = from.sleep;
    best_->accuracies = from.accuracies;
    if (!from.accuracies.empty()) best_->accuracy = from.accuracy;
}

double TimedScene::RatioTo(const PeerRuns& peer, const TimedScene& scene) {
    std::vector<double> ratios;
    for (size_t i = 0; i < peer.ms.size(); ++i) ratios.push_back(scene.runMs_[i] / peer.ms[i]);
    return MedianOf(std::move(ratios));
}

nlohmann::ordered_json TimedScene::ToJson(uint64_t seed, const Peer* peer, const PeerRuns& peerRuns) const {
    nlohmann::ordered_json json = ReportJson(scene_.name, *best_, seed);
    json["run_ms"] = runMs_;
    json["relative_times"] = relativeTimes_;
    if (peer && !peerRuns.ms.empty())
        json["peer"] = {{"engine", peer->name},
                        {"version", peer->version()},
                        {"run_ms", peerRuns.ms},
                        {"median_ms", MedianOf(peerRuns.ms)},
                        {"ratio", RatioTo(peerRuns, *this)},
                        {"accuracy", peerRuns.accuracy}};
    return json;
}

}  // namespace fulcrum
