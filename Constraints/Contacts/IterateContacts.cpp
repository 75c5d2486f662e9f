#include <Fulcrum/Constraints/Contacts/ContactLanes.h>
#include <Fulcrum/Constraints/Contacts/ContactRows.h>

namespace fulcrum {

using namespace contacts;

template <int N, bool kFixedB>
bool IterateContact(ContactBatch<N, kFixedB>& batch, int lane, float overRelaxation, BodyState* states,
                    const ContactSolveSettings& settings, bool relax) {
    ContactBatch<1, kFixedB> single;
    VisitLane(batch, lane, single, [](const void* from, void* to) { std::memcpy(to, from, sizeof(float)); });
    single.contact[0] = batch.contact[lane];
    single.bodyA[0] = batch.bodyA[lane];
    single.bodyB[0] = batch.bodyB[lane];
    single.count = 1;
    single.pointCount = batch.pointCount;
    single.bounces = batch.bounces;
    single.hasNotes = batch.hasNotes;
    single.hasSurface = batch.hasSurface;
    single.gentle = batch.gentle >> lane & 1;
    single.isGuided = batch.isGuided;
    single.locks[0] = batch.locks[lane];
    single.inverseSoftDepth = batch.inverseSoftDepth[lane];
    for (int i = 0; i < batch.pointCount; ++i)
        single.rows[i].inverseResponse = single.rows[i].inverseResponse * Wide<1>(overRelaxation);
    if (relax) SolveAllRows<Pass::Relax>(single, states, settings);
    else SolveContactVelocities(single, states, settings);
    for (int i = 0; i < batch.pointCount; ++i) batch.rows[i].impulse.Set(lane, single.rows[i].impulse[0]);
    for (int k = 0; k < 3; ++k) batch.frictionImpulse[k].Set(lane, single.frictionImpulse[k][0]);
    return single.unsolved != 0;
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                          \
    template bool IterateContact(ContactBatch<lanes, fixedB>&, int, float, BodyState*, const ContactSolveSettings&, \
                                 bool);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
