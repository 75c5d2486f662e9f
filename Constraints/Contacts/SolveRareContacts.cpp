#include <Fulcrum/Constraints/Contacts/ContactRows.h>

namespace fulcrum::contacts {

template <bool kRelax, int N, bool kFixedB>
void SolveRareRows(ContactBatch<N, kFixedB>& batch, BodyState* states, const ContactSolveSettings& settings) {
    SolveRows<kRelax, true>(batch, states, settings);
}

template <int N, bool kFixedB>
void WarmStartRareRows(ContactBatch<N, kFixedB>& batch, BodyState* states) {
    WarmStartRows<true>(batch, states);
}

#define FULCRUM_INSTANTIATE(lanes, fixedB)                                                                     \
    template void SolveRareRows<false>(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&); \
    template void SolveRareRows<true>(ContactBatch<lanes, fixedB>&, BodyState*, const ContactSolveSettings&);  \
    template void WarmStartRareRows(ContactBatch<lanes, fixedB>&, BodyState*);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, false)
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE, true)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum::contacts
