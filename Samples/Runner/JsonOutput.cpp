#include <Fulcrum/Samples/Runner/JsonOutput.h>

#include <Fulcrum/Physics/Files/WholeFile.h>

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <cstdio>

namespace fulcrum {

JsonOutput::JsonOutput(std::filesystem::path path) : path_(std::move(path)) {
    if (path_ != "-") return;
    std::fflush(stdout);
    standardOutput_ = dup(STDOUT_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
}

JsonOutput::~JsonOutput() {
    if (standardOutput_ < 0) return;
    std::fflush(stdout);
    dup2(standardOutput_, STDOUT_FILENO);
    close(standardOutput_);
}

std::string JsonOutput::Check() const {
    if (path_ == "-") return standardOutput_ < 0 ? "--json -: there is no standard output" : "";
    if (path_.empty()) return {};
    const std::filesystem::path folder = path_.parent_path();
    std::error_code error;
    if (!folder.empty() && !std::filesystem::is_directory(folder, error))
        return "--json " + path_.string() + ": there is no folder " + folder.string();
    const Status writable = CheckWritable(path_);
    return writable ? "" : "--json: " + writable.GetError().message;
}

std::string JsonOutput::Write(const nlohmann::ordered_json& json, bool saysWhere) const {
    const std::string text = json.dump(2) + "\n";
    if (path_ == "-") {
        for (size_t written = 0; written < text.size();) {
            const ssize_t count = write(standardOutput_, text.data() + written, text.size() - written);
            if (count <= 0) return "cannot write the JSON to standard output";
            written += static_cast<size_t>(count);
        }
        return {};
    }
    if (const Status written = WriteWholeFile(path_, {text}); !written) return written.GetError().message;
    if (saysWhere) std::printf("Wrote %s\n", path_.c_str());
    return {};
}

}  // namespace fulcrum
