// Runs many short parallel phases, such as the solver's colors, with a cheap barrier between them. Called by the Solve
// stage on the thread that steps. Threads come from any JobSystem; nothing is allocated.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>

#include <span>

namespace fulcrum {

// Runs kernel(phase, block, worker) once for every block 0 .. blockCounts[phase] - 1 of every phase, and begins no
// block of a phase before all blocks of the earlier phases are done: what those wrote is visible. Blocks of one phase
// run in any order at the same time, `worker` (see JobRange) tells them apart. Returns when all are done.
//
// Each worker has the same contiguous share of the blocks in every phase with the same count, unless a worker stalls,
// so that its data stay in its cache. A phase of one block is run by the leader, nearly always the caller, and needs no
// barrier if another such phase follows. Blocks should take 1 us or more. What a kernel throws is thrown by the call;
// some blocks have not been run then.
//
// No helper thread is required: helpers may join at any time, and blocks of workers that do not come are taken by
// others. Phases of 2^20 blocks or more, and more than 2^24 phases, are run on one thread alone.
void RunPhases(JobSystem& jobs, std::span<const uint32_t> blockCounts,
               FunctionRef<void(uint32_t phase, uint32_t block, uint32_t worker)> kernel);

}  // namespace fulcrum
