// Additional iterations over the contacts around light bodies that heavy ones hit. Of the approach of a heavy body M to
// a light one m that lies on the ground, an iteration over all contacts stops only the part m / (m + M): the light body
// is pressed into its support, and the velocity of recovery, of which a relax iteration stops as little, throws the
// heavy one back. So where a contact of bodies of different mass has a large velocity error
// (ContactSolveSettings::mostError), the contacts of both bodies are iterated, and those of all bodies whose contacts
// turn out to be as wrong, until none is, or the effort for a cluster of such bodies is used up: what many bodies do to
// each other in a heap is left to the usual iterations. The same where such a light body hits what it lies on. Serial,
// in the order of the colors. Bodies with joints are left out: their joints would have to be iterated, too. Position
// iterations in the same way where an overlap has grown too much in the step (LimitDepth). Used by Solve.
#pragma once

#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/JointStore.h>
#include <Fulcrum/Physics/World/UnionFind.h>

#include <atomic>
#include <span>

namespace fulcrum {

// Scratch memory of all groups of a step. Contacts, and lanes without one, have indices in the order of solving: by
// group, color, moving before fixed ones; those without a color come before all others.
struct LocalMemory {
    // Empty without contacts.
    LocalMemory(const BodyStore& bodies, const SolverLayout& layout, ScratchArena& scratch);

    std::span<bool> isUneven;    // by body: some contact of it is with a body of different mass; empty if there is none
    std::span<uint8_t> wrongIn;  // by body: the substep, from 1, in which some contact of it was wrong last
    std::span<uint32_t> contactsBegin;     // by body: in `contactsOfBodies`
    std::span<uint32_t> contactsEnd;       // likewise
    std::span<uint32_t> contactsOfBodies;  // two for each contact
    std::span<bool> iterates;              // by contact
    // By body: clusters of bodies whose contacts were iterated, as sets, and how often, at the root of a set.
    std::span<uint32_t> clusters, iterations;
};

// Those of one group.
class LocalIterations {
public:
    LocalIterations(const BodyStore& bodies, const JointStore& joints, SolverLayout& layout, const SolverGroup& group,
                    const LocalMemory& memory);

    // After a velocity iteration over a batch. Called by several threads, for different batches.
    template <int N, bool kFixedB>
    void Check(const ContactBatch<N, kFixedB>& batch, uint8_t substep) {
        if (batch.unsolved != 0) MarkBodies(batch, substep);
    }
    // Whether some contact was wrong in the substep.
    bool AreNeededIn(uint8_t substep) const { return lastWrong_.load(std::memory_order_relaxed) == substep + 1; }
    // relax: after the relax iterations of the substep, else after its velocity iterations.
    void Run(BodyState* states, const ContactSolveSettings& settings, uint8_t substep, bool relax);

    // The same for the depths, after the separations of a batch were updated.
    template <int N, bool kFixedB>
    void CheckDepths(const ContactBatch<N, kFixedB>& batch, uint8_t substep) {
        if (batch.deepened != 0) NoteDeepened(batch, substep);
    }
    bool IsAnyTooDeepIn(uint8_t substep) const { return lastDeepened_.load(std::memory_order_relaxed) == substep + 1; }
    void LimitDepths(BodyState* states, const ContactSolveSettings& settings);

private:
    template <int N, bool kFixedB>
    void MarkBodies(const ContactBatch<N, kFixedB>& batch, uint8_t substep);
    template <int N, bool kFixedB>
    void NoteDeepened(const ContactBatch<N, kFixedB>& batch, uint8_t substep);
    template <int N, bool kFixedB>
    bool IsTooDeep(const ContactBatch<N, kFixedB>& batch, int lane) const;
    template <class Visit>
    void VisitRanges(Visit&& visit);
    void ListContacts();
    template <class Iterate>
    void IterateMarked(Iterate&& iterate);
    void MarkContactsOf(uint32_t body);
    bool IsJointed(uint32_t a, uint32_t b) const { return joints_.HasAny(a) || joints_.HasAny(b); }
    std::span<const uint32_t> Bodies() const { return layout_.BodiesOf(group_); }
    std::span<const uint32_t> ContactsOf(uint32_t body) const;
    uint32_t JoinClusters(UnionFind& clusters, uint32_t a, uint32_t b);

    const BodyStore& bodies_;
    const JointStore& joints_;
    SolverLayout& layout_;
    const SolverGroup& group_;
    const LocalMemory& memory_;
    bool areListed_ = false;
    std::atomic<int> lastWrong_ = 0, lastDeepened_ = 0;  // the substep, from 1
};

}  // namespace fulcrum
