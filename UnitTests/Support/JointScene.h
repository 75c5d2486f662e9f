// Joints of every kind in one world: the scene for comparing builds, threads and versions of joints.
#pragma once

#include <Fulcrum/UnitTests/Support/TestWorld.h>

namespace fulcrum::testing {

inline constexpr int kJointSceneSteps = 240;

// Fills the world; call BeforeStep before each step of kStep seconds. Mechanisms of all kinds with limits, motors,
// friction and springs, some in a plane; a chain whose load makes it a tree; a curtain large enough that all workers
// share it; a body with more joints than there are colors; ragdolls and a car on the floor; what sleeps until it is
// hit. Joints break, are removed, and are switched off and on.
class JointScene {
public:
    static SystemSettings Settings();

    explicit JointScene(TestWorld& world);
    void BeforeStep(int step);
    // Fails the test if expected events of the scene have not happened.
    void ExpectAllHappened() const;
    // Of the bodies' poses and velocities, and of where joints are and what they carry.
    uint64_t Hash() const;

private:
    void AddChains();
    void AddPlane();
    void AddSprings();
    void AddShoulders();
    void AddGears();
    void AddPathsAndRopes();
    void AddCar();
    void AddCurtain();
    void AddHub();
    void AddSleepers();
    void AddWhatBreaks();
    void AddRagdolls();

    TestWorld& world_;
    BodyId swing_, removedBody_, sleeper_, hub_;
    JointId removed_, driven_, switched_, winch_, wheel_, gate_, shoulder_, breaking_;
    bool slept_ = false, woke_ = false, broke_ = false, overflowed_ = false;
};

// The type of the scene's one joint that is not of the engine's kinds: a screw.
std::unique_ptr<JointType> MakeScrew();

// Hash after kJointSceneSteps with so many threads.
uint64_t HashOfJointScene(uint32_t threads);

}  // namespace fulcrum::testing
