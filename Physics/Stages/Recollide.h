// Collision within the step. The rows of a contact are linear in the bodies' motion, and its normal is constant: valid
// for small rotations. Bodies that rotate farther relative to each other within the step, or slide over a static or
// kinematic one, by thresholds relative to their size (ContactBatch::rotated), collide again before the next substep,
// and their rows are replaced.
// Used by Solve, for the contacts of one color at a time.
#pragma once

#include <Fulcrum/Physics/Stages/PairView.h>

namespace fulcrum {

// Collides the pair of a contact again, all its manifolds if it is with a surface, at the poses of the stores' time.
// The records of these must have the impulses of the last substep. rotated: it did not only slide, which is for
// surfaces: seams of others would get contacts that RemoveSeamContacts removed. h: s, of a substep. Manifolds found in
// a contact that is solved already replace it, others are left to the next step.
void RecollidePair(const CollideStores& stores, uint32_t contact, bool rotated, float h, WorkerFindings& findings);

// Replaces the rows of the contacts of a batch that were found again, and forgets that.
template <int N, bool kFixedB>
void RefillContacts(const CollideStores& stores, const ContactPrepareSettings& settings, BodyStore& bodies,
                    ContactBatch<N, kFixedB>& batch);

}  // namespace fulcrum
