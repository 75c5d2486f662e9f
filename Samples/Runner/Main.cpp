// fulcrum-runner: what ./fulcrum run, drop and list start.
#include <Fulcrum/Samples/Runner/Commands.h>
#include <Fulcrum/Samples/Runner/StandardOutput.h>

#include <cstdio>

int main(int argc, char** argv) {
    const fulcrum::Result<fulcrum::Command> command =
        fulcrum::ParseRunnerCommand(std::vector<std::string>(argv + 1, argv + argc));
    if (!command) {
        std::fprintf(stderr, "fulcrum: %s\n", command.GetError().message.c_str());
        return 1;
    }
    return fulcrum::WithStandardOutput([&] { return fulcrum::Execute(command.Value()); });
}
