// The kernels of joints with one lane, which the tests hold those of the engine against.
#include <Fulcrum/Math/Wide.h>

#if FULCRUM_LANES != 1
#undef FULCRUM_KERNEL_LANES
#define FULCRUM_KERNEL_LANES 1
#include <Fulcrum/Constraints/Joints/PrepareJoints.cpp>
#include <Fulcrum/Constraints/Joints/PullJoints.cpp>
#include <Fulcrum/Constraints/Joints/SolveBalls.cpp>
#include <Fulcrum/Constraints/Joints/SolveJoints.cpp>
#endif
