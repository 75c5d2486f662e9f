#include <Fulcrum/Samples/Runner/RunEnvironment.h>

#include <Fulcrum/Math/Wide.h>
#include <Fulcrum/Version.h>

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

namespace fulcrum {

std::string UtcNow() {
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&now, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

std::string CpuModel() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        const size_t colon = line.find(": ");
        if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::string CompilerName() {
#ifdef __clang__
    return std::string("Clang ") + __clang_version__;
#elif defined(__GNUC__)
    return std::string("GCC ") + __VERSION__;
#else
    return "unknown";
#endif
}

std::string CommitText() {
    const char* commit = std::getenv("FULCRUM_COMMIT");
    return commit ? commit : "";
}

int CoreCount() { return static_cast<int>(std::thread::hardware_concurrency()); }

nlohmann::ordered_json FileHead(const char* program) {
    using Json = nlohmann::ordered_json;
    const std::string commit = CommitText();
    return {{"schema", kFileSchema},
            {"program", program},
            {"version", FULCRUM_VERSION_STRING},
            {"date", UtcNow()},
            {"commit", commit.empty() ? Json() : Json(commit)},
            {"machine", {{"cpu", CpuModel()}, {"cores", CoreCount()}}},
            {"compiler", CompilerName()},
            {"lanes", kLanes}};
}

}  // namespace fulcrum
