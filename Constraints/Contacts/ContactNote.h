// Data of a contact that only contact events need: impulses summed over the step (the record has those of the last
// substep), and the approach speed of its points. Rows of eight floats, for lanes. Initialized by Prepare, accumulated
// by Solve; only for contacts with events. Unused points have zero impulse but an undefined speed.
#pragma once

#include <Fulcrum/Constraints/Contacts/ContactBatch.h>

namespace fulcrum {

struct alignas(64) ContactNote {
    static constexpr int kMaxPoints = ContactRecord::kMaxPoints;

    float impulse[kMaxPoints] = {0, 0, 0, 0};  // N s along the normal, by point
    float frictionImpulse[3] = {0, 0, 0};      // N s, world axes, on B
    float twistImpulse = 0;                    // N m s about the normal, on B
    float approachSpeed[kMaxPoints] = {0, 0, 0,
                                       0};  // m/s, >= 0, predicted for the time of impact from the start of the step
    float normal[3] = {0, 0, 0};            // unit, world axes, from A to B: normal used by the solver
    float spare = 0;

    // Indices in the two rows.
    enum Places { kNormalImpulses = 0, kFrictionImpulse = 4, kTwistImpulse = 7, kApproachSpeeds = 0, kNormal = 4 };
};
static_assert(sizeof(ContactNote) == 2 * sizeof(float) * kRowFloats);
FULCRUM_CHECK_PLACE(ContactNote, impulse, 0, ContactNote::kNormalImpulses);
FULCRUM_CHECK_PLACE(ContactNote, frictionImpulse, 0, ContactNote::kFrictionImpulse);
FULCRUM_CHECK_PLACE(ContactNote, twistImpulse, 0, ContactNote::kTwistImpulse);
FULCRUM_CHECK_PLACE(ContactNote, approachSpeed, 1, ContactNote::kApproachSpeeds);
FULCRUM_CHECK_PLACE(ContactNote, normal, 1, ContactNote::kNormal);

// Initializes the notes of a batch's contacts before the solve.
template <int N, bool kFixedB>
void BeginNotes(const ContactBatch<N, kFixedB>& batch, const ConstSolverBodies& bodies, ContactNote* notes);

// Adds the impulses of the substep just solved.
template <int N, bool kFixedB>
void AddRowImpulses(const ContactBatch<N, kFixedB>& batch, ContactNote* notes);

// Adds the given impulses: of the points, and of friction along the batch's tangents and about its normal.
template <int N, bool kFixedB>
void AddImpulses(const ContactBatch<N, kFixedB>& batch, const Wide<N> (&normal)[ContactNote::kMaxPoints],
                 const Wide<N> (&friction)[3], ContactNote* notes);

}  // namespace fulcrum
