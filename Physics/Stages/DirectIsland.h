// An island whose joints are solved directly (Constraints/Direct), between its batches and the direct solver: fills the
// rows from the batches, writes velocities and impulses back, and moves the poses by what the joints are off. Contacts
// are iterated: to them all joints together are one more constraint. Used by Solve, one thread per island. The group of
// the island has no other; its joints are all in JointBatches.
#pragma once

#include <Fulcrum/Constraints/Direct/DirectSolver.h>
#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/World/BodyStore.h>

namespace fulcrum {

class DirectIsland {
public:
    // After Prepare. h: s, of a substep. localOf: by body of the world, to work with; may be shared with other islands.
    // gravity: m/s2.
    DirectIsland(BodyStore& bodies, SolverLayout& layout, const SolverGroup& group, float h, float gravity,
                 std::span<uint32_t> localOf, ScratchArena& scratch);

    // What the velocities are without the joints: the unconstrained ones, or, where there are contacts, too, the
    // current ones less the change by the last impulses.
    enum class From { Unconstrained, Current };

    // The velocities and impulses of all joints. False if that takes too long: then both are as before.
    bool SolveVelocities(From from, ScratchArena& scratch);

    // A position iteration of joints: before that of single rows and contacts notes where the bodies are. After it
    // moves them so that J times the change of pose of both is minus the bias of the locks. Adds no velocity.
    void NotePlaces();
    void CorrectPoses(ScratchArena& scratch);

private:
    void SetBodies(From from);

    BodyStore& bodies_;
    SolverLayout& layout_;
    const SolverGroup& group_;
    double h_, gravity_;
    std::span<uint32_t> localOf_;
    DirectPattern pattern_;
    DirectFactor factor_;
    bool isFactorCurrent_ = false;  // made with the Jacobians of this substep
    std::span<DirectBody> island_;
    std::span<DirectRow> rows_, across_, corrections_;
    std::span<DirectStiffness> stiffness_;
    std::span<DirectVelocity> solved_;
    std::span<Twist<float>> places_;
};

}  // namespace fulcrum
