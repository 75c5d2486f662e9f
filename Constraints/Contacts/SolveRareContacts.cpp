#include <Fulcrum/Constraints/Contacts/BounceContacts.h>
#include <Fulcrum/Constraints/Contacts/ContactRows.h>

namespace fulcrum::contacts {

template <Pass kPass, int N, bool kFixedB>
void SolveRareRows(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    if (batch.bounces) BounceContacts<kPass == Pass::Relax>(batch, states, settings);
    SolveRows<kPass, true>(batch, states, settings);
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                          \
    template void SolveRareRows<Pass::Push>(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&); \
    template void SolveRareRows<Pass::PushAndFriction>(ContactBatch<lanes, fixedB>&, BodyState*,                    \
                                                       const ContactSolveSettings&);                                \
    template void SolveRareRows<Pass::Relax>(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum::contacts
