// Parses command lines; error messages name the nearest valid option or value. Used by the runner and the benchmark, on
// top of CLI11; one thread.
#pragma once

#include <Fulcrum/Math/Result.h>

#include <CLI/CLI.hpp>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace fulcrum {

// Options that take one value. A value that is no number, or outside lowest..highest, is an error of ParseCommandLine
// that names the nearest valid value.
CLI::Option* AddInteger(CLI::App& app, const std::string& name, int lowest, int highest, const std::string& help,
                        std::function<void(int)> store);
// Several, separated by commas.
CLI::Option* AddIntegers(CLI::App& app, const std::string& name, int lowest, int highest, const std::string& help,
                         std::function<void(const std::vector<int>&)> store);
CLI::Option* AddReal(CLI::App& app, const std::string& name, double lowest, double highest, const std::string& help,
                     std::function<void(double)> store);
CLI::Option* AddSeed(CLI::App& app, const std::string& name, const std::string& help,
                     std::function<void(uint64_t)> store);
// `store` may throw CLI::ValidationError.
CLI::Option* AddText(CLI::App& app, const std::string& name, const std::string& help,
                     std::function<void(const std::string&)> store);

// `what` is what the names are ("scene"). The error's message names the nearest one.
Error UnknownName(const std::string& what, const std::string& name, std::span<const std::string> names);

// Arguments without the program's name. Returns an empty text, or the requested help. Error OutOfRange: one line that
// says what is wrong, suggests what was meant and names --help.
Result<std::string> ParseCommandLine(CLI::App& app, std::vector<std::string> arguments);

}  // namespace fulcrum
