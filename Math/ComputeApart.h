// Keeps arithmetic inside of a scope of DefaultFloats. A compiler knows nothing of the register that the scope sets:
// what only the caller uses of a result may sink below the scope's end, where the caller's rounding and traps hold
// again. A call that is not inlined keeps it between. For functions that return numbers which they compute themselves.
#pragma once

namespace fulcrum {

template <class Compute>
[[gnu::noinline]] auto ComputeApart(const Compute& compute) {
    return compute();
}

}  // namespace fulcrum
