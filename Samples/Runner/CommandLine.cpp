#include <Fulcrum/Samples/Runner/CommandLine.h>

#include <Fulcrum/Samples/Runner/NearestName.h>

#include <algorithm>
#include <charconv>
#include <sstream>

namespace fulcrum {
namespace {

template <class Number>
std::string ToText(Number value) {
    std::ostringstream text;
    text << value;
    return text.str();
}

// The whole text as a number between the bounds.
template <class Number>
Number Parse(const std::string& name, const std::string& text, Number lowest, Number highest, const char* kind) {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    const std::string range = ToText(lowest) + " to " + ToText(highest);
    // Overflow: infinite.
    if (error == std::errc::result_out_of_range && stop == end) value = text[0] == '-' ? lowest : highest;
    else if (error != std::errc() || stop != end || !(value == value))
        throw CLI::ValidationError(name + " takes " + kind + " from " + range + ", not '" + text + "'");
    if (error != std::errc() || value < lowest || value > highest)
        throw CLI::ValidationError(name + " " + text + " is outside " + range + "; the nearest valid value is " +
                                   ToText(std::clamp(value, lowest, highest)));
    return value;
}

// A sub-command that was named, or the program itself.
CLI::App& Chosen(CLI::App& app) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    return chosen.empty() ? app : *chosen.front();
}

std::vector<std::string> OptionNames(CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options())
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    return names;
}

std::string HelpHint(const CLI::App& app) {
    return app.get_parent() ? " (./fulcrum " + app.get_name() + " --help shows all)" : " (--help shows all)";
}

// Arguments that are no option and no positional.
Error Unexpected(CLI::App& app, const std::string& argument) {
    CLI::App& chosen = Chosen(app);
    if (argument.size() > 1 && argument[0] == '-') {
        const std::string name = argument.substr(0, argument.find('='));
        Error error = UnknownName("option", name, OptionNames(chosen));
        error.message += HelpHint(chosen);
        return error;
    }
    std::vector<std::string> commands;
    if (&chosen == &app)
        for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
    if (!commands.empty()) return UnknownName("command", argument, commands);
    return {ErrorCode::OutOfRange, "one argument too many: '" + argument + "'" + HelpHint(chosen)};
}

}  // namespace

CLI::Option* AddText(CLI::App& app, const std::string& name, const std::string& help,
                     std::function<void(const std::string&)> store) {
    return app.add_option_function<std::string>(name, std::move(store), help);
}

CLI::Option* AddInteger(CLI::App& app, const std::string& name, int lowest, int highest, const std::string& help,
                        std::function<void(int)> store) {
    return AddText(app, name, help,
                   [=](const std::string& text) { store(Parse(name, text, lowest, highest, "a whole number")); })
        ->type_name("N");
}

CLI::Option* AddIntegers(CLI::App& app, const std::string& name, int lowest, int highest, const std::string& help,
                         std::function<void(const std::vector<int>&)> store) {
    return AddText(app, name, help,
                   [=](const std::string& text) {
                       std::vector<int> values;
                       std::istringstream list(text + ",");
                       for (std::string part; std::getline(list, part, ',');)
                           values.push_back(Parse(name, part, lowest, highest, "whole numbers"));
                       store(values);
                   })
        ->type_name("N,...");
}

CLI::Option* AddReal(CLI::App& app, const std::string& name, double lowest, double highest, const std::string& help,
                     std::function<void(double)> store) {
    return AddText(app, name, help,
                   [=](const std::string& text) { store(Parse(name, text, lowest, highest, "a number")); })
        ->type_name("X");
}

CLI::Option* AddSeed(CLI::App& app, const std::string& name, const std::string& help,
                     std::function<void(uint64_t)> store) {
    return AddText(
               app, name, help,
               [=](const std::string& text) { store(Parse<uint64_t>(name, text, 0, UINT64_MAX, "a whole number")); })
        ->type_name("N");
}

Error UnknownName(const std::string& what, const std::string& name, std::span<const std::string> names) {
    return {ErrorCode::OutOfRange,
            "unknown " + what + " '" + name + "'; the nearest is '" + NearestName(name, names) + "'"};
}

Result<std::string> ParseCommandLine(CLI::App& app, std::vector<std::string> arguments) {
    app.allow_extras();
    for (CLI::App* command : app.get_subcommands({})) command->allow_extras();
    std::reverse(arguments.begin(), arguments.end());  // as CLI11 takes them
    try {
        app.parse(std::move(arguments));
    } catch (const CLI::CallForHelp&) {
        return Chosen(app).help(app.get_subcommands().empty() ? "" : "./" + app.get_name());
    } catch (const CLI::ParseError& error) {
        // If a value is missing because an unknown option follows, report that option.
        const std::vector<std::string> rest = app.remaining(true);
        if (!rest.empty() && dynamic_cast<const CLI::ValidationError*>(&error) == nullptr)
            return Unexpected(app, rest[0]);
        return Error{ErrorCode::OutOfRange, error.what() + HelpHint(Chosen(app))};
    }
    const std::vector<std::string> rest = app.remaining(true);
    if (!rest.empty()) return Unexpected(app, rest[0]);
    return std::string();
}

}  // namespace fulcrum
