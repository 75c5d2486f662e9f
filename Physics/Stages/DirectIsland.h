// An island that is solved directly (Constraints/Direct): between its batches and the direct solver. Fills the rows
// from the batches, writes velocities and impulses back, and moves the poses by what joints and contacts are off.
// Either all constraints are solved together, or the joints alone, where contacts bounce or cannot be rows: to these
// iterations all joints together are one more constraint. Used by Solve, one thread per island. The group of the island
// has no other; its joints are all in JointBatches.
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
    bool HasJoints() const { return hasJoints_; }
    bool HasContacts() const { return contacts_.AreAny(); }
    // Not for direct solutions with contacts are islands of which so many steps took long: as many more as they took
    // longer.
    static constexpr uint8_t kMostMisses = 12;
    // Added to BodyCold::directMisses of bodies that were solved so since they woke.
    static constexpr uint8_t kWasDirect = 0x80;
    static bool HasManyMisses(const BodyCold& body) { return (body.directMisses & ~kWasDirect) >= kMostMisses; }
    // Whether it has contacts, and all can be solved together. After Prepare.
    bool MayBeWhole(const ContactRecord* records) const;
    // At the end of the step, where it was solved whole: counts those steps, of all bodies. True if they are so many.
    bool NoteMisses();

    // What the velocities are without the joints: the unconstrained ones, or, where there are contacts, too, the
    // current ones less the change by the last impulses.
    enum class From { Unconstrained, Current };

    // The velocities and impulses of all joints. False if that takes too long: then both are as before.
    bool SolveJoints(From from, ScratchArena& scratch);
    // The same of all constraints. False if a contact bounces, too.
    bool SolveAll(const ContactSolveSettings& settings, ScratchArena& scratch);

    // A position iteration: before that of single rows notes where the bodies are. After it moves them so that J times
    // the change of pose of both is minus the bias of the locks. The same for contacts after SolveAll. Adds no
    // velocity.
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
    bool hasJoints_ = false;
    bool isWhole_ = false;                         // all constraints were solved together last
    uint32_t solutions_ = 0, factorizations_ = 0;  // of the whole, in this step
    bool isFactorCurrent_ = false;                 // made with the Jacobians of this substep
    std::span<DirectBody> island_;
    std::span<DirectRow> rows_, across_, corrections_;
    size_t acrossCount_ = 0, stiffnessCount_ = 0;
    std::span<DirectStiffness> stiffness_;
    std::span<DirectVelocity> solved_;
    std::span<Twist<float>> places_;
};

}  // namespace fulcrum
