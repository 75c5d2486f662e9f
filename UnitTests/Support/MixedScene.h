// One of everything, in a heap: the scene for comparing builds, threads and versions by their poses.
#pragma once

#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {

inline constexpr int kMixedSceneSteps = 300;

// Fills the world; call BeforeStep before each step of kStep seconds. Spheres, boxes, capsules,
// hulls and compounds fall on a floor and a ramp, a kinematic bar sweeps them together; some bounce, some are locked,
// damped, pushed, one is removed.
class MixedScene {
public:
    explicit MixedScene(TestWorld& world);
    void BeforeStep(int step);

private:
    TestWorld& world_;
    BodyId sweeper_, pushed_, removed_;
};

// HashPoses after kMixedSceneSteps with so many threads.
uint64_t HashOfMixedScene(uint32_t threads);

}  // namespace fulcrum::testing
