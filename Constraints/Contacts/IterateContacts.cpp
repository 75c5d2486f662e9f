#include <Fulcrum/Constraints/Contacts/ContactLanes.h>
#include <Fulcrum/Constraints/Contacts/ContactRows.h>

namespace fulcrum {

using namespace contacts;

template <int N, bool kFixedB>
bool IterateContact(ContactBatch<N, kFixedB>& batch, int lane, float overRelaxation, BodyState* states,
                    const ContactSolveSettings& settings, bool relax) {
    ContactBatch<1, kFixedB> single;
    ReadLane(batch, lane, single);
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
