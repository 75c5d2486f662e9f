// The kernels of contacts with one lane, which the tests hold those of the engine against.
#include <Fulcrum/Math/Wide.h>

#if FULCRUM_LANES != 1
#undef FULCRUM_KERNEL_LANES
#define FULCRUM_KERNEL_LANES 1
#include <Fulcrum/Constraints/Contacts/PrepareContacts.cpp>
#include <Fulcrum/Constraints/Contacts/PullContacts.cpp>
#include <Fulcrum/Constraints/Contacts/RestituteContacts.cpp>
#include <Fulcrum/Constraints/Contacts/SolveContacts.cpp>
#include <Fulcrum/Constraints/Contacts/SolveRareContacts.cpp>
#endif
