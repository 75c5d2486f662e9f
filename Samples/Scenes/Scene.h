// A scene: how a world is filled and by which figure a run of it is judged. One scene serves sample, test and
// benchmark; Scenes.cpp lists them all. Constants, so any thread may read them.
#pragma once

#include <Fulcrum/Physics/Settings.h>

#include <cstdint>

namespace fulcrum {

class SceneWorld;

enum class SceneKind : uint8_t {
    Performance,  // timed by the benchmark; its numbers are fixed
    Sample,       // shows a feature; its figure says whether the feature works
};

struct Scene {
    const char* name;         // lower case, words joined by _
    const char* description;  // one line
    SceneKind kind = SceneKind::Sample;
    int steps = 300;  // of 1/60 s: what a run takes unless told otherwise
    bool sleeping = true;
    bool usesSeed = false;  // whether another seed makes another world
    // Other settings than the defaults; null: none.
    void (*adjust)(SystemSettings& settings) = nullptr;
    // Creates the bodies. A scene may remove some later, and add others: recordings show them as they come and go.
    void (*build)(SceneWorld& world) = nullptr;
    // Called before each step, when world.StepCount() steps are done. Null: nothing to do.
    void (*beforeStep)(SceneWorld& world, double dt) = nullptr;
    // Called after each step, when world.StepCount() counts it: asks queries, draws. Null: nothing to do.
    void (*afterStep)(SceneWorld& world) = nullptr;
    // A batch that is timed after the last step, in place of the steps: how many of what one call answers. Null: the
    // steps are timed.
    void (*query)(SceneWorld& world) = nullptr;
    int queryCount = 0;
    const char* queryName = "";
    // How exact a run was, after its last step, and what that number means. Null where only the run itself can tell.
    double (*accuracy)(const SceneWorld& world) = nullptr;
    const char* accuracyMeaning = "";
};

}  // namespace fulcrum
