// An island that is solved directly (Constraints/Direct): between its batches and the direct solver. Fills the rows
// from the batches, writes velocities and impulses back, and moves the poses by what joints and contacts are off.
// Either its joints are solved, where contacts, too, are iterated: to these iterations all joints together are one more
// constraint. Or, in islands under load, which have no joints, its contacts. Used by Solve, one thread per island. The
// group of the island has no other; its joints are all in JointBatches.
#pragma once

#include <Fulcrum/Constraints/Direct/DirectSolver.h>
#include <Fulcrum/Physics/Stages/DirectContacts.h>
#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/World/BodyStore.h>

namespace fulcrum {

class DirectIsland {
public:
    // h: s, of a substep. localOf: by body of the world, to work with; may be shared with other islands. gravity: m/s2.
    DirectIsland(BodyStore& bodies, SolverLayout& layout, const SolverGroup& group, float h, float gravity,
                 std::span<uint32_t> localOf, ScratchArena& scratch);

    const SolverGroup& Group() const { return group_; }
    bool HasContacts() const { return contacts_.AreAny(); }
    // Whether its contacts may be solved in this step. After Prepare.
    bool MaySolveContacts(const PairStore& pairs) const;
    // At the end of a step in which they were: counts, of all bodies, steps that took long. True if they are many.
    bool NoteMisses();

    // What the velocities are without the joints: the unconstrained ones, or, where there are contacts, too, the
    // current ones less the change by the last impulses.
    enum class From { Unconstrained, Current };

    // The velocities and impulses of all joints. False if that takes too long: then both are as before.
    bool SolveJoints(From from, ScratchArena& scratch);
    // The same of all contacts. False if one bounces, too.
    bool SolveContacts(const ContactSolveSettings& settings, ScratchArena& scratch);

    // A position iteration: before that of single rows notes where the bodies are. After it moves them so that J times
    // the change of pose of both is minus the bias of the locks; likewise for contacts under load. Adds no velocity.
    void NotePlaces(const ContactSolveSettings& settings);
    void CorrectPoses(const ContactSolveSettings& settings, ScratchArena& scratch);

private:
    void SetBodies(From from);
    size_t AddJoints();
    bool Solve(std::span<DirectRow> rows, ScratchArena& scratch);
    void WriteVelocities();

    BodyStore& bodies_;
    SolverLayout& layout_;
    const SolverGroup& group_;
    double h_, speed_, tolerance_ = 0;
    std::span<uint32_t> localOf_;
    DirectContacts contacts_;
    DirectPattern pattern_;
    DirectFactor factor_;
    uint32_t solutions_ = 0, factorizations_ = 0;  // of contacts, in this step
    bool isFactorCurrent_ = false;                 // made with the Jacobians of this substep
    std::span<DirectBody> island_;
    std::span<DirectRow> rows_, across_, corrections_;
    size_t acrossCount_ = 0, stiffnessCount_ = 0;
    std::span<DirectStiffness> stiffness_;
    std::span<DirectVelocity> solved_;
    std::span<Twist<float>> places_;
};

}  // namespace fulcrum
