// A scene: a function that fills a world, and the accuracy figure of its runs. One scene serves sample, test and
// benchmark; Scenes.cpp lists them all. Constants, so any thread may read them.
#pragma once

#include <Fulcrum/Physics/Settings.h>
#include <Fulcrum/Samples/Scenes/SceneView.h>

#include <cstdint>
#include <optional>

namespace fulcrum {

class SceneWorld;

enum class SceneKind : uint8_t {
    Performance,  // timed by the benchmark; its numbers are fixed
    Sample,       // shows a feature; its figure says whether the feature works
};

// Both ends are in it.
struct AccuracyRange {
    double lowest = 0, highest = 0;
};

struct Scene {
    const char* name;         // lower case, words joined by _
    const char* description;  // one line
    SceneKind kind = SceneKind::Sample;
    int steps = 300;  // of 1/60 s: what a run takes unless told otherwise
    bool sleeping = true;
    bool usesSeed = false;  // whether another seed makes another world
    // Whether every dynamic body is created above or at the place where it is to stay: it drifts if it moves sideways.
    bool isBuiltToStand = false;
    // Whether nothing but gravity drives the bodies, and no spring stores energy: kinetic plus potential energy must
    // never rise.
    bool isClosed = false;
    // Runs whose median is the accuracy figure of the benchmark, where one run is chance: the gravity of each is larger
    // than that of the one before by a millionth. The first is the one that is timed.
    int accuracyRuns = 1;
    SceneView view{};
    // Other settings than the defaults; null: none.
    void (*adjust)(SystemSettings& settings) = nullptr;
    // Creates the bodies. A scene may add and remove bodies later; recordings show that.
    void (*build)(SceneWorld& world) = nullptr;
    // Called before each step, when world.StepCount() steps are done. Null: nothing to do.
    void (*beforeStep)(SceneWorld& world, double dt) = nullptr;
    // Called after each step, when world.StepCount() counts it: for queries and drawing. Null: nothing to do.
    void (*afterStep)(SceneWorld& world) = nullptr;
    // A batch of queries that is timed after the last step, in place of the steps, and its size. Null: the steps are
    // timed.
    void (*query)(SceneWorld& world) = nullptr;
    int queryCount = 0;
    const char* queryName = "";
    // The same queries by a call each, timed beside the batch. Null: only the batch.
    void (*querySingly)(SceneWorld& world) = nullptr;
    // The accuracy figure of a run, after its last step, and its meaning. Null if the run computes it.
    double (*accuracy)(const SceneWorld& world) = nullptr;
    const char* accuracyMeaning = "";
    const char* accuracyUnit = "";
    // Where the figure must be after the scene's own duration at the default settings; null: there is no telling, as of
    // wall clock.
    std::optional<AccuracyRange> accuracyRange{};
    // By how much its magnitude may grow before the benchmark calls a run less accurate than its baseline; null: any
    // figure will do.
    std::optional<double> accuracyTolerance{};
};

}  // namespace fulcrum
