// The contacts of an island that is solved directly: between their batches and the direct solver. Used by DirectIsland.
//
// A point is a row that pushes, and gives way by its impulse times gamma, a small part of the impulse's own motion. A
// load would make more of it the heavier it is: so gamma is less where the impulses are large. The friction of a
// manifold is a patch (DirectProblem.h). Overlaps are corrected in the poses.
#pragma once

#include <Fulcrum/Constraints/Direct/DirectProblem.h>
#include <Fulcrum/Jobs/ScratchArena.h>
#include <Fulcrum/Physics/Stages/SolverLayout.h>
#include <Fulcrum/Physics/World/BodyStore.h>
#include <Fulcrum/Physics/World/PairStore.h>

namespace fulcrum {

// Not for direct solutions with contacts are islands of which so many steps took long: as many more as they took
// longer.
inline constexpr uint8_t kMostMisses = 12;

// So few contacts are solved however long it takes.
inline constexpr size_t kFewContacts = 3;

// Whether the contacts of a body in an island of so many may be: not those of bodies created inside each other, and,
// until they fall asleep, of those of which solutions took long.
inline bool MayBeSolvedDirectly(const BodyStore& bodies, uint32_t body, size_t contacts) {
    return !bodies.dynamics[body].crowded && (contacts <= kFewContacts || bodies.cold[body].directMisses < kMostMisses);
}
// The same of a contact with another body: not with masses of its own, nor with kinematic bodies, which press with any
// force and wedge what is in their way.
inline bool MayBeSolvedDirectly(const BodyStore& bodies, const PairStore& pairs, uint32_t contact, uint32_t other) {
    const bool hasMasses = !pairs.massOverrides.empty() && pairs.records[contact].Has(ContactRecord::kMassOverride);
    return !hasMasses && bodies.dynamics[other].motion != MotionType::Kinematic;
}

class DirectContacts {
public:
    // localOf: see DirectIsland. h: s, of a substep. give: m/s, by which a contact may give way.
    DirectContacts(BodyStore& bodies, SolverLayout& layout, const SolverGroup& group, std::span<const uint32_t> localOf,
                   double h, double give, ScratchArena& scratch);

    bool AreAny() const { return !contacts_.empty(); }
    size_t Count() const { return contacts_.size(); }
    size_t MostRows() const { return contacts_.size() * (ContactRecord::kMaxPoints + 3); }
    std::span<const DirectPatch> Patches() const { return patches_.first(patchCount_); }
    // See MayBeSolvedDirectly.
    bool MayBeSolvedDirectly(const PairStore& pairs) const;

    // Appends the rows to the first `count` of `rows`, with the impulses of the last substep. island: bodies with the
    // velocities that they have without constraints. False if some contact bounces.
    bool AddRows(std::span<const DirectBody> island, const ContactSolveSettings& settings, std::span<DirectRow> rows,
                 size_t& count);
    // Makes rows stiffer that give way by more than they may. False if there is none.
    bool Stiffen(std::span<DirectRow> rows);
    void ReadImpulses(std::span<const DirectRow> rows);
    // Those of bodies that are wedged are balanced, but too large for a warm start of iterations.
    void ForgetImpulses();

    // Appends the rows of a correction of poses to the first `count` of `to`. rows: those of the solution. False if
    // they ask for nothing.
    bool AddCorrections(std::span<const DirectRow> rows, const ContactSolveSettings& settings, std::span<DirectRow> to,
                        size_t& count) const;
    void UpdateSeparations(const ContactSolveSettings& settings);

private:
    // Its rows: points in use, tangents and twist.
    struct Contact {
        uint32_t first;
        uint8_t normals;
        bool hasFriction;
        double stiffness;  // gamma is divided by this
        double size;       // m, of the smaller body there: its arm
        std::span<DirectRow> RowsOf(std::span<DirectRow> rows) const {
            return rows.subspan(first, normals + (hasFriction ? 3u : 0u));
        }
    };
    template <class Visit>
    void VisitBatches(Visit&& visit) const;
    bool Stiffen(Contact& contact, std::span<DirectRow> rows, double beyond) const;

    BodyStore& bodies_;
    SolverLayout& layout_;
    const SolverGroup& group_;
    std::span<const uint32_t> localOf_;
    double h_, give_;
    std::span<Contact> contacts_;  // by lane of the batches
    std::span<DirectPatch> patches_;
    size_t patchCount_ = 0;
};

}  // namespace fulcrum
