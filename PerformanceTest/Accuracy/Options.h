// The command lines of ./fulcrum accuracy and ./fulcrum advise. Read by Main.cpp.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/Lab.h>
#include <Fulcrum/PerformanceTest/Accuracy/Recordings.h>

#include <optional>
#include <string>
#include <vector>

namespace fulcrum::accuracy {

struct LabCommand {
    LabOptions lab;
    std::filesystem::path table;           // a document to write the tables into; empty: none
    std::filesystem::path save, baseline;  // of errors, see Baseline.h; empty: none
    RecordingOptions recordings;
    bool soaks = false;  // --soak: one long run, whose errors and conditions are printed
    std::string commit;
    std::optional<double> adviseError, adviseBudget;  // a part; ms a frame. One of both: the command advises
    std::string help;                                 // not empty: only help was requested
};

// Arguments without the program's name; the first may be "advise", which loads the user's scene (UserScene.h). Error
// OutOfRange: one line that says what is wrong.
Result<LabCommand> ParseLabCommand(std::vector<std::string> arguments);

}  // namespace fulcrum::accuracy
