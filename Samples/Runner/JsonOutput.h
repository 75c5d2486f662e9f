// Where the JSON of --json goes: into a file, or to standard output where it is named "-". While an output of that name
// lives, all else that is printed goes to standard error, so that whoever reads gets JSON alone. One at a time, one
// thread.
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
    // Both give an empty text where all is well, else what is wrong. Check is for before minutes are spent on what is
    // to be written. Write says where it wrote.
    std::string Check() const;
    std::string Write(const nlohmann::ordered_json& json) const;

private:
    std::filesystem::path path_;
    int standardOutput_ = -1;  // the descriptor that stood for it, where it is taken
};

}  // namespace fulcrum
