// Runs a scene step by step and measures it. Used by the runner and the benchmark; one thread.
#pragma once

#include <Fulcrum/Samples/Scenes/PenetrationMeter.h>
#include <Fulcrum/Samples/Scenes/RestMeters.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace fulcrum {

struct Statistics {
    double median = 0, mean = 0, p99 = 0, max = 0;
};
// p99 is the smallest sample that 99 % of them do not exceed. Zeros where there are no samples.
Statistics Summarize(std::vector<double> samples);

// When all bodies slept, in a run with sleeping.
struct SleepTime {
    std::optional<double> seconds;  // null: not within the limit
    double limit = 0;               // s
};

// Energy that appeared from nothing (EnergyMeter).
struct EnergyRise {
    double joules = 0, relative = 0;
};

// The largest value of a step, at which it was, and whose.
struct WorstOfRun {
    double value = 0;
    std::string whose;  // empty: nobody's
    int step = 0;
};

// What StepReport::errors said in a run whose world measures them, and what belongs to it.
struct ErrorFigures {
    WorstOfRun jointError, jointAngle;                 // m, rad
    WorstOfRun energyGain, momentum, angularMomentum;  // J, N s, N m s
    WorstOfRun push;                                   // J, of one body
    WorstOfRun effort;                                 // substeps; no value where the settings' always did
    bool solvesDirectly = false;                       // contacts of some island of `effort`, because of a load
    double energyChange = 0;                           // J, summed over all steps
};

// Measurements of a run. Times are wall clock, ms.
struct RunFigures {
    int steps = 0;  // those that were timed
    double dt = 0;  // s
    uint32_t threads = 1;
    SolverSettings solver;
    NarrowPhaseMethod narrowPhase = NarrowPhaseMethod::Automatic;
    Statistics stepMs;
    std::array<double, kStageCount> stageMedianMs{};
    int queryCount = 0;        // of the scene's batch; 0: it has none
    std::string queryName;     // what they are
    Statistics queryMs;        // of the whole batch
    double singleQueryNs = 0;  // of one by a call of its own; 0: not timed
    StepReport last;           // of the last step
    size_t bodies = 0, dynamicBodies = 0;
    uint32_t islands = 0, awakeIslands = 0;  // at the end
    float largestPenetration = 0;            // m, of all contacts
    std::string deepestPair;                 // "box 12 and hull 15"; empty where nothing touched
    int deepestStep = 0;
    Penetration overlap;      // the largest for its size, by the shapes alone
    std::string overlapPair;  // empty where nothing overlapped
    uint32_t largestContacts = 0;
    uint32_t libccdFailures = 0, libccdFallbacks = 0;  // of all steps
    double energyAtStart = 0, energyAtEnd = 0;         // J, with that of springs
    uint64_t poseHash = 0;
    size_t memoryBytes = 0;
    std::optional<Drift> drift;            // at the end; null: the scene is not built to stand
    std::optional<double> endSpeed;        // m/s, the largest in the last second (SpeedMeter); null: not measured
    std::optional<SleepTime> sleep;        // null: sleeping is off
    std::optional<EnergyRise> energyRise;  // null: the scene is not closed
    std::optional<ErrorFigures> errors;    // null: the world does not measure them
    double accuracy = 0;                   // the scene's figure
    std::vector<double> accuracies;        // where `accuracy` is the median of several runs: theirs
    int nonFinite = 0;                     // bodies
};

// What the meters of Scenes/RestMeters.h see all bodies for after each step, which costs the next step its caches:
// steps of a sleeping world take a third longer.
enum class RestMeters { Off, On };

// Takes `untimed` steps, then `steps` timed ones of dt seconds; `afterStep` is called after each of all of them. A
// scene's batch of queries is run once untimed, then timed five times, and likewise the queries one by one. Errors:
// those of PhysicsSystem::Update.
Result<RunFigures> Simulate(SceneWorld& world, int untimed, int steps, double dt, uint32_t threads,
                            FunctionRef<void()> afterStep, RestMeters rest = RestMeters::On);

// Fills in what Simulate does without RestMeters: a run of its own of `steps` steps. `jobs` may be null.
Status MeasureRest(const Scene& scene, const SceneInput& input, JobSystem* jobs, int steps, double dt,
                   RunFigures& figures);

// The time after which all bodies of a scene sleep, whether or not the scene has sleeping on: a run of its own, of at
// most `limit` seconds. `jobs` may be null.
Result<SleepTime> MeasureSleep(const Scene& scene, SceneInput input, JobSystem* jobs, double dt, double limit);

// The accuracy figures of the scene's accuracyRuns, each after `steps` steps; input.gravityScale is that of the first.
Result<std::vector<double>> AccuracyOfRuns(const Scene& scene, const SceneInput& input, JobSystem* jobs, int steps,
                                           double dt);

// The time by which scenes are compared: of the batch if there is one, otherwise of the step.
inline const Statistics& ComparedMs(const RunFigures& figures) {
    return figures.queryCount > 0 ? figures.queryMs : figures.stepMs;
}
// Of its batch; 0 where it has none.
double QueriesPerSecond(const RunFigures& figures);

// 16 hexadecimal digits.
std::string HashText(uint64_t hash);

}  // namespace fulcrum
