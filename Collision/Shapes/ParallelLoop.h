// A parallel-for callback that lets slow builds of shapes use threads without depending on a job system.
#pragma once

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Math/Function.h>

#include <cstdint>

namespace fulcrum {

// Runs job(i) once for each i in 0 .. count - 1, on any threads in any order, and returns when all are done. Easily
// made from JobSystem::ParallelFor. Empty: serial.
using ParallelLoop = Function<void(uint32_t count, const Function<void(uint32_t)>& job)>;

inline void RunLoop(const ParallelLoop& parallel, uint32_t count, const Function<void(uint32_t)>& job) {
    if (parallel && count > 1) {
        parallel(count, [&](uint32_t i) {
            const DefaultFloats floats;
            job(i);
        });
    } else {
        for (uint32_t i = 0; i < count; ++i) job(i);
    }
}

}  // namespace fulcrum
