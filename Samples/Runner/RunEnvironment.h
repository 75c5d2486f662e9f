// When and on what a program runs, for the heads of its files. Any thread.
#pragma once

#include <string>

namespace fulcrum {

std::string UtcNow();        // as 2026-01-31T23:59:59Z
std::string CpuModel();      // as the system names it; "unknown" where it does not
std::string CompilerName();  // with its version
int CoreCount();             // 0 where the system does not say
std::string CommitText();    // of the environment's FULCRUM_COMMIT, which ./fulcrum sets; empty where it is not set

}  // namespace fulcrum
