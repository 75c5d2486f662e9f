// Keeps arithmetic inside of a scope of DefaultFloats. A compiler knows nothing of the register that the scope sets:
// what only the caller uses of a result may sink below the scope's end, where the caller's rounding and traps hold
// again, and a call without other effects as a whole. The empty statement is an effect that needs the result. For
// functions that return numbers which they compute themselves.
#pragma once

namespace fulcrum {

template <class Compute>
[[gnu::noinline]] auto ComputeApart(const Compute& compute) {
    auto result = compute();
    asm volatile("" : "+m"(result) : : "memory");
    return result;
}

}  // namespace fulcrum
