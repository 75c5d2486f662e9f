// A scene of the accuracy lab, and the measurements of one run of it. Scenes are functions in Scenes/, listed in
// Registry.cpp. A run belongs to one thread; runs share nothing.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/PerformanceTest/Accuracy/Setting.h>
#include <Fulcrum/Samples/Scenes/Random.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace fulcrum::accuracy {

class LabRecorder;

struct NamedValue {
    std::string name;
    double value;
};

// Ends a run in another engine: says what that lacks.
struct NotInPeer : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Cost of a run so far.
struct Work {
    double seconds = 0;           // wall clock, of the steps only
    double simulatedSeconds = 0;  // of all worlds of the run
    // Sum over the steps of (contacts + joints) x substeps x (velocity + position iterations), by the reports of the
    // steps. An island with more effort than the system's counts with its own, and has that share of the constraints
    // which it has of the bodies. The same on every machine.
    double traversals = 0;
    // With an AccuracyTarget: how often an island's effort rose after it had fallen, though its contacts and joints had
    // stayed the same, in the second half of the world's time.
    int effortReturns = 0;
    uint64_t hash = 0;  // of the last poses of all worlds
};

// One run of a scene with one setting and one seed: inputs and measurements.
class LabRun {
public:
    LabRun(const Setting& ofSetting, double ofParameter, bool isShort, uint64_t seed, JobSystem* ofJobs = nullptr)
        : setting(ofSetting), parameter(ofParameter), isQuick(isShort), random(seed), jobs(ofJobs) {}

    // Dimensionless, >= 0: deviation of a result from the closed form, relative to its size. The first is the scene's
    // main error.
    void Error(const char* name, double error) { errors.push_back({name, error}); }
    // Additional results.
    void Figure(const char* name, double value) { figures.push_back({name, value}); }
    // A dimensionless result, for the comparison with the finest setting.
    void Observe(double value) { observed.push_back(value); }
    // A condition that must hold: of the scene, or of all (finite poses, bodies within their domain).
    void Require(bool holds, const std::string& condition);

    double Dt() const { return setting.Dt(); }
    double Seconds(double full, double quick) const { return isQuick ? quick : full; }
    int Count(int full, int quick) const { return isQuick ? quick : full; }
    // Whole steps of the setting, at least one.
    int Steps(double seconds) const;

    const Setting& setting;
    LabRecorder* recorder = nullptr;  // not owned; of the first world
    double parameter;
    bool isQuick;
    Random random;
    JobSystem* jobs;

    std::vector<NamedValue> errors, figures;
    std::vector<double> observed;
    std::vector<std::string> failedConditions;  // each once
    std::string worst;                          // what has the largest error, and when; empty: unknown
    bool isMeasured = true;                     // false: no step had anything that the error is of, so it is 0
    bool isLost = false;                        // numbers of a peer were not finite: errors mean nothing
    Work work;
};

struct LabScene {
    const char* name;          // of the list of scenes
    const char* variant = "";  // if there are several variants
    const char* what;          // the set-up in one line
    const char* error;         // the main error in one line
    double parameter = 0;
    Influences influences{};
    bool isExtreme = false;
    bool isSlow = false;   // its full grid is coarse
    int seeds = 1;         // of chaotic scenes 32: the errors are medians over so many runs
    int quickSeeds = 1;    // the same with --quick
    double blowUp = 10;    // a run whose main error exceeds this has blown up
    double testBound = 0;  // the main error at the finest quick setting is below this
    // Makes worlds (LabWorld.h), steps them, and reports to the run.
    void (*run)(LabRun& run) = nullptr;

    // "incline.slide"
    std::string FullName() const { return *variant ? std::string(name) + "." + variant : name; }
};

}  // namespace fulcrum::accuracy
