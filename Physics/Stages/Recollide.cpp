#include <Fulcrum/Physics/Stages/Recollide.h>

#include <algorithm>

namespace fulcrum {

namespace {

// Contact points may disappear within a step, but the contact stays that of this step.
void MarkApart(PairStore& pairs, const Pair& pair) {
    ContactRecord& record = pairs.RecordOf(pair);
    record.ForgetImpulses();
    record.Set(ContactRecord::kApart, true);
}

bool IsFoundAnew(const ContactRecord& record) {
    return record.Has(ContactRecord::kRecollided) || record.Has(ContactRecord::kApart);
}

bool IsSolved(const Pair& pair) { return pair.touching && !pair.onSeam && pair.pointCount > 0; }

// Whether the bodies rotate so fast that manifolds are outdated before the end of a substep of h seconds, or body B, a
// kinematic one, so fast that the motion of its points is predicted for the start of the step only (FixedSide).
bool RotateTooFast(const CollideStores& stores, const Pair& pair, float h) {
    constexpr float kMostInSubstep = 1, kMostOfKinematic = 0.5f;  // rad
    const Vector3 ofB = stores.bodies.AngularVelocityOf(pair.bodyB);
    const float dt = stores.step.dt;
    if (pair.fixedB && LengthSquared(ofB) * dt * dt > kMostOfKinematic * kMostOfKinematic) return true;
    return LengthSquared(Vector3(stores.bodies.AngularVelocityOf(pair.bodyA) - ofB)) * h * h >
           kMostInSubstep * kMostInSubstep;
}

// Whether a pair with a surface has so many manifolds that to find them again would take too long.
bool HasManyManifolds(const PairStore& pairs, uint32_t index) {
    constexpr int kMany = 8;
    int count = 0;
    for (; index != PairStore::kNone; index = pairs.MoreOf(index)) ++count;
    return count > kMany;
}

void MarkFound(PairStore& pairs, const Pair& pair) {
    ContactRecord& record = pairs.RecordOf(pair);
    if (pair.onSeam) record.pointCount = 0;  // as RemoveSeamContacts left it
    else if (pair.touching) record.Set(ContactRecord::kRecollided, true);
}

}  // namespace

void RecollidePair(const CollideStores& stores, uint32_t contact, bool rotated, float h, WorkerFindings& findings) {
    PairStore& pairs = stores.pairs;
    uint32_t index = pairs.contacts[contact].pair;
    if (!IsSolved(pairs.pairs[index])) return;
    if (!pairs.pairs[index].surface && !rotated) return;
    if (IsFoundAnew(pairs.RecordOf(pairs.pairs[index]))) return;  // with another manifold of the surface
    if (RotateTooFast(stores, pairs.pairs[index], h)) return;
    if (pairs.pairs[index].isMore) index = pairs.Find(pairs.pairs[index].colliderA, pairs.pairs[index].colliderB);
    Pair& pair = pairs.pairs[index];
    const PairView view = ViewPair(stores, index);
    // For the motion of a whole step, as at its start: with less, contacts of edges would lose the points of their
    // faces.
    const float reach = PairReach(stores, pair, view.shapes).WithRotation(stores, pair, view.shapes);
    if (!pair.surface) {
        Manifold manifold;
        FindManifold(stores, view, reach, manifold, findings);
        if (manifold.pointCount == 0) return MarkApart(pairs, pair);
        // Other workers may solve what this contact balances: the next step drops the impulses of both.
        if (TurnsFromOthers(stores, view, manifold)) return;
        WriteManifold(stores, view, manifold, pairs.contacts[pair.contact], pairs.RecordOf(pair), findings);
        pairs.contacts[pair.contact].reference = view.bInA;
        return MarkFound(pairs, pair);
    }
    if (HasManyManifolds(pairs, index)) return;
    FindSurfaceManifolds(stores, view, index, reach, findings);
    WriteSurfaceManifolds(stores, view, index, false, findings);
    for (const uint32_t place : findings.surfacePlaces)
        if (place != PairStore::kNone && IsSolved(pairs.pairs[place])) MarkApart(pairs, pairs.pairs[place]);
    for (uint32_t i = index; i != PairStore::kNone; i = pairs.MoreOf(i)) {
        const Pair& slot = pairs.pairs[i];
        pairs.contacts[slot.contact].reference = view.bInA;
        if (!pairs.RecordOf(slot).Has(ContactRecord::kApart)) MarkFound(pairs, slot);
    }
}

template <int N, bool kFixedB>
void RefillContacts(const CollideStores& stores, const ContactPrepareSettings& settings, BodyStore& bodies,
                    ContactBatch<N, kFixedB>& batch) {
    PairStore& pairs = stores.pairs;
    for (int lane = 0; lane < batch.count; ++lane) {
        ContactRecord& record = pairs.records[batch.contact[lane]];
        if (!IsFoundAnew(record)) continue;
        record.Set(ContactRecord::kRecollided, false);
        const bool isApart = record.Has(ContactRecord::kApart);
        const Pair& pair = pairs.PairOf(batch.contact[lane]);
        BodyState states[2];
        BodyMass masses[2];
        BodyPose poses[2];
        for (int i = 0; i < 2; ++i) {
            const uint32_t body = i == 0 ? pair.bodyA : pair.bodyB;
            states[i] = bodies.states[body];
            masses[i] = bodies.masses[body];
            poses[i] = bodies.poses[body];
            const Quaternion q = stores.RotationOf(body);
            const float rotation[4] = {q.x, q.y, q.z, q.w};
            std::copy_n(rotation, 4, poses[i].rotation);
        }
        const Vector3 offset = stores.OffsetOf(pair.bodyA, pair.bodyB);
        for (int k = 0; k < 3; ++k) {
            poses[0].position[k] = 0;
            poses[1].position[k] = double{offset[k]};
        }
        RefillContact(batch, lane, pairs.records.data(), {states, masses, poses}, bodies.unconstrained[pair.bodyA].row,
                      kFixedB ? nullptr : bodies.unconstrained[pair.bodyB].row, settings, stores.elapsed);
        if (isApart) record.Set(ContactRecord::kApart, false);
    }
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                        \
    template void RefillContacts(const CollideStores&, const ContactPrepareSettings&, BodyStore&, \
                                 ContactBatch<lanes, fixedB>&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
