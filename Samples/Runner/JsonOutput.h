// The destination of --json: a file, or standard output for "-". While an output of that name exists, all other output
// goes to standard error, so that standard output is pure JSON. One at a time, one thread.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>

namespace fulcrum {

class JsonOutput {
public:
    explicit JsonOutput(std::filesystem::path path);  // empty: no JSON is wanted
    ~JsonOutput();
    JsonOutput(const JsonOutput&) = delete;
    JsonOutput& operator=(const JsonOutput&) = delete;

    bool IsWanted() const { return !path_.empty(); }
    // Both return an empty text, or what is wrong. Check is for before the simulation. Write prints where it wrote, if
    // asked to.
    std::string Check() const;
    std::string Write(const nlohmann::ordered_json& json, bool saysWhere = true) const;

private:
    std::filesystem::path path_;
    int standardOutput_ = -1;  // the saved descriptor while it is redirected
};

}  // namespace fulcrum
