// Forces and torques of the interface act for a step, and are given again for the next. One that stays the same, as
// wind or buoyancy, does not keep a body awake: the body falls asleep under it, and sleeps while it is given again in
// each step. It wakes as soon as the push is another, or ends. And kinematic bodies that were moved for one step. One
// thread.
#pragma once

#include <Fulcrum/Physics/World/Waking.h>

namespace fulcrum {

// As a step begins: bodies whose push is another than in the last step count as moving, and wake.
void BeginPushes(const SleepStores& stores);
// Of a body that the user puts to sleep, or that is dynamic no more: nothing pushes it, nor did before.
void ForgetPush(BodyStore& bodies, uint32_t body);
// As it ends: what sleeps has used its push, too.
void EndPushes(BodyStore& bodies);

// As a step begins: those that were moved in the last one, and not told again, stop.
void BeginSingleMoves(BodyStore& bodies);

}  // namespace fulcrum
