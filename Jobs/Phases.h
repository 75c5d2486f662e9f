// Many short parallel phases with a cheap barrier between each and the next: the solver's colors.
// Called by the Solve stage on the thread that steps. Threads come from any JobSystem; nothing is allocated.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>

#include <span>

namespace fulcrum {

// Runs kernel(phase, block, worker) once for every block 0 .. blockCounts[phase] - 1 of every phase, and begins no
// block of a phase before all blocks of the earlier phases are done: what those wrote is visible. Blocks of one phase
// run in any order at the same time, `worker` (see JobRange) tells them apart. Returns when all are done.
//
// Each worker has the same contiguous share of the blocks in every phase with the same count, as long as nobody falls
// behind, so that its data stay in its cache. A phase of one block is run by the one thread that leads, nearly always
// the caller, and costs no barrier where another such phase follows. Blocks should take 1 us or more. A kernel must not
// throw.
//
// It counts on no helper: those that come at any time take blocks, and all blocks of those that do not are taken over.
// Phases of 2^20 blocks or more, and more than 2^24 phases, are run on one thread alone.
void RunPhases(JobSystem& jobs, std::span<const uint32_t> blockCounts,
               FunctionRef<void(uint32_t phase, uint32_t block, uint32_t worker)> kernel);

}  // namespace fulcrum
