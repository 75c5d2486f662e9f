// When and on what a program runs, for the heads of its files. Any thread.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace fulcrum {

std::string UtcNow();        // as 2026-01-31T23:59:59Z
std::string CpuModel();      // as the system names it; "unknown" where it does not
std::string CompilerName();  // with its version
int CoreCount();             // 0 where the system does not say
std::string CommitText();    // of the environment's FULCRUM_COMMIT, which ./fulcrum sets; empty where it is not set

// What the files of --json begin with: schema, program, version, date, commit (null: unknown), machine, compiler,
// lanes.
nlohmann::ordered_json FileHead(const char* program);
// Increment with each change after which older files cannot be read. In 1 files of `run` had no head, and lanes of
// `bench` were text.
inline constexpr int kFileSchema = 2;

}  // namespace fulcrum
